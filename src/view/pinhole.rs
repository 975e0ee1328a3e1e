//! A camera over a grid of pixels: from pixels to rays, from points to pixels.

use glam::DVec3;

use super::{Camera, Size};

/// A camera and the size of its picture, ready for many rays.
#[derive(Clone, Copy, Debug)]
pub struct Pinhole {
    eye: DVec3,
    forward: DVec3,
    /// Half the width and half the height of the picture at depth 1, along its right and its up.
    right: DVec3,
    up: DVec3,
    half_px: [f64; 2],
}

/// Where a point appears in a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Projected {
    /// From the left edge.
    pub x_px: f64,
    /// From the upper edge.
    pub y_px: f64,
    /// Along the camera's forward direction, in mesh units; more than 0.
    pub depth: f64,
}

impl Pinhole {
    /// Prepares `camera` for pictures of `size`.
    #[must_use]
    pub fn new(camera: &Camera, size: Size) -> Self {
        let (right, up) = camera.basis();
        let tan_y = (0.5 * f64::from(camera.fov_y_rad)).tan();
        Self {
            eye: camera.eye.as_dvec3(),
            forward: camera.forward.as_dvec3(),
            right: right * (tan_y * size.aspect()),
            up: up * tan_y,
            half_px: [size.width(), size.height()].map(|side| 0.5 * f64::from(side)),
        }
    }

    /// Where the rays begin.
    #[must_use]
    pub fn eye(&self) -> [f32; 3] {
        self.eye.as_vec3().into() // it came from f32
    }

    /// As [`Camera::ray`].
    #[must_use]
    pub fn ray(&self, x_px: f64, y_px: f64) -> [f32; 3] {
        let (x, y) = (x_px / self.half_px[0] - 1.0, 1.0 - y_px / self.half_px[1]);
        (self.forward + self.right * x + self.up * y).normalize().as_vec3().into()
    }

    /// Where `point` appears; `None` if it is not in front of the eye.
    #[must_use]
    pub fn project(&self, point: [f32; 3]) -> Option<Projected> {
        let at = self.homogeneous(point);
        (at.z > 0.0).then(|| self.to_px(at))
    }

    /// The visible part of a segment, cut where it leaves the picture by more than `margin` of its half size.
    #[must_use]
    pub(crate) fn project_segment(&self, ends: [[f32; 3]; 2], margin: f64) -> Option<[Projected; 2]> {
        let [a, b] = ends.map(|end| self.homogeneous(end));
        let (mut from, mut to) = (0.0_f64, 1.0_f64);
        // Inside all four sides a point is in front of the eye too.
        for side in [DVec3::X, DVec3::NEG_X, DVec3::Y, DVec3::NEG_Y] {
            let inside = |p: DVec3| (1.0 + margin) * p.z - side.dot(p);
            let (at_a, at_b) = (inside(a), inside(b));
            if at_a < 0.0 && at_b < 0.0 {
                return None;
            }
            let cut = at_a / (at_a - at_b);
            if at_a < 0.0 {
                from = from.max(cut);
            } else if at_b < 0.0 {
                to = to.min(cut);
            }
        }
        let ends = [a.lerp(b, from), a.lerp(b, to)];
        (from <= to && ends.iter().all(|end| end.z > 0.0)).then(|| ends.map(|end| self.to_px(end)))
    }

    /// Right and up in half pictures at depth 1, and depth: the picture is where both are within ± depth.
    fn homogeneous(&self, point: [f32; 3]) -> DVec3 {
        let at = DVec3::from(point.map(f64::from)) - self.eye;
        let part = |axis: DVec3| at.dot(axis) / axis.length_squared();
        DVec3::new(part(self.right), part(self.up), at.dot(self.forward))
    }

    fn to_px(self, at: DVec3) -> Projected {
        Projected {
            x_px: (1.0 + at.x / at.z) * self.half_px[0],
            y_px: (1.0 - at.y / at.z) * self.half_px[1],
            depth: at.z,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::view::Up;

    fn pinhole() -> Pinhole {
        let camera = Camera::look_at([1.0, 2.0, 3.0], [-4.0, 0.5, -2.0], 0.8, Up::Y).unwrap();
        Pinhole::new(&camera, Size::new(320, 200).unwrap())
    }

    #[test]
    fn project_finds_the_pixel_that_the_ray_went_through() {
        let pinhole = pinhole();
        for (x, y) in [(0.5, 0.5), (160.0, 100.0), (319.5, 7.5), (20.0, 199.0)] {
            let direction = pinhole.ray(x, y);
            let point = std::array::from_fn(|i| pinhole.eye()[i] + 8.0 * direction[i]);
            let at = pinhole.project(point).unwrap();
            assert!((at.x_px - x).abs() < 1e-3 && (at.y_px - y).abs() < 1e-3, "{at:?}");
            let behind = std::array::from_fn(|i| pinhole.eye()[i] - 8.0 * direction[i]);
            assert_eq!(pinhole.project(behind), None);
        }
    }

    #[test]
    fn segment_is_cut_at_the_sides_of_the_picture() {
        let pinhole = pinhole();
        let at = |x: f64, y: f64, t: f32| {
            let direction = pinhole.ray(x, y);
            std::array::from_fn(|i| pinhole.eye()[i] + t * direction[i])
        };
        let [a, b] = pinhole.project_segment([at(10.0, 10.0, 1.0), at(300.0, 150.0, 9.0)], 0.0).unwrap();
        assert!((a.x_px - 10.0).abs() < 1e-3 && (b.x_px - 300.0).abs() < 1e-3);
        let [a, b] = pinhole.project_segment([at(10.0, 100.0, 5.0), at(2000.0, 100.0, 5.0)], 0.0).unwrap();
        assert!((a.x_px - 10.0).abs() < 1e-3 && (b.x_px - 320.0).abs() < 1e-3, "{b:?}");
        assert!(pinhole.project_segment([at(-10.0, 0.0, 5.0), at(-20.0, 150.0, 5.0)], 0.0).is_none());
        // From before the eye to behind it: what is left ends at a side, not at infinity.
        let [_, b] = pinhole.project_segment([at(160.0, 100.0, 5.0), at(10.0, 100.0, -5.0)], 0.0).unwrap();
        assert!(b.depth > 0.0 && (b.x_px - 320.0).abs() < 1e-3, "{b:?}");
    }
}
