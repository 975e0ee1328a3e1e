//! Two closed triangles: whether they meet beyond what they share, by exact signs alone.
//!
//! The signs used are those of Tomas Möller, *A Fast Triangle-Triangle Intersection Test*, 1997 (both planes
//! first) and Philippe Guigue and Olivier Devillers, *Fast and Robust Triangle-Triangle Overlap Test Using
//! Orientation Predicates*, 2003; the rest is six plain segment tests, since few pairs get so far.

use crate::geom::Aabb;
use crate::geom::predicate::{Sign, orient3d, surely_parted, turn};
use crate::mesh::{FaceId, Mesh};

pub(crate) type Point = [f32; 3];

/// The vertices of a face, and their positions.
#[derive(Clone, Copy)]
pub(crate) struct Corners {
    pub(crate) ids: [u32; 3],
    pub(crate) at: [Point; 3],
}

impl Corners {
    pub(super) fn of(mesh: &Mesh, face: FaceId) -> Self {
        Self { ids: mesh.triangles()[face.index()], at: mesh.corners(face) }
    }

    /// From corner `first` on, counter-clockwise.
    #[inline]
    pub(super) fn from(&self, first: usize) -> [Point; 3] {
        let [a, b, c] = self.at;
        [[a, b, c], [b, c, a], [c, a, b]][first]
    }
}

/// Whether two faces with area intersect beyond what they share.
pub(crate) fn intersect(f: &Corners, g: &Corners) -> bool {
    let mut shared = (0..3).filter_map(|i| g.ids.iter().position(|&id| id == f.ids[i]).map(|j| (i, j)));
    match (shared.next(), shared.next(), shared.next()) {
        (None, ..) => meet(f.at, g.at),
        (Some((i, j)), None, _) => meet_beyond_vertex(f.from(i), g.from(j)),
        (Some((i, j)), Some((k, l)), None) => folded(f.at[i], f.at[k], f.at[3 - i - k], g.at[3 - j - l]),
        (Some(_), Some(_), Some(_)) => false,
    }
}

/// Two triangles `a`, `b`, `c` and `a`, `b`, `d`: whether `d` lies in the plane, on the side of `c`.
pub(super) fn folded(a: Point, b: Point, c: Point, d: Point) -> bool {
    orient3d(a, b, c, d).is_zero() && {
        let axis = plane_axis([a, b, c]);
        turn(a, b, c, axis) == turn(a, b, d, axis)
    }
}

/// Two triangles with a common first corner: what they share beyond it reaches the opposite edge of one.
fn meet_beyond_vertex(f: [Point; 3], g: [Point; 3]) -> bool {
    // Around a vertex of a smooth surface most pairs of faces are separated by a plane perpendicular to the
    // surface.
    if surely_parted(f[0], [f[1], f[2]], [g[1], g[2]]) {
        return false;
    }
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
pub(crate) fn segment_meets([p, q]: [Point; 2], triangle: [Point; 3]) -> bool {
    let [a, b, c] = triangle;
    let (above, below) = (orient3d(a, b, c, p), orient3d(a, b, c, q));
    match (above, below) {
        (Sign::Zero, Sign::Zero) => segment_meets_in_plane([p, q], triangle),
        _ if above == below => false,
        // The line meets the plane in one point of the segment; is it in the triangle?
        _ => !mixed([(a, b), (b, c), (c, a)].map(|(u, v)| orient3d(p, q, u, v))),
    }
}

/// [`segment_meets`] in one plane, projected along an axis along which the triangle has area.
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

/// An axis along which the projected triangle has area. Faces without area were filtered out.
fn plane_axis([a, b, c]: [Point; 3]) -> usize {
    (0..3).find(|&axis| !turn(a, b, c, axis).is_zero()).unwrap_or(0)
}

fn mixed(signs: [Sign; 3]) -> bool {
    signs.contains(&Sign::Positive) && signs.contains(&Sign::Negative)
}
