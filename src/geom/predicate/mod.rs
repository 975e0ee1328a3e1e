//! The one place that decides a sign.
//!
//! Every sidedness question of the crate is the sign of one 3×3 determinant whose entries are differences of
//! two `f32` numbers. It is answered in three steps, each only when the one before cannot tell:
//!
//! 1. an `f64` evaluation with a static error bound (Jonathan R. Shewchuk, *Adaptive Precision Floating-Point
//!    Arithmetic and Fast Robust Geometric Predicates*, 1997, section 4.3, bound A);
//! 2. whole numbers modulo a power of two, when the entries are exact in `f64` and span at most 51 bits, if need be
//!    after each row and column was scaled: exact ties on CAD parts end here;
//! 3. a register as long as the range of the products: always exact.
//!
//! Entries are multiples of 2⁻¹⁴⁹ below 2¹²⁹, so products of three lie in 2⁻⁴⁴⁷ … 2³⁸⁷ and the six-term sums
//! below 2³⁹³: no step can overflow or underflow, for any finite input.
//!
//! ```
//! use umbrage::geom::predicate::{Sign, orient3d};
//! let [a, b, c] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
//! assert_eq!(orient3d(a, b, c, [0.0, 0.0, -1.0]), Sign::Positive); // below a counter-clockwise triangle
//! assert_eq!(orient3d(a, b, c, [0.3, 0.3, 0.0]), Sign::Zero);
//! ```

use std::ops::Neg;

use super::Light;
use accumulator::Accumulator;
use filter::{EPSILON, Row, rounded_det, sign_of_det};

mod accumulator;
pub(crate) mod filter;
mod integer;

/// The sign of a real number, known exactly.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[repr(i8)]
pub enum Sign {
    /// Below zero.
    Negative = -1,
    /// Exactly zero: a tie.
    Zero = 0,
    /// Above zero.
    Positive = 1,
}

impl Sign {
    /// −1, 0 or +1.
    #[inline]
    #[must_use]
    pub fn value(self) -> i32 {
        self as i32
    }

    /// Whether the number is exactly zero.
    #[inline]
    #[must_use]
    pub fn is_zero(self) -> bool {
        self == Self::Zero
    }

    #[inline]
    pub(crate) fn of<T: PartialOrd + Default>(number: T) -> Self {
        let zero = T::default();
        if number > zero {
            Self::Positive
        } else if number < zero {
            Self::Negative
        } else {
            Self::Zero
        }
    }
}

impl Neg for Sign {
    type Output = Self;

    #[inline]
    fn neg(self) -> Self {
        match self {
            Self::Negative => Self::Positive,
            Self::Zero => Self::Zero,
            Self::Positive => Self::Negative,
        }
    }
}

/// A point in homogeneous coordinates, kept symbolically: `(plus − minus, w)` with `w` 1 or 0.
///
/// The difference is never rounded, so that an extruded vertex `v − L` is exact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Homogeneous {
    plus: [f32; 3],
    minus: [f32; 3],
    finite: bool,
}

impl Homogeneous {
    /// A point at a place, `w = 1`.
    #[inline]
    #[must_use]
    pub fn point(position: [f32; 3]) -> Self {
        Self { plus: position, minus: [0.0; 3], finite: true }
    }

    /// A light, as it is.
    #[inline]
    #[must_use]
    pub fn light(light: &Light) -> Self {
        Self { plus: light.xyz(), minus: [0.0; 3], finite: !light.is_directional() }
    }

    /// The vertex at `position` pushed away from `light` to infinity: `(v·w − L, 0)`.
    #[inline]
    #[must_use]
    pub fn extruded(position: [f32; 3], light: &Light) -> Self {
        let plus = if light.is_directional() { [0.0; 3] } else { position };
        Self { plus, minus: light.xyz(), finite: false }
    }

    /// Whether `w = 1`.
    #[inline]
    #[must_use]
    pub fn is_finite(&self) -> bool {
        self.finite
    }

    /// The coordinates rounded to `f64`: `(x, y, z, w)`.
    #[must_use]
    pub fn to_f64(self) -> [f64; 4] {
        let [x, y, z] = std::array::from_fn(|i| f64::from(self.plus[i]) - f64::from(self.minus[i]));
        [x, y, z, if self.finite { 1.0 } else { 0.0 }]
    }

    /// As a row of a determinant whose pivot is the finite point `pivot`.
    #[inline]
    pub(crate) fn row(&self, pivot: [f32; 3]) -> Row {
        Row(self.plus, if self.finite { pivot } else { self.minus })
    }
}

