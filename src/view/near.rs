//! The near plane that cuts nothing.
//!
//! Reversed depth without a far plane is as precise beyond a near plane of a micrometer as beyond one of a
//! kilometer: depth is `near / distance`, a float with its own exponent. So the near plane is put where
//! nothing is seen, half as far as a bound of the nearest visible surface. Let a point of a face be seen at
//! the depth `t`, through a ray of length `r` at depth 1. Two bounds hold, and the larger one counts:
//!
//! - `t` is at least the least depth of the face's corners.
//! - `t·r` is at least the distance `h` of the eye from the face's plane, so `t ≥ h/c`, with the length `c`
//!   of the ray through the corner of the picture that is farthest from the middle. A face whose plane
//!   contains the eye is seen edge-on, that is, not at all, so `h` is never 0.
//!
//! Faces beyond one side of the picture do not count. Half the bound leaves more than enough for the rounding
//! of the bound itself (2⁻³⁷ of it) and of a rasterizer that clips (2⁻²⁰).

use glam::{DVec2, DVec3};

use super::{Camera, Lens, Projection, Size};
use crate::geom::predicate::{Homogeneous, height};
use crate::mesh::{FaceId, Mesh};

/// Least near plane, relative to the farthest coordinate that is seen: at `f32`'s smallest normal number
/// depths end, 2⁻¹²⁶, and between the two remain 26 powers of two for the distances of what is seen.
const LEAST: f64 = 1.0 / (1_u128 << 100) as f64;

/// Relative error of a sum of three products in `f64`, of the sum of their magnitudes, and more.
const ROUNDING: f64 = 1.0 / (1_u64 << 48) as f64;

impl Camera {
    /// The distance of the near plane, in mesh units: the camera's own, or else one that cuts away nothing of
    /// what is seen of `meshes` in a picture of `size`.
    ///
    /// That is half a lower bound of the nearest visible depth, however near a surface is; 1 if nothing is
    /// seen. With parallel rays it is 0, the plane that the rays begin in. Finite for every mesh, and above 0
    /// for a perspective camera. Only a surface 2¹⁰⁰ times nearer than another one may be cut. Cost: some 20
    /// ns per face.
    ///
    /// ```
    /// use umbrage::mesh::Mesh;
    /// use umbrage::testing::shapes;
    /// use umbrage::view::{Camera, Size, Up};
    /// // A crate before the eye, on a plain of ten kilometers.
    /// let ground = vec![[-5e3, -1.0, -5e3], [5e3, -1.0, -5e3], [5e3, -1.0, 5e3], [-5e3, -1.0, 5e3]];
    /// let ground = Mesh::new(ground, vec![[0, 2, 1], [0, 3, 2]])?;
    /// let camera = Camera::look_at([0.0, 0.5, 4.0], [0.0; 3], 0.6, Up::Y)?;
    /// let near = camera.near([&shapes::cube(), &ground], Size::new(640, 480)?);
    /// assert!(near > 0.5 && near < 1.5); // The bound is the distance of the ground's plane here.
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn near<'m>(&self, meshes: impl IntoIterator<Item = &'m Mesh>, size: Size) -> f32 {
        if let Some(near) = self.near {
            return near;
        }
        if matches!(self.lens, Lens::Orthographic { .. }) {
            return 0.0;
        }
        let view = Pyramid::new(&self.projection(size, 1.0));
        let (mut nearest, mut farthest) = (f64::INFINITY, 0.0_f64);
        for mesh in meshes {
            for face in (0..mesh.face_count()).map(FaceId::new) {
                view.add(mesh.corners(face), &mut nearest, &mut farthest);
            }
        }
        if nearest == f64::INFINITY {
            return 1.0;
        }
        let near = (0.5 * nearest).max(LEAST * farthest).max(f64::from(f32::MIN_POSITIVE));
        (near.min(f64::from(f32::MAX)) as f32).max(f32::MIN_POSITIVE)
    }
}

