//! A camera that turns around a point.

use umbrage::geom::Aabb;
use umbrage::glam::DVec3;
use umbrage::view::{Camera, Lens, Up};

/// A camera by what it looks at, from how far, and from which side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Orbit {
    /// What the camera turns around, in world space.
    pub(super) target: DVec3,
    /// From the eye to the target, in mesh units; above 0.
    pub(super) distance: f64,
    /// Around the up axis, radians; 0 looks from the front.
    yaw: f64,
    /// Above the horizon, radians.
    pitch: f64,
    lens: Lens,
    near: Option<f32>,
    up: Up,
}

/// The steepest view, radians: looking straight down, left and right would have no meaning.
const STEEPEST: f64 = 1.55;
/// Turn of a drag over the height of the picture, radians.
const TURN: f64 = std::f64::consts::PI;
/// The least and the largest distance from the target, in diagonals of the scene.
const DISTANCES: [f64; 2] = [1e-4, 1e3];

impl Orbit {
    /// The orbit of a camera, around the point of its axis that is nearest to the center of the scene. What a
    /// camera is rolled around its axis by is lost.
    pub(super) fn of(camera: &Camera, bounds: &Aabb, up: Up) -> Self {
        let (eye, forward) = (camera.eye.as_dvec3(), camera.forward.as_dvec3());
        let along = (center(bounds) - eye).dot(forward);
        let distance = if along > 0.0 { along } else { size(bounds) };
        let [right, upright, back] = axes(up).map(|axis| -forward.dot(axis));
        Self {
            target: eye + distance * forward,
            distance,
            yaw: right.atan2(back),
            pitch: upright.clamp(-1.0, 1.0).asin().clamp(-STEEPEST, STEEPEST),
            lens: camera.lens,
            near: camera.near,
            up,
        }
    }

    /// The camera; the default view where coordinates would leave the range of `f32`.
    pub(super) fn camera(&self, bounds: &Aabb, aspect: f64) -> Camera {
        let (eye, target) = (self.eye().as_vec3(), self.target.as_vec3());
        let fov = match self.lens {
            Lens::Perspective { fov_y_rad } => fov_y_rad,
            _ => Camera::DEFAULT_FOV_Y_RAD,
        };
        match Camera::look_at(eye.into(), target.into(), fov, self.up) {
            Ok(camera) => Camera { lens: self.lens, near: self.near, ..camera },
            Err(_) => Camera::fit(bounds, self.up, aspect),
        }
    }

    fn eye(&self) -> DVec3 {
        self.target + self.distance * self.towards()
    }

    /// From the target to the eye, unit length.
    fn towards(&self) -> DVec3 {
        let [right, up, back] = axes(self.up);
        self.pitch.cos() * (self.yaw.sin() * right + self.yaw.cos() * back) + self.pitch.sin() * up
    }

    /// Right and up in the picture, unit length.
    pub(super) fn screen_axes(&self) -> [DVec3; 2] {
        let towards = self.towards();
        let right = axes(self.up)[1].cross(towards).normalize();
        [right, towards.cross(right)]
    }

    /// Turns by a drag, in heights of the picture to the right and down.
    pub(super) fn turn(&mut self, [right, down]: [f64; 2]) {
        self.yaw -= TURN * right;
        self.pitch = (self.pitch + TURN * down).clamp(-STEEPEST, STEEPEST);
    }

    /// Moves the target with the pointer, by a drag in heights of the picture to the right and down.
    pub(super) fn pan(&mut self, [right, down]: [f64; 2]) {
        let [x, y] = self.screen_axes();
        self.target += self.height() * (down * y - right * x);
    }

    /// Comes nearer by a factor below 1, or leaves by one above 1.
    pub(super) fn zoom(&mut self, factor: f64, bounds: &Aabb) {
        let [least, most] = DISTANCES.map(|diagonals| diagonals * size(bounds));
        let distance = (self.distance * factor).clamp(least, most);
        if let Lens::Orthographic { height } = &mut self.lens {
            *height = (f64::from(*height) * distance / self.distance) as f32;
        }
        self.distance = distance;
    }

