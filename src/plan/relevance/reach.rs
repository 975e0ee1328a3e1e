//! How far a lamp shines, and into which cone.
//!
//! # Effect of rounding
//!
//! The shading computes the cosine of a point's angle from the axis of a spot light in `f32`: the unit
//! vectors err by less than 2⁻²² in length and direction, the products and sums by 2⁻²³, together by less
//! than [`COSINE`]. A point counts as out of the cone if its cosine is below that of the outer angle by more.
//! Distances are computed in `f64` with fewer than 16 roundings; [`SLACK`] is 2¹³ roundings.

use glam::DVec3;

use super::fault::{Fault, Faults};
use crate::geom::Aabb;
use crate::scene::Lamp;
use crate::shadow::volume::parting::LampBox;

/// See the head of this file.
const COSINE: f64 = 1.0 / (1 << 20) as f64;
const SLACK: f64 = 1.0 / (1_u64 << 40) as f64;

/// The ball and the cone that hold every point that a lamp lights.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reach {
    center: DVec3,
    /// The lamp's half-size, for its range.
    radius: f64,
    /// Square of the range, rounded up.
    range_squared: f64,
    /// The axis of the cone, of length 1, and the cosine of its angle, rounded down; none if it is a
    /// half-space or more.
    cone: Option<(DVec3, f64)>,
}

/// Whether a lamp may light each point.
pub(in crate::plan) fn may_light(lamp: &Lamp, physical_falloff: bool) -> impl Fn([f32; 3]) -> bool {
    let reach = Reach::of(lamp, physical_falloff, Faults::default());
    move |point| reach.may_light(point)
}

impl Reach {
    pub(super) fn of(lamp: &Lamp, physical_falloff: bool, faults: Faults) -> Self {
        let light = lamp.light();
        let is_limited = !light.is_directional() && (physical_falloff || faults.has(Fault::RangeAlways));
        let radius = LampBox::of(lamp).radius();
        let range = lamp.range.filter(|_| is_limited).map_or(f64::INFINITY, f64::from);
        let cone = lamp.cone.filter(|_| !light.is_directional()).and_then(|cone| {
            let cosine = f64::from(cone.outer_rad).cos() - COSINE;
            let axis = DVec3::from(cone.direction.map(f64::from)).try_normalize()?;
            (cosine > 0.0).then_some((axis, cosine))
        });
        Self {
            center: DVec3::from(light.xyz().map(f64::from)),
            radius,
            range_squared: range * range * (1.0 + SLACK),
            cone,
        }
    }

    /// Whether neither range nor cone ends the light anywhere.
    pub(super) fn is_endless(&self) -> bool {
        self.range_squared == f64::INFINITY && self.cone.is_none()
    }

    /// Whether the lamp may light a point.
    pub(super) fn may_light(&self, p: [f32; 3]) -> bool {
        let away = DVec3::from(p.map(f64::from)) - self.center;
        let squared = away.length_squared();
        if squared > self.range_squared {
            return false;
        }
        self.cone.is_none_or(|(axis, cosine)| axis.dot(away) >= cosine * squared.sqrt())
    }

    /// Whether a segment from a point that the lamp may light to a point of the lamp may meet a box.
    ///
    /// The ball is convex and holds both ends, if the lamp is no larger. So is the cone cut with the ball; a
    /// lamp with an extent leaves the cone, and is not tested.
    pub(super) fn may_meet(&self, bounds: &Aabb) -> bool {
        let [low, high] = [bounds.low, bounds.high].map(|p| DVec3::from(p.map(f64::from)) - self.center);
        let gap = low.max(-high).max(DVec3::ZERO);
        let most = self.range_squared.max(self.radius * self.radius);
        if gap.length_squared() > most * (1.0 + SLACK) {
            return false;
        }
        let Some((axis, cosine)) = self.cone.filter(|_| self.radius == 0.0) else { return true };
        // A plane through the apex that touches the cone on the side of the box: the box lies beyond it.
        let (center, half) = (0.5 * (low + high), 0.5 * (high - low));
        let across = center - axis.dot(center) * axis;
        let Some(across) = across.try_normalize() else { return true };
        let normal = cosine * across - (1.0 - cosine * cosine).sqrt() * axis;
        let least = normal.dot(center) - normal.abs().dot(half);
        // The plane's own roundings turn it by less than SLACK.
        least <= SLACK * (center.length() + half.length())
    }

    /// Least distance from the lamp's center to a point of a box, squared, rounded down.
    pub(super) fn least_distance_squared(&self, bounds: &Aabb) -> f64 {
        let [low, high] = [bounds.low, bounds.high].map(|p| DVec3::from(p.map(f64::from)) - self.center);
        low.max(-high).max(DVec3::ZERO).length_squared() * (1.0 - SLACK)
    }
}
