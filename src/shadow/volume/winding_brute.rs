//! Winding numbers of a small volume at many points, by brute force: every triangle is tested, and no tree is
//! built.

use super::ShadowVolume;
use super::winding::{
    Crossing, TRIES, crossing_to, scattered_in, side_of, thickened, weighted, winding_number,
};
use crate::geom::Aabb;
use crate::geom::predicate::{Homogeneous, Sign};

/// What [`WindingIndex`](super::WindingIndex) answers, for volumes so small that a tree over them does not
/// pay: a segment from the point to an anchor whose winding number is known, against every triangle.
#[derive(Debug)]
pub(crate) struct WindingTable<'volume> {
    volume: &'volume ShadowVolume,
    /// Triangles that are neither flat nor wholly at infinity, with the number of their copies.
    triangles: Vec<([Homogeneous; 3], i32)>,
    within: Aabb,
    /// Made when they are asked for; `None` where an anchor lies on the volume.
    anchors: Vec<Option<Anchor>>,
}

#[derive(Debug)]
struct Anchor {
    place: Homogeneous,
    winding: i32,
    /// The side of each triangle that the anchor is on.
    sides: Vec<Sign>,
}

impl<'volume> WindingTable<'volume> {
    /// Prepares `volume` for queries in the box `within`, which is not empty.
    pub(crate) fn new(volume: &'volume ShadowVolume, within: Aabb) -> Self {
        let corners =
            weighted(volume).into_iter().map(|(triangle, copies)| (volume.corners(triangle), copies));
        let triangles = corners.filter(|(corners, _)| corners.iter().any(Homogeneous::is_finite)).collect();
        Self { volume, triangles, within: thickened(within), anchors: Vec::new() }
    }

    /// The winding number at `p`; `None` if `p` lies on a triangle of the volume (or, hardly ever, where
    /// [`winding_number`] abstains).
    pub(crate) fn number(&mut self, p: [f32; 3]) -> Option<i32> {
        self.by_anchors(p).unwrap_or_else(|| winding_number(self.volume, p))
    }

    /// `None` if the segment to every anchor runs through an edge, or every anchor lies on the volume.
    fn by_anchors(&mut self, p: [f32; 3]) -> Option<Option<i32>> {
        let p = Homogeneous::point(p);
        'anchors: for i in 0..TRIES {
            if self.anchors.len() == i as usize {
                self.anchors.push(self.anchor(i));
            }
            let Some(anchor) = &self.anchors[i as usize] else { continue };
            let (mut sum, mut tie) = (anchor.winding, false);
            for ((corners, copies), &side) in self.triangles.iter().zip(&anchor.sides) {
                match crossing_to(*corners, p, anchor.place, side) {
                    Crossing::Miss => {}
                    Crossing::Through(sign) => sum += copies * sign,
                    Crossing::Starts => return Some(None),
                    Crossing::Tie => tie = true,
                }
            }
            if tie {
                continue 'anchors;
            }
            return Some(Some(sum));
        }
        None
    }

    fn anchor(&self, i: u32) -> Option<Anchor> {
        let place = scattered_in(&self.within, i);
        let winding = winding_number(self.volume, place)?;
        let place = Homogeneous::point(place);
        let sides = self.triangles.iter().map(|(corners, _)| side_of(*corners, place)).collect();
        Some(Anchor { place, winding, sides })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shadow::volume::test_support::under;

    #[test]
    fn winding_table_does_not_abstain_beside_a_sheet_in_whose_plane_the_box_lies() {
        let volume = under([0.3, 0.2, 5.0], 0.0);
        for p in [[3.0, 3.0, 0.0], [-2.0, 0.125, 0.0]] {
            for within in [Aabb::around([p]), Aabb::around([p, [0.0; 3]])] {
                let mut table = WindingTable::new(&volume, within);
                assert_eq!(table.by_anchors(p), Some(Some(0)), "{p:?}");
                // Without thickness no anchor is of use, and every triangle is tested.
                table = WindingTable { within, ..WindingTable::new(&volume, within) };
                assert_eq!((table.by_anchors(p), table.number(p)), (None, Some(0)), "{p:?}");
            }
        }
        let mut table = WindingTable::new(&volume, Aabb { low: [-1.0; 3], high: [1.0; 3] });
        assert_eq!((table.number([0.25, 0.25, 0.0]), table.number([0.25, 0.25, -1.0])), (None, Some(1)));
    }
}
