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
//! every light, and as segments they touch what their neighbors touch.
//!
//! The signs used are those of Tomas Möller, *A Fast Triangle-Triangle Intersection Test*, 1997 (both planes
//! first) and Philippe Guigue and Olivier Devillers, *Fast and Robust Triangle-Triangle Overlap Test Using
//! Orientation Predicates*, 2003; the rest is six plain segment tests, since few pairs get so far.

use std::ops::ControlFlow;

use super::CrackReport;
use crate::geom::Aabb;
use crate::geom::box_pairs::Overlaps;
use crate::geom::predicate::{Sign, collinear, orient3d, surely_parted, turn};
use crate::mesh::{FaceId, Mesh};
use crate::parallel;
use crate::topology::Topology;

/// Self-intersections of a mesh: pairs of faces that meet where they should not.
///
/// ```
/// use umbrage::check::CrackReport;
/// use umbrage::testing::shapes;
/// use umbrage::topology::Topology;
/// let mesh = shapes::cube();
/// let topology = Topology::of(&mesh);
/// let mut report = CrackReport::of(&mesh, &topology);
/// report.add_self_intersections(&mesh, &topology, 10);
/// let found = report.self_intersections.expect("they were searched for");
/// assert!(found.complete && found.pairs == 0);
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct SelfIntersections {
    /// The number of pairs.
    pub pairs: usize,
    /// The number of faces that are in a pair.
    pub faces: usize,
    /// The first pairs, in order, up to the number asked for.
    pub first: Vec<[FaceId; 2]>,
    /// Whether these are all; `false` if the search stopped at [`SelfIntersections::MOST`] or
    /// [`SelfIntersections::MOST_TESTS`].
    pub complete: bool,
}

impl SelfIntersections {
    /// The number of pairs at which counting stops: 67,108,864, some ten seconds.
    pub const MOST: usize = 1 << 26;
    /// Budget of the search, in tests of two faces or of two nodes of the tree; 256 more per face. Less than
    /// a minute. Only meshes whose faces nearly all overlap, or slivers across everything, take as many.
    pub const MOST_TESTS: u64 = 1 << 27;
}

impl CrackReport {
    /// Adds the self-intersections to the report, with the first `keep` pairs. See
    /// [`for_each_self_intersection`] for the definition and the cost.
    ///
    /// # Panics
    ///
    /// Panics if `topology` has other triangles than `mesh`.
    pub fn add_self_intersections(&mut self, mesh: &Mesh, topology: &Topology, keep: usize) {
        let mut found = SelfIntersections { pairs: 0, faces: 0, first: Vec::new(), complete: true };
        let mut involved = vec![false; topology.face_count()];
        let mut tests = SelfIntersections::MOST_TESTS + 256 * topology.face_count() as u64;
        let end = for_each_intersection_among(mesh, &faces_with_area(mesh, topology), &mut tests, |pair| {
            if found.pairs == SelfIntersections::MOST {
                return ControlFlow::Break(());
            }
            found.pairs += 1;
            for face in pair {
                found.faces += usize::from(!std::mem::replace(&mut involved[face.index()], true));
            }
            // Pairs arrive unordered: from time to time all but the first ones are dropped.
            if found.first.len() >= keep.saturating_mul(2).max(1024) {
                found.first.sort_unstable();
                found.first.truncate(keep);
            }
            found.first.push(pair);
            ControlFlow::Continue(())
        });
        found.first.sort_unstable();
        found.first.truncate(keep);
        found.complete = end.is_continue();
        self.counts.self_intersections = Some(found.pairs);
        self.self_intersections = Some(found);
    }
}

/// Calls `visit` with each pair of faces that intersect, the lower id first, each pair once, until it breaks.
/// The order depends on the mesh alone. `mesh` is the welded mesh from whose triangles `topology` was built.
///
/// Candidates come from a tree over the faces' boxes, about 150 bytes per face. Few pairs are held at a time,
/// so that memory stays bounded even if all faces intersect each other.
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

/// The faces with area, which alone can intersect, ascending.
fn faces_with_area(mesh: &Mesh, topology: &Topology) -> Vec<FaceId> {
    assert!(mesh.triangles() == topology.triangles(), "the topology is that of another mesh");
    let has_area = |&face: &FaceId| {
        let [a, b, c] = mesh.corners(face);
        !topology.is_collapsed(face) && !collinear(a, b, c)
    };
    topology.faces().filter(has_area).collect()
}

/// Tasks per parallel step; their pairs are visited after the step, in order.
const WINDOW: usize = 256;
/// Pairs held per task; a task that finds more is repeated alone, and visits its pairs as it finds them.
const MOST_HELD: usize = 4096;

/// Result of a task.
#[derive(Default)]
struct Done {
    pairs: Vec<[FaceId; 2]>,
    tests: u64,
    /// Whether there were more pairs than are held.
    more: bool,
}

