//! The parallelogram that holds a light, and the exact side of its plane.

use glam::DVec3;

use crate::geom::Light;
use crate::geom::predicate::{Homogeneous, Sign, directions_turn, side_of_point};

/// Half an ulp of 1: the largest relative error of one rounding.
pub(super) const EPSILON: f64 = f64::EPSILON / 2.0;

/// The points `anchor` + `offset` + u·`e1` + v·`e2`, u and v from 0 to 1. At infinity these are directions,
/// and the anchor is 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Frame {
    pub(super) anchor: [f32; 3],
    pub(super) offset: DVec3,
    pub(super) e1: DVec3,
    pub(super) e2: DVec3,
    pub(super) plane: Plane,
    pub(super) at_infinity: bool,
    /// How far rounding may have moved the outline of the light, in u and v.
    pub(super) rounding: f64,
}

/// The plane of a light in numbers that were never rounded.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Plane {
    /// Through the anchor, along two vectors.
    Spanned([f32; 3], [f32; 3]),
    /// Through three points.
    Through([[f32; 3]; 3]),
    /// Before the receiver, at right angles to its view, known in rounded numbers only.
    Facing,
    Infinite,
}

impl Frame {
    /// The square around a disk at `ahead`, a unit vector, and across it.
    ///
    /// Basis: Duff and others, *Building an Orthonormal Basis, Revisited*, 2017. Its vectors are off by a few
    /// ulps, which moves the outline by as much.
    #[inline]
    pub(super) fn round(ahead: DVec3, radius: f64, at_infinity: bool) -> Self {
        let sign = 1_f64.copysign(ahead.z);
        let a = -1.0 / (sign + ahead.z);
        let b = ahead.x * ahead.y * a;
        let e1 = radius * DVec3::new(1.0 + sign * ahead.x * ahead.x * a, sign * b, -sign * ahead.x);
        let e2 = radius * DVec3::new(b, sign + ahead.y * ahead.y * a, -ahead.y);
        let offset = if at_infinity { ahead } else { DVec3::ZERO } - e1 - e2;
        let plane = if at_infinity { Plane::Infinite } else { Plane::Facing };
        let rounding = 32.0 * EPSILON;
        Self { anchor: [0.0; 3], offset, e1: 2.0 * e1, e2: 2.0 * e2, plane, at_infinity, rounding }
    }

    /// The vector from `p` to the corner u = v = 0, and what bounds its terms, axis by axis.
    #[inline(always)]
    pub(super) fn corner_from(&self, p: [f32; 3]) -> (DVec3, DVec3) {
        if self.at_infinity {
            return (self.offset, self.offset.abs());
        }
        let to_anchor = wide(self.anchor) - wide(p);
        (to_anchor + self.offset, to_anchor.abs() + self.offset.abs())
    }

    /// The side of the light's plane on which `x` lies; `None` if only rounded numbers could tell.
    #[inline]
    pub(super) fn side(&self, x: [f32; 3]) -> Option<Sign> {
        match self.plane {
            Plane::Spanned(e1, e2) => {
                let anchor = Light::point(self.anchor).ok()?;
                let from_anchor = Homogeneous::extruded(x, &anchor);
                Some(directions_turn([Homogeneous::point(e1), Homogeneous::point(e2), from_anchor]))
            }
            Plane::Through(corners) => Some(side_of_point(corners, x)),
            Plane::Facing | Plane::Infinite => None,
        }
    }
}

pub(super) fn wide(v: [f32; 3]) -> DVec3 {
    DVec3::from(v.map(f64::from))
}
