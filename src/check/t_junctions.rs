//! T-junctions: boundary vertices that lie inside another boundary edge.

use std::ops::ControlFlow;

use super::boundary::Boundary;
use crate::geom::Aabb;
use crate::geom::box_pairs::PointQueries;
use crate::geom::predicate::collinear;
use crate::mesh::{EdgeId, VertexId};

impl Boundary<'_> {
    /// Boundary vertices inside a boundary edge that is not theirs, ascending; and whether the search
    /// finished.
    ///
    /// If a vertex lies in several edges, one on which it lies exactly is preferred, then the edge of the
    /// lowest id. If thousands of edges overlap, each vertex would be tested against all of them: the search
    /// gives up after `tests` tests.
    pub(super) fn t_junctions(&self, mut tests: u64) -> (Vec<TJunction>, bool) {
        let segments: Vec<[[f32; 3]; 2]> =
            self.ends.iter().map(|ends| ends.map(|end| self.points[end as usize])).collect();
        let boxes: Vec<Aabb> = segments
            .iter()
            .map(|&[a, b]| {
                let slack = std::array::from_fn(|i| half_ulp(a[i]).max(half_ulp(b[i])));
                widened(Aabb::around([a, b]), slack)
            })
            .collect();
        let mut tree = PointQueries::of(&boxes);
        drop(boxes);
        let largest_half_ulp =
            |of: &[[f32; 3]]| of.iter().flatten().map(|&x| half_ulp(x)).fold(0.0, f64::max);
        // An edge lies within half an ulp of its ends on each axis, and so does the vertex.
        let slack = 2.0 * 3.0_f64.sqrt() * largest_half_ulp(&self.points);
        let mut plain = PLAIN_TESTS + 32 * self.edges.len() as u64;
        let mut found = Vec::new();
        for (vertex, &point) in self.points.iter().enumerate() {
            // Edges exactly through the vertex come first, then those of the lowest id.
            let mut best: Option<(bool, u32)> = None;
            let query = widened(Aabb::around([point]), point.map(half_ulp));
            let before = tests;
            let end = tree.for_each_at(&query, (point, slack), |edge| {
                if let Some(edge) = edge.filter(|&edge| best.is_none_or(|best| (false, edge) < best))
                    && !self.ends[edge as usize].contains(&(vertex as u32))
                {
                    let [a, b] = segments[edge as usize];
                    let exact = strictly_inside(point, a, b);
                    if exact || within_rounding(point, a, b) {
                        let candidate = (!exact, edge);
                        best = Some(best.map_or(candidate, |best| best.min(candidate)));
                    }
                }
                tests = tests.saturating_sub(1);
                // After an exact one only lower ids could be better.
                let below = best.filter(|best| !best.0).map_or(u32::MAX, |best| best.1);
                if tests > 0 { ControlFlow::Continue(below) } else { ControlFlow::Break(()) }
            });
            if end.is_break() {
                break;
            }
            plain = plain.saturating_sub(before - tests);
            if plain == 0 && !tree.has_frames() {
                tree.add_frames(|edge| segments[edge]);
            }
            if let Some((near, edge)) = best {
                let (vertex, edge) = (self.vertices[vertex], self.edges[edge as usize]);
                found.push(TJunction { vertex, edge, exact: !near });
            }
        }
        (found, tests > 0)
    }
}

/// Tests of all vertices before oriented boxes are used.
const PLAIN_TESTS: u64 = 1 << 16;

/// A boundary vertex inside another boundary edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct TJunction {
    pub(super) vertex: VertexId,
    pub(super) edge: EdgeId,
    pub(super) exact: bool,
}

/// Whether `p` lies on the open segment, exactly: on its line, in its box, and at neither end.
fn strictly_inside(p: [f32; 3], a: [f32; 3], b: [f32; 3]) -> bool {
    p != a && p != b && Aabb::around([a, b]).contains(p) && collinear(a, b, p)
}

/// Whether `p` lies on the open segment up to the rounding of the coordinates.
///
/// If real points a*, b* and p* = a* + t(b* − a*) were rounded to `f32`, each coordinate moved by half an ulp
/// at most. So p − (a + t(b − a)) is at most half_ulp(p) + (1 − t)·half_ulp(a) + t·half_ulp(b) on each axis,
/// and the last two terms are at most the larger half ulp. The test is whether one t satisfies this on all
/// three axes. A point that could itself be an end is excluded: that is a near-miss seam.
fn within_rounding(p: [f32; 3], a: [f32; 3], b: [f32; 3]) -> bool {
    let bound: [f64; 3] = std::array::from_fn(|i| half_ulp(p[i]) + half_ulp(a[i]).max(half_ulp(b[i])));
    let offset = |q: [f32; 3], i: usize| f64::from(p[i]) - f64::from(q[i]);
    let at = |q| (0..3).all(|i| offset(q, i).abs() <= bound[i]);
    if at(a) || at(b) {
        return false;
    }
    let (mut low, mut high) = (0.0_f64, 1.0_f64);
    for i in 0..3 {
        let along = f64::from(b[i]) - f64::from(a[i]);
        if along == 0.0 {
            if offset(a, i).abs() > bound[i] {
                return false;
            }
            continue;
        }
        let ends = [(offset(a, i) - bound[i]) / along, (offset(a, i) + bound[i]) / along];
        low = low.max(ends[0].min(ends[1]));
        high = high.min(ends[0].max(ends[1]));
    }
    low <= high
}

/// Half the distance to the next `f32`: the largest error of rounding to `x`.
fn half_ulp(x: f32) -> f64 {
    let exponent = (x.to_bits() >> 23 & 0xff).max(1) as i32;
    f64::from(exponent - 127 - 24).exp2()
}

/// The box with `slack` on each side, rounded outwards.
fn widened(aabb: Aabb, slack: [f64; 3]) -> Aabb {
    let low = |i: usize| ((f64::from(aabb.low[i]) - slack[i]) as f32).next_down().max(f32::MIN);
    let high = |i: usize| ((f64::from(aabb.high[i]) + slack[i]) as f32).next_up().min(f32::MAX);
    Aabb { low: std::array::from_fn(low), high: std::array::from_fn(high) }
}
