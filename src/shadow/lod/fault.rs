//! Faults that tests inject, to see that a comparison would catch them.

/// What is done wrong on purpose.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Fault {
    /// The shadow of an edge moves no farther than the edge.
    EdgeMovesByDelta,
    /// Shells that are seen are simplified too.
    SeenAreSimplified,
}

crate::fault::faults!();
