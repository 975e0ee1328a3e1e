//! Faults that tests inject, to see that a comparison would catch them.

/// What is done wrong on purpose.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Fault {
    /// The box of a piece is tested against the view instead of its shadow volume.
    BoxInView,
    /// The points at infinity of a shadow volume are forgotten where it is tested against tiles.
    NoExtruded,
    /// What touches the border of a shadow counts as inside.
    NotStrict,
    /// The range counts although light does not end there.
    RangeAlways,
}

crate::fault::faults!();
