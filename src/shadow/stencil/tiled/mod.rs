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

mod fault;
mod form;
mod options;
mod parts;
mod state;
#[cfg(test)]
mod tests;
mod triangle;
mod view;

use std::sync::atomic::{AtomicU64, Ordering};

pub use options::CounterOptions;

use self::fault::{Fault, Faults};
use self::parts::{Part, SeenPart, parts};
use self::state::State;
use self::triangle::{Meeting, Place};
use self::view::{Cell, TileRow, View, tile_rows};
use crate::caster::CasterGroup;
use crate::geom::Light;
use crate::oracle::Verdict;
use crate::shadow::visibility::asked;
use crate::shadow::volume::{Caps, ShadowVolume};
use crate::shadow::{Answer, Claim, LampShadow, Samples, Updates, Visibility};

/// The volumes of one light, in closed parts.
#[derive(Debug)]
pub(in crate::shadow) struct TiledCounting<'a> {
    casters: &'a CasterGroup<'a>,
    light: Light,
    volumes: Vec<(ShadowVolume, Vec<Part>)>,
    /// Samples along each side of a tile.
    tile: usize,
    /// The state for all triangles; `None` to choose in each tile.
    state: Option<State>,
    faults: Faults,
}

/// Work of a picture, added up by several threads.
#[derive(Debug, Default)]
struct Work {
    fragments: AtomicU64,
    updates: AtomicU64,
}

impl<'a> TiledCounting<'a> {
    /// For the technique `counter`.
    pub(in crate::shadow) fn prepare(
        casters: &'a CasterGroup<'a>,
        light: &Light,
        options: CounterOptions,
    ) -> Self {
        Self::with_state(casters, light, options.tile, None)
    }

    /// For the technique `zpass-reversed`.
    pub(in crate::shadow) fn prepare_reversed(casters: &'a CasterGroup<'a>, light: &Light) -> Self {
        Self::with_state(casters, light, CounterOptions::DEFAULT.tile, Some(State::REVERSED))
    }

    fn with_state(casters: &'a CasterGroup<'a>, light: &Light, tile: u32, state: Option<State>) -> Self {
        let volumes = casters.casters().iter().map(|caster| {
            let volume = caster.volume(light, Caps::Both);
            let parts = parts(&volume);
            (volume, parts)
        });
        let (volumes, tile) = (volumes.collect(), tile.clamp(1, 64) as usize);
        Self { casters, light: *light, volumes, tile, state, faults: Faults::default() }
    }

    /// The count of each sample that is asked; `None` where a point lies on a volume.
    fn counts(&self, samples: &Samples, asked: &[bool]) -> (Vec<Option<i32>>, Updates) {
        let (work, mut counts) = (Work::default(), vec![Some(0); samples.len()]);
        let Some(view) = View::of(samples.projection()) else {
            return (vec![None; samples.len()], Updates::default());
        };
        let rows = tile_rows(samples, asked, &view, self.tile, self.faults);
        for (volume, part) in
            self.volumes.iter().flat_map(|(volume, parts)| parts.iter().map(move |part| (volume, part)))
        {
            let part = SeenPart::of(volume, part, &view, self.faults);
            let picture = Picture { counting: self, samples, asked, view: &view, part: &part, work: &work };
            crate::parallel::rows(&mut counts, samples.row_len() * self.tile, |index, counts| {
                if let Some(row) = &rows[index] {
                    picture.row(index, row, counts);
                }
            });
        }
        let [fragments, updates] = [work.fragments, work.updates].map(AtomicU64::into_inner);
        (counts, Updates { fragments, updates })
    }
}

/// One part of a volume in one picture.
struct Picture<'a> {
    counting: &'a TiledCounting<'a>,
    samples: &'a Samples,
    asked: &'a [bool],
    view: &'a View,
    part: &'a SeenPart<'a>,
    work: &'a Work,
}

