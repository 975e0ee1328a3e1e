//! A software counter: shadow volumes rasterized in tiles, with exact signs.
//!
//! In each tile every part of a volume is counted by the method that takes fewer triangles there: from the
//! eye to the visible points (depth pass), or from the points to infinity (depth fail). Both give the winding
//! number, the first from that at the eye on. Three refinements, none of which changes a count:
//!
//! - *Split plane.* (Samuli Laine, *Split-Plane Shadow Volumes*, Graphics Hardware 2005.) The choice of the
//!   method, once for each tile and part: triangles wholly behind the tile's points do not count from the
//!   eye, and those wholly before them do not count behind. Laine's plane through the light tells which side
//!   has fewer; here they are counted.
//! - *Hierarchy.* (Timo Aila and Tomas Akenine-Möller, *A Hierarchical Shadow Volume Algorithm for Real-Time
//!   Rendering*, Graphics Hardware 2004.) Where no triangle crosses a tile between its least and greatest
//!   depth, one sample decides all.
//! - *Depth bounds.* (Morgan McGuire, John Hughes, Kevin Egan, Mark Kilgard, Cass Everitt, *Fast, Practical
//!   and Robust Shadows*, 2003.) A part that lies outside the tile's depths is left out.
//!
//! The same rasterizer counts by one stencil state alone: the technique `zpass-reversed`.

mod count;
mod fault;
mod form;
mod options;
mod parts;
mod state;
#[cfg(test)]
mod tests;
mod triangle;
mod view;

pub use options::CounterOptions;

pub(in crate::shadow) use self::count::Counter;
pub(in crate::shadow) use self::parts::ClosedVolume;
use crate::caster::CasterGroup;
use crate::geom::Light;
use crate::oracle::Verdict;
use crate::shadow::visibility::asked;
use crate::shadow::volume::Caps;
use crate::shadow::{Answer, Claim, LampShadow, Samples, Visibility};

/// The volumes of one light, and how they are counted.
#[derive(Debug)]
pub(in crate::shadow) struct TiledCounting<'a> {
    casters: &'a CasterGroup<'a>,
    light: Light,
    volumes: Vec<ClosedVolume>,
    counter: Counter,
}

impl<'a> TiledCounting<'a> {
    /// For the technique `counter`.
    pub(in crate::shadow) fn prepare(
        casters: &'a CasterGroup<'a>,
        light: &Light,
        options: CounterOptions,
    ) -> Self {
        Self::with(casters, light, Counter::of(options))
    }

    /// For the technique `zpass-reversed`.
    pub(in crate::shadow) fn prepare_reversed(casters: &'a CasterGroup<'a>, light: &Light) -> Self {
        Self::with(casters, light, Counter::reversed())
    }

    fn with(casters: &'a CasterGroup<'a>, light: &Light, counter: Counter) -> Self {
        let all = casters.casters().iter();
        let volumes = all.map(|caster| ClosedVolume::new(caster.volume(light, Caps::Both))).collect();
        Self { casters, light: *light, volumes, counter }
    }
}

impl LampShadow for TiledCounting<'_> {
    /// A sample is in shadow if its count is not 0. If its point lies on a volume, the exact ray cast
    /// decides.
    fn shade(&self, samples: &Samples) -> Visibility {
        let (counts, updates) = self.counter.counts(samples, &asked(samples, &self.light), &self.volumes);
        let visibility =
            Visibility::of_indexed(samples, &self.light, Claim::Exact, |index, hit| match counts[index] {
                Some(count) => Answer::of(f32::from(u8::from(count == 0))),
                None => {
                    let dark = self.casters.oracle().verdict(hit.point, &self.light) == Verdict::Shadowed;
                    Answer { is_exact: true, ..Answer::of(f32::from(u8::from(!dark))) }
                }
            });
        visibility.with_updates(updates)
    }

    fn bytes(&self) -> usize {
        self.volumes.iter().map(ClosedVolume::bytes).sum()
    }
}
