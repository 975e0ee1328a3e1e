//! The mistakes of an animation system that tests inject, each of which a comparison must catch.

/// A mistake.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Fault {
    /// Rotations turn the long way round.
    LongArc,
    /// Tangents are not scaled by the time between two keys.
    TangentScale,
    /// A channel goes on beyond its ends.
    Clamp,
    /// A step takes the next key.
    StepAhead,
    /// Joints move vertices without the inverse bind matrix.
    InverseBind,
    /// Weights of a vertex are taken as they are.
    Normalize,
    /// A node stands where its own transform puts it, without its parent.
    Parent,
    /// Morph weights move nothing.
    Morph,
}

crate::fault::faults!();
