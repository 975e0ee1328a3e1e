//! Signs of determinants of points that are known in `f64`, relative to a common origin.
//!
//! A point on a ray is no `f32` point: far from the origin of the mesh the spacing of `f32` is larger than a
//! pixel. Relative to the eye such a point has all digits of `f64`. A sign then is either certain for the
//! exact points, or not claimed.
//!
//! Let ε = 2⁻⁵³. Every coordinate errs by at most ε of itself: it is an `f32` difference, or a product,
//! rounded once. An entry `u − v` of the determinant errs by at most `ε(|u| + |v|)`, and by as much once more
//! when it is rounded. With magnitudes `|u| + |v|` instead of entries, a product of three has an error of at
//! most three times two ε, and six more come from the products and sums: 12ε of the magnitudes' permanent, to
//! first order.

use super::{Homogeneous, Sign};

/// Relative error bound, of the permanent of magnitudes: 16ε, above the derived 12ε.
const BOUND: f64 = 8.0 * f64::EPSILON;

/// A point, or a direction (a point at infinity), relative to an origin; coordinates err by at most 2⁻⁵³ of
/// themselves.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rounded {
    at: [f64; 3],
    finite: bool,
}

impl Rounded {
    /// A finite point.
    pub(crate) fn point(at: [f64; 3]) -> Self {
        Self { at, finite: true }
    }

    /// An exact homogeneous point as seen from `origin`; its own coordinates are those of a vertex or light.
    pub(crate) fn seen_from(origin: [f32; 3], exact: Homogeneous) -> Self {
        Self { at: exact.row(origin).rounded(), finite: exact.is_finite() }
    }
}

/// As [`orient3d_homogeneous`](super::orient3d_homogeneous), for rounded points: zero where the sign of the
/// exact determinant is not certain.
pub(crate) fn orient3d_rounded(points: [Rounded; 4]) -> Sign {
    orient3d_within(points, BOUND)
}

#[inline(always)]
fn orient3d_within(points: [Rounded; 4], bound: f64) -> Sign {
    let Some(k) = points.iter().rposition(|point| point.finite) else { return Sign::Zero };
    let pivot = points[k].at;
    let (mut rows, mut sizes, mut count) = ([[0.0; 3]; 3], [[0.0; 3]; 3], 0);
    for (i, point) in points.iter().enumerate().filter(|&(i, _)| i != k) {
        debug_assert_ne!(i, k);
        for axis in 0..3 {
            let minus = if point.finite { pivot[axis] } else { 0.0 };
            rows[count][axis] = point.at[axis] - minus;
            sizes[count][axis] = point.at[axis].abs() + minus.abs();
        }
        count += 1;
    }
    let [a, b, c] = rows;
    let det = a[0] * (b[1] * c[2] - b[2] * c[1])
        + a[1] * (b[2] * c[0] - b[0] * c[2])
        + a[2] * (b[0] * c[1] - b[1] * c[0]);
    let [a, b, c] = sizes;
    let permanent = a[0] * (b[1] * c[2] + b[2] * c[1])
        + a[1] * (b[2] * c[0] + b[0] * c[2])
        + a[2] * (b[0] * c[1] + b[1] * c[0]);
    match det.abs() > bound * permanent {
        true if k % 2 == 1 => Sign::of(det),
        true => -Sign::of(det),
        false => Sign::Zero,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::Light;
    use crate::geom::predicate::orient3d_homogeneous;
    use crate::random::SplitMix64;

    /// Claims that differ from the exact sign, and claims, over points that are nearly coplanar.
    fn wrong_claims(bound: f64) -> [usize; 2] {
        let mut random = SplitMix64(3);
        let mut counts = [0; 2];
        for _ in 0..200_000 {
            let mut whole = |most: usize| random.below(2 * most + 1) as f32 - most as f32;
            let far = [5_000_000.0, -3_000_000.0, 1.0];
            let mut point = |most: usize| [0, 1, 2].map(|i| far[i] + whole(most));
            let [a, b, c, origin] = [point(1 << 18), point(1 << 18), point(1 << 18), point(1 << 10)];
            // In the plane of the other three, or next to it.
            let mut d = [0, 1, 2].map(|i| a[i] + (b[i] - c[i]));
            d[2] += [0.0, 0.25, -0.25][(whole(30) as i32).unsigned_abs() as usize % 3];
            let exact = [a, b, c, d].map(Homogeneous::point);
            let sun = Homogeneous::light(&Light::directional([0, 1, 2].map(|i| b[i] - a[i] + 1.0)).unwrap());
            for points in [exact, [exact[0], exact[1], exact[3], sun], [sun, exact[0], exact[1], exact[2]]] {
                let rounded = points.map(|point| Rounded::seen_from(origin, point));
                let claim = orient3d_within(rounded, bound);
                counts[0] += usize::from(!claim.is_zero() && claim != orient3d_homogeneous(points));
                counts[1] += usize::from(!claim.is_zero());
            }
        }
        counts
    }

    #[test]
    fn rounded_signs_are_those_of_the_exact_points() {
        let [wrong, claims] = wrong_claims(BOUND);
        assert!(wrong == 0 && claims > 200_000, "{wrong} wrong of {claims}");
    }

    #[test]
    fn rounded_sign_of_axes_is_claimed_at_any_scale() {
        // One product of the determinant and the same one of the permanent: nothing cancels.
        for scale in [1e-30, 1.0, 1e30] {
            let axis = |i: usize| {
                let mut at = [0.0; 3];
                at[i] = scale;
                Rounded::point(at)
            };
            for (order, sign) in [
                ([0, 1, 2], Sign::Positive),
                ([1, 2, 0], Sign::Positive),
                ([2, 0, 1], Sign::Positive),
                ([0, 2, 1], Sign::Negative),
                ([1, 0, 2], Sign::Negative),
                ([2, 1, 0], Sign::Negative),
            ] {
                let [a, b, c] = order.map(axis);
                let origin = Rounded::point([0.0; 3]);
                assert_eq!(orient3d_rounded([a, b, c, origin]), sign, "{order:?} times {scale}");
            }
        }
    }

    #[test]
    fn rounded_sign_of_points_that_round_is_not_claimed_on_a_plane() {
        // On the plane z = x + y, but for the rounding of z.
        let mut claimed = [0, 0];
        for i in 1..2000_u32 {
            let at = |k: u32| f64::from(i.wrapping_mul(k) % 997) / 3.0;
            let on = |x: f64, y: f64| Rounded::point([x, y, x + y]);
            let points = [on(at(3), at(5)), on(at(7), at(11)), on(at(13), at(17)), on(at(19), at(23))];
            for (claimed, bound) in claimed.iter_mut().zip([BOUND, 0.0]) {
                *claimed += usize::from(!orient3d_within(points, bound).is_zero());
            }
        }
        assert!(claimed[0] == 0 && claimed[1] > 0, "{claimed:?}");
    }
}
