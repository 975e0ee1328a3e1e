//! Parts of keys that tests forget, to see that a comparison would catch them.

/// The part of a key that is forgotten.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Fault {
    Frame,
    Place,
    Light,
    View,
    Casters,
    Brightness,
    GridCasters,
    GridLight,
    GridSide,
}

crate::fault::faults!();