/// [`for_each_self_intersection`] among some faces, ascending, that all have area. It breaks if `visit` does,
/// or if no tests are left.
///
/// A test of two faces whose boxes overlap costs one, and so does a test of two nodes of the tree, of which
/// slivers across everything need many. Faces that all overlap (those around one vertex, say) are tested each
/// against each.
pub(crate) fn for_each_intersection_among(
    mesh: &Mesh,
    faces: &[FaceId],
    tests: &mut u64,
    mut visit: impl FnMut([FaceId; 2]) -> ControlFlow<()>,
) -> ControlFlow<()> {
    let boxes: Vec<Aabb> = faces.iter().map(|&face| Aabb::around(mesh.corners(face))).collect();
    let tree = Overlaps::of(&boxes);
    drop(boxes);
    // Each face is compared with about ten near it: in the order of the tree these are near in memory too.
    let corners: Vec<Corners> = tree.order().iter().map(|&i| Corners::of(mesh, faces[i as usize])).collect();
    let pair = |places: [usize; 2]| {
        let [i, j] = places.map(|place| tree.order()[place]);
        [faces[i.min(j) as usize], faces[i.max(j) as usize]]
    };
    let intersect = |[i, j]: [usize; 2]| intersect(&corners[i], &corners[j]);
    for window in tree.tasks().chunks(WINDOW) {
        let mut done: Vec<Done> = window.iter().map(|_| Done::default()).collect();
        let most = *tests;
        parallel::rows(&mut done, 1, |task, done| {
            let done = &mut done[0];
            // A break only means that the rest of this task is not needed.
            let _ = tree.for_each_pair(window[task], |places| {
                done.tests += 1;
                if let Some(places) = places.filter(|&places| intersect(places)) {
                    done.more = done.pairs.len() == MOST_HELD;
                    if !done.more {
                        done.pairs.push(pair(places));
                    }
                }
                if done.more || done.tests >= most {
                    ControlFlow::Break(())
                } else {
                    ControlFlow::Continue(())
                }
            });
        });
        for (&task, done) in window.iter().zip(done) {
            if done.more {
                tree.for_each_pair(task, |places| {
                    *tests = tests.saturating_sub(1);
                    if let Some(places) = places.filter(|&places| intersect(places)) {
                        visit(pair(places))?;
                    }
                    if *tests == 0 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
                })?;
                continue;
            }
            *tests = tests.saturating_sub(done.tests);
            done.pairs.into_iter().try_for_each(&mut visit)?;
            if *tests == 0 {
                return ControlFlow::Break(());
            }
        }
    }
    ControlFlow::Continue(())
}

/// All pairs of faces that intersect, the lower id first, ascending. [`for_each_self_intersection`] does not
/// hold them in memory.
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
    pairs.sort_unstable();
    pairs
}

type Point = [f32; 3];

/// The vertices of a face, and their positions.
struct Corners {
    ids: [u32; 3],
    at: [Point; 3],
}

impl Corners {
    fn of(mesh: &Mesh, face: FaceId) -> Self {
        Self { ids: mesh.triangles()[face.index()], at: mesh.corners(face) }
    }

    /// From corner `first` on, counter-clockwise.
    #[inline]
    fn from(&self, first: usize) -> [Point; 3] {
        let [a, b, c] = self.at;
        [[a, b, c], [b, c, a], [c, a, b]][first]
    }
}

/// Whether two faces with area intersect beyond what they share.
fn intersect(f: &Corners, g: &Corners) -> bool {
    let mut shared = (0..3).filter_map(|i| g.ids.iter().position(|&id| id == f.ids[i]).map(|j| (i, j)));
    match (shared.next(), shared.next(), shared.next()) {
        (None, ..) => meet(f.at, g.at),
        (Some((i, j)), None, _) => meet_beyond_vertex(f.from(i), g.from(j)),
        (Some((i, j)), Some((k, l)), None) => folded(f.at[i], f.at[k], f.at[3 - i - k], g.at[3 - j - l]),
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::shapes;

    /// `count` triangles, each through all others, without a common vertex.
    fn heap(count: u32) -> (Mesh, Topology) {
        let one = Mesh::new(vec![[0.0; 3], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]], vec![[0, 1, 2]]).unwrap();
        let mesh = shapes::soup(&Mesh::concat(&vec![one; count as usize]).unwrap());
        let topology = Topology::of(&mesh);
        (mesh, topology)
    }

    fn found(mesh: &Mesh, faces: &[FaceId], mut tests: u64) -> (Vec<[FaceId; 2]>, ControlFlow<()>) {
        let mut pairs = Vec::new();
        let end = for_each_intersection_among(mesh, faces, &mut tests, |pair| {
            pairs.push(pair);
            ControlFlow::Continue(())
        });
        (pairs, end)
    }

    #[test]
    fn intersections_of_more_pairs_than_are_held_come_once_each() {
        let (mesh, topology) = heap(150);
        let all: Vec<[FaceId; 2]> =
            (0..150).flat_map(|f| (f + 1..150).map(move |g| [FaceId(f), FaceId(g)])).collect();
        assert!(all.len() > MOST_HELD, "one task holds them all");
        assert_eq!(self_intersections(&mesh, &topology), all);
        // With one face too few the comparison fails.
        let fewer: Vec<FaceId> = topology.faces().skip(1).collect();
        assert_ne!(found(&mesh, &fewer, u64::MAX).0.len(), all.len());
    }

    #[test]
    fn intersections_end_where_tests_do() {
        for count in [20, 150] {
            let (mesh, topology) = heap(count);
            let faces: Vec<FaceId> = topology.faces().collect();
            let (all, end) = found(&mesh, &faces, u64::MAX);
            assert!(end.is_continue() && all.len() as u32 == count * (count - 1) / 2);
            let (some, end) = found(&mesh, &faces, 100);
            assert!(end.is_break() && some.len() <= 100, "{} pairs", some.len());
        }
    }
}
