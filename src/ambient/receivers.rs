//! The points that ambient occlusion is worked out for.

use crate::mesh::FaceId;

/// A surface point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Receiver {
    /// The point.
    pub point: [f32; 3],
    /// The normal, of length 1. `None` where two sides of a sheet meet: the mean over the whole sphere counts.
    pub normal: Option<[f32; 3]>,
    /// The face whose middle this is, among those of all meshes in sequence. It hides nothing from itself.
    pub face: Option<FaceId>,
}

/// What gets one value.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Per {
    /// Each position: one normal over all of its faces.
    Vertex,
    /// Each position and normal: a hard edge has one value on each side.
    #[default]
    Corner,
    /// Each face, at its middle.
    Face,
}

/// The receivers of some meshes, and which one each corner of a face takes its value from.
#[derive(Clone, Debug, Default)]
pub struct Receivers {
    pub(super) list: Vec<Receiver>,
    pub(super) corners: Vec<[u32; 3]>,
}

impl Receivers {
    /// The receivers, without two that are equal.
    #[must_use]
    pub fn list(&self) -> &[Receiver] {
        &self.list
    }

    /// For each face of all meshes, in sequence, the indices of its corners' receivers.
    #[must_use]
    pub fn corners(&self) -> &[[u32; 3]] {
        &self.corners
    }
}
