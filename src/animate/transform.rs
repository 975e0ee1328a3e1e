//! The transform of a node below its parent.

use glam::{DMat4, DQuat, DVec3};

/// A node's own transform. What a clip moves has parts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Local {
    Matrix(DMat4),
    Parts {
        translation: DVec3,
        /// Of unit length.
        rotation: DQuat,
        scale: DVec3,
    },
}

impl Local {
    pub(crate) fn matrix(&self) -> DMat4 {
        match *self {
            Self::Matrix(matrix) => matrix,
            Self::Parts { translation, rotation, scale } => {
                DMat4::from_scale_rotation_translation(scale, rotation, translation)
            }
        }
    }

    pub(crate) fn is_matrix(&self) -> bool {
        matches!(self, Self::Matrix(_))
    }

    /// The same as translation, rotation and scale; shear is lost, and so is a matrix without a volume.
    pub(crate) fn in_parts(&self) -> Self {
        match self {
            Self::Matrix(matrix) if matrix.determinant() != 0.0 => {
                let (scale, rotation, translation) = matrix.to_scale_rotation_translation();
                Self::Parts { translation, rotation, scale }
            }
            Self::Matrix(matrix) => Self::Parts {
                translation: matrix.w_axis.truncate(),
                rotation: DQuat::IDENTITY,
                scale: DVec3::ZERO,
            },
            parts @ Self::Parts { .. } => *parts,
        }
    }
}
