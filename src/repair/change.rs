//! What a step of repair did: its changes, one by one.

/// What happened to a vertex, a face, a hole or a shell.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[non_exhaustive]
pub enum ChangeKind {
    /// A vertex became one with another one.
    VertexMerged,
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
}

impl ChangeKind {
    /// The stable name, in snake case.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::VertexMerged => "vertex_merged",
            Self::VertexDropped => "vertex_dropped",
            Self::CollapsedDropped => "collapsed_dropped",
            Self::DuplicateDropped => "duplicate_dropped",
            Self::OppositeCancelled => "opposite_cancelled",
            Self::OppositeKept => "opposite_kept",
        }
    }

    /// Whether the mesh was changed; `false` for what a step found and left.
    #[must_use]
    pub fn is_change(self) -> bool {
        !matches!(self, Self::OppositeKept)
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
}

impl Step {
    /// Changes that are listed at most, so that the list of a large mesh stays small.
    pub const LISTED: usize = 1000;

    pub(super) fn new(name: &'static str) -> Self {
        Self { name, count: 0, left: 0, changes: Vec::new(), largest_move: 0.0 }
    }

    pub(super) fn add(&mut self, kind: ChangeKind, old: Option<u32>, new: Option<u32>, at: [f32; 3]) {
        if kind.is_change() {
            self.count += 1;
        } else {
            self.left += 1;
        }
        if self.changes.len() < Self::LISTED {
            self.changes.push(Change { kind, old, new, at });
        }
    }
}