/// The sign of `det [a−d; b−d; c−d]`: positive when `d` lies below the plane of `a`, `b`, `c`, that is, on the
/// side from which they run clockwise (Shewchuk 1997, section 2's sign, and the `robust` crate's).
#[inline]
#[must_use]
pub fn orient3d(a: [f32; 3], b: [f32; 3], c: [f32; 3], d: [f32; 3]) -> Sign {
    sign_of_det([Row(a, d), Row(b, d), Row(c, d)])
}

/// The sign of the determinant of four homogeneous rows `(x, y, z, w)`; for finite points that of [`orient3d`].
///
/// Zero when all four lie at infinity.
#[inline]
#[must_use]
pub fn orient3d_homogeneous(points: [Homogeneous; 4]) -> Sign {
    let Some(k) = points.iter().rposition(Homogeneous::is_finite) else { return Sign::Zero };
    let pivot = points[k].plus;
    // Subtracting the pivot from the finite rows leaves its own w as the only one in the last column, so the
    // determinant is (−1)^(k+3) times that of the other three rows.
    let others = match k {
        0 => [1, 2, 3],
        1 => [0, 2, 3],
        2 => [0, 1, 3],
        _ => [0, 1, 2],
    };
    let row = |i: usize| points[others[i]].row(pivot);
    let sign = sign_of_det([row(0), row(1), row(2)]);
    if k % 2 == 1 { sign } else { -sign }
}

/// The sign of the determinant of three homogeneous points taken as directions, `w` left out: for points at
/// infinity, that of [`orient3d_homogeneous`] with any finite fourth point.
#[inline]
#[must_use]
pub(crate) fn directions_turn(points: [Homogeneous; 3]) -> Sign {
    sign_of_det(points.map(|point| Row(point.plus, point.minus)))
}

/// Which side of a face the light is on: positive in front (where the corners run counter-clockwise), negative
/// behind, zero exactly edge-on. The sign of `(b−a)×(c−a) · (L − a·w)`.
#[inline]
#[must_use]
pub fn side_of_light([a, b, c]: [[f32; 3]; 3], light: &Light) -> Sign {
    sign_of_det([Row(b, a), Row(c, a), Homogeneous::light(light).row(a)])
}

/// As [`side_of_light`], every sign by the last step: what exactness costs where no filter spares it.
#[cfg(feature = "verify")]
#[inline]
#[must_use]
pub(crate) fn side_of_light_unfiltered([a, b, c]: [[f32; 3]; 3], light: &Light) -> Sign {
    Accumulator::of_det(&[Row(b, a), Row(c, a), Homogeneous::light(light).row(a)]).sign()
}

/// Which side of a face a point is on: positive in front. The opposite of [`orient3d`].
#[inline]
#[must_use]
pub fn side_of_point([a, b, c]: [[f32; 3]; 3], p: [f32; 3]) -> Sign {
    sign_of_det([Row(b, a), Row(c, a), Row(p, a)])
}

/// The determinant whose sign [`side_of_point`] and [`side_of_light`] tell, to 2⁻³⁹ of itself: the height over the
/// face's plane times twice its area. Exact where rounding would show.
#[inline]
#[must_use]
pub(crate) fn height([a, b, c]: [[f32; 3]; 3], of: Homogeneous) -> f64 {
    value_of_det([Row(b, a), Row(c, a), of.row(a)], SHARE)
}

/// The filter's error is at most 2⁻⁵⁰ of the permanent, so 2⁻⁴⁰ of a determinant that is more than this share of it.
/// (Measured: 2⁻⁴². A share of 2⁻¹⁶ errs by more than 2⁻³⁹ and is caught.)
const SHARE: f64 = 1.0 / 1024.0;

#[inline(always)]
fn value_of_det(rows: [Row; 3], share: f64) -> f64 {
    let (det, permanent) = rounded_det(&rows);
    if det.abs() > permanent * share { det } else { Accumulator::of_det(&rows).value() }
}

/// Which way the triangle `a`, `b`, `c` turns when looked at along `axis` (0, 1, 2 for x, y, z): positive when
/// its normal's component on that axis is.
#[inline]
#[must_use]
pub fn turn(a: [f32; 3], b: [f32; 3], c: [f32; 3], axis: usize) -> Sign {
    turn_homogeneous(a, b, Homogeneous::point(c), axis)
}

