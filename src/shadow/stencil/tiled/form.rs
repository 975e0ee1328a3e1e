//! Linear forms of homogeneous points, in `f64` with an error bound.

use glam::DVec3;

use super::view::Cell;
use crate::geom::predicate::{Homogeneous, Sign};

/// Bound of all roundings, relative to the terms: 32 of them.
///
/// A coordinate relative to the origin is rounded once, a product twice more, a cross product once more, and
/// the sum of three cross products twice. So the normal errs by 6ε of its terms (ε = 2⁻⁵³), the offset by 8ε.
/// The product with a point that is rounded once errs by 8ε, and three more sums by 3ε: 11ε in all. The box
/// of a tile adds two roundings of its corners, two of its middle and half, and one of each product with a
/// depth.
const ERROR: f64 = 1.0 / (1_u64 << 48) as f64;

/// A homogeneous point relative to an origin.
#[derive(Clone, Copy, Debug)]
pub(super) struct Local {
    pub(super) at: DVec3,
    /// 1, or 0 at infinity.
    pub(super) w: f64,
}

impl Local {
    pub(super) fn of(point: Homogeneous, origin: [f32; 3]) -> Self {
        Self { at: DVec3::from(point.row(origin).rounded()), w: f64::from(u8::from(point.is_finite())) }
    }
}

/// The linear form of a homogeneous point x that is 0 on the plane through three homogeneous points: the
/// opposite of the sign of [`orient3d_homogeneous`](crate::geom::predicate::orient3d_homogeneous) of the
/// three and x.
#[derive(Clone, Copy, Debug)]
pub(super) struct Form {
    normal: DVec3,
    offset: f64,
    /// The largest sum of terms of a coordinate of the normal.
    normal_size: f64,
    /// The sum of the terms of the offset.
    offset_size: f64,
}

impl Form {
    pub(super) fn through([u, v, w]: [Local; 3]) -> Self {
        let pairs = [(u.w, v.at, w.at), (v.w, w.at, u.at), (w.w, u.at, v.at)];
        let normal = pairs.iter().map(|&(weight, a, b)| weight * a.cross(b)).sum();
        let size: DVec3 = pairs.iter().map(|&(weight, a, b)| weight * cross_size(a, b)).sum();
        Self {
            normal,
            offset: -u.at.dot(v.at.cross(w.at)),
            normal_size: size.max_element(),
            offset_size: u.at.abs().dot(cross_size(v.at, w.at)),
        }
    }

    /// The sign at a finite point, if it is certain. `reach` is the sum of the magnitudes of its coordinates.
    #[inline]
    pub(super) fn sign(&self, point: DVec3, reach: f64) -> Option<Sign> {
        let value = self.normal.dot(point) + self.offset;
        let error = ERROR * (reach * self.normal_size + self.offset_size);
        (value.abs() > error).then(|| Sign::of(value))
    }

    /// The sign at every direction of a cell, if it is certain and the same: of a form through the eye.
    #[inline]
    pub(super) fn sign_across(&self, cell: &Cell) -> Option<Sign> {
        let radius =
            self.normal.abs().dot(cell.half) + ERROR * (cell.reach * self.normal_size + self.offset_size);
        let middle = self.normal.dot(cell.middle) + self.offset;
        (middle.abs() > radius).then(|| Sign::of(middle))
    }

    /// The sign at every point of a cell between its depths, if it is certain and the same.
    pub(super) fn sign_within(&self, cell: &Cell) -> Option<Sign> {
        let [near, far] = cell.depth;
        let (middle, radius) = (self.normal.dot(cell.middle), self.normal.abs().dot(cell.half));
        let [low, high] = [middle - radius, middle + radius];
        // A point is its direction times its depth, or beside parallel rays plus a step along them.
        let ([low, high], scale) = match cell.along {
            None => ([(low * near).min(low * far), (high * near).max(high * far)], far),
            Some(along) => {
                let [a, b] = [near, far].map(|depth| depth * self.normal.dot(along));
                ([low + a.min(b), high + a.max(b)], 1.0)
            }
        };
        let error = ERROR * (scale * cell.reach * self.normal_size + self.offset_size);
        if low + self.offset > error {
            Some(Sign::Positive)
        } else if high + self.offset < -error {
            Some(Sign::Negative)
        } else {
            None
        }
    }
}

/// The sums of the terms of a cross product.
fn cross_size(a: DVec3, b: DVec3) -> DVec3 {
    let (a, b) = (a.abs(), b.abs());
    DVec3::new(a.y * b.z + a.z * b.y, a.z * b.x + a.x * b.z, a.x * b.y + a.y * b.x)
}
