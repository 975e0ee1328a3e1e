//! Faces that meet where they should not.
//!
//! Two closed triangles are compared by exact signs alone, with what they share by right set aside:
//!
//! - no common vertex: they intersect if they have any point in common, an overlap in one plane or a mere
//!   touch included (two solids stacked face on face do intersect);
//! - one common vertex: if they have a point in common besides it;
//! - one common edge: if they lie in one plane, on the same side of it, folded onto each other;
//! - three common vertices: never; these are duplicates, and reported as such.
//!
//! Faces without area (collapsed or collinear) are left out: they are reported by name, they are edge-on to
//! every light, and as segments they touch what their neighbours touch.
//!
//! The signs used are those of Tomas Möller, *A Fast Triangle-Triangle Intersection Test*, 1997 (both planes
//! first) and Philippe Guigue and Olivier Devillers, *Fast and Robust Triangle-Triangle Overlap Test Using
//! Orientation Predicates*, 2003; the rest is six plain segment tests, since few pairs get so far.

use std::ops::ControlFlow;

use super::Topology;
use crate::geom::predicate::{Sign, collinear, orient3d, turn};
use crate::geom::{Aabb, bvh::Bvh};
use crate::mesh::{FaceId, Mesh};

/// Calls `visit` with each pair of faces that intersect, the smaller id first, in ascending order, each pair
/// once, until it breaks.
///
/// `mesh` is the welded mesh from whose triangles `topology` was built. Candidates come from a tree over the
/// faces' boxes (about 90 bytes a face while it lives); nothing is kept of the pairs, so that memory stays
/// bounded even where all faces intersect all others.
///
/// # Panics
///
/// Panics if `topology` has other triangles than `mesh`.
pub fn for_each_self_intersection(
    mesh: &Mesh,
    topology: &Topology,
    visit: impl FnMut([FaceId; 2]) -> ControlFlow<()>,
) {
    let _ = for_each_intersection_among(mesh, &faces_with_area(mesh, topology), &mut { u64::MAX }, visit);
}

/// The faces that can intersect others, ascending.
pub(crate) fn faces_with_area(mesh: &Mesh, topology: &Topology) -> Vec<FaceId> {
    assert!(mesh.triangles() == topology.triangles(), "the topology is that of another mesh");
    let has_area = |&face: &FaceId| {
        let [a, b, c] = mesh.corners(face);
        !topology.is_collapsed(face) && !collinear(a, b, c)
    };
    topology.faces().filter(has_area).collect()
}

/// The same among some faces, ascending, that all have area; it breaks as `visit` does, or when no tests are
/// left.
/// Of faces that all reach one place (those around one vertex, say) each is tested against all others.
pub(crate) fn for_each_intersection_among(
    mesh: &Mesh,
    faces: &[FaceId],
    tests: &mut u64,
    mut visit: impl FnMut([FaceId; 2]) -> ControlFlow<()>,
) -> ControlFlow<()> {
    let aabb = |face: FaceId| Aabb::around(mesh.corners(face));
    let bvh = Bvh::build(&faces.iter().map(|&face| aabb(face)).collect::<Vec<_>>());
    let mut partners = Vec::new();
    for (place, &face) in faces.iter().enumerate() {
        let query = aabb(face);
        partners.clear();
        let test = |slot: usize| {
            let other = bvh.order()[slot] as usize;
            if other > place {
                let other = faces[other];
                if query.overlaps(&aabb(other)) && intersect(mesh, face, other) {
                    partners.push(other);
                }
            }
            *tests = tests.saturating_sub(1);
            *tests > 0
        };
        bvh.walk(|node| node.overlaps(&query), test);
        partners.sort_unstable();
        for &other in &partners {
            visit([face, other])?;
        }
        if *tests == 0 {
            return ControlFlow::Break(());
        }
    }
    ControlFlow::Continue(())
}

/// All pairs of faces that intersect, the smaller id first, ascending. See [`for_each_self_intersection`],
/// which does not hold them in memory.
///
/// # Panics
///
/// Panics if `topology` has other triangles than `mesh`.
#[must_use]
pub fn self_intersections(mesh: &Mesh, topology: &Topology) -> Vec<[FaceId; 2]> {
    let mut pairs = Vec::new();
    for_each_self_intersection(mesh, topology, |pair| {
        pairs.push(pair);
        ControlFlow::Continue(())
    });
    pairs
}

type Point = [f32; 3];

