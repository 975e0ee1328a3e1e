//! Faults that tests inject, to see that a comparison would catch them.

/// What is done wrong on purpose.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Fault {
    /// Edges left of u = 0 are dropped.
    NoLeft,
    /// What is open at u = 1 is not closed there.
    NoClosing,
    /// Areas are added, where they overlap twice.
    Sum,
    /// Parts beyond the light cast.
    NoFarPlane,
    /// A face seen edge-on counts as seen from the front.
    ZeroIsFront,
    /// Edges between three faces or more count once.
    NoMultiplicity,
    /// Faces through the receiver hide nothing.
    NoFan,
}

crate::fault::faults!();
