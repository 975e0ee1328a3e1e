//! The corners of a polygon, seen along an axis.

use std::cmp::Ordering;

use crate::geom::predicate::{Sign, turn};

/// A polygon in the plane of two axes. Its corners are numbers into `ring`.
#[derive(Clone, Copy)]
pub(super) struct Outline<'a> {
    pub(super) positions: &'a [[f32; 3]],
    /// The vertex of each corner.
    pub(super) ring: &'a [u32],
    /// The axis that is looked along: 0, 1, 2 for x, y, z.
    pub(super) axis: usize,
}

impl Outline<'_> {
    #[inline]
    pub(super) fn at(&self, corner: u32) -> [f32; 3] {
        self.positions[self.ring[corner as usize] as usize]
    }

    /// The order in which the sweep meets two corners: from left to right, then from below.
    #[inline]
    pub(super) fn order(&self, a: u32, b: u32) -> Ordering {
        let (p, q) = (self.at(a), self.at(b));
        let (right, up) = ((self.axis + 1) % 3, (self.axis + 2) % 3);
        by_number(p[right], q[right]).then_with(|| by_number(p[up], q[up]))
    }

    /// Whether the triangle of three corners runs counter-clockwise (positive) or clockwise: exact.
    #[inline]
    pub(super) fn turn(&self, a: u32, b: u32, c: u32) -> Sign {
        turn(self.at(a), self.at(b), self.at(c), self.axis)
    }
}

/// The order of two coordinates, where −0 equals +0.
#[inline]
fn by_number(p: f32, q: f32) -> Ordering {
    // Finite, so that there is an order.
    p.partial_cmp(&q).unwrap_or(Ordering::Equal)
}

/// The order of two positions: by x, then y, then z.
#[inline]
pub(super) fn less(p: [f32; 3], q: [f32; 3]) -> Ordering {
    by_number(p[0], q[0]).then_with(|| by_number(p[1], q[1])).then_with(|| by_number(p[2], q[2]))
}

#[inline]
pub(super) fn minus(p: [f32; 3], q: [f32; 3]) -> [f64; 3] {
    [f64::from(p[0]) - f64::from(q[0]), f64::from(p[1]) - f64::from(q[1]), f64::from(p[2]) - f64::from(q[2])]
}

#[inline]
pub(super) fn cross(u: [f64; 3], v: [f64; 3]) -> [f64; 3] {
    [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]
}

/// The axis of the largest component, the first of equal ones.
#[inline]
pub(super) fn dominant(normal: [f64; 3]) -> usize {
    let [x, y, z] = normal.map(f64::abs);
    if x >= y && x >= z {
        0
    } else if y >= z {
        1
    } else {
        2
    }
}

/// The three axes, from that of the largest component of the polygon's normal to that of the smallest.
///
/// The normal is Newell's: the sum of the cross products of neighboring corners, here relative to the first
/// corner. Its rounding only decides along which axis a polygon is looked at first.
pub(super) fn axes(positions: &[[f32; 3]], ring: &[u32]) -> [usize; 3] {
    let from = |corner: u32| minus(positions[corner as usize], positions[ring[0] as usize]);
    let mut normal = [0.0; 3];
    for pair in ring.windows(2) {
        let [x, y, z] = cross(from(pair[0]), from(pair[1]));
        normal = [normal[0] + x, normal[1] + y, normal[2] + z];
    }
    let mut axes = [0, 1, 2];
    axes.sort_by(|&i: &usize, &j: &usize| normal[j].abs().total_cmp(&normal[i].abs()));
    axes
}

/// Turns the ring so that it starts, and runs, the same for every first corner and for both windings: as the
/// least of all these sequences of positions. Whether its direction was turned. Linear time.
pub(super) fn make_canonical(positions: &[[f32; 3]], ring: &mut [u32]) -> bool {
    let n = ring.len();
    let order = |a: u32, b: u32| less(positions[a as usize], positions[b as usize]);
    let forward = |i: usize| ring[i % n];
    let backward = |i: usize| ring[n - 1 - i % n];
    let (ahead, back) = (least_start(n, |i, j| order(forward(i), forward(j))), {
        least_start(n, |i, j| order(backward(i), backward(j)))
    });
    let compared = (0..n).map(|k| order(backward(back + k), forward(ahead + k)));
    let turned = compared.fold(Ordering::Equal, Ordering::then) == Ordering::Less;
    if turned {
        ring.reverse();
        ring.rotate_left(back);
    } else {
        ring.rotate_left(ahead);
    }
    turned
}

/// The start of the least rotation of a cyclic sequence of `n` items, any of them if there are several. The
/// indices given to `order` are below `2 n`.
fn least_start(n: usize, order: impl Fn(usize, usize) -> Ordering) -> usize {
    // Two candidates, equal so far over `k` items. Where they differ, no start within the larger one's items
    // so far is the least.
    let (mut i, mut j, mut k) = (0, 1, 0);
    while i < n && j < n && k < n {
        match order(i + k, j + k) {
            Ordering::Equal => k += 1,
            Ordering::Greater => (i, k) = (i + k + 1, 0),
            Ordering::Less => (j, k) = (j + k + 1, 0),
        }
        if i == j {
            j += 1;
        }
    }
    i.min(j)
}
