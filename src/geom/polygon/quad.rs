//! Quads: one of two diagonals.

use std::cmp::Ordering;

use super::outline::{cross, dominant, less, minus};
use crate::geom::predicate::{surely_convex, turn};

/// How a quad is cut.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Quad {
    /// The corner that the diagonal starts at: 0 (it ends at corner 2) or 1 (it ends at corner 3).
    pub(crate) from: usize,
    /// Whether two sides cross, so that either diagonal folds the quad over itself.
    pub(crate) crosses: bool,
}

impl Quad {
    /// The diagonal inside the quad, seen along the axis that its normal is closest to. Of two inside, the
    /// shorter one, and of two as long, the one with the least corner (by x, then y, then z): a rule of
    /// positions alone, so that the same quad is cut alike wherever it begins and whichever side is its
    /// front.
    #[inline]
    pub(crate) fn of([a, b, c, d]: [[f32; 3]; 4]) -> Self {
        // Both diagonals turn into each other, up to one sign, where the quad begins at its next corner:
        // every number below is then the same to the last bit.
        let normal = cross(minus(c, a), minus(d, b));
        let axis = dominant(normal);
        if surely_convex([a, b, c, d], axis) {
            return Self { from: usize::from(is_better([b, d], [a, c])), crosses: false };
        }
        let mut inside = insides([a, b, c, d], axis);
        if inside == [0; 2] {
            // No area, or two lobes that cancel: then another axis may show them.
            let axes = [0, 1, 2].map(|axis| insides([a, b, c, d], axis));
            inside = axes.into_iter().find(|inside| *inside != [0; 2]).unwrap_or(inside);
        }
        let from = match inside[0].cmp(&inside[1]) {
            Ordering::Greater => 0,
            Ordering::Less => 1,
            Ordering::Equal => usize::from(is_better([b, d], [a, c])),
        };
        Self { from, crosses: inside[from] < 0 }
    }
}

/// For each diagonal: 1 if it is inside, as its two triangles turn the same way; −1 if it folds, as they turn
/// against each other; 0 if one of them has no area.
#[inline]
fn insides([a, b, c, d]: [[f32; 3]; 4], axis: usize) -> [i32; 2] {
    let side = |p, q, r| turn(p, q, r, axis).value();
    [side(a, b, c) * side(c, d, a), side(b, c, d) * side(d, a, b)]
}

/// Whether the first diagonal is shorter, or as long and holds the least corner.
///
/// Which of two is shorter follows no pattern that a processor could guess, so that no branch hangs on it.
#[inline]
fn is_better(first: [[f32; 3]; 2], second: [[f32; 3]; 2]) -> bool {
    let square = |[p, q]: [[f32; 3]; 2]| {
        let [x, y, z] = minus(p, q);
        x * x + y * y + z * z
    };
    let (one, other) = (square(first), square(second));
    if one == other { holds_the_least(first, second) } else { one < other }
}

#[cold]
fn holds_the_least(first: [[f32; 3]; 2], second: [[f32; 3]; 2]) -> bool {
    let least = |[p, q]: [[f32; 3]; 2]| if less(p, q) == Ordering::Greater { [q, p] } else { [p, q] };
    let ([p, q], [r, s]) = (least(first), least(second));
    less(p, r).then(less(q, s)) == Ordering::Less
}
