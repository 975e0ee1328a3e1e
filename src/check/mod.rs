//! The crack report: everything that is wrong with a mesh, by name, with places.
//!
//! A defect is data, not an error: any mesh gets a report. Terms are defined at [`Counts`]; what each kind of
//! defect does to a shadow is said by [`DefectKind::effect`].

mod balance;
mod boundary;
mod defect;
mod faces;
mod self_intersections;
mod shells;
#[cfg(test)]
mod tests;

pub use defect::{Defect, DefectKind};

use std::ops::ControlFlow;

use crate::built::{self, Part};
use crate::geom::Aabb;
use crate::geom::predicate::Sign;
use crate::mesh::{EdgeId, FaceId, Mesh};
use crate::topology::Topology;
use crate::topology::fan::Fans;
pub use balance::Screen;
pub(crate) use self_intersections::{faces_with_area, for_each_intersection_among};
pub use self_intersections::{for_each_self_intersection, self_intersections};

/// What is wrong with a mesh: the numbers, the shells, and where each defect lies.
///
/// Places are computed on demand by [`CrackReport::items`], from the same mesh and topology.
#[derive(Clone, Debug, PartialEq)]
pub struct CrackReport {
    /// The numbers.
    pub counts: Counts,
    /// The shells, in the order of their first faces.
    pub shell_list: Vec<ShellReport>,
    /// Whether it was found out of all shells which others they lie in. Where thousands lie in one place the search
    /// gives up, and the rest have no [`ShellReport::depth_known`].
    pub nesting_complete: bool,
    /// Whether all T-junctions were looked for. Where thousands of boundary edges lie over one another the search
    /// gives up, and there may be more.
    pub t_junctions_complete: bool,
    /// How many boundary edges would close at which tolerance, ascending; empty if there is no boundary.
    pub near_miss: Vec<NearMiss>,
    /// What [`CrackReport::add_self_intersections`] found; `None` before it was called.
    pub self_intersections: Option<SelfIntersections>,
    places: Places,
}

/// The numbers of a crack report. Sums of several are in [`Counts::total`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Counts {
    /// Triangles as read, collapsed ones included.
    pub faces: usize,
    /// Undirected edges of faces that have not collapsed.
    pub edges: usize,
    /// Sets of faces connected through edges (not through single vertices).
    pub shells: usize,
    /// Shells that are watertight.
    pub closed_shells: usize,
    /// V − E + F over faces that have not collapsed, their edges, and their vertices.
    pub euler_characteristic: i64,
    /// Edges with exactly one face.
    pub boundary_edges: usize,
    /// Connected components of the boundary edges.
    pub boundary_loops: usize,
    /// Edges with three faces or more.
    pub non_manifold_edges: usize,
    /// The most faces that any edge has.
    pub max_faces_per_edge: usize,
    /// Edges with exactly two faces that run along it in the same direction.
    pub misoriented_edges: usize,
    /// Vertices whose faces form more than one fan.
    pub non_manifold_vertices: usize,
    /// Faces with two equal corners after welding; they have no edges.
    pub collapsed_faces: usize,
    /// Faces with three different corners on one line, exactly.
    pub zero_area_faces: usize,
    /// Faces beyond the first with the same three vertices: the two numbers below together.
    pub duplicate_faces: usize,
    /// Extras that run the same way round as the first face with their vertices.
    pub duplicate_same_winding: usize,
    /// Extras that run the other way round.
    pub duplicate_opposite_winding: usize,
    /// Boundary edges that pair one to one at the largest tolerance of [`CrackReport::near_miss`].
    pub near_miss_edges: usize,
    /// Boundary vertices inside another boundary edge, exactly or within the rounding of the coordinates.
    pub t_junctions: usize,
    /// Those of them that lie exactly on the edge.
    pub t_junctions_exact: usize,
    /// Watertight shells whose volume has the wrong sign for their nesting.
    pub inside_out_shells: usize,
    /// Shells of which it was not found out whether they are inside out, and which do not count as such: see
    /// [`ShellReport::undecided`].
    pub undecided_shells: usize,
    /// Pairs of faces that meet where they should not; `None` where nobody looked.
    pub self_intersections: Option<usize>,
    /// Volume in cubic mesh units, positive with faces outwards: the sum over the shells.
    pub signed_volume: f64,
    /// Every edge has exactly two faces, in opposite directions.
    pub watertight: bool,
    /// At every edge the two directions are used equally often.
    pub balanced: bool,
    /// Every edge is used an even number of times.
    pub even: bool,
}

