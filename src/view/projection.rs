//! From the world to clip space: reversed depth, and no far plane.
//!
//! Depth is `near / distance`: 1 at the near plane, 0 at infinity, so that a vertex at infinity (`w = 0`) gets
//! exactly 0 and nothing has to be pushed off the far plane. (An infinite far plane: Cass Everitt and Mark J.
//! Kilgard, *Practical and Robust Stenciled Shadow Volumes for Hardware-Accelerated Rendering*, 2002, §3.2;
//! reversed, so that the spacing of floats cancels that of `1/z`: Eric Lengyel, *Projection Matrix Tricks*, 2007.)

use glam::{DMat3, DVec2, DVec3};

/// An eye, the three rows of a perspective projection, and the near plane; the very `f32` values that shaders use.
///
/// A homogeneous point `(p, w)` has the clip coordinates `x = right·q`, `y = up·q`, `w = forward·q` with
/// `q = p − w·eye`, and `z = near·w`. Subtracting the eye first, from coordinates that are exact, costs one
/// rounding; a matrix with the translation in it would cost the distance to the origin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Projection {
    /// Where the rays begin, in world space.
    pub eye: [f32; 3],
    /// Clip `x` per mesh unit: perpendicular to `forward`, 1 at the right edge of the picture at depth 1.
    pub right: [f32; 3],
    /// Clip `y` per mesh unit: 1 at the upper edge of the picture at depth 1.
    pub up: [f32; 3],
    /// Clip `w` per mesh unit: the unit vector that the eye looks along.
    pub forward: [f32; 3],
    /// How far the near plane is from the eye, in mesh units; more than 0.
    pub near: f32,
}

impl Projection {
    /// The clip coordinates of a homogeneous point, in `f64`.
    #[must_use]
    pub fn clip(&self, [x, y, z, w]: [f64; 4]) -> [f64; 4] {
        let q = DVec3::new(x, y, z) - w * wide(self.eye);
        [wide(self.right).dot(q), wide(self.up).dot(q), f64::from(self.near) * w, wide(self.forward).dot(q)]
    }

    /// The direction, at depth 1 (`forward·direction = 1`), of the ray through a place of the picture in normalized
    /// device coordinates: −1 to 1 from left to right and from below to above.
    #[must_use]
    pub fn ray(&self, ndc: DVec2) -> DVec3 {
        self.rows().transpose().inverse() * ndc.extend(1.0)
    }

    /// The corners of the near rectangle in world space, around it.
    #[must_use]
    pub fn near_corners(&self) -> [DVec3; 4] {
        let near = f64::from(self.near);
        [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]
            .map(|(x, y)| wide(self.eye) + near * self.ray(DVec2::new(x, y)))
    }

    /// Right, up and forward as the columns of a matrix.
    fn rows(&self) -> DMat3 {
        DMat3::from_cols(wide(self.right), wide(self.up), wide(self.forward))
    }
}

fn wide(p: [f32; 3]) -> DVec3 {
    DVec3::from(p.map(f64::from))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn projection() -> Projection {
        let (eye, right) = ([1.0, 2.0, 3.0], [0.8, 0.0, -0.6]);
        Projection { eye, right, up: [0.0, 2.0, 0.0], forward: [-0.6, 0.0, -0.8], near: 0.25 }
    }

    #[test]
    fn projection_sends_infinity_to_depth_zero_and_the_near_plane_to_one() {
        let projection = projection();
        assert_eq!(projection.clip([-3.0, 1.0, -4.0, 0.0])[2], 0.0);
        for corner in projection.near_corners() {
            let [x, y, z, w] = projection.clip(corner.extend(1.0).to_array());
            assert!((z / w - 1.0).abs() < 1e-6 && (x / w).abs() - 1.0 < 1e-6 && (y / w).abs() - 1.0 < 1e-6);
        }
    }

    #[test]
    fn projection_ray_goes_through_its_place_in_the_picture() {
        let projection = projection();
        for ndc in [DVec2::ZERO, DVec2::new(0.75, -0.3), DVec2::new(-1.0, 1.0)] {
            let [x, y, _, w] = projection.clip(projection.ray(ndc).extend(0.0).to_array());
            assert!((w - 1.0).abs() < 1e-12 && (DVec2::new(x, y) - ndc).length() < 1e-12);
        }
    }
}
