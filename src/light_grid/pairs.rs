//! Pairs of a face and a cell that it may meet, sorted by cell.

use super::bits::RankedBits;
use super::cells::Cells;
use super::chain::ChainFace;
use super::facet::{Facet, Meeting};
use super::fault::{Fault, Faults};
use super::view::View;

/// A face in a cell.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Pair {
    /// Rank of the cell among the cells that hold a point.
    pub(super) slot: u32,
    pub(super) face: u32,
    /// The greatest nearness in the cell, rounded up.
    pub(super) near: f32,
    /// The least nearness in the cell, rounded down.
    pub(super) far: f32,
    /// One bit per edge that the cell's rays may meet.
    pub(super) met: u8,
    pub(super) ray: GenericRay,
}

/// How the cell's generic ray meets the face.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum GenericRay {
    #[default]
    Misses,
    Crosses,
    /// It may touch an edge.
    Unsure,
}

/// Cells looked at for each pair that may be made. Most cells that a face's rectangle holds may hold no
/// point.
const LOOKS: usize = 16;

/// The pairs of the faces with the cells that hold a point, face by face; `None` if there would be more than
/// `most`, or if too many cells would have to be looked at.
pub(super) fn pairs(
    faces: impl Iterator<Item = ChainFace>,
    view: &View,
    cells: &Cells,
    occupied: &RankedBits,
    most: usize,
    faults: Faults,
) -> Option<Vec<Pair>> {
    let (mut pairs, mut looks) = (Vec::new(), LOOKS.saturating_mul(most));
    for face in faces {
        let Some([columns, rows]) = view.bounds(face.corners).and_then(|bounds| cells.of(&bounds)) else {
            continue;
        };
        let [width, height] = [columns, rows].map(|[first, last]| (last - first) as usize + 1);
        looks = looks.checked_sub(width * height)?;
        let mut facet = None;
        for y in rows[0]..=rows[1] {
            for x in columns[0]..=columns[1] {
                let Some(slot) = occupied.rank(cells.number(x, y)) else { continue };
                let facet = facet.get_or_insert_with(|| Facet::new(view, face.corners, face.sign));
                let square = cells.square([x, y]);
                let met = match facet.meeting(&square) {
                    Meeting::None => continue,
                    Meeting::All => 0,
                    Meeting::Some(met) => met,
                };
                let [far, near] = facet.nearness(&square);
                let ray = match cells.generic_ray([x, y]).map(|ray| facet.meeting(&ray)) {
                    Some(Meeting::None) => GenericRay::Misses,
                    Some(Meeting::All) => GenericRay::Crosses,
                    Some(Meeting::Some(_)) if faults.has(Fault::TouchIsCrossing) => GenericRay::Crosses,
                    _ => GenericRay::Unsure,
                };
                let (mut near, mut far) = (above(near), below(far));
                if faults.has(Fault::RoundedInwards) {
                    (near, far) = (near.next_down(), far.next_up());
                }
                if pairs.len() == most {
                    return None;
                }
                pairs.push(Pair { slot, face: face.face, near, far, met, ray });
            }
        }
    }
    Some(pairs)
}

/// What lies in cells by cell, and the index of each cell's first item, one more than there are cells. A
/// counting sort: within a cell the order stays.
pub(super) fn by_cell<T: Copy + Default>(
    items: &[T],
    cells: u32,
    slot: impl Fn(&T) -> u32,
) -> (Vec<T>, Vec<u32>) {
    let mut starts = vec![0; cells as usize + 2];
    for item in items {
        starts[slot(item) as usize + 2] += 1;
    }
    for slot in 2..starts.len() {
        starts[slot] += starts[slot - 1];
    }
    let mut sorted = vec![T::default(); items.len()];
    for item in items {
        let at = &mut starts[slot(item) as usize + 1];
        sorted[*at as usize] = *item;
        *at += 1;
    }
    starts.pop();
    (sorted, starts)
}

/// The least `f32` that is not below.
fn above(x: f64) -> f32 {
    let rounded = x as f32;
    if f64::from(rounded) < x { rounded.next_up() } else { rounded }
}

/// The greatest `f32` that is not above.
fn below(x: f64) -> f32 {
    let rounded = x as f32;
    if f64::from(rounded) > x { rounded.next_down() } else { rounded }
}
