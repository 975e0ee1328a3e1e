//! How a piecewise linear function folds at an edge between two faces.

use glam::DVec3;

use super::pieces::Pieces;
use crate::mesh::FaceId;

/// The two ends of an edge, and the corners opposite to it. The function x folds by Σ shares · x: the change
/// of its slope across the edge, with the two faces turned into one plane.
pub(super) struct Fold {
    pub(super) corners: [u32; 4],
    /// Their squares add up to 1.
    pub(super) shares: [f64; 4],
    pub(super) weight: f64,
}

impl Fold {
    /// Those of all edges that have two faces with an area. A fold counts as `share` of the area of both: so
    /// a thin face weighs no more than its area, and the unit of length does not matter.
    pub(super) fn all(cut: &Pieces<'_>, share: f64) -> Vec<Self> {
        let mut sides: Vec<([u32; 2], u32, u32)> = Vec::new();
        for (face, [a, b, c]) in cut.faces().filter(|&(face, _)| cut.area(face) > 0.0) {
            for [from, to, opposite] in [[a, b, c], [b, c, a], [c, a, b]] {
                sides.push(([from.min(to), from.max(to)], opposite, face.0));
            }
        }
        sides.sort_unstable();
        let edges = sides.chunk_by(|a, b| a.0 == b.0);
        edges
            .filter_map(|uses| {
                let &[([i, j], k, f), (_, l, g)] = uses else { return None };
                let [from, along] = [cut.at(i), cut.at(j) - cut.at(i)];
                let [[a, b, c], [d, e, h]] = [k, l].map(|opposite| outwards(along, cut.at(opposite) - from));
                let shares = [a + d, b + e, c, h];
                let length = shares.iter().map(|x| x * x).sum::<f64>().sqrt();
                let weight = share * (cut.area(FaceId(f)) + cut.area(FaceId(g)));
                let fold = Self { corners: [i, j, k, l], shares: shares.map(|x| x / length), weight };
                fold.shares.iter().all(|x| x.is_finite()).then_some(fold)
            })
            .collect()
    }

    pub(super) fn of(&self, x: &[f64]) -> f64 {
        self.corners.iter().zip(self.shares).map(|(&corner, share)| share * x[corner as usize]).sum()
    }
}

/// The slope out of a face across an edge, as shares of its two ends and of the corner opposite to it: that
/// corner lies beside a point of the edge, at its height.
fn outwards(along: DVec3, corner: DVec3) -> [f64; 3] {
    let beside = corner.dot(along) / along.length_squared();
    let height = (corner - beside * along).length();
    [(1.0 - beside) / height, beside / height, -1.0 / height]
}
