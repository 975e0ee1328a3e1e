//! Points sorted into the cells of a grid, and each face tested against the points of its cells: alias-free
//! shadows without a tree over the faces.
//!
//! (Timo Aila and Samuli Laine, *Alias-Free Shadow Maps*, EGSR 2004; Gregory Johnson et al., *The Irregular
//! Z-Buffer*, 2005.) Each test is that of the exact ray cast.

use super::bits::RankedBits;
use super::cells::Cells;
use super::chain::{Chain, ChainFace};
use super::facet::{Facet, Meeting};
use super::fault::{Fault, Faults};
use super::grid::{Rectangle, rectangle, window_around};
use super::pairs::by_cell;
use super::verdict::GridVerdict;
use super::view::View;
use crate::geom::predicate::Homogeneous;
use crate::geom::{Aabb, Light};
use crate::oracle::segment_filter::{Outcome, SegmentFilter};
use crate::oracle::{Intersection, intersect};

/// The verdicts about points, by each face in the cells that it meets, `side` cells along each side of each
/// view. An exact tie counts as lit.
///
/// Memory: some 200 bytes per point. Faces that overlap in most cells, as the light sees them, would take all
/// faces times all points: after some seconds of work the points that are not dark are left undecided.
#[must_use]
pub fn sorted_verdicts(chain: &Chain<'_>, points: &[[f32; 3]], side: u32) -> Vec<GridVerdict> {
    let most = (1 << 28) + 256 * (points.len() + chain.face_count());
    verdicts_with(chain, points, side, most, Faults::default())
}

pub(super) fn verdicts_with(
    chain: &Chain<'_>,
    points: &[[f32; 3]],
    side: u32,
    most: usize,
    faults: Faults,
) -> Vec<GridVerdict> {
    let views = View::all(&Aabb::around(points.iter().copied()), chain.light());
    let casting = Aabb::around(chain.faces().flat_map(|face| face.corners));
    let scene = Scene { points, light: chain.light(), casting };
    let (mut verdicts, mut spare) = (vec![GridVerdict::Lit; points.len()], Some(most));
    for (number, view) in views.iter().enumerate() {
        let held = (0..).zip(points).filter(|(_, p)| View::holding(&views, **p) == number);
        // A point without a rectangle is the light itself, and lit.
        let held: Vec<(u32, Rectangle)> =
            held.filter_map(|(index, &p)| Some((index, rectangle(view, &view.project(p))?))).collect();
        let Some(mut sorted) = Sorted::of(&scene, view, &held, side.clamp(1, 4096), faults) else { continue };
        spare = spare.and_then(|spare| sorted.test_all(chain, &scene, view, spare));
        for entry in sorted.entries.iter().filter(|entry| entry.is_dark) {
            verdicts[entry.point as usize] = GridVerdict::Dark;
        }
    }
    if spare.is_none() {
        verdicts.iter_mut().filter(|verdict| **verdict == GridVerdict::Lit).for_each(|verdict| {
            *verdict = GridVerdict::Undecided;
        });
    }
    verdicts
}

/// A point of one view, as the faces of a cell meet it.
#[derive(Clone, Copy, Debug)]
struct Entry {
    point: u32,
    way: SegmentFilter,
    is_dark: bool,
}

/// The points of one view, by cell. A point whose rectangle touches several cells is in each of them.
struct Sorted {
    cells: Cells,
    occupied: RankedBits,
    starts: Vec<u32>,
    entries: Vec<Entry>,
    /// The least nearness of the points of each cell.
    deepest: Vec<f64>,
    /// How many points of each cell are not dark.
    alive: Vec<u32>,
}

/// What all points have in common.
struct Scene<'a> {
    points: &'a [[f32; 3]],
    light: &'a Light,
    /// All faces.
    casting: Aabb,
}

impl Scene<'_> {
    /// The segment of a point to the light.
    fn way(&self, point: u32) -> SegmentFilter {
        let p = self.points[point as usize];
        let far = |i: usize| {
            let (p, low, high) =
                (f64::from(p[i]), f64::from(self.casting.low[i]), f64::from(self.casting.high[i]));
            (high - p).max(p - low)
        };
        SegmentFilter::new(p, Homogeneous::light(self.light), far(0).max(far(1)).max(far(2)).max(0.0))
    }
}

