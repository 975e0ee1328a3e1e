//! Faults that tests inject, to see that a comparison would catch them.

/// What is done wrong on purpose.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Fault {
    /// A scissor rectangle ends one pixel too soon, as if rounded down.
    OnePixelLess,
    /// A scissor rectangle holds the casters instead of their shadow volume.
    BoxOfCasters,
}

crate::fault::faults!();