impl Picture<'_> {
    /// Counts the part in a row of tiles; `counts` are those of the row's samples.
    fn row(&self, index: usize, row: &TileRow, counts: &mut [Option<i32>]) {
        if self.part.is_apart(&row.all) {
            return;
        }
        let mut lists: Vec<Vec<(u32, Place)>> = vec![Vec::new(); row.tiles.len()];
        for (number, triangle) in (0..).zip(&self.part.triangles) {
            if !triangle.may_meet(&row.all) {
                continue;
            }
            for (list, cell) in lists.iter_mut().zip(&row.tiles) {
                if let Some(place) = cell.as_ref().and_then(|cell| triangle.place(cell)) {
                    list.push((number, place));
                }
            }
        }
        for (column, (list, cell)) in lists.iter().zip(&row.tiles).enumerate() {
            if let Some(cell) = cell.as_ref().filter(|_| !list.is_empty()) {
                self.tile([column, index], cell, list, counts);
            }
        }
    }

    /// Counts the part in one tile.
    fn tile(&self, tile: [usize; 2], cell: &Cell, list: &[(u32, Place)], counts: &mut [Option<i32>]) {
        let mut samples = self.samples_of(tile);
        if let Some(state) = self.counting.state {
            return samples.for_each(|sample| self.count(sample, state, list.iter().copied(), counts));
        }
        if self.part.is_apart(cell) {
            return;
        }
        let without = |place| list.iter().filter(|(_, own)| *own != place).count();
        let (before, behind) = (without(Place::Behind), without(Place::Before));
        let is_from_eye = self.part.at_eye.is_some() && before <= behind;
        let (state, left_out) =
            if is_from_eye { (State::ZPASS, Place::Behind) } else { (State::ZFAIL, Place::Before) };
        let left_out =
            if self.counting.faults.has(Fault::WrongSideDropped) { Place::Before } else { left_out };
        let kept = list.iter().copied().filter(|(_, place)| *place != left_out);
        let crosses = |(_, place): &(u32, Place)| *place == Place::Across;
        let is_uniform = !list.iter().any(crosses) || self.counting.faults.has(Fault::CrossedIsUniform);
        if is_uniform && let Some(first) = samples.next() {
            // The tile's points are not parted from each other by the part.
            let mut own = [Some(0)];
            self.count(Sample { slot: 0, ..first }, state, kept.clone(), &mut own);
            if let [Some(count)] = own {
                for sample in std::iter::once(first).chain(samples) {
                    counts[sample.slot] = counts[sample.slot].map(|own| own + count);
                }
                return;
            }
            samples = self.samples_of(tile);
        }
        samples.for_each(|sample| self.count(sample, state, kept.clone(), counts));
    }

    /// The samples of a tile that are asked and in front of the eye.
    fn samples_of(&self, [column, row]: [usize; 2]) -> impl Iterator<Item = Sample> + '_ {
        let (width, side) = (self.samples.row_len(), self.counting.tile);
        let columns = column * side..((column + 1) * side).min(width);
        let first = row * side * width;
        let rows = 0..side.min(self.samples.len() / width - row * side);
        rows.flat_map(move |y| columns.clone().map(move |x| y * width + x)).filter_map(move |slot| {
            let hit = self.samples.hits()[first + slot].as_ref().filter(|_| self.asked[first + slot])?;
            Some(Sample { slot, point: hit.point, face: hit.corners })
        })
    }

    /// Adds to the count of a sample.
    fn count(
        &self,
        sample: Sample,
        state: State,
        triangles: impl Iterator<Item = (u32, Place)>,
        counts: &mut [Option<i32>],
    ) {
        let volume = self.part.volume;
        let start = if state.is_from_eye() { self.part.at_eye } else { Some(0) };
        let (mut sum, mut fragments, mut updates) = (start, 0, 0);
        for (number, _) in triangles {
            let triangle = &self.part.triangles[number as usize];
            let meeting = triangle.meet(volume, self.view, sample.point, self.counting.faults);
            if meeting == Meeting::On {
                sum = None;
            }
            fragments += u64::from(meeting != Meeting::Miss);
            if let Some(value) = state.update(meeting, || triangle.is_face(volume, sample.face)) {
                updates += 1;
                sum = sum.map(|sum| sum + value);
            }
        }
        self.work.fragments.fetch_add(fragments, Ordering::Relaxed);
        self.work.updates.fetch_add(updates, Ordering::Relaxed);
        let count = &mut counts[sample.slot];
        *count = count.zip(sum).map(|(count, sum)| count + sum);
    }
}

/// A visible point, and its place among the samples of its row of tiles.
#[derive(Clone, Copy)]
struct Sample {
    slot: usize,
    point: [f32; 3],
    face: [[f32; 3]; 3],
}

impl LampShadow for TiledCounting<'_> {
    /// A sample is in shadow if its count is not 0. If its point lies on a volume, the exact ray cast
    /// decides.
    fn shade(&self, samples: &Samples) -> Visibility {
        let (counts, updates) = self.counts(samples, &asked(samples, &self.light));
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
        let of_parts = |parts: &Vec<Part>| parts.iter().map(|part| size_of_val(&part[..])).sum::<usize>();
        self.volumes.iter().map(|(volume, parts)| volume.bytes() + of_parts(parts)).sum()
    }
}
