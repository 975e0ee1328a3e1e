//! Monotone polygons: two chains of corners, each from left to right. Linear time.
//!
//! Michael R. Garey, David S. Johnson, Franco P. Preparata, Robert E. Tarjan, *Triangulating a Simple
//! Polygon*, 1978. A triangle has no area only where the two chains touch.

use std::cmp::Ordering;

use super::cut::Filled;
use super::outline::Outline;
use crate::geom::predicate::Sign;

/// Adds the triangles of a monotone piece: `corners` counter-clockwise, at least three. As many triangles as
/// corners, less two; each with its corners in the order that they have in the piece.
pub(super) fn cut(
    outline: &Outline<'_>,
    corners: &[u32],
    stack: &mut Vec<(u32, bool)>,
    filled: &mut Filled<'_>,
) {
    let n = corners.len() as u32;
    let order = |i: u32, j: u32| outline.order(corners[i as usize], corners[j as usize]);
    let first = (1..n).fold(0, |first, i| if order(i, first) == Ordering::Less { i } else { first });
    let last = (1..n).fold(0, |last, i| if order(i, last) == Ordering::Greater { i } else { last });
    let mut emit = |i: u32, j: u32, k: u32| {
        let mut triangle = [i, j, k];
        triangle.sort_unstable();
        filled.push(triangle.map(|i| corners[i as usize]));
    };
    // The next corner of the lower chain, and of the upper one.
    let (next, previous) = (|i: u32| (i + 1) % n, |i: u32| (i + n - 1) % n);
    let (mut low, mut high) = (next(first), previous(first));
    stack.clear();
    stack.push((first, true));
    for _ in 0..n - 2 {
        let is_low = high == last || low != last && order(low, high) != Ordering::Greater;
        let corner = if is_low { low } else { high };
        let (top, top_is_low) = *stack.last().expect("it is never empty");
        if stack.len() > 1 && is_low != top_is_low {
            // The other chain sees the whole stack.
            stack.windows(2).for_each(|pair| emit(pair[0].0, pair[1].0, corner));
            stack.clear();
            stack.push((top, top_is_low));
        } else {
            let convex = if is_low { Sign::Positive } else { Sign::Negative };
            while let [.., (before, _), (top, _)] = stack[..] {
                let [a, b, c] = [before, top, corner].map(|i| corners[i as usize]);
                if outline.turn(a, b, c) != convex {
                    break;
                }
                emit(before, top, corner);
                stack.pop();
            }
        }
        stack.push((corner, is_low));
        if is_low {
            low = next(low);
        } else {
            high = previous(high);
        }
    }
    stack.windows(2).for_each(|pair| emit(pair[0].0, pair[1].0, last));
}