    /// How much of the world is seen at the target from bottom to top, in mesh units.
    pub(super) fn height(&self) -> f64 {
        match self.lens {
            Lens::Orthographic { height } => height.into(),
            Lens::Perspective { fov_y_rad } => 2.0 * self.distance * f64::from(0.5 * fov_y_rad).tan(),
            _ => self.distance,
        }
    }

    /// The same view of something that reaches so far around a point; seen along `normal`, unless that is the
    /// null vector.
    pub(super) fn flown_to(&self, target: [f64; 3], reach: f64, normal: [f64; 3], bounds: &Aabb) -> Self {
        let mut there = Self { target: target.into(), ..*self };
        if let Some(normal) = DVec3::from(normal).try_normalize() {
            let [right, up, back] = axes(self.up).map(|axis| normal.dot(axis));
            there.yaw = right.atan2(back);
            there.pitch = up.clamp(-1.0, 1.0).asin().clamp(-STEEPEST, STEEPEST);
        }
        let wanted = (6.0 * reach).clamp(size(bounds) / 50.0, 2.0 * size(bounds));
        there.zoom(wanted / self.height().max(f64::MIN_POSITIVE), bounds);
        there
    }

    /// On the way from this view to another: 0 here, 1 there.
    pub(super) fn towards_other(&self, there: &Self, part: f64) -> Self {
        let part = part.clamp(0.0, 1.0);
        let smooth = part * part * (3.0 - 2.0 * part);
        let between = |a: f64, b: f64| a + smooth * (b - a);
        // The short way around.
        let around = (there.yaw - self.yaw + std::f64::consts::PI).rem_euclid(std::f64::consts::TAU);
        let lens = match (self.lens, there.lens) {
            (Lens::Orthographic { height: a }, Lens::Orthographic { height: b }) => {
                Lens::Orthographic { height: between(a.into(), b.into()) as f32 }
            }
            (_, lens) => lens,
        };
        Self {
            target: self.target.lerp(there.target, smooth),
            distance: (between(self.distance.ln(), there.distance.ln())).exp(),
            yaw: self.yaw + smooth * (around - std::f64::consts::PI),
            pitch: between(self.pitch, there.pitch),
            lens,
            ..*there
        }
    }
}

/// Right, up and back of a file, in the world.
fn axes(up: Up) -> [DVec3; 3] {
    [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|axis| up.turn(axis).into())
}

/// The middle of a box; the origin of an empty one.
pub(super) fn center(bounds: &Aabb) -> DVec3 {
    if bounds.is_empty() { DVec3::ZERO } else { DVec3::from(bounds.center().map(f64::from)) }
}

