//! Faults that tests inject, to see that a comparison would catch them.

/// What is done wrong on purpose.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Fault {
    /// An edge of multiplicity ±2 is no boundary.
    NoOutline,
    /// Faces are united across every edge.
    UnitedAcross,
    /// A generic ray that may touch an edge counts as crossing the face.
    TouchIsCrossing,
    /// Bounds of the nearness are rounded inwards.
    RoundedInwards,
    /// The sheet of the visible face may be crossed twice.
    TwoCrossings,
    /// A point is sorted into the cell of its rounded y.
    NoErrorBox,
    /// The sheet of the visible face hides no part of the light, wherever its faces lie.
    OwnLeftOut,
    /// Rays to a light with an extent stay in the cell of its center.
    NoReach,
    /// Faces that are edge-on for the center of a light with an extent do not cast.
    EdgeOnLeftOut,
}

crate::fault::faults!();
