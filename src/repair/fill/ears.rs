//! A long loop to triangles: its shortest diagonals first.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use super::shape::distance;
use crate::geom::predicate::collinear;

/// Triangles between the corners `0..n` of a loop, in its winding. The corner whose neighbors are closest is
/// cut off, again and again; those that would make a face without area, or a diagonal that is `in_use`, come
/// last. n·log n.
pub(super) fn by_ears(points: &[[f32; 3]], in_use: impl Fn(usize, usize) -> bool) -> Vec<[usize; 3]> {
    let n = points.len();
    let mut next: Vec<usize> = (1..n).chain([0]).collect();
    let mut prev: Vec<usize> = [n - 1].into_iter().chain(0..n - 1).collect();
    let mut changes = vec![0_u32; n];
    // Lengths are not negative, so that their bits ascend with them.
    let ear = |prev: usize, at: usize, next: usize, changes: u32| {
        let flat = collinear(points[prev], points[at], points[next]);
        let bad = u8::from(flat) + u8::from(in_use(prev, next));
        Reverse((bad, distance(points[prev], points[next]).to_bits(), at, changes))
    };
    let mut ears: BinaryHeap<_> = (0..n).map(|at| ear(prev[at], at, next[at], 0)).collect();
    let mut triangles = Vec::with_capacity(n - 2);
    while triangles.len() < n - 2 {
        let Some(Reverse((_, _, at, seen))) = ears.pop() else { break };
        if changes[at] != seen {
            continue; // its neighbors have changed since
        }
        let (before, after) = (prev[at], next[at]);
        triangles.push([before, at, after]);
        (next[before], prev[after], changes[at]) = (after, before, u32::MAX);
        for corner in [before, after] {
            changes[corner] += 1;
            ears.push(ear(prev[corner], corner, next[corner], changes[corner]));
        }
    }
    triangles
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ears_are_two_fewer_than_corners_and_use_each_side_once() {
        for n in [3, 4, 9, 1000] {
            let points: Vec<[f32; 3]> =
                (0..n).map(|k| [(k * k % 17) as f32, (k * 7 % 23) as f32, (k % 5) as f32]).collect();
            let triangles = by_ears(&points, |_, _| false);
            assert_eq!(triangles.len(), n - 2);
            let mut open = std::collections::BTreeMap::new();
            for &[a, b, c] in &triangles {
                for (p, q) in [(a, b), (b, c), (c, a)] {
                    *open.entry((p.min(q), p.max(q))).or_insert(0) += if p < q { 1 } else { -1 };
                }
            }
            open.retain(|_, sum| *sum != 0);
            let sides = (0..n).map(|i| if i + 1 < n { ((i, i + 1), 1) } else { ((0, i), -1) });
            assert_eq!(open, sides.collect());
        }
    }

    #[test]
    fn ears_avoid_faces_without_area_and_diagonals_in_use() {
        // A square with the middles of its sides: corners may go first, middles may not.
        let points = [[0, 0], [1, 0], [2, 0], [2, 1], [2, 2], [1, 2], [0, 2], [0, 1]]
            .map(|[x, y]| [x as f32, y as f32, 0.0]);
        let flat = |triangles: &[[usize; 3]]| {
            triangles.iter().filter(|t| collinear(points[t[0]], points[t[1]], points[t[2]])).count()
        };
        assert_eq!(flat(&by_ears(&points, |_, _| false)), 0);
        // Fault injected: a fan around the first corner.
        assert_eq!(flat(&(1..7).map(|k| [0, k, k + 1]).collect::<Vec<_>>()), 2);
        let used = by_ears(&points[..4], |i, j| [i.min(j), i.max(j)] == [1, 3]);
        assert!(used.iter().all(|t| !(t.contains(&1) && t.contains(&3))));
    }
}
