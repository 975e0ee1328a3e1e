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
//! Pairs that need no test are left out first: those within a star-shaped shell, and those around a vertex or
//! an edge with many faces, which are compared by direction; a duplicate meets what its original meets.

mod fans;
mod search;
mod star;
#[cfg(test)]
mod tests;
mod triangles;

use std::ops::ControlFlow;

use self::search::Search;
pub(crate) use self::star::is_star;
pub(crate) use self::triangles::{Corners, intersect, segment_meets};
use super::{CrackReport, faces};
use crate::geom::box_pairs::NO_SET;
use crate::geom::predicate::collinear;
use crate::mesh::{FaceId, Mesh};
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
        let end = for_each_within(mesh, topology, &mut tests, |pair| {
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
        self.counts.self_intersections_complete = found.complete;
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
    let _ = for_each_within(mesh, topology, &mut { u64::MAX }, visit);
}

/// [`for_each_self_intersection`], until no tests are left.
fn for_each_within(
    mesh: &Mesh,
    topology: &Topology,
    tests: &mut u64,
    mut visit: impl FnMut([FaceId; 2]) -> ControlFlow<()>,
) -> ControlFlow<()> {
    assert!(topology.is_of(mesh), "the topology is that of another mesh");
    // Only faces with area can intersect, and only the first of several with the same vertices is compared.
    let repeats = if topology.survey().repeats { faces::duplicates(topology) } else { Vec::new() };
    let mut copies: Vec<[FaceId; 2]> = repeats.iter().map(|found| [found.original, found.extra]).collect();
    copies.sort_unstable();
    let mut extra: Vec<FaceId> = repeats.into_iter().map(|found| found.extra).collect();
    extra.sort_unstable();
    let is_first = |face: FaceId| extra.binary_search(&face).is_err();
    let has_area = |&face: &FaceId| {
        let [a, b, c] = mesh.corners(face);
        !topology.is_collapsed(face) && !collinear(a, b, c) && is_first(face)
    };
    let faces: Vec<FaceId> = topology.faces().filter(has_area).collect();
    let search = Search::among(mesh, &faces).without_pairs_within(star_shells(mesh, topology, &faces));
    if copies.is_empty() {
        return search.run(tests, visit);
    }
    let all = |face: FaceId| {
        let from = copies.partition_point(|copy| copy[0] < face);
        let same = copies[from..].iter().take_while(move |copy| copy[0] == face);
        std::iter::once(face).chain(same.map(|copy| copy[1]))
    };
    search.run(tests, |[f, g]| all(f).try_for_each(|f| all(g).try_for_each(|g| visit([f.min(g), f.max(g)]))))
}

/// Faces of a shell below which a proof is not worth it.
const FEW: usize = 64;

/// The shell of each face if it is watertight and star-shaped; empty if there is none such.
fn star_shells(mesh: &Mesh, topology: &Topology, faces: &[FaceId]) -> Vec<u32> {
    let shells = topology.shells();
    let mut watertight = vec![true; shells.count];
    for edge in topology.edges() {
        let face = topology.half_edges(edge).next().map(|half_edge| topology.face(half_edge));
        let sound = topology.valence(edge) == 2 && !topology.is_misoriented(edge);
        if let Some(shell) = face.filter(|_| !sound).and_then(|face| shells.of_face[face.index()]) {
            watertight[shell as usize] = false;
        }
    }
    let list = shells.faces_by_shell();
    let star: Vec<bool> = (watertight.iter().zip(list.iter()))
        .map(|(&watertight, faces)| watertight && faces.len() >= FEW && is_star(mesh, faces))
        .collect();
    if !star.contains(&true) {
        return Vec::new();
    }
    let shell = |face: &FaceId| shells.of_face[face.index()].filter(|&shell| star[shell as usize]);
    faces.iter().map(|face| shell(face).unwrap_or(NO_SET)).collect()
}

/// [`for_each_self_intersection`] among some faces, ascending, that all have area. It breaks if `visit` does,
/// or if no tests are left.
pub(crate) fn for_each_intersection_among(
    mesh: &Mesh,
    faces: &[FaceId],
    tests: &mut u64,
    visit: impl FnMut([FaceId; 2]) -> ControlFlow<()>,
) -> ControlFlow<()> {
    Search::among(mesh, faces).run(tests, visit)
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
