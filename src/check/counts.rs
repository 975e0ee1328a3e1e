//! The numbers of a crack report, and the verdict that they give.

use super::{CrackReport, DefectKind};
use crate::mesh::Mesh;
use crate::topology::Topology;

/// The numbers of a crack report. [`Counts::total`] adds up several.
///
/// ```
/// use umbrage::check::{CrackReport, Verdict};
/// use umbrage::testing::shapes;
/// use umbrage::topology::Topology;
/// let cube = shapes::open_cube();
/// let counts = CrackReport::of(&cube, &Topology::of(&cube)).counts;
/// assert_eq!((counts.boundary_edges, counts.boundary_loops), (4, 1));
/// assert_eq!(counts.verdict(), Verdict::Cracked);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
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
    /// Duplicates with the winding of the first face with their vertices.
    pub duplicate_same_winding: usize,
    /// Duplicates with the opposite winding.
    pub duplicate_opposite_winding: usize,
    /// Boundary edges that pair one to one at the largest tolerance of
    /// [`CrackReport::near_miss`](super::CrackReport::near_miss).
    pub near_miss_edges: usize,
    /// Boundary vertices inside another boundary edge, exactly or within the rounding of the coordinates.
    pub t_junctions: usize,
    /// T-junctions whose vertex lies exactly on the edge.
    pub t_junctions_exact: usize,
    /// Watertight shells whose volume has the wrong sign for their nesting.
    pub inside_out_shells: usize,
    /// Shells whose orientation is undecided, which do not count as inside out: see
    /// [`ShellReport::undecided`](super::ShellReport::undecided).
    pub undecided_shells: usize,
    /// Pairs of faces that meet where they should not; `None` if they were not searched for.
    /// Where the search did not finish, those found before.
    pub self_intersections: Option<usize>,
    /// Whether [`Counts::self_intersections`] are all that there are; `false` if the search stopped at a
    /// limit.
    pub self_intersections_complete: bool,
    /// Whether [`Counts::t_junctions`] are all that there are; `false` if the search stopped at a limit.
    pub t_junctions_complete: bool,
    /// Volume in cubic mesh units, positive with faces outwards: the sum over the shells.
    pub signed_volume: f64,
    /// Every edge has exactly two faces, in opposite directions.
    pub watertight: bool,
    /// At every edge the two directions are used equally often.
    pub balanced: bool,
    /// Every edge is used an even number of times.
    pub even: bool,
}

impl Default for Counts {
    /// The counts of a mesh without faces.
    fn default() -> Self {
        let mesh = Mesh::default();
        CrackReport::of(&mesh, &Topology::of(&mesh)).counts
    }
}

impl Counts {
    /// The verdict: [`Counts::is_empty`], [`Counts::sound`], [`Counts::may_be_sound`] or none of them.
    #[must_use]
    pub fn verdict(&self) -> Verdict {
        if self.is_empty() {
            Verdict::Empty
        } else if self.sound() {
            Verdict::Sound
        } else if self.may_be_sound() {
            Verdict::NotProven
        } else {
            Verdict::Cracked
        }
    }

    /// Whether there is no face at all, or none that does not collapse.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.faces == self.collapsed_faces
    }

    /// Whether the number of defects of a kind is final, rather than the number found before a search
    /// stopped.
    #[must_use]
    pub fn is_complete(&self, kind: DefectKind) -> bool {
        match kind {
            DefectKind::SelfIntersection => self.self_intersections_complete,
            DefectKind::TJunction => self.t_junctions_complete,
            DefectKind::InsideOutShell => self.undecided_shells == 0,
            _ => true,
        }
    }

    /// Whether the mesh is watertight and no shell is inside out, as it is without faces; `false` too if that
    /// is undecided for some shell.
    #[must_use]
    pub fn sound(&self) -> bool {
        self.may_be_sound() && self.undecided_shells == 0
    }

    /// Whether the mesh is watertight and no shell was found to be inside out.
    #[must_use]
    pub fn may_be_sound(&self) -> bool {
        self.watertight && self.inside_out_shells == 0
    }

    /// The counts of several reports together: numbers add up, maxima stay maxima, properties hold if they
    /// hold of all, and what one report did not compute is `None`. `None` for an empty list.
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
            self_intersections_complete: a.self_intersections_complete && b.self_intersections_complete,
            t_junctions_complete: a.t_junctions_complete && b.t_junctions_complete,
            signed_volume: a.signed_volume + b.signed_volume,
            watertight: a.watertight && b.watertight,
            balanced: a.balanced && b.balanced,
            even: a.even && b.even,
        })
    }
}

/// What a crack report says of a mesh, from good to bad.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[non_exhaustive]
pub enum Verdict {
    /// Watertight, and no shell is inside out.
    Sound,
    /// Nothing is wrong, but the nesting search gave up before it was decided which shell lies in which.
    NotProven,
    /// There are no faces, or they all collapse: nothing was checked.
    Empty,
    /// Not watertight, or a shell is inside out.
    Cracked,
}

impl Verdict {
    /// The name that `umbrage check` prints.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Sound => "sound",
            Self::NotProven => "not proven sound",
            Self::Empty => "empty",
            Self::Cracked => "cracked",
        }
    }
}

impl std::fmt::Display for Verdict {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.name())
    }
}
