//! Points on the ray of a pixel, relative to the eye, and the faces between such a point and the light.
//!
//! A visible point rounded to `f32` may lie a pixel and more beside its ray: a thousand units from the origin
//! the spacing of `f32` is 1/16384 of a unit. Relative to the eye the point has the digits of `f64`, wherever
//! the mesh lies, and no vertex and no light is rounded to `f32`. Signs are those of [`orient3d_rounded`]:
//! where one is not certain, the segment counts as touching the face. This happens within some 2⁻⁴⁷ of the
//! distances from the eye only, far inside of every pixel's footprint.

use super::{Pixels, Seen};
use crate::geom::predicate::{Homogeneous, Rounded, Sign, orient3d_rounded, side_of_light};
use crate::mesh::FaceId;
use crate::oracle::PrimaryHit;

/// The depth of the point that is shaded, relative to its face's: so much nearer to the eye that the rounding
/// of no sign puts the point behind, and a 64th of the least depth bound of a footprint.
const BEFORE: f64 = 1.0 - 1.0 / (1 << 24) as f64;

/// Relation of the segment from a point to the light with a face.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Meeting {
    Crossing,
    /// The segment touches the face, or nearly.
    Touching,
}

/// A point on a ray from the eye.
#[derive(Clone, Copy, Debug)]
pub(super) struct RayPoint {
    /// Relative to the eye.
    pub(super) at: [f64; 3],
    /// In world space, rounded.
    pub(super) world: [f32; 3],
    /// More than the rounding of `world`.
    pub(super) slack: f32,
}

impl RayPoint {
    /// The point at `t` lengths of a direction from the eye.
    pub(super) fn new(eye: [f32; 3], direction: [f32; 3], t: f64) -> Self {
        let at = direction.map(|x| t * f64::from(x));
        let most = f64::from(f32::MAX);
        let world = [0, 1, 2].map(|i| (f64::from(eye[i]) + at[i]).clamp(-most, most) as f32);
        let largest = world.iter().fold(0.0_f32, |most, x| most.max(x.abs()));
        Self { at, world, slack: largest * (2.0 * f32::EPSILON) + f32::MIN_POSITIVE }
    }
}

impl Pixels<'_> {
    /// The point that is shaded where a ray meets a face.
    pub(super) fn shaded(&self, visible: &PrimaryHit, direction: [f32; 3]) -> RayPoint {
        RayPoint::new(self.rendered.projection.eye, direction, BEFORE * visible.t)
    }

    /// Calls `visit` with every face that the open segment from the visible point to the light crosses or
    /// touches.
    pub(super) fn for_each_meeting(
        &self,
        visible: &PrimaryHit,
        direction: [f32; 3],
        mut visit: impl FnMut(FaceId, Meeting),
    ) {
        let point = self.shaded(visible, direction);
        self.oracle.for_each_candidate(point.world, point.slack, self.rendered.light, |face, corners| {
            let side = (face == visible.face).then_some(visible.side);
            if let Some(meeting) = self.meeting(point, corners, side) {
                visit(face, meeting);
            }
        });
    }

    /// The relation of a face with the segment from `point`, on this `side` of the face if that is known.
    fn meeting(&self, point: RayPoint, corners: [[f32; 3]; 3], side: Option<Sign>) -> Option<Meeting> {
        let p = Rounded::point(point.at);
        let [a, b, c] = corners.map(|corner| self.relative(Homogeneous::point(corner)));
        let here = side.unwrap_or_else(|| -orient3d_rounded([a, b, c, p]));
        let there = side_of_light(corners, self.rendered.light);
        // An open segment does not contain its ends.
        if !here.is_zero() && (here == there || there.is_zero()) {
            return None;
        }
        let first = orient3d_rounded([p, self.light, a, b]);
        let second = orient3d_rounded([p, self.light, b, c]);
        if first == -second && !first.is_zero() {
            return None;
        }
        let edges = [first, second, orient3d_rounded([p, self.light, c, a])];
        match (edges.contains(&Sign::Positive), edges.contains(&Sign::Negative)) {
            (true, true) => None,
            _ if here.is_zero() || edges.contains(&Sign::Zero) => Some(Meeting::Touching),
            _ => Some(Meeting::Crossing),
        }
    }

    /// A vertex or light, relative to the eye.
    pub(super) fn relative(&self, exact: Homogeneous) -> Rounded {
        Rounded::seen_from(self.rendered.projection.eye, exact)
    }

    /// The number of casting faces between a visible point and the light, and whether the segment only
    /// touches any of them.
    pub(super) fn count(&self, visible: &PrimaryHit, direction: [f32; 3]) -> (u32, bool) {
        let (mut count, mut touching) = (0, false);
        self.for_each_meeting(visible, direction, |face, meeting| match meeting {
            _ if self.rendered.signs[face.index()] == 0 => {}
            Meeting::Crossing => count += 1,
            Meeting::Touching => touching = true,
        });
        (count, touching)
    }

    /// Whether a face whose side was left to `f32` is visible, or lies between the visible point and the
    /// light.
    pub(super) fn meets_unsure(&self, seen: &Seen) -> bool {
        let unsure = self.rendered.unsure;
        let mut met = unsure.binary_search(&seen.visible.face).is_ok();
        self.for_each_meeting(&seen.visible, seen.direction, |face, _| {
            met |= unsure.binary_search(&face).is_ok();
        });
        met
    }
}
