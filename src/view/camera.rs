//! A camera: where a picture is taken from, in which direction, and through which lens.

use std::f32::consts::PI;

use glam::{DVec3, Vec3};

use super::{Projection, ProjectionKind, Ray, Rays, Size, Up};
use crate::geom::Aabb;

/// A camera in world space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// The position of the eye; for parallel rays, of the center of the plane that they begin in.
    pub eye: Vec3,
    /// The direction of view, unit length.
    pub forward: Vec3,
    /// The direction that is up in the picture; need not be perpendicular to `forward`, only not parallel.
    pub up: Vec3,
    /// Perspective or orthographic.
    pub lens: Lens,
    /// The distance of the near plane in mesh units, above 0; `None`: see [`Camera::near`].
    pub near: Option<f32>,
}

/// The lens of a camera.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Lens {
    /// Rays through one point.
    Perspective {
        /// Vertical field of view, radians, in (0, π).
        fov_y_rad: f32,
    },
    /// Parallel rays.
    Orthographic {
        /// Height of what is seen, in mesh units; finite and above 0.
        height: f32,
    },
}

/// Why numbers make no [`Camera`].
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CameraError {
    /// A coordinate is NaN or infinite.
    #[error("the camera's eye and target need finite coordinates, not {0}")]
    NotFinite(f32),
    /// Eye and target are the same.
    #[error("the camera's eye is its target, {0},{1},{2}")]
    EyeIsTarget(f32, f32, f32),
    /// The field of view is not an angle that a plane picture can have.
    #[error("the field of view is {} degrees; it must be more than 0 and less than 180", .0.to_degrees())]
    FieldOfView(f32),
    /// The height of an orthographic camera is not a length.
    #[error("the height of the view is {0}; it must be finite and more than 0")]
    Height(f32),
    /// The distance of the near plane is not a length.
    #[error("the near plane is {0} away; it must be finite and more than 0")]
    Near(f32),
}

/// The default field of view: 35 degrees, that of a mild telephoto lens.
const FOV_Y_RAD: f32 = 35.0 * PI / 180.0;

/// The direction from the center towards the eye of a fitted camera, as right, up, back: three-quarter from
/// the front, 21 degrees above the horizon.
const THREE_QUARTER: [f64; 3] = [0.6, 0.45, 1.0];

/// The size of a fitted picture, as a multiple of that of its content.
const MARGIN: f64 = 1.08;

impl Camera {
    /// The field of view of a camera for which none is asked, radians.
    pub const DEFAULT_FOV_Y_RAD: f32 = FOV_Y_RAD;

    /// A camera at `eye` that looks to `target`, with `up` upright (or, looking along it, the next axis).
    ///
    /// # Errors
    ///
    /// [`CameraError`] if a coordinate is not finite, eye and target are the same, or `fov_y_rad` is not in
    /// (0, π).
    pub fn look_at(eye: [f32; 3], target: [f32; 3], fov_y_rad: f32, up: Up) -> Result<Self, CameraError> {
        if let Some(&x) = eye.iter().chain(&target).find(|x| !x.is_finite()) {
            return Err(CameraError::NotFinite(x));
        }
        if !(fov_y_rad > 0.0 && fov_y_rad < PI) {
            return Err(CameraError::FieldOfView(fov_y_rad));
        }
        if eye == target {
            return Err(CameraError::EyeIsTarget(eye[0], eye[1], eye[2]));
        }
        // In f64 the difference of two different f32 is not zero and its square neither over- nor underflows.
        let forward = (wide(target) - wide(eye)).normalize();
        let mut upright = wide(up.turn([0.0, 1.0, 0.0]).map(|x| x as f32));
        if !spans(forward, upright) {
            upright = wide(up.turn([0.0, 0.0, -1.0]).map(|x| x as f32));
        }
        let (forward, up) = (forward.as_vec3(), upright.as_vec3());
        Ok(Self { eye: eye.into(), forward, up, lens: Lens::Perspective { fov_y_rad }, near: None })
    }

    /// The same camera with parallel rays, which sees this much of the world from bottom to top.
    ///
    /// # Errors
    ///
    /// [`CameraError::Height`].
    pub fn orthographic(self, height: f32) -> Result<Self, CameraError> {
        match height > 0.0 && height.is_finite() {
            true => Ok(Self { lens: Lens::Orthographic { height }, ..self }),
            false => Err(CameraError::Height(height)),
        }
    }

    /// The same camera with a near plane at this distance: nothing nearer is seen.
    ///
    /// # Errors
    ///
    /// [`CameraError::Near`].
    pub fn with_near(self, near: f32) -> Result<Self, CameraError> {
        match near > 0.0 && near.is_finite() {
            true => Ok(Self { near: Some(near), ..self }),
            false => Err(CameraError::Near(near)),
        }
    }

