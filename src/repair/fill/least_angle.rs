//! The triangulation of a loop that bends least.

use super::shape::{normal, triangle_area};
use crate::geom::predicate::collinear;

/// What part of a triangulation costs: faces without area and diagonals in use, then the sharpest bend
/// between two neighbors, as 1 minus the cosine between their normals, then the area.
#[derive(Clone, Copy, PartialEq)]
struct Cost {
    bad: u32,
    bend: f64,
    area: f64,
}

impl Cost {
    const NONE: Self = Self { bad: 0, bend: 0.0, area: 0.0 };

    fn is_below(self, other: Self) -> bool {
        (self.bad, self.bend, self.area) < (other.bad, other.bend, other.area)
    }
}

/// Triangles between the corners `0..n` of a loop, in its winding, whose sharpest bend is small: among each
/// other, and towards the faces around the hole, of which `around` has the unit normal at each side.
///
/// The dynamic programme of [`least_area`](super::least_area::least_area) with the weights of Peter Liepa,
/// *Filling Holes in Meshes*, 2003, section 3: a stretch is known by its best triangle alone, so that the
/// result is good rather than the best.
pub(super) fn least_angle(
    points: &[[f32; 3]],
    around: &[[f64; 3]],
    in_use: impl Fn(usize, usize) -> bool,
) -> Vec<[usize; 3]> {
    let n = points.len();
    let mut cost = vec![Cost::NONE; n * n];
    let mut middle = vec![0_u32; n * n];
    // The normal of what lies across each stretch: a face around the hole, or the stretch's best triangle.
    let mut across = vec![[0.0; 3]; n * n];
    for i in 0..n - 1 {
        across[i * n + i + 1] = around[i];
    }
    for width in 2..n {
        for i in 0..n - width {
            let j = i + width;
            let mut best: Option<(Cost, usize, [f64; 3])> = None;
            for k in i + 1..j {
                let (left, right) = (cost[i * n + k], cost[k * n + j]);
                let bad = left.bad + right.bad;
                if best.is_some_and(|(best, ..)| bad > best.bad) {
                    continue;
                }
                let corners = [points[i], points[k], points[j]];
                let own = normal(corners);
                let mut bend = left.bend.max(right.bend);
                bend = bend.max(between(own, across[i * n + k])).max(between(own, across[k * n + j]));
                if width == n - 1 {
                    bend = bend.max(between(own, around[n - 1]));
                }
                let area = left.area + right.area + triangle_area(corners);
                let flat = collinear(corners[0], corners[1], corners[2]);
                let candidate = Cost { bad: bad + u32::from(flat), bend, area };
                if best.is_none_or(|(best, ..)| candidate.is_below(best)) {
                    best = Some((candidate, k, own));
                }
            }
            let Some((mut found, k, own)) = best else { continue };
            found.bad += u32::from(width < n - 1 && in_use(i, j));
            (cost[i * n + j], middle[i * n + j], across[i * n + j]) = (found, k as u32, own);
        }
    }
    super::least_area::triangles(n, &middle)
}

/// 1 minus the cosine between two unit normals; 0 where one of them is none.
fn between(u: [f64; 3], v: [f64; 3]) -> f64 {
    if u == [0.0; 3] || v == [0.0; 3] {
        return 0.0;
    }
    1.0 - (u[0] * v[0] + u[1] * v[1] + u[2] * v[2])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn least_angle_does_not_fold() {
        let up = [0.0, 0.0, 1.0];
        // A dart seen from above: one diagonal lies outside, and folds.
        let dart = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 4.0, 0.0]];
        let triangles = least_angle(&dart, &[up; 4], |_, _| false);
        assert!(triangles.iter().all(|t| t.contains(&0) && t.contains(&2)));
        // Fault injected: seen from below, every triangle bends by half a turn.
        assert!(triangles.iter().all(|t| between(normal(t.map(|c| dart[c])), [0.0, 0.0, -1.0]) == 2.0));
    }

    #[test]
    fn least_angle_avoids_diagonals_in_use() {
        let square = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
        for used in [[0, 2], [1, 3]] {
            let triangles = least_angle(&square, &[[0.0, 0.0, 1.0]; 4], |i, j| [i, j] == used);
            assert!(triangles.iter().all(|t| !(t.contains(&used[0]) && t.contains(&used[1]))));
        }
    }
}
