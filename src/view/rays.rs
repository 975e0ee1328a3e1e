//! A projection over a grid of pixels: from pixels to rays, from points to pixels.

use glam::{DMat3, DVec3, DVec4};

use super::{Projection, Size};

/// A projection and the size of its picture, ready for many rays.
///
/// Whatever casts rays through pixels takes them from here: pictures and their verification look along the
/// same ones.
#[derive(Clone, Copy, Debug)]
pub struct Rays {
    projection: Projection,
    /// From picture coordinates and distance to the world, seen from the eye.
    inverse: DMat3,
    half_px: [f64; 2],
}

/// A ray through a position of the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// The eye; of an orthographic camera the point of its plane that is seen at this position, rounded to
    /// `f32`.
    pub origin: [f32; 3],
    /// One unit of distance along the camera's forward direction.
    pub direction: [f32; 3],
}

/// The position of a point in a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Projected {
    /// From the left edge.
    pub x_px: f64,
    /// From the upper edge.
    pub y_px: f64,
    /// Along the camera's forward direction, in mesh units; more than 0.
    pub depth: f64,
}

impl Rays {
    /// Prepares `projection` for pictures of `size`.
    #[must_use]
    pub fn new(projection: &Projection, size: Size) -> Self {
        Self {
            projection: *projection,
            inverse: projection.depth_one(),
            half_px: [size.width(), size.height()].map(|side| 0.5 * f64::from(side)),
        }
    }

    /// The ray through the position `x_px`, `y_px` of the picture: from 0, 0 at its upper left corner; the
    /// center of a pixel lies half a pixel further.
    #[must_use]
    pub fn ray(&self, x_px: f64, y_px: f64) -> Ray {
        let (offset, direction) = self.wide(x_px, y_px);
        let origin = match self.projection.is_orthographic() {
            false => self.projection.eye,
            true => (wide(self.projection.eye) + offset).as_vec3().into(),
        };
        Ray { origin, direction: direction.as_vec3().into() }
    }

    /// The direction of [`Rays::ray`] before it is rounded.
    #[must_use]
    pub fn direction(&self, x_px: f64, y_px: f64) -> DVec3 {
        self.wide(x_px, y_px).1
    }

    /// From the eye to the ray's origin, and the direction.
    fn wide(&self, x_px: f64, y_px: f64) -> (DVec3, DVec3) {
        let (x, y) = (x_px / self.half_px[0] - 1.0, 1.0 - y_px / self.half_px[1]);
        match self.projection.is_orthographic() {
            true => (self.inverse * DVec3::new(x, y, 0.0), self.inverse * DVec3::Z),
            false => (DVec3::ZERO, self.inverse * DVec3::new(x, y, 1.0)),
        }
    }

