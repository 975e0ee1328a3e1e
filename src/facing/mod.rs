//! Exact sides: whether a light is in front of each face, behind it, or in its plane.
//!
//! [`classify`] is the reference. [`FacePlanes`] gives the same answers many times as fast for many lights,
//! and [`FaceClusters`] for whole clusters of faces at once.

mod clusters;
#[cfg(feature = "gpu")]
pub(crate) mod gpu;
pub(crate) mod plane_tree;
pub(crate) mod planes;
pub(crate) mod quantized;
#[cfg(test)]
mod signs_tests;

pub(crate) use clusters::OPEN_SHARE;
pub use clusters::{FaceClusters, FacingRanges};
pub use planes::FacePlanes;

use crate::geom::{Facing, Light, predicate};
use crate::mesh::{FaceId, Mesh};

/// The side of one face that `light` is on, exactly.
///
/// # Panics
///
/// Panics if there is no such face.
#[inline]
#[must_use]
pub fn facing_of(mesh: &Mesh, face: FaceId, light: &Light) -> Facing {
    Facing::of(predicate::side_of_light(mesh.corners(face), light))
}

/// The side of every face that `light` is on, exactly; one entry per face.
///
/// Costs one filtered predicate per face. Memory: 1 byte per face. For many lights on one mesh,
/// [`FacePlanes`] is many times as fast.
///
/// ```
/// use umbrage::facing::classify;
/// use umbrage::geom::Facing;
/// use umbrage::testing::shapes;
/// let facing = classify(&shapes::cube(), &"point:3,0.1,0.2".parse()?);
/// assert_eq!(facing.iter().filter(|&&side| side == Facing::Front).count(), 2);
/// # Ok::<(), umbrage::geom::LightError>(())
/// ```
#[must_use]
pub fn classify(mesh: &Mesh, light: &Light) -> Vec<Facing> {
    (0..mesh.face_count()).map(|face| facing_of(mesh, FaceId::new(face), light)).collect()
}

/// Which faces cast the shadow, and with which sign.
///
/// ```
/// use umbrage::facing::CasterFaces;
/// use umbrage::geom::Facing;
/// let facing = [Facing::Front, Facing::Back, Facing::EdgeOn];
/// assert_eq!(CasterFaces::All.signs(&facing), [1, -1, 0]);
/// assert_eq!(CasterFaces::Front.signs(&facing), [1, 0, 0]);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Default)]
#[non_exhaustive]
pub enum CasterFaces {
    /// Every face that is not edge-on, with its sign. Right for every mesh.
    #[default]
    All,
    /// Front faces only: the textbook outline, "one face in front, the other not".
    Front,
    /// Back faces only: the front faces of a shell whose faces look inwards.
    Back,
}

impl CasterFaces {
    /// Lower-case name, as in reports: `general`, `front`, `back`.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::All => "general",
            Self::Front => "front",
            Self::Back => "back",
        }
    }

    /// The sign that each face casts with: one entry per face, −1, 0 or +1.
    #[must_use]
    pub fn signs(self, facing: &[Facing]) -> Vec<i8> {
        let mut signs = Vec::new();
        self.signs_into(facing, &mut signs);
        signs
    }

    /// As [`CasterFaces::signs`], into a buffer that keeps its memory.
    pub fn signs_into(self, facing: &[Facing], signs: &mut Vec<i8>) {
        signs.clear();
        signs.extend(facing.iter().map(|&facing| self.sign(facing)));
    }

    /// The sign that a face casts with.
    #[inline]
    #[must_use]
    pub fn sign(self, facing: Facing) -> i8 {
        match self {
            Self::All => facing.sign(),
            Self::Front => facing.sign().max(0),
            Self::Back => facing.sign().min(0),
        }
    }

    /// The sides on which a face casts, as bits: [`CASTS_IN_FRONT`], [`CASTS_BEHIND`].
    #[inline]
    #[must_use]
    pub fn mask(self) -> u8 {
        match self {
            Self::All => CASTS_IN_FRONT | CASTS_BEHIND,
            Self::Front => CASTS_IN_FRONT,
            Self::Back => CASTS_BEHIND,
        }
    }
}

/// Bit of a mask: the face casts if the light is in front of it.
pub const CASTS_IN_FRONT: u8 = 1;
/// Bit of a mask: the face casts if the light is behind it.
pub const CASTS_BEHIND: u8 = 2;
