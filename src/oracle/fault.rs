//! Faults that tests inject, to see that a comparison would catch them.

/// What is done wrong on purpose.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Fault {
    /// An expected face counts as passed by the ray.
    PassesUnasked,
    /// Nothing is taken to be nearer than an expected face.
    NothingNearer,
}

crate::fault::faults!();
