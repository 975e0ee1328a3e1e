//! The side of a face that a light is on.

use crate::geom::predicate::Sign;

/// Side of a face that a light is on. The side is decided once and stored, so all later stages agree.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(i8)]
pub enum Facing {
    /// The light is behind the face.
    Back = -1,
    /// The light is exactly in the face's plane, or the face has no area.
    EdgeOn = 0,
    /// The light is in front of the face.
    Front = 1,
}

impl Facing {
    /// −1, 0 or +1.
    #[inline]
    #[must_use]
    pub fn sign(self) -> i8 {
        self as i8
    }

    #[inline]
    pub(crate) fn of(sign: Sign) -> Self {
        match sign {
            Sign::Negative => Self::Back,
            Sign::Zero => Self::EdgeOn,
            Sign::Positive => Self::Front,
        }
    }
}