/// What a perspective projection sees, from its eye on.
struct Pyramid {
    eye: [f32; 3],
    /// Right, up and forward.
    rows: [DVec3; 3],
    /// Length of the longest ray at depth 1.
    corner: f64,
}

impl Pyramid {
    fn new(projection: &Projection) -> Self {
        let corners = [DVec2::ONE, DVec2::NEG_ONE, DVec2::new(1.0, -1.0), DVec2::new(-1.0, 1.0)];
        Self {
            eye: projection.eye,
            rows: [projection.right, projection.up, projection.forward].map(wide),
            corner: corners.map(|corner| projection.ray(corner).length()).into_iter().fold(1.0, f64::max),
        }
    }

    /// Takes the depth of a face into account, if it may be seen.
    fn add(&self, corners: [[f32; 3]; 3], nearest: &mut f64, farthest: &mut f64) {
        let from_eye = corners.map(|corner| wide(corner) - wide(self.eye));
        let depths = from_eye.map(|q| self.rows[2].dot(q));
        if depths.iter().all(|&depth| depth <= 0.0) || self.is_aside(&from_eye, depths) {
            return;
        }
        let reach = from_eye.iter().map(|q| q.abs().max_element()).fold(0.0, f64::max);
        *farthest = farthest.max(reach);
        let least = depths.into_iter().fold(f64::INFINITY, f64::min);
        if least >= *nearest {
            return;
        }
        let above = height(corners, Homogeneous::point(self.eye)).abs();
        if above == 0.0 {
            return; // edge-on
        }
        let [u, v] = [from_eye[1] - from_eye[0], from_eye[2] - from_eye[0]];
        // A sliver's normal is short, and rounds by a part of its longest products.
        let normal = u.cross(v).length() + ROUNDING * u.length() * v.length();
        *nearest = nearest.min(least.max(above / normal / self.corner));
    }

    /// Whether a triangle lies beyond one of the four sides of the picture.
    fn is_aside(&self, from_eye: &[DVec3; 3], depths: [f64; 3]) -> bool {
        let [right, up, forward] = self.rows;
        [(right, 1.0), (right, -1.0), (up, 1.0), (up, -1.0)].into_iter().any(|(row, sign)| {
            from_eye.iter().zip(depths).all(|(&q, depth)| {
                let rounding = ROUNDING * (row.abs() + forward.abs()).dot(q.abs());
                sign * row.dot(q) - depth > rounding
            })
        })
    }
}

