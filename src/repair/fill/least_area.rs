//! The triangulation of a loop with the least area.

use super::shape::triangle_area;
use crate::geom::predicate::collinear;

/// What part of a triangulation costs: faces without area and diagonals in use come first, then the area.
#[derive(Clone, Copy, PartialEq)]
struct Cost {
    bad: u32,
    area: f64,
}

/// What is bad of a stretch that cannot be cut: more than any other has, and twice that fits 32 bits.
const NEVER: u32 = 1 << 30;

impl Cost {
    const NONE: Self = Self { bad: 0, area: 0.0 };

    fn is_below(self, other: Self) -> bool {
        self.bad < other.bad || self.bad == other.bad && self.area < other.area
    }
}

/// Triangles between the corners `0..n` of a loop, in its winding, whose area is least among those with the
/// fewest faces without area and diagonals that are `in_use`. Of several the first.
///
/// A dynamic programme over the stretches of the loop, from short to long: a stretch from i to j has the
/// triangle of i, j and some k between them, and two shorter stretches. Cubic time, 24 n² bytes.
pub(super) fn least_area(points: &[[f32; 3]], in_use: impl Fn(usize, usize) -> bool) -> Vec<[usize; 3]> {
    least_area_among(points, in_use, |_| true).expect("every loop can be cut")
}

/// The same among the triangulations whose triangles are all `allowed`; `None` if there are none. A triangle
/// is only asked for if it would be the best one yet of its stretch: a few of a thousand.
pub(super) fn least_area_among(
    points: &[[f32; 3]],
    in_use: impl Fn(usize, usize) -> bool,
    allowed: impl Fn([usize; 3]) -> bool,
) -> Option<Vec<[usize; 3]>> {
    let n = points.len();
    let mut cost = vec![Cost::NONE; n * n];
    let mut middle = vec![0_u32; n * n];
    for width in 2..n {
        for i in 0..n - width {
            let j = i + width;
            let mut best: Option<(Cost, usize)> = None;
            for k in i + 1..j {
                let (left, right) = (cost[i * n + k], cost[k * n + j]);
                let bad = left.bad + right.bad;
                if bad >= NEVER || best.is_some_and(|(best, _)| bad > best.bad) {
                    continue;
                }
                let corners = [points[i], points[k], points[j]];
                let area = left.area + right.area + triangle_area(corners);
                let flat = collinear(corners[0], corners[1], corners[2]);
                let candidate = Cost { bad: bad + u32::from(flat), area };
                if best.is_none_or(|(best, _)| candidate.is_below(best)) && allowed([i, k, j]) {
                    best = Some((candidate, k));
                }
            }
            let Some((mut found, k)) = best else {
                cost[i * n + j].bad = NEVER;
                continue;
            };
            // The longest stretch ends in a side of the loop, not in a diagonal.
            found.bad += u32::from(width < n - 1 && in_use(i, j));
            (cost[i * n + j], middle[i * n + j]) = (found, k as u32);
        }
    }
    (cost[n - 1].bad < NEVER).then(|| triangles(n, &middle))
}

/// The triangles of the whole loop, where `middle` has the third corner of each stretch's triangle.
pub(super) fn triangles(n: usize, middle: &[u32]) -> Vec<[usize; 3]> {
    let mut triangles = Vec::with_capacity(n - 2);
    let mut stretches = vec![(0, n - 1)];
    while let Some((i, j)) = stretches.pop() {
        if j - i > 1 {
            let k = middle[i * n + j] as usize;
            triangles.push([i, k, j]);
            stretches.extend([(k, j), (i, k)]);
        }
    }
    triangles
}

#[cfg(test)]
mod tests {
    use super::super::tests::all_triangulations;
    use super::*;
    use crate::random::SplitMix64;

    fn cost(points: &[[f32; 3]], faces: &[[usize; 3]], used: &[[usize; 2]]) -> (usize, f64) {
        let n = points.len();
        let at = |face: &[usize; 3]| face.map(|corner| points[corner]);
        let flat = faces.iter().filter(|face| collinear(at(face)[0], at(face)[1], at(face)[2])).count();
        let edges = faces.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [a, c]]);
        let diagonals = edges.filter(|&[a, b]| b - a > 1 && b - a < n - 1);
        let in_use = diagonals.filter(|diagonal| used.contains(diagonal)).count();
        // Each diagonal has two faces.
        (flat + in_use / 2, faces.iter().map(|face| triangle_area(at(face))).sum())
    }

    #[test]
    fn least_area_is_the_least_of_all_triangulations() {
        let mut random = SplitMix64(9);
        for round in 0..60 {
            let n = 4 + round % 5;
            let points: Vec<[f32; 3]> = (0..n).map(|_| [(); 3].map(|()| random.below(4) as f32)).collect();
            let used: Vec<[usize; 2]> = (0..round % 3).map(|_| [0, 2 + random.below(n - 3)]).collect();
            let found = least_area(&points, |i, j| used.contains(&[i, j]));
            assert_eq!(found.len(), n - 2);
            let (bad, area) = cost(&points, &found, &used);
            let costs = all_triangulations(0, n - 1).into_iter().map(|faces| cost(&points, &faces, &used));
            let least = costs.clone().min_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1))).unwrap();
            assert!(bad == least.0 && (area - least.1).abs() <= 1e-12 * area, "{points:?}");
            // Fault injected: any triangulation will do.
            let worst = costs.max_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1))).unwrap();
            assert!(worst >= least);
        }
    }
}