    /// The position of `point` in the picture; `None` if it is not in front of the eye.
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
        // Inside all four sides a point is in front of a perspective eye too.
        for side in [DVec4::X, DVec4::NEG_X, DVec4::Y, DVec4::NEG_Y] {
            let inside = |p: DVec4| (1.0 + margin) * p.w - side.dot(p);
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

    /// Clip x and y, the distance, and clip w: the picture is where x and y are within ± w.
    fn homogeneous(&self, point: [f32; 3]) -> DVec4 {
        let at = wide(point) - wide(self.projection.eye);
        let [x, y, depth] =
            [self.projection.right, self.projection.up, self.projection.forward].map(|row| wide(row).dot(at));
        DVec4::new(x, y, depth, if self.projection.is_orthographic() { 1.0 } else { depth })
    }

    fn to_px(self, at: DVec4) -> Projected {
        Projected {
            x_px: (1.0 + at.x / at.w) * self.half_px[0],
            y_px: (1.0 - at.y / at.w) * self.half_px[1],
            depth: at.z,
        }
    }
}

fn wide(p: [f32; 3]) -> DVec3 {
    DVec3::from(p.map(f64::from))
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::*;
    use crate::view::{Camera, Up};

    fn size() -> Size {
        Size::new(320, 200).unwrap()
    }

    fn camera() -> Camera {
        Camera::look_at([1.0, 2.0, 3.0], [-4.0, 0.5, -2.0], 0.8, Up::Y).unwrap()
    }

    fn cameras() -> [Rays; 2] {
        [camera(), camera().orthographic(6.0).unwrap()]
            .map(|camera| Rays::new(&camera.projection(size(), 0.1), size()))
    }

    fn along(ray: Ray, t: f32) -> [f32; 3] {
        std::array::from_fn(|i| ray.origin[i] + t * ray.direction[i])
    }

    #[test]
    fn rays_are_those_of_the_projection_bit_for_bit() {
        let projection = camera().projection(size(), 0.1);
        let rays = Rays::new(&projection, size());
        for (x, y) in (0..4000).map(|i| (f64::from(i % 321), f64::from(i % 201) + 0.5)) {
            let ndc = DVec2::new(2.0 * x / 320.0 - 1.0, 1.0 - 2.0 * y / 200.0);
            let naive = projection.ray(ndc);
            assert_eq!(rays.direction(x, y), naive);
            assert_eq!(rays.ray(x, y), Ray { origin: projection.eye, direction: naive.as_vec3().into() });
        }
    }

    #[test]
    fn rays_of_an_orthographic_camera_are_parallel_and_apart_by_its_height() {
        let [_, rays] = cameras();
        let [top, bottom, left, right] =
            [(160.0, 0.0), (160.0, 200.0), (0.0, 100.0), (320.0, 100.0)].map(|(x, y)| rays.ray(x, y));
        assert!([bottom, left, right].iter().all(|ray| ray.direction == top.direction));
        let apart = |a: Ray, b: Ray| wide(a.origin).distance(wide(b.origin));
        // Rows, their inverse and the origins are rounded to f32: numbers up to 10, a handful of times.
        let error = 8.0 * 10.0 * f64::from(f32::EPSILON);
        assert!((apart(top, bottom) - 6.0).abs() < error, "{}", apart(top, bottom));
        assert!((apart(left, right) - 9.6).abs() < error, "{}", apart(left, right));
        let forward = camera().forward.as_dvec3();
        assert!((wide(top.direction) - forward).length() < error);
        assert!((wide(top.origin) - camera().eye.as_dvec3()).dot(forward).abs() < error);
    }

    #[test]
    fn project_finds_the_pixel_that_the_ray_went_through() {
        for rays in cameras() {
            for (x, y) in [(0.5, 0.5), (160.0, 100.0), (319.5, 7.5), (20.0, 199.0)] {
                let ray = rays.ray(x, y);
                let at = rays.project(along(ray, 8.0)).unwrap();
                assert!((at.x_px - x).abs() < 1e-3 && (at.y_px - y).abs() < 1e-3, "{at:?}");
                assert!((at.depth - 8.0).abs() < 1e-5, "{at:?}");
                assert_eq!(rays.project(along(ray, -8.0)), None);
            }
        }
    }

    #[test]
    fn segment_is_cut_at_the_sides_of_the_picture() {
        for rays in cameras() {
            let at = |x: f64, y: f64, t: f32| along(rays.ray(x, y), t);
            let [a, b] = rays.project_segment([at(10.0, 10.0, 1.0), at(300.0, 150.0, 9.0)], 0.0).unwrap();
            assert!((a.x_px - 10.0).abs() < 1e-3 && (b.x_px - 300.0).abs() < 1e-3);
            let [a, b] = rays.project_segment([at(10.0, 100.0, 5.0), at(2000.0, 100.0, 5.0)], 0.0).unwrap();
            assert!((a.x_px - 10.0).abs() < 1e-3 && (b.x_px - 320.0).abs() < 1e-3, "{b:?}");
            assert!(rays.project_segment([at(-10.0, 0.0, 5.0), at(-20.0, 150.0, 5.0)], 0.0).is_none());
        }
        // From before the eye to behind it: what is left ends at a side, not at infinity.
        let [rays, _] = cameras();
        let at = |x: f64, y: f64, t: f32| along(rays.ray(x, y), t);
        let [_, b] = rays.project_segment([at(160.0, 100.0, 5.0), at(10.0, 100.0, -5.0)], 0.0).unwrap();
        assert!(b.depth > 0.0 && (b.x_px - 320.0).abs() < 1e-3, "{b:?}");
    }
}
