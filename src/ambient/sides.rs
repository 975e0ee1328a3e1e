//! On which side of the other faces through its point a receiver at a hard edge is.

use std::sync::Arc;

use crate::mesh::FaceId;

/// For receivers whose faces do not surround them: where these faces are.
#[derive(Clone, Debug, Default)]
pub(super) struct Sides {
    /// For each receiver a direction into its own faces; 0 if they surround it.
    inward: Vec<[f32; 3]>,
    /// The number of each receiver among all.
    numbers: Vec<u32>,
    /// Of each face, the receivers of its corners.
    of_face: Arc<Vec<[u32; 3]>>,
}

/// How steeply a receiver at a hard edge is moved off its own faces, as it is moved into them: by less than a
/// sixteenth of a degree, and by far more than normals are rounded.
const RISE: f64 = 1.0 / 1024.0;

impl Sides {
    pub(super) fn new(inward: Vec<[f32; 3]>, of_face: &[[u32; 3]]) -> Self {
        if inward.iter().all(|&into| into == [0.0; 3]) {
            return Self::default();
        }
        Self { numbers: (0..).take(inward.len()).collect(), inward, of_face: Arc::new(of_face.to_vec()) }
    }

    /// Those of some receivers.
    #[cfg(feature = "verify")]
    pub(super) fn only(&self, chosen: &[u32]) -> Self {
        if self.inward.is_empty() {
            return Self::default();
        }
        Self {
            inward: chosen.iter().map(|&index| self.inward[index as usize]).collect(),
            numbers: chosen.iter().map(|&index| self.numbers[index as usize]).collect(),
            of_face: Arc::clone(&self.of_face),
        }
    }

    /// A direction into the faces of a receiver; 0 if they surround it.
    pub(super) fn inward(&self, index: usize) -> [f32; 3] {
        self.inward.get(index).copied().unwrap_or_default()
    }

    /// Where a receiver is moved, by nothing, to see which side of a face that is not its own it is on: along
    /// its normal. At a hard edge, where the other side of the edge may contain the normal, into its own
    /// faces.
    pub(super) fn off(&self, index: usize, normal: [f32; 3]) -> [f32; 3] {
        match self.inward(index) {
            [0.0, 0.0, 0.0] => normal,
            inward => [0, 1, 2].map(|i| (f64::from(inward[i]) + RISE * f64::from(normal[i])) as f32),
        }
    }

    /// Whether a receiver stands for a corner of a face.
    pub(super) fn is_own(&self, index: usize, face: FaceId) -> bool {
        self.of_face
            .get(face.index())
            .zip(self.numbers.get(index))
            .is_some_and(|(receivers, number)| receivers.contains(number))
    }
}
