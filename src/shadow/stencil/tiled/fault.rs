//! Faults that tests inject, to see that a comparison would catch them.

/// What is done wrong on purpose.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Fault {
    /// A ray that runs exactly through an edge meets none of its triangles.
    TieMisses,
    /// Counts from the eye start at 0, whatever the eye is in.
    StartsAtZero,
    /// A tile has the depth of its first sample.
    FirstDepth,
    /// One sample decides a tile that a triangle crosses.
    CrossedIsUniform,
    /// Only triangles behind a tile count in it where its samples are counted from the eye.
    WrongSideDropped,
}

crate::fault::faults!();