    /// A camera that shows all of `bounds`: the default view, three-quarter from the front, from the right
    /// and from 21 degrees above, 35 degrees of field of view, as near as leaves a margin of 8 %.
    ///
    /// `aspect` is width over height. An empty box is taken as the origin, a point as a box one unit around
    /// it. For a box so large that the eye would leave `f32`, the eye is clamped to its range.
    #[must_use]
    pub fn fit(bounds: &Aabb, up: Up, aspect: f64) -> Self {
        Self::fit_from(THREE_QUARTER, bounds, up, aspect)
    }

    /// The same seen from another side: `towards` leads from the center to the eye, as right, up, back; its
    /// length does not matter. Seen from above or below, back is at the lower edge of the picture.
    ///
    /// # Panics
    ///
    /// Panics if `towards` is zero or not finite.
    #[must_use]
    pub fn fit_from(towards: [f64; 3], bounds: &Aabb, up: Up, aspect: f64) -> Self {
        let center = wide(bounds.center());
        let half = match bounds.diagonal() {
            0.0 => DVec3::splat(0.5),
            _ => (wide(bounds.high) - wide(bounds.low)) * 0.5,
        };
        let vertical = towards[0] == 0.0 && towards[2] == 0.0;
        let towards = DVec3::from(up.turn(towards)).try_normalize().expect("a direction");
        // The vertical itself cannot be upright in a picture along it.
        let upright = DVec3::from(up.turn(if vertical { [0.0, 0.0, -1.0] } else { [0.0, 1.0, 0.0] }));
        let (right, top) = basis(-towards, upright);
        let tan_y = f64::from(0.5 * FOV_Y_RAD).tan() / MARGIN;
        let corners = || {
            (0..8).map(|corner| {
                let sign = |axis: usize| if corner >> axis & 1 == 0 { -1.0 } else { 1.0 };
                half * DVec3::new(sign(0), sign(1), sign(2))
            })
        };
        // Each side of the picture needs a distance, that of its nearest corner. The eye moves sideways until
        // two opposite sides need the same.
        let fit = |aside: DVec3, tan: f64| {
            let ask = |sign: f64| {
                corners()
                    .map(|at| at.dot(towards) + sign * at.dot(aside) / tan)
                    .fold(f64::NEG_INFINITY, f64::max)
            };
            let (one, other) = (ask(1.0), ask(-1.0));
            (0.5 * (one + other), 0.5 * (one - other) * tan)
        };
        let (distance_x, x) = fit(right, tan_y * aspect);
        let (distance_y, y) = fit(top, tan_y);
        let step = towards * distance_x.max(distance_y) + right * x + top * y;
        let most = f64::from(f32::MAX);
        let eye = (center + step).clamp(DVec3::splat(-most), DVec3::splat(most));
        Self {
            eye: eye.as_vec3(),
            forward: (-towards).as_vec3(),
            up: upright.as_vec3(),
            lens: Lens::Perspective { fov_y_rad: FOV_Y_RAD },
            near: None,
        }
    }

    /// The ray through the position `x_px`, `y_px` of a picture of `size`: see [`Rays`], also for many of
    /// them.
    #[must_use]
    pub fn ray(&self, x_px: f64, y_px: f64, size: Size) -> Ray {
        self.rays(size).ray(x_px, y_px)
    }

    /// The rays of a picture of `size`.
    #[must_use]
    pub fn rays(&self, size: Size) -> Rays {
        // Rays do not depend on the near plane.
        Rays::new(&self.projection(size, 1.0), size)
    }

    /// The projection of this camera for a picture of `size`, cut at `near` mesh units before the eye. An
    /// orthographic one has its far plane at the end of `f32`: choose another for a depth buffer.
    #[must_use]
    pub fn projection(&self, size: Size, near: f32) -> Projection {
        let (right, up) = self.basis();
        let (half, kind) = match self.lens {
            Lens::Perspective { fov_y_rad } => (tan_half(fov_y_rad), ProjectionKind::InfinitePerspective),
            Lens::Orthographic { height } => {
                (0.5 * f64::from(height), ProjectionKind::Orthographic { far: f32::MAX })
            }
        };
        Projection {
            eye: self.eye.into(),
            right: (right / (half * size.aspect())).as_vec3().into(),
            up: (up / half).as_vec3().into(),
            forward: self.forward.into(),
            near,
            kind,
        }
    }

    /// Unit vectors to the right and upwards in the picture.
    pub(super) fn basis(&self) -> (DVec3, DVec3) {
        let forward = self.forward.as_dvec3();
        let up = self.up.as_dvec3();
        // A file may give any pair; without a plane, an axis that the view is farthest from serves.
        basis(forward, if spans(forward, up) { up } else { DVec3::AXES[forward.abs().min_position()] })
    }
}

fn tan_half(fov_y_rad: f32) -> f64 {
    (0.5 * f64::from(fov_y_rad)).tan()
}

/// Whether two directions determine left and right. `f32` components of unit length are off by up to 2⁻²⁵: a
/// sine below 2⁻²⁰ would leave the roll of the picture to rounding.
fn spans(forward: DVec3, up: DVec3) -> bool {
    forward.cross(up.normalize_or_zero()).length() >= (-20_f64).exp2()
}