/// Whether two faces with area intersect beyond what they share.
fn intersect(mesh: &Mesh, f: FaceId, g: FaceId) -> bool {
    let [ids_f, ids_g] = [f, g].map(|face| mesh.triangles()[face.index()]);
    // Turn the first shared vertex of each face to the front.
    let mut shared = (0..3).filter_map(|i| ids_g.iter().position(|&id| id == ids_f[i]).map(|j| (i, j)));
    let rotated = |face: FaceId, by: usize| {
        let mut corners = mesh.corners(face);
        corners.rotate_left(by);
        corners
    };
    match (shared.next(), shared.next(), shared.next()) {
        (None, ..) => meet(mesh.corners(f), mesh.corners(g)),
        (Some((i, j)), None, _) => meet_beyond_vertex(rotated(f, i), rotated(g, j)),
        (Some((i, j)), Some((k, l)), None) => {
            let (f, g) = (mesh.corners(f), mesh.corners(g));
            folded(f[i], f[k], f[3 - i - k], g[3 - j - l])
        }
        (Some(_), Some(_), Some(_)) => false,
    }
}

/// Two triangles `a`, `b`, `c` and `a`, `b`, `d`: whether `d` lies in the plane, on the side of `c`.
fn folded(a: Point, b: Point, c: Point, d: Point) -> bool {
    orient3d(a, b, c, d).is_zero() && {
        let axis = plane_axis([a, b, c]);
        turn(a, b, c, axis) == turn(a, b, d, axis)
    }
}

/// Two triangles with a common first corner: what they share beyond it reaches the opposite edge of one.
fn meet_beyond_vertex(f: [Point; 3], g: [Point; 3]) -> bool {
    if apart(f, &g[1..]) || apart(g, &f[1..]) {
        return false;
    }
    segment_meets([f[1], f[2]], g) || segment_meets([g[1], g[2]], f)
}

/// Two triangles without a common corner.
fn meet(f: [Point; 3], g: [Point; 3]) -> bool {
    if apart(f, &g) || apart(g, &f) {
        return false;
    }
    let edges = |[a, b, c]: [Point; 3]| [[a, b], [b, c], [c, a]];
    edges(f).into_iter().any(|edge| segment_meets(edge, g))
        || edges(g).into_iter().any(|edge| segment_meets(edge, f))
}

/// Whether all of `points` lie strictly on one side of the triangle's plane.
fn apart([a, b, c]: [Point; 3], points: &[Point]) -> bool {
    let first = orient3d(a, b, c, points[0]);
    !first.is_zero() && points[1..].iter().all(|&p| orient3d(a, b, c, p) == first)
}

/// Whether a closed segment and a closed triangle with area have a point in common.
fn segment_meets([p, q]: [Point; 2], triangle: [Point; 3]) -> bool {
    let [a, b, c] = triangle;
    let (above, below) = (orient3d(a, b, c, p), orient3d(a, b, c, q));
    match (above, below) {
        (Sign::Zero, Sign::Zero) => segment_meets_in_plane([p, q], triangle),
        _ if above == below => false,
        // The line meets the plane in one point of the segment; is it in the triangle?
        _ => !mixed([(a, b), (b, c), (c, a)].map(|(u, v)| orient3d(p, q, u, v))),
    }
}

/// The same where both lie in one plane, seen along an axis on which the triangle has area.
fn segment_meets_in_plane([p, q]: [Point; 2], triangle: [Point; 3]) -> bool {
    let axis = plane_axis(triangle);
    let [a, b, c] = triangle;
    let edges = [(a, b), (b, c), (c, a)];
    let inside = |point| !mixed(edges.map(|(u, v)| turn(u, v, point, axis)));
    inside(p) || inside(q) || edges.iter().any(|&(u, v)| segments_cross([p, q], [u, v], axis))
}

/// Whether two closed segments of one plane have a point in common, given that neither end of the first lies
/// in the triangle that the second bounds: so they cross, or an end of the second lies on the first.
fn segments_cross([p, q]: [Point; 2], [u, v]: [Point; 2], axis: usize) -> bool {
    let opposite = |a: Sign, b: Sign| a.value() * b.value() < 0;
    let (s, t) = (turn(p, q, u, axis), turn(p, q, v, axis));
    let on = |sign: Sign, end| sign.is_zero() && Aabb::around([p, q]).contains(end);
    on(s, u) || on(t, v) || (opposite(s, t) && opposite(turn(u, v, p, axis), turn(u, v, q, axis)))
}

/// An axis along which the triangle is seen with area. (It has some: one that has none is never asked.)
fn plane_axis([a, b, c]: [Point; 3]) -> usize {
    (0..3).find(|&axis| !turn(a, b, c, axis).is_zero()).unwrap_or(0)
}

fn mixed(signs: [Sign; 3]) -> bool {
    signs.contains(&Sign::Positive) && signs.contains(&Sign::Negative)
}
