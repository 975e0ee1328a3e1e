//! Where a picture is taken from.

use glam::Vec3;

/// A perspective camera in world space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Where the eye is.
    pub eye: Vec3,
    /// Where it looks, unit length.
    pub forward: Vec3,
    /// What is up in the picture; need not be perpendicular to `forward`, only not parallel.
    pub up: Vec3,
    /// Vertical field of view, radians, in (0, π).
    pub fov_y_rad: f32,
}
