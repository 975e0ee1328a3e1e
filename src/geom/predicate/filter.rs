//! Step 1: the determinant in `f64`, with an error bound.

use super::{Sign, exact_sign_of_det};

/// A row of a determinant: the exact difference of two vectors, not yet rounded.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Row(pub(crate) [f32; 3], pub(crate) [f32; 3]);

impl Row {
    /// The difference in `f64`, with one rounding per entry. Written without `map`: closures on arrays are
    /// not always inlined.
    #[inline]
    pub(crate) fn rounded(self) -> [f64; 3] {
        let Self(u, v) = self;
        [
            f64::from(u[0]) - f64::from(v[0]),
            f64::from(u[1]) - f64::from(v[1]),
            f64::from(u[2]) - f64::from(v[2]),
        ]
    }
}

/// Half an ulp of 1 in `f64`: the largest relative error of one rounding.
pub(crate) const EPSILON: f64 = f64::EPSILON / 2.0;

/// Relative error bound of the filter: bound A of Shewchuk 1997, section 4.3. With entries that are
/// differences rounded once, [`rounded_det`] errs by at most this factor times the sum of the products'
/// magnitudes. (Tests on near ties fail with a quarter of the bound; they did not fail with 0.3 of it.)
pub(crate) const FILTER: f64 = (7.0 + 56.0 * EPSILON) * EPSILON;

/// The determinant in `f64`, and the sum of the magnitudes of its products.
#[inline(always)]
pub(crate) fn rounded_det(rows: &[Row; 3]) -> (f64, f64) {
    let [a, b, c] = [rows[0].rounded(), rows[1].rounded(), rows[2].rounded()];
    let (bxcy, cxby) = (b[0] * c[1], c[0] * b[1]);
    let (cxay, axcy) = (c[0] * a[1], a[0] * c[1]);
    let (axby, bxay) = (a[0] * b[1], b[0] * a[1]);
    let det = a[2] * (bxcy - cxby) + b[2] * (cxay - axcy) + c[2] * (axby - bxay);
    let permanent = (bxcy.abs() + cxby.abs()) * a[2].abs()
        + (cxay.abs() + axcy.abs()) * b[2].abs()
        + (axby.abs() + bxay.abs()) * c[2].abs();
    (det, permanent)
}

/// The sign, if the filter is certain. `None` only if the determinant is at most `2 · FILTER · permanent`,
/// which is what the next step relies on.
#[inline(always)]
pub(crate) fn certain_sign(rows: &[Row; 3], filter: f64) -> Option<Sign> {
    let (det, permanent) = rounded_det(rows);
    let bound = filter * permanent;
    if det > bound {
        Some(Sign::Positive)
    } else if det < -bound {
        Some(Sign::Negative)
    } else if permanent == 0.0 {
        Some(Sign::Zero) // no product can underflow, so every product is exactly zero
    } else {
        None
    }
}

/// The sign of a determinant. All uncertain cases are rare and take one call out of line.
#[inline(always)]
pub(crate) fn sign_of_det(rows: [Row; 3]) -> Sign {
    match certain_sign(&rows, FILTER) {
        Some(sign) => sign,
        None => {
            let [Row(a, x), Row(b, y), Row(c, z)] = rows;
            exact_sign_of_det(
                a[0], a[1], a[2], b[0], b[1], b[2], c[0], c[1], c[2], x[0], x[1], x[2], y[0], y[1], y[2],
                z[0], z[1], z[2],
            )
        }
    }
}
