//! Exact geometric predicates: the only module that decides a sign.
//!
//! Every orientation test of the crate is the sign of one 3×3 determinant whose entries are differences of
//! two `f32` numbers. The sign is found in three steps, each used only if the previous step is not certain:
//!
//! 1. an `f64` evaluation with a static error bound (Jonathan R. Shewchuk, *Adaptive Precision Floating-Point
//!    Arithmetic and Fast Robust Geometric Predicates*, 1997, section 4.3, bound A);
//! 2. integer arithmetic modulo a power of two, for entries that are exact in `f64` and span at most 51 bits,
//!    if need be after each row and column was scaled: exact ties on CAD parts are decided here;
//! 3. a fixed-point accumulator as long as the range of the products: always exact.
//!
//! Entries are multiples of 2⁻¹⁴⁹ below 2¹²⁹. So products of three entries lie in 2⁻⁴⁴⁷ … 2³⁸⁷, and sums of
//! six products are below 2³⁹³: no step can overflow or underflow, for any finite input.
//!
//! ```
//! use umbrage::geom::predicate::{Sign, orient3d};
//! let [a, b, c] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
//! assert_eq!(orient3d(a, b, c, [0.0, 0.0, -1.0]), Sign::Positive); // below a counter-clockwise triangle
//! assert_eq!(orient3d(a, b, c, [0.3, 0.3, 0.0]), Sign::Zero);
//! ```

use std::ops::Neg;

use super::{Aabb, Light};
use accumulator::Accumulator;
use filter::{EPSILON, Row, rounded_det, sign_of_det};

mod accumulator;
pub(crate) mod filter;
mod integer;
mod rounded;

pub(crate) use rounded::{Rounded, orient3d_rounded};

/// The exact sign of a real number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[repr(i8)]
pub enum Sign {
    /// The number is below zero.
    Negative = -1,
    /// The number is exactly zero: a tie.
    Zero = 0,
    /// The number is above zero.
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

/// A point in homogeneous coordinates, stored symbolically as `(plus − minus, w)` with `w` 1 or 0.
///
/// The difference is never rounded, so an extruded vertex `v − L` is exact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Homogeneous {
    plus: [f32; 3],
    minus: [f32; 3],
    finite: bool,
}

impl Homogeneous {
    /// A finite point, `w = 1`.
    #[inline]
    #[must_use]
    pub fn point(position: [f32; 3]) -> Self {
        Self { plus: position, minus: [0.0; 3], finite: true }
    }

    /// The position of a point light, `w = 1`, or the direction towards a directional light, `w = 0`.
    #[inline]
    #[must_use]
    pub fn light(light: &Light) -> Self {
        Self { plus: light.xyz(), minus: [0.0; 3], finite: !light.is_directional() }
    }

    /// The vertex at `position`, extruded away from `light` to infinity: `(v·w − L, 0)`.
    #[inline]
    #[must_use]
    pub fn extruded(position: [f32; 3], light: &Light) -> Self {
        let plus = if light.is_directional() { [0.0; 3] } else { position };
        Self { plus, minus: light.xyz(), finite: false }
    }

    /// Whether the point is finite, `w = 1`.
    #[inline]
    #[must_use]
    pub fn is_finite(&self) -> bool {
        self.finite
    }

    /// The coordinates `(x, y, z, w)`, rounded to `f64`.
    #[must_use]
    pub fn to_f64(self) -> [f64; 4] {
        let [x, y, z] = std::array::from_fn(|i| f64::from(self.plus[i]) - f64::from(self.minus[i]));
        [x, y, z, if self.finite { 1.0 } else { 0.0 }]
    }

    /// The point as a row of a determinant whose pivot is the finite point `pivot`.
    #[inline]
    pub(crate) fn row(&self, pivot: [f32; 3]) -> Row {
        Row(self.plus, if self.finite { pivot } else { self.minus })
    }
}

/// The orientation of four points: the sign of `det [a−d; b−d; c−d]`. Positive if `d` lies below the plane of
/// `a`, `b`, `c`, that is, on the side from which they run clockwise (the sign convention of Shewchuk 1997,
/// section 2, and of the `robust` crate).
#[inline]
#[must_use]
pub fn orient3d(a: [f32; 3], b: [f32; 3], c: [f32; 3], d: [f32; 3]) -> Sign {
    sign_of_det([Row(a, d), Row(b, d), Row(c, d)])
}