/// As [`turn`], with a third corner that may lie at infinity.
#[inline]
#[must_use]
pub fn turn_homogeneous(a: [f32; 3], b: [f32; 3], c: Homogeneous, axis: usize) -> Sign {
    let mut unit = [0.0; 3];
    unit[axis] = 1.0;
    sign_of_det([Row(b, a), c.row(a), Row(unit, [0.0; 3])])
}

/// Whether three points lie on one line (or fewer).
#[inline]
#[must_use]
pub fn collinear(a: [f32; 3], b: [f32; 3], c: [f32; 3]) -> bool {
    !surely_not_collinear(a, b, c, MINOR_FILTER) && (0..3).all(|axis| turn(a, b, c, axis).is_zero())
}

/// A minor of two products of single rounded differences errs by at most this times the sum of their magnitudes
/// (Shewchuk 1997, section 4.3, bound A of two dimensions). Half of it is caught.
const MINOR_FILTER: f64 = (3.0 + 16.0 * EPSILON) * EPSILON;

/// Whether one of the minors is surely not zero.
#[inline(always)]
fn surely_not_collinear(a: [f32; 3], b: [f32; 3], c: [f32; 3], filter: f64) -> bool {
    let (u, v) = (Row(b, a).rounded(), Row(c, a).rounded());
    for (i, j) in [(0, 1), (1, 2), (2, 0)] {
        let (p, q) = (u[i] * v[j], u[j] * v[i]);
        if (p - q).abs() > filter * (p.abs() + q.abs()) {
            return true;
        }
    }
    false
}

/// Whether some plane through `apex` surely parts two pairs of points: one strictly on one side, the other on the other.
/// One plane is tried, halfway between them.
#[inline]
pub(crate) fn surely_parted(apex: [f32; 3], first: [[f32; 3]; 2], second: [[f32; 3]; 2]) -> bool {
    surely_parted_by(apex, first, second, ALONG_FILTER)
}

#[inline(always)]
fn surely_parted_by(apex: [f32; 3], first: [[f32; 3]; 2], second: [[f32; 3]; 2], filter: f64) -> bool {
    let [a, b] = first.map(|p| Row(p, apex).rounded());
    let [c, d] = second.map(|p| Row(p, apex).rounded());
    let towards = |i: usize| (a[i] + b[i]) - (c[i] + d[i]);
    let normal = [towards(0), towards(1), towards(2)];
    surely_along(a, normal, filter)
        && surely_along(b, normal, filter)
        && surely_along(c, normal.map(Neg::neg), filter)
        && surely_along(d, normal.map(Neg::neg), filter)
}

/// The dot product of any vector with one of single rounded differences errs by at most four roundings (the difference,
/// the product, two sums) of its products' magnitudes, whose sum errs by as many: (4 + 32 ε) ε is enough. (An eighth of
/// it is caught.) Nothing underflows as long as the vector's entries are 0 or multiples of 2⁻¹⁴⁹.
const ALONG_FILTER: f64 = (4.0 + 32.0 * EPSILON) * EPSILON;

/// Whether the dot product of a row, rounded, with `normal` is surely positive.
#[inline(always)]
fn surely_along(v: [f64; 3], normal: [f64; 3], filter: f64) -> bool {
    let [x, y, z] = [v[0] * normal[0], v[1] * normal[1], v[2] * normal[2]];
    x + y + z > filter * (x.abs() + y.abs() + z.abs())
}

/// What the filter could not tell: `[a − x; b − y; c − z]`.
///
/// Scalars, since what a caller stores as four bytes and this loads as sixteen cannot be forwarded by a processor's
/// store buffer: it cost 12 ns, a third of the whole.
#[inline(never)]
#[expect(clippy::too_many_arguments, reason = "numbers stay in registers, arrays do not")]
#[rustfmt::skip]
fn exact_sign_of_det(
    a0: f32, a1: f32, a2: f32, b0: f32, b1: f32, b2: f32, c0: f32, c1: f32, c2: f32,
    x0: f32, x1: f32, x2: f32, y0: f32, y1: f32, y2: f32, z0: f32, z1: f32, z2: f32,
) -> Sign {
    let rows = [Row([a0, a1, a2], [x0, x1, x2]), Row([b0, b1, b2], [y0, y1, y2]), Row([c0, c1, c2], [z0, z1, z2])];
    match integer::sign_of_det(rows) {
        Some(sign) => sign,
        None => wide_sign_of_det(rows),
    }
}

#[cold]
#[inline(never)]
fn wide_sign_of_det(rows: [Row; 3]) -> Sign {
    integer::sign_of_scaled_det(rows).unwrap_or_else(|| Accumulator::of_det(&rows).sign())
}

#[cfg(test)]
mod tests;
