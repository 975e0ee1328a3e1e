//! Faces cut into triangles of about the same area, and points in these.

use glam::DVec3;

use super::{Ask, Receiver, Receivers};
use crate::mesh::FaceId;

/// The rule of three points: it integrates a polynomial of the second degree exactly over a triangle. So it
/// does a linear function times a hat function.
pub(super) const EXACT: [[f64; 3]; 3] = [[4.0, 1.0, 1.0], [1.0, 4.0, 1.0], [1.0, 1.0, 4.0]];
/// The rule of one point: the middle.
pub(super) const MIDDLE: [[f64; 3]; 1] = [[2.0, 2.0, 2.0]];
/// The sum of the numbers of each point of a rule.
const SUM: f64 = 6.0;

/// Points that are asked about together.
const LOT: usize = 1 << 16;

/// The faces, and how finely they are cut.
pub(super) struct Pieces<'a> {
    receivers: &'a Receivers,
    areas: Vec<f64>,
    whole: f64,
    wanted: f64,
}

/// A point inside a face.
#[derive(Clone, Copy)]
pub(super) struct Point {
    pub(super) face: FaceId,
    /// The receivers at the corners of the face.
    pub(super) corners: [u32; 3],
    /// The share of each corner.
    pub(super) at: [f64; 3],
    /// The number of points in the face.
    pub(super) points: f64,
}

impl<'a> Pieces<'a> {
    pub(super) fn of(receivers: &'a Receivers, wanted: u32) -> Self {
        let area = |&corners: &[u32; 3]| {
            let [a, b, c] = corners.map(|corner| at(receivers, corner));
            0.5 * (b - a).cross(c - a).length()
        };
        let areas: Vec<f64> = receivers.corners.iter().map(area).collect();
        let wanted = f64::from(wanted.min(super::MOST_INSIDE));
        Self { receivers, whole: areas.iter().sum(), areas, wanted }
    }

    pub(super) fn faces(&self) -> impl Iterator<Item = (FaceId, [u32; 3])> {
        self.receivers.corners.iter().enumerate().map(|(face, &corners)| (FaceId::new(face), corners))
    }

    pub(super) fn receivers(&self) -> usize {
        self.receivers.list.len()
    }

    pub(super) fn at(&self, receiver: u32) -> DVec3 {
        at(self.receivers, receiver)
    }

    pub(super) fn area(&self, face: FaceId) -> f64 {
        self.areas[face.index()]
    }

    pub(super) fn whole(&self) -> f64 {
        self.whole
    }

    /// Parts per side of a face, at least 1. The face is cut into the square of that. NaN, from meshes
    /// without area, becomes 1.
    fn cuts(&self, face: FaceId) -> u32 {
        ((self.wanted * self.area(face) / self.whole).sqrt() as u32).max(1)
    }

    /// Gives `each` the points of a rule in all pieces, with their openness.
    pub(super) fn each(&self, rule: &[[f64; 3]], ask: Ask<'_>, each: &mut dyn FnMut(&Point, f32)) {
        let mut lot: Vec<Point> = Vec::new();
        let mut done = |lot: &mut Vec<Point>| {
            let list = lot.iter().map(|point| self.receiver(point)).collect();
            let inside = Receivers { list, solids: self.receivers.solids.clone(), ..Receivers::default() };
            lot.drain(..).zip(ask(&inside)).for_each(|(point, open)| each(&point, open));
        };
        for (face, corners) in self.faces() {
            let cuts = self.cuts(face);
            let points = f64::from(cuts) * f64::from(cuts) * rule.len() as f64;
            for piece in pieces(cuts) {
                for shares in rule {
                    let of = |corner: usize| -> f64 { (0..3).map(|i| shares[i] * piece[i][corner]).sum() };
                    let at = [0, 1, 2].map(|corner| of(corner) / (SUM * f64::from(cuts)));
                    lot.push(Point { face, corners, at, points });
                }
                if lot.len() >= LOT - EXACT.len() {
                    done(&mut lot);
                }
            }
        }
        if !lot.is_empty() {
            done(&mut lot);
        }
    }

    /// The point as a receiver, with the normal that a viewer draws there.
    fn receiver(&self, &Point { face, corners, at, .. }: &Point) -> Receiver {
        let mix = |of: &dyn Fn(&Receiver) -> Option<[f32; 3]>| -> DVec3 {
            let parts = corners.iter().zip(at);
            parts
                .filter_map(|(&corner, at)| Some((of(&self.receivers.list[corner as usize])?, at)))
                .map(|(vector, at)| at * DVec3::from(vector.map(f64::from)))
                .sum()
        };
        let normal = mix(&|receiver| receiver.normal).normalize_or_zero();
        Receiver {
            point: mix(&|receiver| Some(receiver.point)).to_array().map(|x| x as f32),
            normal: (normal != DVec3::ZERO).then(|| normal.to_array().map(|x| x as f32)),
            face: Some(face),
        }
    }
}

fn at(receivers: &Receivers, receiver: u32) -> DVec3 {
    DVec3::from(receivers.list[receiver as usize].point.map(f64::from))
}

/// The triangles that a face is cut into, by their corners; these as shares of the face's corners, times
/// `cuts`.
fn pieces(cuts: u32) -> impl Iterator<Item = [[f64; 3]; 3]> {
    let corner = move |i: u32, j: u32| [f64::from(cuts) - f64::from(i + j), f64::from(i), f64::from(j)];
    (0..cuts).flat_map(move |i| {
        (0..cuts - i).flat_map(move |j| {
            let upright = [corner(i, j), corner(i + 1, j), corner(i, j + 1)];
            let turned =
                (i + j + 2 <= cuts).then(|| [corner(i + 1, j + 1), corner(i, j + 1), corner(i + 1, j)]);
            std::iter::once(upright).chain(turned)
        })
    })
}
