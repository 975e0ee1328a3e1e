//! Counting in tiles: the lists of triangles, the method of each tile, the counts of its samples.

use std::sync::atomic::{AtomicU64, Ordering};

use super::CounterOptions;
use super::fault::{Fault, Faults};
use super::parts::{ClosedVolume, SeenPart};
use super::state::State;
use super::triangle::{Meeting, Place};
use super::view::{Cell, TileRow, Tiles, View};
use crate::shadow::{Samples, Updates};

/// How volumes are counted.
#[derive(Clone, Copy, Debug)]
pub(in crate::shadow) struct Counter {
    /// Samples along each side of a tile.
    tile: usize,
    /// The state for all triangles; `None` to choose in each tile.
    state: Option<State>,
    pub(super) faults: Faults,
}

/// Tiles of the default size, each counted by the method with fewer triangles.
impl Default for Counter {
    fn default() -> Self {
        Self::of(CounterOptions::DEFAULT)
    }
}

/// Work of a picture, added up by several threads.
#[derive(Debug, Default)]
struct Work {
    fragments: AtomicU64,
    updates: AtomicU64,
}

impl Counter {
    pub(super) fn of(options: CounterOptions) -> Self {
        Self { tile: options.tile.clamp(1, 64) as usize, state: None, faults: Faults::default() }
    }

    /// The same with one state for all triangles.
    pub(super) fn with_state(self, state: State) -> Self {
        Self { state: Some(state), ..self }
    }

    /// Every triangle counted by the complement of z-fail's test: as many fragments as z-fail has.
    pub(in crate::shadow) fn reversed() -> Self {
        Self::default().with_state(State::REVERSED)
    }

    /// The count of each sample that is asked; `None` where a point lies on a volume.
    ///
    /// Memory: some 220 bytes per triangle that is in the picture, part by part, and 8 per triangle and tile
    /// of a row.
    pub(in crate::shadow) fn counts<'v>(
        &self,
        samples: &Samples,
        asked: &[bool],
        volumes: impl IntoIterator<Item = &'v ClosedVolume>,
    ) -> (Vec<Option<i32>>, Updates) {
        let (work, mut counts) = (Work::default(), vec![Some(0); samples.len()]);
        let Some(view) = View::of(samples.projection()) else {
            return (vec![None; samples.len()], Updates::default());
        };
        let tiles = Tiles::of(samples, asked, &view, self.tile, self.faults);
        for (volume, part) in volumes.into_iter().flat_map(ClosedVolume::parts) {
            let seen = tiles.all.and_then(|all| SeenPart::of(volume, part, &view, &all, self.faults));
            let Some(part) = seen else { continue };
            let picture = Picture { counter: self, samples, asked, view: &view, part: &part, work: &work };
            crate::parallel::rows(&mut counts, samples.row_len() * self.tile, |index, counts| {
                if let Some(row) = &tiles.rows[index] {
                    picture.row(index, row, counts);
                }
            });
        }
        for &outside in &tiles.outside {
            counts[outside] = None;
        }
        let [fragments, updates] = [work.fragments, work.updates].map(AtomicU64::into_inner);
        (counts, Updates { fragments, updates })
    }
}

/// One part of a volume in one picture.
struct Picture<'a> {
    counter: &'a Counter,
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
        if let Some(state) = self.counter.state {
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
            if self.counter.faults.has(Fault::WrongSideDropped) { Place::Before } else { left_out };
        let kept = list.iter().copied().filter(|(_, place)| *place != left_out);
        let crosses = |(_, place): &(u32, Place)| *place == Place::Across;
        let is_uniform = !list.iter().any(crosses) || self.counter.faults.has(Fault::CrossedIsUniform);
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
        let (width, side) = (self.samples.row_len(), self.counter.tile);
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
            let meeting = triangle.meet(volume, self.view, sample.point, self.counter.faults);
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