/// The diagonal of a box, and 1 for a point or an empty one.
pub(super) fn size(bounds: &Aabb) -> f64 {
    let diagonal = if bounds.is_empty() { 0.0 } else { bounds.diagonal() };
    if diagonal > 0.0 && diagonal.is_finite() { diagonal } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    const BOUNDS: Aabb = Aabb { low: [-1.0, 0.0, -2.0], high: [3.0, 2.0, 2.0] };

    fn fitted(up: Up) -> (Camera, Orbit) {
        let camera = Camera::fit(&BOUNDS, up, 1.5);
        (camera, Orbit::of(&camera, &BOUNDS, up))
    }

    /// A few roundings of numbers below 16 to `f32`.
    const ROUNDED: f32 = 16.0 * 8.0 * f32::EPSILON;

    #[test]
    fn orbit_of_a_camera_gives_this_camera_back() {
        for up in [Up::Y, Up::Z] {
            let (camera, orbit) = fitted(up);
            let back = orbit.camera(&BOUNDS, 1.5);
            assert!(back.eye.distance(camera.eye) < ROUNDED, "{up:?}: {back:?} for {camera:?}");
            assert!(back.forward.distance(camera.forward) < ROUNDED);
            assert_eq!((back.lens, back.near, back.up), (camera.lens, camera.near, camera.up));
        }
    }

    #[test]
    fn orbit_turns_around_its_target_and_stops_before_the_pole() {
        let (_, mut orbit) = fitted(Up::Z);
        let before = orbit;
        orbit.turn([0.3, 50.0]);
        assert_eq!((orbit.target, orbit.distance), (before.target, before.distance));
        assert!((orbit.eye().distance(orbit.target) - orbit.distance).abs() < 1e-12 * orbit.distance);
        // Looking down along z, almost.
        assert!(orbit.towards().z > 0.999 && orbit.camera(&BOUNDS, 1.0).forward.is_normalized());
        // The drag of a whole turn changes nothing that is seen.
        let mut turned = before;
        turned.turn([2.0, 0.0]);
        assert!(turned.eye().distance(before.eye()) < 1e-9);
    }

    #[test]
    fn orbit_pans_with_the_pointer() {
        let (camera, mut orbit) = fitted(Up::Y);
        let size = umbrage::view::Size::new(600, 400).unwrap();
        let at = |camera: &Camera| camera.rays(size).project(center(&BOUNDS).as_vec3().into()).unwrap();
        let before = at(&camera);
        orbit.pan([0.25, -0.1]);
        let after = at(&orbit.camera(&BOUNDS, 1.5));
        // The center is at the distance of the target: it follows by 100 and -40 pixels.
        assert!((after.x_px - before.x_px - 100.0).abs() < 0.1, "{before:?} {after:?}");
        assert!((after.y_px - before.y_px + 40.0).abs() < 0.1);
    }

    #[test]
    fn orbit_zooms_within_bounds_and_with_parallel_rays_too() {
        let (_, mut orbit) = fitted(Up::Y);
        orbit.zoom(0.5, &BOUNDS);
        assert!((orbit.distance - 0.5 * fitted(Up::Y).1.distance).abs() < 1e-12);
        orbit.zoom(0.0, &BOUNDS);
        assert!(orbit.distance > 0.0);
        orbit.zoom(1e300, &BOUNDS);
        assert!(orbit.camera(&BOUNDS, 1.0).eye.is_finite());
        let camera = fitted(Up::Y).0.orthographic(4.0).unwrap();
        let mut parallel = Orbit::of(&camera, &BOUNDS, Up::Y);
        parallel.zoom(0.25, &BOUNDS);
        assert!((parallel.height() - 1.0).abs() < 1e-6);
    }

    #[test]
    fn orbit_flies_the_short_way_and_arrives() {
        let (_, mut here) = fitted(Up::Y);
        here.yaw = 3.0;
        let there = here.flown_to([1.0, 0.5, 0.25], 0.1, [-0.1, 0.0, -1.0], &BOUNDS);
        assert_eq!(there.target, DVec3::new(1.0, 0.5, 0.25));
        assert!(there.distance < here.distance && there.towards().z < -0.9);
        assert_eq!(here.towards_other(&there, 0.0).target, here.target);
        let arrived = here.towards_other(&there, 7.0);
        assert!(arrived.eye().distance(there.eye()) < 1e-9);
        // From 3.0 to about -3.04 radians: over π, not through 0.
        let half = here.towards_other(&there, 0.5);
        assert!(half.yaw > 3.0, "{}", half.yaw);
        // What has no normal is looked at from where the camera is.
        assert_eq!(here.flown_to([0.0; 3], 0.1, [0.0; 3], &BOUNDS).yaw, here.yaw);
    }

    #[test]
    fn orbit_of_extreme_scenes_stays_finite() {
        for bounds in
            [Aabb::EMPTY, Aabb { low: [f32::MIN; 3], high: [f32::MAX; 3] }, Aabb::around([[5.0; 3]])]
        {
            let mut orbit = Orbit::of(&Camera::fit(&bounds, Up::Y, 1.0), &bounds, Up::Y);
            orbit.zoom(100.0, &bounds);
            orbit.pan([3.0, 3.0]);
            let camera = orbit.camera(&bounds, 1.0);
            assert!(camera.eye.is_finite() && camera.forward.is_finite(), "{bounds:?}");
        }
    }
}