fn wide(p: [f32; 3]) -> DVec3 {
    DVec3::from(p.map(f64::from))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::Aabb;
    use crate::oracle::Oracle;
    use crate::random::SplitMix64;
    use crate::testing::shapes;
    use crate::view::Up;

    /// The least depth that a ray of the picture sees.
    fn nearest(oracle: &Oracle, camera: &Camera, size: Size) -> Option<f64> {
        let rays = camera.rays(size);
        let pixels = (0..size.height()).flat_map(|y| (0..size.width()).map(move |x| (x, y)));
        pixels
            .filter_map(|(x, y)| {
                let ray = rays.ray(f64::from(x) + 0.5, f64::from(y) + 0.5);
                oracle.first_visible(ray.origin, ray.direction).map(|hit| hit.t)
            })
            .reduce(f64::min)
    }

    #[test]
    fn near_plane_cuts_nothing_that_a_ray_sees_and_one_of_the_box_does() {
        let plain = shapes::scaled(&shapes::sheet(4), 5000.0);
        let scene =
            Mesh::concat(&[plain, shapes::translated(&shapes::torus(24, 12, 2.0, 0.7), [9e3, 9e3, 2.0])]);
        let size = Size::new(24, 18).unwrap();
        let mut random = SplitMix64(11);
        let (mut seen, mut cut) = (0, 0);
        for mesh in [shapes::torus(24, 12, 2.0, 0.7), shapes::menger_sponge(1), scene.unwrap()] {
            let oracle = Oracle::build(&mesh);
            let middle = mesh.corners(FaceId::new(mesh.face_count() - 1))[0];
            for _ in 0..60 {
                let mut next = || random.below(4001) as f32 / 1000.0 - 2.0;
                let [eye, target] = [(); 2].map(|()| [0, 1, 2].map(|i| middle[i] + next()));
                let Ok(camera) = Camera::look_at(eye, target, 1.2, Up::Y) else { continue };
                let Some(t) = nearest(&oracle, &camera, size) else { continue };
                seen += 1;
                let near = f64::from(camera.near([&mesh], size));
                assert!(0.0 < near && 1.99 * near <= t, "{eye:?} {target:?}: {near} {t}");
                cut += usize::from(t < oracle.bounds().diagonal() / 1024.0);
            }
        }
        assert!(seen > 90 && cut > 5, "{seen} {cut}");
    }

    #[test]
    fn near_plane_is_half_as_far_as_a_wall_and_honors_what_is_asked() {
        let wall = shapes::translated(&shapes::scaled(&shapes::sheet(1), 10.0), [-5.0, -5.0, 0.0]);
        let size = Size::new(100, 100).unwrap();
        for (distance, up) in [(0.01_f32, Up::Y), (3.0, Up::Z), (1e-20, Up::Y)] {
            let camera = Camera::look_at([0.0, 0.0, distance], [0.0, 0.0, -1.0], 0.6, up).unwrap();
            let (near, corner) = (camera.near([&wall], size), 1.0 + 2.0 * 0.3_f32.tan().powi(2));
            let least = 0.5 * distance / corner.sqrt();
            assert!(0.999 * least <= near && near <= 0.5 * distance, "{distance}: {near} {least}");
            assert_eq!(camera.with_near(7.0).unwrap().near([&wall], size), 7.0);
            let parallel = camera.orthographic(2.0).unwrap();
            assert_eq!(parallel.near([&wall], size), 0.0);
            assert_eq!(parallel.with_near(7.0).unwrap().near([&wall], size), 7.0);
        }
        // What is edge-on, behind, or aside does not count: an eye in the wall, and one that looks away.
        for (eye, target) in [
            ([0.0; 3], [0.0, 1.0, 1.0]),
            ([0.0, 0.0, 1.0], [0.0, 0.0, 2.0]),
            ([40.0, 0.0, 0.1], [40.0, 0.0, 0.0]),
        ] {
            let camera = Camera::look_at(eye, target, 0.6, Up::Y).unwrap();
            assert_eq!(camera.near([&wall], size), 1.0, "{eye:?}");
        }
    }

    #[test]
    fn near_is_finite_and_above_zero_for_any_mesh_and_eye() {
        let sizes = [f32::from_bits(1), 1e-30, 1.0, 3.4e38, f32::MAX];
        for scale in sizes {
            let mesh = shapes::scaled(&shapes::cube(), scale);
            let bounds = Aabb::around(mesh.positions().iter().copied());
            let eyes = sizes.into_iter().flat_map(|x| [[x; 3], [-x, 0.0, x]]);
            for eye in eyes.chain([[0.0; 3], Camera::fit(&bounds, Up::Y, 1.0).eye.into()]) {
                let camera = Camera { eye: eye.into(), ..Camera::fit(&bounds, Up::Y, 1.0) };
                let near = camera.near([&mesh], Size::new(16, 9).unwrap());
                assert!(near >= f32::MIN_POSITIVE && near.is_finite(), "{scale} {eye:?}: {near}");
            }
        }
        let empty = Mesh::new(Vec::new(), Vec::new()).unwrap();
        let camera = Camera::fit(&Aabb::EMPTY, Up::Y, 1.0);
        assert_eq!(camera.near([&empty], Size::new(16, 9).unwrap()), 1.0);
    }
}
