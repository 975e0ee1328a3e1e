//! Penumbrae of exact silhouette edges: the techniques `penumbra-map` and `smoothies`.
//!
//! (Chris Wyman and Charles Hansen, *Penumbra Maps*, EGSR 2003; Eric Chan and Frédo Durand, *Rendering Fake
//! Soft Shadows with Smoothies*, EGSR 2003.) The hard shadow is exact. Outside it the nearest edge counts, in
//! half-widths of its penumbra: by the penumbra law for `penumbra-map`; for `smoothies` from one width that
//! all edges have in the map. That width is right for edges of mean depth. No picture of the edges is drawn:
//! each sample asks the edges themselves.
//!
//! As published (`profile=full`) light grows from 0 at the hard edge to 1, and the umbra stays as large as
//! the hard shadow. With `profile=half` it grows from one half, and inside the hard shadow the map gives the
//! other half, as `single-sample` does. (Edges inside a shadow are hidden from the light: they do not
//! brighten it.)

use super::edges::Edges;
use super::horizon::AboveHorizon;
use super::light_map::{LightMap, Receiver};
use super::{Profile, SilhouetteOptions};
use crate::caster::CasterGroup;
use crate::oracle::{PrimaryHit, Verdict};
use crate::scene::Lamp;
use crate::shadow::LampShadow;
use crate::shadow::map::MapError;
use crate::shadow::{Answer, Claim, Samples, Visibility};

#[derive(Debug)]
struct Silhouettes<'a> {
    map: LightMap<'a>,
    edges: Edges,
    profile: Profile,
    /// Whether all edges have one width in the map.
    is_fixed: bool,
}

pub(in crate::shadow) fn penumbra_map<'a>(
    casters: &'a CasterGroup<'a>,
    lamp: &Lamp,
    options: SilhouetteOptions,
) -> Result<Box<dyn LampShadow + 'a>, MapError> {
    prepare(casters, lamp, options, false)
}

pub(in crate::shadow) fn smoothies<'a>(
    casters: &'a CasterGroup<'a>,
    lamp: &Lamp,
    options: SilhouetteOptions,
) -> Result<Box<dyn LampShadow + 'a>, MapError> {
    prepare(casters, lamp, options, true)
}

fn prepare<'a>(
    casters: &'a CasterGroup<'a>,
    lamp: &Lamp,
    options: SilhouetteOptions,
    is_fixed: bool,
) -> Result<Box<dyn LampShadow + 'a>, MapError> {
    let map = LightMap::prepare(casters, lamp, options.size)?;
    let edges = Edges::of(&map);
    let silhouettes = Silhouettes { map, edges, profile: options.profile, is_fixed };
    Ok(Box::new(AboveHorizon::new(silhouettes, lamp)))
}

impl Silhouettes<'_> {
    fn answer(&self, hit: &PrimaryHit) -> Answer {
        let is_dark =
            self.map.casters.oracle().verdict(hit.point, self.map.lamp.light()) == Verdict::Shadowed;
        let value = |receiver: &mut Receiver<'_>| match (self.profile, is_dark) {
            (Profile::Full, true) => 0.0,
            (Profile::Full, false) => self.nearest_edge(receiver),
            (Profile::Half, true) => inner(receiver),
            (Profile::Half, false) => receiver.profile(self.nearest_edge(receiver)),
        };
        let answer = self.map.answer(hit, value);
        // Where the map has no answer, the hard shadow is one.
        let is_unknown =
            answer.is_outside || !self.map.receiver(hit).is_some_and(|receiver| receiver.is_sound());
        let value = if is_unknown && is_dark { 0.0 } else { answer.value };
        Answer { value, is_exact: true, ..answer }
    }

    fn nearest_edge(&self, receiver: &Receiver<'_>) -> f64 {
        let k = receiver.k[0].max(receiver.k[1]);
        if k == 0.0 {
            return 1.0;
        }
        match self.is_fixed {
            false => self.edges.nearest(receiver, |_, above| k * above),
            true => self.edges.nearest(receiver, |depth, above| k * self.edges.mean_depth * above / depth),
        }
    }
}

/// The inner half of the penumbra, at a point in the hard shadow. An open texel there says that an edge
/// passes within a texel.
fn inner(receiver: &mut Receiver<'_>) -> f64 {
    match receiver.own_texel() {
        Some((depth, true)) if receiver.k[0] > 0.0 => {
            let q = receiver.nearest_open(depth);
            receiver.profile(-q)
        }
        Some((_, false)) if receiver.k[0] > 0.0 => 0.5,
        _ => 0.0,
    }
}

impl LampShadow for Silhouettes<'_> {
    fn shade(&self, samples: &Samples) -> Visibility {
        Visibility::of(samples, self.map.lamp.light(), Claim::Approximate, |hit| self.answer(hit))
    }

    fn bytes(&self) -> usize {
        self.map.bytes() + self.edges.bytes()
    }

    fn texel_world(&self) -> Option<f64> {
        Some(self.map.texel_world())
    }

    fn bias_world(&self) -> Option<f64> {
        Some(self.map.bias_world())
    }
}

#[cfg(test)]
mod tests {
    use crate::shadow::soft::tests::{SQUARE, SUN, disk_fraction, square_fraction, values, worst};

    #[test]
    fn silhouettes_equal_the_visible_part_of_an_aligned_half_plane() {
        for name in ["penumbra-map", "smoothies"] {
            let technique = format!("{name}:size=256");
            // Outside the hard shadow without any map: to rounding, where all edges that matter are at one
            // depth.
            let square = values(&technique, SQUARE, 0.0);
            let is_exact = name == "penumbra-map";
            let outer: Vec<_> = square.iter().copied().filter(|(x, _)| *x > 1e-3).collect();
            let off =
                outer.iter().fold(0.0, |most: f64, &(x, v)| most.max((v - square_fraction(x, 0.0)).abs()));
            assert_eq!(off < 1e-5, is_exact, "{name} {off}");
            let error = worst(&square, |x| square_fraction(x, 0.0));
            assert!(error < if is_exact { 0.06 } else { 0.2 }, "{name} {error}");
            let error = worst(&values(&technique, SUN, 0.0), disk_fraction);
            assert!(error < if is_exact { 0.1 } else { 0.3 }, "{name} {error}");
            // As published: too dark by a half at the hard edge.
            let full = values(&format!("{name}:size=256,profile=full"), SQUARE, 0.0);
            assert!(worst(&full, |x| square_fraction(x, 0.0)) > 0.45, "{name}");
            assert!(full.iter().all(|&(x, value)| x > 0.0 || value == 0.0));
        }
    }
}