fn basis(forward: DVec3, up: DVec3) -> (DVec3, DVec3) {
    let right = forward.cross(up).normalize();
    (right, right.cross(forward))
}

fn wide(p: [f32; 3]) -> DVec3 {
    DVec3::from(p.map(f64::from))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn look_at_refuses_what_is_no_camera() {
        let look = |eye, target, fov| Camera::look_at(eye, target, fov, Up::Y);
        assert_eq!(look([1.0; 3], [1.0; 3], 0.5), Err(CameraError::EyeIsTarget(1.0, 1.0, 1.0)));
        assert!(matches!(look([f32::NAN; 3], [1.0; 3], 0.5), Err(CameraError::NotFinite(_))));
        for fov in [0.0, -1.0, PI, f32::NAN, f32::INFINITY] {
            assert!(matches!(look([0.0; 3], [1.0; 3], fov), Err(CameraError::FieldOfView(_))), "{fov}");
        }
        for far in [f32::MAX, f32::from_bits(1)] {
            let camera = look([-far; 3], [far; 3], 0.5).unwrap();
            assert!((camera.forward.length() - 1.0).abs() < 1e-6, "{camera:?}");
        }
    }

    #[test]
    fn look_at_along_up_still_knows_left_from_right() {
        let size = Size::new(64, 48).unwrap();
        for (up, eye) in [(Up::Y, [0.0, 5.0, 0.0]), (Up::Z, [0.0, 0.0, 5.0])] {
            let camera = Camera::look_at(eye, [0.0; 3], 1.0, up).unwrap();
            let [left, right] = [0.0, 64.0].map(|x| camera.ray(x, 24.0, size).direction);
            assert!(left[0] < -0.1 && right[0] > 0.1, "{left:?} {right:?}");
        }
    }

    #[test]
    fn fit_shows_every_corner_and_fills_the_picture() {
        let boxes = [
            ([-1.0; 3], [1.0; 3]),
            ([0.0; 3], [10.0, 0.1, 0.1]),
            ([0.0, 0.0, 5.0], [0.0, 9.0, 5.0]),
            ([1e-30; 3], [3e-30; 3]),
            ([1e5; 3], [1e5 + 64.0; 3]),
        ];
        for (low, high) in boxes {
            // A line seen along it is a point, so it is left out from the sides.
            let sides: &[[f64; 3]] = match low == [-1.0; 3] {
                true => {
                    &[THREE_QUARTER, [0.0, 0.0, 2.0], [-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, -1.0, 0.0]]
                }
                false => &[THREE_QUARTER],
            };
            let shapes = [(Up::Y, (960, 540)), (Up::Z, (300, 900))];
            for (&side, (up, (width, height))) in
                sides.iter().flat_map(|side| shapes.map(|shape| (side, shape)))
            {
                let size = Size::new(width, height).unwrap();
                let bounds = Aabb { low, high };
                let camera = Camera::fit_from(side, &bounds, up, size.aspect());
                let rays = camera.rays(size);
                let towards = wide(up.turn(side).map(|x| x as f32)).normalize();
                assert!(camera.forward.as_dvec3().dot(towards) < -0.999_999, "{side:?}");
                // The eye is on that side of the middle.
                assert!((camera.eye.as_dvec3() - wide(bounds.center())).dot(towards) > 0.0, "{side:?}");
                let mut widest = 0.0_f64;
                for corner in 0..8 {
                    let p = std::array::from_fn(|i| if corner >> i & 1 == 0 { low[i] } else { high[i] });
                    let at = rays.project(p).expect("in front of the eye");
                    let (x, y) = (at.x_px / f64::from(width) - 0.5, at.y_px / f64::from(height) - 0.5);
                    widest = widest.max(x.abs()).max(y.abs());
                }
                assert!((0.4..0.5).contains(&widest), "{bounds:?} {size}: {widest}");
            }
        }
        for bounds in [Aabb::EMPTY, Aabb { low: [f32::MIN; 3], high: [f32::MAX; 3] }] {
            assert!(Camera::fit(&bounds, Up::Y, 1.0).eye.is_finite());
        }
    }

    #[test]
    fn ray_through_the_middle_looks_forward_and_y_runs_downwards() {
        let size = Size::new(8, 4).unwrap();
        let camera = Camera::look_at([0.0, 0.0, 5.0], [0.0; 3], 1.0, Up::Y).unwrap();
        let middle = Ray { origin: [0.0, 0.0, 5.0], direction: [0.0, 0.0, -1.0] };
        assert_eq!(camera.ray(4.0, 2.0, size), middle);
        let [x, y, z] = camera.ray(0.0, 0.0, size).direction;
        assert!((y / -z - 0.5_f32.tan()).abs() < 1e-6 && (x / y + 2.0).abs() < 1e-6);
    }
}