/// The orientation of four homogeneous points: the sign of the determinant of their rows `(x, y, z, w)`. For
/// finite points the result equals that of [`orient3d`].
///
/// Zero if all four points lie at infinity.
#[inline]
#[must_use]
pub fn orient3d_homogeneous(points: [Homogeneous; 4]) -> Sign {
    let Some(k) = points.iter().rposition(Homogeneous::is_finite) else { return Sign::Zero };
    let pivot = points[k].plus;
    // Subtracting the pivot from the finite rows leaves only the pivot's own w in the last column. So the
    // determinant is (−1)^(k+3) times the determinant of the other three rows.
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

/// The sign of the determinant of three homogeneous points taken as directions, without `w`. For points at
/// infinity, the result equals that of [`orient3d_homogeneous`] with any finite fourth point.
#[inline]
#[must_use]
pub(crate) fn directions_turn(points: [Homogeneous; 3]) -> Sign {
    sign_of_det(points.map(|point| Row(point.plus, point.minus)))
}

/// The side of a face that the light is on: positive in front (where the corners run counter-clockwise),
/// negative behind, zero exactly edge-on. The sign of `(b−a)×(c−a) · (L − a·w)`.
#[inline]
#[must_use]
pub fn side_of_light([a, b, c]: [[f32; 3]; 3], light: &Light) -> Sign {
    sign_of_det([Row(b, a), Row(c, a), Homogeneous::light(light).row(a)])
}

/// As [`side_of_light`], with every sign computed by the last step: the cost of exactness without a filter.
#[cfg(feature = "verify")]
#[inline]
#[must_use]
pub(crate) fn side_of_light_unfiltered([a, b, c]: [[f32; 3]; 3], light: &Light) -> Sign {
    Accumulator::of_det(&[Row(b, a), Row(c, a), Homogeneous::light(light).row(a)]).sign()
}

/// The side of a face that a point is on: positive in front. The opposite of [`orient3d`].
#[inline]
#[must_use]
pub fn side_of_point([a, b, c]: [[f32; 3]; 3], p: [f32; 3]) -> Sign {
    sign_of_det([Row(b, a), Row(c, a), Row(p, a)])
}

/// The determinant whose sign [`side_of_point`] and [`side_of_light`] return, with a relative error of at
/// most 2⁻³⁹: the height over the face's plane times twice the area of the face. Computed exactly where
/// rounding would exceed this error.
#[inline]
#[must_use]
pub(crate) fn height([a, b, c]: [[f32; 3]; 3], of: Homogeneous) -> f64 {
    value_of_det([Row(b, a), Row(c, a), of.row(a)], SHARE)
}

/// Smallest ratio of the determinant to the permanent for which `f64` is accurate enough. The filter's error
/// is at most 2⁻⁵⁰ of the permanent, hence 2⁻⁴⁰ of a determinant above this ratio. (Measured: 2⁻⁴². With a
/// ratio of 2⁻¹⁶ the error exceeds 2⁻³⁹, which a test catches.)
const SHARE: f64 = 1.0 / 1024.0;

#[inline(always)]
fn value_of_det(rows: [Row; 3], share: f64) -> f64 {
    let (det, permanent) = rounded_det(&rows);
    if det.abs() > permanent * share { det } else { Accumulator::of_det(&rows).value() }
}

/// The orientation of the triangle `a`, `b`, `c` projected along `axis` (0, 1, 2 for x, y, z): the sign of
/// that component of the triangle's normal.
#[inline]
#[must_use]
pub fn turn(a: [f32; 3], b: [f32; 3], c: [f32; 3], axis: usize) -> Sign {
    let (u, v) = (Row(b, a).rounded(), Row(c, a).rounded());
    let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
    match certain_minor(u, v, i, j, MINOR_FILTER) {
        Sign::Zero => turn_homogeneous(a, b, Homogeneous::point(c), axis),
        certain => certain,
    }
}

/// Whether all four corners of a quad certainly turn the same way along `axis`: then it is convex in that
/// projection. One test for what four calls of [`turn`] find out, in less time; false where they may say
/// otherwise.
#[inline]
pub(crate) fn surely_convex(corners: [[f32; 3]; 4], axis: usize) -> bool {
    // Axes are known to the compiler, and a processor guesses right which: it does not wait for `axis`.
    match axis {
        0 => surely_convex_in::<1, 2>(corners, MINOR_FILTER),
        1 => surely_convex_in::<2, 0>(corners, MINOR_FILTER),
        _ => surely_convex_in::<0, 1>(corners, MINOR_FILTER),
    }
}

#[inline(always)]
fn surely_convex_in<const I: usize, const J: usize>([a, b, c, d]: [[f32; 3]; 4], filter: f64) -> bool {
    let side = |p: [f32; 3], q: [f32; 3]| [I, J].map(|axis| f64::from(q[axis]) - f64::from(p[axis]));
    let [ab, bc, cd, da] = [side(a, b), side(b, c), side(c, d), side(d, a)];
    // Each is the minor of `turn` for one corner, of differences that are rounded once, too.
    let (mut left, mut right) = (true, true);
    for (u, v) in [(ab, bc), (bc, cd), (cd, da), (da, ab)] {
        let (p, q) = (u[0] * v[1], u[1] * v[0]);
        let error = filter * (p.abs() + q.abs());
        left &= p - q > error;
        right &= q - p > error;
    }
    left | right
}

/// As [`turn`], with a third corner that may lie at infinity.
#[inline]
#[must_use]
pub fn turn_homogeneous(a: [f32; 3], b: [f32; 3], c: Homogeneous, axis: usize) -> Sign {
    let mut unit = [0.0; 3];
    unit[axis] = 1.0;
    sign_of_det([Row(b, a), c.row(a), Row(unit, [0.0; 3])])
}

/// Whether three points lie on one line, coinciding points included.
#[inline]
#[must_use]
pub fn collinear(a: [f32; 3], b: [f32; 3], c: [f32; 3]) -> bool {
    !surely_not_collinear(a, b, c, MINOR_FILTER) && (0..3).all(|axis| turn(a, b, c, axis).is_zero())
}

/// Whether a point of the triangle's plane lies in the closed triangle.
pub(crate) fn on_triangle([a, b, c]: [[f32; 3]; 3], p: [f32; 3]) -> bool {
    if !Aabb::around([a, b, c]).contains(p) {
        return false;
    }
    // Inside or on the edge in every projection; a projection onto a line has turns of zero only.
    (0..3).all(|axis| {
        let turns = [(a, b), (b, c), (c, a)].map(|(u, v)| turn(u, v, p, axis));
        !(turns.contains(&Sign::Positive) && turns.contains(&Sign::Negative))
    })
}

/// Relative error bound of a 2×2 minor. A minor of differences that are rounded once errs by at most this
/// factor times the sum of the magnitudes of its two products (Shewchuk 1997, section 4.3, bound A in two
/// dimensions). Tests fail with half of the bound.
const MINOR_FILTER: f64 = (3.0 + 16.0 * EPSILON) * EPSILON;

/// Whether one of the minors is certainly nonzero.
#[inline(always)]
fn surely_not_collinear(a: [f32; 3], b: [f32; 3], c: [f32; 3], filter: f64) -> bool {
    let (u, v) = (Row(b, a).rounded(), Row(c, a).rounded());
    [(0, 1), (1, 2), (2, 0)].into_iter().any(|(i, j)| !certain_minor(u, v, i, j, filter).is_zero())
}

/// The sign of a minor of rounded differences; zero if it is not certain.
#[inline(always)]
fn certain_minor(u: [f64; 3], v: [f64; 3], i: usize, j: usize, filter: f64) -> Sign {
    let (p, q) = (u[i] * v[j], u[j] * v[i]);
    if (p - q).abs() > filter * (p.abs() + q.abs()) { Sign::of(p - q) } else { Sign::Zero }
}

/// Whether a plane through `apex` certainly separates two pairs of points: one pair strictly on one side, the
/// other pair strictly on the other side. Only one plane is tried, halfway between the pairs.
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

/// Relative error bound of a dot product of any vector with a vector of differences that are rounded once.
///
/// The dot product errs by at most four roundings (the difference, the product, two sums) of the sum of its
/// products' magnitudes. The computed sum of magnitudes errs by as many roundings, so (4 + 32 ε) ε is enough.
/// (Tests fail with an eighth of the bound.) Nothing underflows as long as the vector's entries are 0 or
/// multiples of 2⁻¹⁴⁹.
const ALONG_FILTER: f64 = (4.0 + 32.0 * EPSILON) * EPSILON;

/// Whether the dot product of a rounded row with `normal` is certainly positive.
#[inline(always)]
fn surely_along(v: [f64; 3], normal: [f64; 3], filter: f64) -> bool {
    let [x, y, z] = [v[0] * normal[0], v[1] * normal[1], v[2] * normal[2]];
    x + y + z > filter * (x.abs() + y.abs() + z.abs())
}

/// The sign of the determinant `[a − x; b − y; c − z]` that the filter could not decide.
///
/// The arguments are scalars: a value that the caller stores as four bytes and this function loads as sixteen
/// cannot be forwarded by the processor's store buffer. Arrays cost 12 ns more, a third of the total.
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