impl Counts {
    /// Watertight, and no shell inside out; `false` too where that is not known of every shell.
    #[must_use]
    pub fn sound(&self) -> bool {
        self.may_be_sound() && self.undecided_shells == 0
    }

    /// Watertight, and no shell found to be inside out.
    #[must_use]
    pub fn may_be_sound(&self) -> bool {
        self.watertight && self.inside_out_shells == 0
    }

    /// Several reports as one: counts add up, maxima and conjunctions are taken as such, and what one of them
    /// did not compute is not known of all. `None` of nothing.
    #[must_use]
    pub fn total(reports: impl IntoIterator<Item = Self>) -> Option<Self> {
        reports.into_iter().reduce(|a, b| Self {
            faces: a.faces + b.faces,
            edges: a.edges + b.edges,
            shells: a.shells + b.shells,
            closed_shells: a.closed_shells + b.closed_shells,
            euler_characteristic: a.euler_characteristic + b.euler_characteristic,
            boundary_edges: a.boundary_edges + b.boundary_edges,
            boundary_loops: a.boundary_loops + b.boundary_loops,
            non_manifold_edges: a.non_manifold_edges + b.non_manifold_edges,
            max_faces_per_edge: a.max_faces_per_edge.max(b.max_faces_per_edge),
            misoriented_edges: a.misoriented_edges + b.misoriented_edges,
            non_manifold_vertices: a.non_manifold_vertices + b.non_manifold_vertices,
            collapsed_faces: a.collapsed_faces + b.collapsed_faces,
            zero_area_faces: a.zero_area_faces + b.zero_area_faces,
            duplicate_faces: a.duplicate_faces + b.duplicate_faces,
            duplicate_same_winding: a.duplicate_same_winding + b.duplicate_same_winding,
            duplicate_opposite_winding: a.duplicate_opposite_winding + b.duplicate_opposite_winding,
            near_miss_edges: a.near_miss_edges + b.near_miss_edges,
            t_junctions: a.t_junctions + b.t_junctions,
            t_junctions_exact: a.t_junctions_exact + b.t_junctions_exact,
            inside_out_shells: a.inside_out_shells + b.inside_out_shells,
            undecided_shells: a.undecided_shells + b.undecided_shells,
            self_intersections: a.self_intersections.zip(b.self_intersections).map(|(a, b)| a + b),
            signed_volume: a.signed_volume + b.signed_volume,
            watertight: a.watertight && b.watertight,
            balanced: a.balanced && b.balanced,
            even: a.even && b.even,
        })
    }
}

/// One shell: faces connected through edges.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShellReport {
    /// The lowest-numbered face of the shell.
    pub first_face: FaceId,
    /// How many faces it has.
    pub faces: usize,
    /// How many edges it has.
    pub edges: usize,
    /// How many vertices it has; one that two shells share counts for both.
    pub vertices: usize,
    /// V − E + F.
    pub euler_characteristic: i64,
    /// (2 − χ) / 2 of a watertight shell with one fan at each vertex; otherwise `None`.
    pub genus: Option<u64>,
    /// Volume in cubic mesh units, positive with faces outwards. Of a shell that is not balanced it is that of
    /// the cones over its faces from one point for the whole mesh, the mean of all corners.
    pub signed_volume: f64,
    /// The exact sign of the volume of a watertight shell; zero for one that is not.
    pub volume_sign: Sign,
    /// Every edge has exactly two faces, in opposite directions.
    pub watertight: bool,
    /// At every edge the two directions are used equally often.
    pub balanced: bool,
    /// Watertight, and the sign of the volume contradicts the depth: negative at an even one, positive at an
    /// odd one. (A cavity inside a solid is sound.) `false` where the depth is not known.
    pub inside_out: bool,
    /// In how many other watertight shells this one lies; 0 for one that is not watertight, or if it is not known.
    pub depth: usize,
    /// Whether the depth was found out: see [`CrackReport::nesting_complete`].
    pub depth_known: bool,
    /// The innermost of those shells, as an index into the list.
    pub parent: Option<usize>,
    /// The box around it.
    pub bounds: Aabb,
}

