//! What a step of repair did: its changes, one by one.

use super::index_map::IndexMap;

/// What happened to a vertex, a face, a hole or a shell.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[non_exhaustive]
pub enum ChangeKind {
    /// A vertex became one with another one.
    VertexMerged,
    /// A vertex was left beside another one at the same position: a skin moves them differently.
    KeptApart,
    /// A vertex that no face uses was dropped.
    VertexDropped,
    /// A face with two equal corners was dropped.
    CollapsedDropped,
    /// A face was dropped that has the three vertices and the winding of another one, which stays.
    DuplicateDropped,
    /// A face was dropped together with one of the same three vertices and the opposite winding.
    OppositeCancelled,
    /// Two faces of the same three vertices and opposite windings were left: alone, they cast.
    OppositeKept,
    /// A face was turned over.
    FaceTurned,
    /// A surface that has no orientation (a Möbius strip) was left; `old` is its first face.
    ShellLeft,
    /// A face was cut at a vertex that lies on its edge; `new` is that vertex.
    FaceCut,
    /// A vertex that lies on the edge of a face was left: there were too many.
    TJunctionLeft,
    /// A fan of faces got a vertex of its own, at the same position.
    VertexSplit,
    /// An edge of more than two faces was left: its fans are one at both ends.
    EdgeLeft,
    /// A hole was closed; `new` is the first face of the patch, and [`Change::patch`] tells more.
    HoleFilled,
    /// A hole was left, for the reason that [`Change::patch`] has.
    HoleLeft,
}

impl ChangeKind {
    /// The stable name, in snake case.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::VertexMerged => "vertex_merged",
            Self::KeptApart => "kept_apart",
            Self::VertexDropped => "vertex_dropped",
            Self::CollapsedDropped => "collapsed_dropped",
            Self::DuplicateDropped => "duplicate_dropped",
            Self::OppositeCancelled => "opposite_cancelled",
            Self::OppositeKept => "opposite_kept",
            Self::FaceTurned => "face_turned",
            Self::ShellLeft => "shell_left",
            Self::FaceCut => "face_cut",
            Self::TJunctionLeft => "t_junction_left",
            Self::VertexSplit => "vertex_split",
            Self::EdgeLeft => "edge_left",
            Self::HoleFilled => "hole_filled",
            Self::HoleLeft => "hole_left",
        }
    }

    /// Whether the mesh was changed; `false` for what a step found and left.
    #[must_use]
    pub fn is_change(self) -> bool {
        use ChangeKind::{EdgeLeft, HoleLeft, KeptApart, OppositeKept, ShellLeft, TJunctionLeft};
        !matches!(self, KeptApart | OppositeKept | ShellLeft | TJunctionLeft | EdgeLeft | HoleLeft)
    }
}

/// One change.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Change {
    /// What happened.
    pub kind: ChangeKind,
    /// The vertex or face before the step; `None` if there was none.
    pub old: Option<u32>,
    /// The vertex or face after the step that stands for it; `None` if there is none.
    pub new: Option<u32>,
    /// Where it is.
    pub at: [f32; 3],
    /// The hole, if it is about one.
    pub patch: Option<Patch>,
}

/// A hole, and the faces that close it.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Patch {
    /// The number of its edges.
    pub edges: usize,
    /// The length around it, in mesh units.
    pub length: f64,
    /// The area of the patch; `None` if there is none.
    pub area: Option<f64>,
    /// The largest distance of a corner from the plane of the hole: the one through the mean of its corners
    /// whose normal is the hole's area as a vector.
    pub off_plane: f64,
    /// Whether the patch meets other faces where it should not; `None` if that was not found out.
    pub meets: Option<bool>,
    /// Why the hole was left; `None` if it was closed.
    pub left: Option<Left>,
}

/// Why a hole was left.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[non_exhaustive]
pub enum Left {
    /// It has more edges than was asked for.
    TooLong,
    /// It is longer around than was asked for.
    TooFarAround,
    /// Its edges do not close to a loop: windings disagree, or edges of more than two faces interrupt it.
    NoLoop,
    /// The patch would meet other faces where it should not.
    Meets,
    /// Every patch between the vertices of the hole would meet other faces: proven.
    NoPatch,
    /// An edge of the patch would have more than two faces.
    EdgeInUse,
    /// Whether the patch meets other faces was not decided: too many overlap.
    NotDecided,
}

impl Left {
    /// The reason in words that follow "left:".
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::TooLong => "more edges than the limit",
            Self::TooFarAround => "longer around than the limit",
            Self::NoLoop => "its edges do not close to a loop",
            Self::Meets => "the patch would meet other faces",
            Self::NoPatch => "every patch between its vertices would meet other faces",
            Self::EdgeInUse => "an edge of the patch would have more than two faces",
            Self::NotDecided => "not decided whether the patch meets other faces",
        }
    }
}

/// What one step did to a mesh.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Step {
    /// The name of the step, as reports give it.
    pub name: &'static str,
    /// The number of changes.
    pub count: usize,
    /// The number of places that were found and left.
    pub left: usize,
    /// The first [`Step::LISTED`] changes, and what was left among them, in the order of their indices.
    pub changes: Vec<Change>,
    /// How far a vertex moved at most, in mesh units, in any frame.
    pub largest_move: f64,
    /// Where the vertices are after the step; `None` if each kept its index, but for new ones at the end.
    pub vertices: Option<IndexMap>,
    /// Where the faces are after the step; `None` if each kept its index, but for new ones at the end.
    pub faces: Option<IndexMap>,
}

impl Step {
    /// Changes that are listed at most, so that the list of a large mesh stays small.
    pub const LISTED: usize = 1000;

    pub(super) fn new(name: &'static str) -> Self {
        Self { name, count: 0, left: 0, changes: Vec::new(), largest_move: 0.0, vertices: None, faces: None }
    }

    pub(super) fn add(&mut self, kind: ChangeKind, old: Option<u32>, new: Option<u32>, at: [f32; 3]) {
        if kind.is_change() {
            self.count += 1;
        } else {
            self.left += 1;
        }
        if self.changes.len() < Self::LISTED {
            self.changes.push(Change { kind, old, new, at, patch: None });
        }
    }

    /// Adds a hole that was closed, or left.
    pub(super) fn add_hole(&mut self, patch: Patch, new: Option<u32>, at: [f32; 3]) {
        let listed = self.changes.len();
        let kind = if patch.left.is_none() { ChangeKind::HoleFilled } else { ChangeKind::HoleLeft };
        self.add(kind, None, new, at);
        if let Some(change) = self.changes.get_mut(listed) {
            change.patch = Some(patch);
        }
    }
}