impl Sorted {
    /// The points of `held`, given by their number and rectangle; `None` if there are none.
    fn of(
        scene: &Scene<'_>,
        view: &View,
        held: &[(u32, Rectangle)],
        side: u32,
        faults: Faults,
    ) -> Option<Self> {
        let cells = Cells::over(window_around(held.iter().map(|(_, rectangle)| *rectangle))?, side);
        let numbers = |&(point, mut rectangle): &(u32, Rectangle)| {
            if faults.has(Fault::NoErrorBox) {
                let [y1, y2, w] = view.project(scene.points[point as usize]).at;
                rectangle = [y1, y2].map(|y| [f64::from((y / w) as f32); 2]);
            }
            let [columns, rows] = cells.of(&rectangle).unwrap_or_default();
            let row = move |y| (columns[0]..=columns[1]).map(move |x| (cells.number(x, y), point));
            (rows[0]..=rows[1]).flat_map(row)
        };
        let occupied = RankedBits::of(held.iter().flat_map(numbers).map(|(cell, _)| cell), cells.count());
        let slots =
            held.iter().flat_map(numbers).filter_map(|(cell, point)| Some((occupied.rank(cell)?, point)));
        let slots: Vec<(u32, u32)> = slots.collect();
        let (slots, starts) = by_cell(&slots, occupied.count(), |(slot, _)| *slot);
        let mut deepest = vec![f64::INFINITY; occupied.count() as usize];
        for &(slot, point) in &slots {
            let [least, _] = view.project(scene.points[point as usize]).nearness();
            deepest[slot as usize] = deepest[slot as usize].min(least);
        }
        let entry = |&(_, point): &(u32, u32)| Entry { point, way: scene.way(point), is_dark: false };
        let alive = starts.windows(2).map(|range| range[1] - range[0]).collect();
        Some(Self { cells, occupied, starts, entries: slots.iter().map(entry).collect(), deepest, alive })
    }

    /// Tests all faces; `None` if there is more work than `spare`, otherwise what is left of it.
    fn test_all(
        &mut self,
        chain: &Chain<'_>,
        scene: &Scene<'_>,
        view: &View,
        mut spare: usize,
    ) -> Option<usize> {
        for face in chain.faces() {
            let Some([columns, rows]) =
                view.see(face.corners).and_then(|seen| self.cells.of(&seen.rectangle))
            else {
                continue;
            };
            let mut facet = None;
            for y in rows[0]..=rows[1] {
                spare = spare.checked_sub((columns[1] - columns[0]) as usize + 1)?;
                for x in columns[0]..=columns[1] {
                    let Some(slot) = self.occupied.rank(self.cells.number(x, y)) else { continue };
                    if self.alive[slot as usize] == 0 {
                        continue;
                    }
                    let facet = facet.get_or_insert_with(|| Facet::new(view, face.corners, face.sign));
                    let square = self.cells.square([x, y]);
                    let is_near = facet.nearness(&square)[1] > self.deepest[slot as usize];
                    if is_near && facet.meeting(&square) != Meeting::None {
                        spare = spare.checked_sub(self.alive[slot as usize] as usize)?;
                        self.test(scene, slot as usize, &face);
                    }
                }
            }
        }
        Some(spare)
    }

    /// Tests a face against the points of a cell that are not dark.
    fn test(&mut self, scene: &Scene<'_>, slot: usize, face: &ChainFace) {
        for entry in &mut self.entries[self.starts[slot] as usize..self.starts[slot + 1] as usize] {
            if entry.is_dark {
                continue;
            }
            let exactly = || intersect(scene.points[entry.point as usize], scene.light, face.corners);
            let is_crossed = match entry.way.passes(&face.corners) {
                Outcome::Missed => false,
                Outcome::Crossed(_) => true,
                Outcome::Unsure => matches!(exactly(), Intersection::Crossing(_)),
            };
            entry.is_dark = is_crossed;
            self.alive[slot] -= u32::from(is_crossed);
        }
    }
}