impl ShellReport {
    /// Whether it is not known if the shell is inside out: it has a volume, and its depth was not found out.
    #[must_use]
    pub fn undecided(&self) -> bool {
        !self.depth_known && !self.volume_sign.is_zero()
    }
}

/// What welding the boundary within a distance would close.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NearMiss {
    /// The distance over the diagonal of the mesh.
    pub relative: f64,
    /// The distance, in mesh units.
    pub distance: f64,
    /// Boundary edges that would pair one to one with another.
    pub edges: usize,
}

/// Faces that meet where they should not.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SelfIntersections {
    /// How many pairs of faces.
    pub pairs: usize,
    /// How many faces take part in one.
    pub faces: usize,
    /// The first pairs, in order, up to the number that was asked for.
    pub first: Vec<[FaceId; 2]>,
    /// Whether these are all; `false` if the search stopped at [`SelfIntersections::MOST`] or
    /// [`SelfIntersections::MOST_TESTS`].
    pub complete: bool,
}

impl SelfIntersections {
    /// Where counting stops: 67,108,864 pairs, some ten seconds. Where all faces overlap all others, their
    /// number is no longer news.
    pub const MOST: usize = 1 << 26;
    /// Where looking stops: after so many tests of two faces or of two nodes of the tree, and 256 more a face; less than a
    /// minute. Only faces that nearly all reach into one place, or slivers across everything, take as many.
    pub const MOST_TESTS: u64 = 1 << 27;
}

/// What cannot be read off the topology again at once: ids only, no coordinates.
#[derive(Clone, Debug, Default, PartialEq)]
struct Places {
    /// Boundary edges, loop by loop, and where each loop ends.
    loop_edges: Vec<EdgeId>,
    loop_ends: Vec<u32>,
    zero_area: Vec<FaceId>,
    duplicates: Vec<faces::Duplicate>,
    near_miss_edges: Vec<EdgeId>,
    t_junctions: Vec<boundary::TJunction>,
}

/// After so many tests of a shell, or a face of one, against another, and 256 more a face, the search for shells in
/// shells gives up: some seconds.
const NESTING_TESTS: u64 = 1 << 26;
/// The same for tests of a boundary vertex against a boundary edge.
const T_JUNCTION_TESTS: u64 = 1 << 24;

impl CrackReport {
    /// Looks for every defect but self-intersections.
    ///
    /// `mesh` is the welded mesh from whose triangles `topology` was built. Linear time for a mesh without
    /// defects, with 12 bytes a triangle at most beside the topology; a boundary of k edges is searched in
    /// k·log k with about 220 bytes an edge, and shells whose boxes lie in another's through a tree over that
    /// one's faces. Where thousands of shells or of boundary edges lie in one place, which would take quadratic time,
    /// the search gives up after some seconds and says so ([`CrackReport::nesting_complete`],
    /// [`CrackReport::t_junctions_complete`]).
    ///
    /// Memory: at its peak 12 bytes a face without defects, at most 700 whatever they are.
    ///
    /// # Panics
    ///
    /// Panics if `topology` has other triangles than `mesh`.
    ///
    /// ```
    /// use umbrage::testing::shapes;
    /// use umbrage::check::CrackReport;
    /// use umbrage::topology::Topology;
    /// let cube = shapes::cube();
    /// let topology = Topology::of(&cube);
    /// let report = CrackReport::of(&cube, &topology);
    /// assert!(report.counts.sound());
    /// assert_eq!(report.counts.euler_characteristic, 2);
    /// ```
    #[must_use]
    pub fn of(mesh: &Mesh, topology: &Topology) -> Self {
        let faces = topology.face_count() as u64;
        Self::within(mesh, topology, NESTING_TESTS + 256 * faces, T_JUNCTION_TESTS + 256 * faces)
    }

