//! The crack report of one mesh.

use crate::built::{self, Part};
use crate::geom::Aabb;
use crate::mesh::{EdgeId, FaceId, Mesh};
use crate::topology::Topology;

use super::boundary::Boundary;
use super::t_junctions::TJunction;
use super::{Counts, NearMiss, SelfIntersections, ShellReport, faces, shells};

/// Everything that is wrong with a mesh: the numbers, the shells, and the ids of the defects.
///
/// Positions are computed on demand by [`CrackReport::items`], from the same mesh and topology.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct CrackReport {
    /// The numbers.
    pub counts: Counts,
    /// The shells, in the order of their first faces.
    pub shell_list: Vec<ShellReport>,
    /// Whether the nesting search finished. It gives up if thousands of shells overlap; those without a depth
    /// have [`ShellReport::depth_known`] false.
    pub nesting_complete: bool,
    /// Whether the search for T-junctions finished. It gives up if thousands of boundary edges overlap; then
    /// there may be more.
    pub t_junctions_complete: bool,
    /// For each tolerance tried, ascending, the number of boundary edges that a weld would close; empty if
    /// there is no boundary.
    pub near_miss: Vec<NearMiss>,
    /// Result of [`CrackReport::add_self_intersections`]; `None` before its call.
    pub self_intersections: Option<SelfIntersections>,
    pub(super) places: Places,
}

/// Ids of the defects that are not cheap to recompute from the topology; no coordinates.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Places {
    /// Boundary edges, loop by loop, and the end of each loop in that list.
    pub(super) loop_edges: Vec<EdgeId>,
    pub(super) loop_ends: Vec<u32>,
    pub(super) zero_area: Vec<FaceId>,
    pub(super) duplicates: Vec<faces::Duplicate>,
    pub(super) near_miss_edges: Vec<EdgeId>,
    pub(super) t_junctions: Vec<TJunction>,
}

/// Budget of the nesting search, in tests of a shell or face against another; 256 more per face. Some
/// seconds.
const NESTING_TESTS: u64 = 1 << 26;
/// Budget of the search for T-junctions, in tests of a boundary vertex against a boundary edge; 256 more per
/// face.
const T_JUNCTION_TESTS: u64 = 1 << 24;

impl CrackReport {
    /// The report of every defect except self-intersections. `mesh` is the welded mesh from whose triangles
    /// `topology` was built.
    ///
    /// Time: linear for a mesh without defects. A boundary of k edges takes k·log k. Shells whose boxes lie
    /// in the box of another are tested through a tree over the faces of that one. Thousands of shells or of
    /// boundary edges that overlap would take quadratic time: the search gives up after some seconds and
    /// reports that ([`CrackReport::nesting_complete`], [`CrackReport::t_junctions_complete`]).
    ///
    /// Memory: 12 bytes per face at the peak without defects, at most 700 with any; about 220 per boundary
    /// edge. If the topology has no survey yet, that of [`Topology::shells`] comes first.
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

    /// [`CrackReport::of`] with other budgets for the two searches.
    pub(super) fn within(
        mesh: &Mesh,
        topology: &Topology,
        nesting_tests: u64,
        t_junction_tests: u64,
    ) -> Self {
        assert!(topology.is_of(mesh), "the topology is that of another mesh");
        built::note(Part::Report, mesh);
        let uses = topology.edge_counts();
        let shells = topology.shells();
        let survey = topology.survey();
        let (fans, vertices) = (&survey.fans, survey.vertices);
        let shell_list = shells::shells(mesh, topology, &shells, fans, vertices, &uses, nesting_tests);
        drop(shells);

        let zero_area = faces::zero_area(mesh, topology);
        let duplicates = if survey.repeats { faces::duplicates(topology) } else { Vec::new() };
        let same_winding = duplicates.iter().filter(|duplicate| duplicate.same_winding).count();

        let (mut loop_edges, mut loop_ends) = (Vec::new(), Vec::new());
        let (mut near_miss, mut near_miss_edges, mut t_junctions) = (Vec::new(), Vec::new(), Vec::new());
        let mut t_junctions_complete = true;
        if uses.boundary > 0 {
            (loop_edges, loop_ends) = topology.grouped_boundary();
            let bounds = shell_list.iter().fold(Aabb::EMPTY, |all, shell| all.join(&shell.bounds));
            let boundary = Boundary::new(mesh, topology, &loop_edges);
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
            self_intersections_complete: true,
            t_junctions_complete,
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
}
