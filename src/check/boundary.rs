//! Borders that nearly meet: what a small weld would close, and vertices that lie inside an edge.

use super::NearMiss;
use crate::geom::predicate::collinear;
use crate::geom::{Aabb, bvh::Bvh};
use crate::mesh::{EdgeId, Mesh, VertexId, weld_points};
use crate::topology::Topology;

/// The distances that are tried, over the diagonal of the mesh: from about the spacing of `f32` at that size
/// to what one would see.
const TOLERANCES: [f64; 4] = [1e-7, 1e-6, 1e-5, 1e-4];

/// The boundary: its edges, its vertices, and each edge's ends as indices among them.
pub(super) struct Boundary<'a> {
    edges: &'a [EdgeId],
    vertices: Vec<VertexId>,
    points: Vec<[f32; 3]>,
    ends: Vec<[u32; 2]>,
}

impl<'a> Boundary<'a> {
    pub(super) fn new(mesh: &Mesh, topology: &Topology, edges: &'a [EdgeId]) -> Self {
        let mut vertices: Vec<VertexId> = edges.iter().flat_map(|&edge| topology.vertices(edge)).collect();
        vertices.sort_unstable();
        vertices.dedup();
        let index = |vertex| vertices.binary_search(&vertex).expect("the ends are all there") as u32;
        let ends = edges.iter().map(|&edge| topology.vertices(edge).map(index)).collect();
        let points = vertices.iter().map(|vertex| mesh.positions()[vertex.index()]).collect();
        Self { edges, vertices, points, ends }
    }

    /// How many edges pair one to one at each tolerance, and which do at the largest, ascending.
    ///
    /// Vertices of the boundary are welded as by [`Weld::Within`](crate::mesh::Weld::Within). An edge whose
    /// ends become one has collapsed and pairs with nothing; three or more that fall together do not pair
    /// one to one.
    pub(super) fn near_miss(&self, diagonal: f64) -> (Vec<NearMiss>, Vec<EdgeId>) {
        let mut pairs = Vec::new();
        let found = TOLERANCES.map(|relative| {
            let distance = relative * diagonal;
            pairs = self.pairs_within(distance);
            NearMiss { relative, distance, edges: pairs.len() }
        });
        (found.to_vec(), pairs)
    }

    fn pairs_within(&self, distance: f64) -> Vec<EdgeId> {
        let welded = weld_points(&self.points, distance);
        let mut keyed: Vec<([u32; 2], EdgeId)> = Vec::with_capacity(self.edges.len());
        for (ends, &edge) in self.ends.iter().zip(self.edges) {
            let [a, b] = ends.map(|end| welded[end as usize]);
            if a != b {
                keyed.push(([a.min(b), a.max(b)], edge));
            }
        }
        keyed.sort_unstable();
        let two = keyed.chunk_by(|a, b| a.0 == b.0).filter(|group| group.len() == 2);
        let mut pairs: Vec<EdgeId> = two.flatten().map(|&(_, edge)| edge).collect();
        pairs.sort_unstable();
        pairs
    }

    /// Vertices inside an edge that is not theirs, ascending: each with the edge, and whether it lies on it
    /// exactly. An exact one is preferred, then the edge of the smallest id. Also whether all were looked for: where
    /// thousands of edges lie in one place, each vertex would be tested against all of them, and it gives up after
    /// `tests` tests.
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
        let bvh = Bvh::build(&boxes);
        let mut found = Vec::new();
        for (vertex, &point) in self.points.iter().enumerate() {
            let mut best: Option<(bool, u32)> = None;
            let query = widened(Aabb::around([point]), point.map(half_ulp));
            let visit = |slot: usize| {
                let edge = bvh.order()[slot];
                let could_be_better = best.is_none_or(|best| (false, edge) < best);
                if could_be_better && !self.ends[edge as usize].contains(&(vertex as u32)) {
                    let [a, b] = segments[edge as usize];
                    let exact = strictly_inside(point, a, b);
                    if exact || within_rounding(point, a, b) {
                        let candidate = (!exact, edge);
                        best = Some(best.map_or(candidate, |best| best.min(candidate)));
                    }
                }
                tests = tests.saturating_sub(1);
                tests > 0
            };
            bvh.walk(|aabb| aabb.overlaps(&query), visit);
            if tests == 0 {
                break;
            }
            if let Some((near, edge)) = best {
                let (vertex, edge) = (self.vertices[vertex], self.edges[edge as usize]);
                found.push(TJunction { vertex, edge, exact: !near });
            }
        }
        (found, tests > 0)
    }
}

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

/// Whether `p` could lie on the open segment but for the rounding of the coordinates.
///
/// If real points a*, b* and p* = a* + t(b* − a*) were rounded to `f32`, each coordinate moved by half an ulp
/// at most, so p − (a + t(b − a)) is at most half_ulp(p) + (1 − t)·half_ulp(a) + t·half_ulp(b) on each axis,
/// and the last two terms are at most the larger half ulp. Is there a t that satisfies all three? A point
/// that could itself be an end is none: that is a near-miss seam.
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