    /// The same with other bounds on the tests that the two searches may make.
    fn within(mesh: &Mesh, topology: &Topology, nesting_tests: u64, t_junction_tests: u64) -> Self {
        assert!(topology.is_of(mesh), "the topology is that of another mesh");
        built::note(Part::Report, mesh);
        let uses = topology.edge_counts();
        let shells = topology.shells();
        let &Fans { several: ref fans, vertices, folded } = topology.fans();
        let shell_list = shells::shells(mesh, topology, &shells, fans, vertices, &uses, nesting_tests);
        drop(shells);

        let zero_area = faces::zero_area(mesh, topology);
        let may_repeat = folded || uses.non_manifold > 0;
        let duplicates = if may_repeat { faces::duplicates(topology) } else { Vec::new() };
        let same_winding = duplicates.iter().filter(|duplicate| duplicate.same_winding).count();

        let (mut loop_edges, mut loop_ends) = (Vec::new(), Vec::new());
        let (mut near_miss, mut near_miss_edges, mut t_junctions) = (Vec::new(), Vec::new(), Vec::new());
        let mut t_junctions_complete = true;
        if uses.boundary > 0 {
            (loop_edges, loop_ends) = topology.grouped_boundary();
            let bounds = shell_list.iter().fold(Aabb::EMPTY, |all, shell| all.join(&shell.bounds));
            let boundary = boundary::Boundary::new(mesh, topology, &loop_edges);
            (near_miss, near_miss_edges) = boundary.near_miss(bounds.diagonal());
            (t_junctions, t_junctions_complete) = boundary.t_junctions(t_junction_tests);
        }

        let counts = Counts {
            faces: topology.face_count(),
            edges: topology.edge_count(),
            shells: shell_list.len(),
            closed_shells: shell_list.iter().filter(|shell| shell.watertight).count(),
            // Each term is below 2³².
            euler_characteristic: vertices as i64 - topology.edge_count() as i64
                + (topology.face_count() - topology.collapsed_face_count()) as i64,
            boundary_edges: uses.boundary,
            boundary_loops: loop_ends.len(),
            non_manifold_edges: uses.non_manifold,
            max_faces_per_edge: uses.max_faces,
            misoriented_edges: uses.misoriented,
            non_manifold_vertices: fans.chunk_by(|a, b| a.0 == b.0).count(),
            collapsed_faces: topology.collapsed_face_count(),
            zero_area_faces: zero_area.len(),
            duplicate_faces: duplicates.len(),
            duplicate_same_winding: same_winding,
            duplicate_opposite_winding: duplicates.len() - same_winding,
            near_miss_edges: near_miss_edges.len(),
            t_junctions: t_junctions.len(),
            t_junctions_exact: t_junctions.iter().filter(|junction| junction.exact).count(),
            inside_out_shells: shell_list.iter().filter(|shell| shell.inside_out).count(),
            undecided_shells: shell_list.iter().filter(|shell| shell.undecided()).count(),
            self_intersections: None,
            signed_volume: shell_list.iter().map(|shell| shell.signed_volume).sum(),
            watertight: uses.watertight(),
            balanced: uses.balanced,
            even: uses.even,
        };
        let places = Places { loop_edges, loop_ends, zero_area, duplicates, near_miss_edges, t_junctions };
        Self {
            counts,
            nesting_complete: shell_list.iter().all(|shell| shell.depth_known),
            shell_list,
            t_junctions_complete,
            near_miss,
            self_intersections: None,
            places,
        }
    }

    /// Looks for self-intersections too, and keeps the first `keep` pairs. See
    /// [`for_each_self_intersection`](super::for_each_self_intersection) for what counts, and for the cost.
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
            // They come in no order: now and then all but the first ones are let go.
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
