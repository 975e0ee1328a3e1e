//! T-junctions: boundary vertices that lie inside another boundary edge.

use std::ops::ControlFlow;

use super::boundary::Boundary;
use crate::geom::Aabb;
use crate::geom::box_pairs::PointQueries;
use crate::geom::predicate::collinear;
use crate::mesh::{EdgeId, Mesh, VertexId};
use crate::topology::Topology;

/// Boundary vertices that lie exactly inside a boundary edge, each with one such edge; and whether the search
/// finished within `tests`.
pub(crate) fn exact_t_junctions(
    mesh: &Mesh,
    topology: &Topology,
    tests: u64,
) -> (Vec<(VertexId, EdgeId)>, bool) {
    let (edges, _) = topology.grouped_boundary();
    let (found, complete) = Boundary::new(mesh, topology, &edges).t_junctions(tests);
    let exact = found.into_iter().filter(|junction| junction.exact);
    (exact.map(|junction| (junction.vertex, junction.edge)).collect(), complete)
}

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
    let exponent = u64::from((x.to_bits() >> 23 & 0xff).max(1));
    // 2^(exponent − 127 − 24) by its bits: a call of `exp2` takes longer than the rest of a test.
    f64::from_bits((exponent + 1023 - 127 - 24) << 52)
}

/// The box with `slack` on each side, rounded outwards.
fn widened(aabb: Aabb, slack: [f64; 3]) -> Aabb {
    let low = |i: usize| ((f64::from(aabb.low[i]) - slack[i]) as f32).next_down().max(f32::MIN);
    let high = |i: usize| ((f64::from(aabb.high[i]) + slack[i]) as f32).next_up().min(f32::MAX);
    Aabb { low: std::array::from_fn(low), high: std::array::from_fn(high) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::SplitMix64;
    use crate::testing::shapes;

    #[test]
    fn half_ulp_is_half_the_distance_to_the_next_number() {
        for x in [0.0, 1e-45, f32::MIN_POSITIVE, 0.75, 1.0, -1.0, 3.5, -4096.0, 1e30, f32::MAX.next_down()] {
            let above = f64::from(x.abs().next_up()) - f64::from(x.abs());
            assert_eq!(half_ulp(x), 0.5 * above, "{x}");
        }
    }

    /// The T-junctions of a mesh, and the tests that they took.
    fn searched(mesh: &Mesh, most: u64) -> (Vec<TJunction>, bool) {
        let topology = Topology::of(mesh);
        let (edges, _) = topology.grouped_boundary();
        Boundary::new(mesh, &topology, &edges).t_junctions(most)
    }

    /// By testing each vertex of the boundary against each edge.
    fn naive(mesh: &Mesh) -> Vec<TJunction> {
        let topology = Topology::of(mesh);
        let (edges, _) = topology.grouped_boundary();
        let boundary = Boundary::new(mesh, &topology, &edges);
        let mut found = Vec::new();
        for (vertex, &point) in boundary.points.iter().enumerate() {
            let candidates = (0..edges.len()).filter_map(|edge| {
                let ends = boundary.ends[edge];
                let [a, b] = ends.map(|end| boundary.points[end as usize]);
                let exact = strictly_inside(point, a, b);
                let on = !ends.contains(&(vertex as u32)) && (exact || within_rounding(point, a, b));
                on.then_some((!exact, edge))
            });
            if let Some((near, edge)) = candidates.min() {
                found.push(TJunction { vertex: boundary.vertices[vertex], edge: edges[edge], exact: !near });
            }
        }
        found
    }

    /// Separate triangles on a coarse lattice: many vertices on many edges.
    fn lattice(seed: u64, count: usize) -> Mesh {
        let mut random = SplitMix64(seed);
        let mut whole = |most: usize| random.below(most) as f32;
        let positions = (0..3 * count).map(|_| [whole(9), whole(9), whole(2)]).collect();
        let triangles = (0..count as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        Mesh::new(positions, triangles).unwrap()
    }

    #[test]
    fn t_junctions_are_those_of_each_vertex_against_each_edge() {
        // The larger ones need more tests than axis-aligned boxes are used for: oriented boxes follow.
        for (seed, count) in [(1, 20), (2, 60), (3, 300), (4, 900)] {
            let mesh = lattice(seed, count);
            let (found, complete) = searched(&mesh, u64::MAX);
            let expected = naive(&mesh);
            assert!(
                complete && found == expected && found.len() > count / 2,
                "{count}: {} found",
                found.len()
            );
            // Fault injected: a vertex pulled off its edges.
            let moved = expected[0].vertex.index();
            let (mut positions, triangles, ..) = mesh.into_parts();
            positions[moved] = [99.0, 99.0, 99.0];
            assert_ne!(searched(&Mesh::new(positions, triangles.to_vec()).unwrap(), u64::MAX).0, expected);
        }
    }

    /// Squares of two faces one inside the other, aslant: the boxes of their edges all overlap.
    fn slanted(count: u32) -> Mesh {
        let square = |k: u32| {
            let [a, b] = [3.0, 4.0].map(|x: f32| x * (k + 1) as f32);
            [[a, b, 0.0], [-b, a, 0.0], [-a, -b, 0.0], [b, -a, 0.0]]
        };
        let triangles =
            (0..count).flat_map(|k| [[4 * k, 4 * k + 1, 4 * k + 2], [4 * k, 4 * k + 2, 4 * k + 3]]);
        Mesh::new((0..count).flat_map(square).collect(), triangles.collect()).unwrap()
    }

    /// Triangles with a side on one line, each over most of the others.
    fn on_a_line(count: u32) -> Mesh {
        let corner =
            |k: u32| [[k as f32, 0.0, 0.0], [(k + 3 * count) as f32, 0.0, 0.0], [k as f32, 1.0, k as f32]];
        let triangles = (0..count).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect();
        Mesh::new((0..count).flat_map(corner).collect(), triangles).unwrap()
    }

    #[test]
    fn t_junctions_of_stacked_edges_take_few_tests() {
        for (name, mesh, expected) in [("slanted", slanted(3000), 0), ("line", on_a_line(3000), 2 * 3000 - 2)]
        {
            let few = 150 * 3 * mesh.face_count() as u64;
            let (found, complete) = searched(&mesh, few);
            assert!(complete && found.len() == expected, "{name}: {} found, {complete}", found.len());
            // Fault injected: too few tests are said to be too few.
            assert!(!searched(&mesh, 1000).1, "{name}");
        }
        // A vertex on a slanted edge is found among all the others.
        let corner = shapes::translated(&shapes::tetrahedron(), [0.0; 3]);
        let lone = Mesh::new(
            corner.positions().iter().map(|p| [p[0] - 0.5, p[1] + 3.5, p[2]]).collect(),
            vec![[0, 1, 2]],
        );
        let with = Mesh::concat(&[slanted(500), lone.unwrap()]).unwrap();
        assert_eq!(searched(&with, u64::MAX).0, naive(&with));
    }
}
