//! The one place that decides a sign.
//!
//! Every sidedness question of the crate is the sign of one 3×3 determinant whose entries are differences of
//! two `f32` numbers. It is answered in four steps, each only when the one before cannot tell:
//!
//! 1. an `f64` evaluation with a static error bound (Jonathan R. Shewchuk, *Adaptive Precision Floating-Point
//!    Arithmetic and Fast Robust Geometric Predicates*, 1997, section 4.3, bound A);
//! 2. `i128` integers, when the entries of each row span at most 41 bits: exact ties on CAD parts end here;
//! 3. the first two again, where subtracting one row from another leaves smaller entries: far from a light, that
//!    is, where all vertices that are extruded from it lie nearly one way;
//! 4. a sum of exact products as a floating-point expansion (ibid., section 2): always exact.
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
    fn row(&self, pivot: [f32; 3]) -> Row {
        Row(self.plus, if self.finite { pivot } else { self.minus })
    }
}

/// A row of a determinant: the exact difference of two vectors.
#[derive(Clone, Copy)]
struct Row([f32; 3], [f32; 3]);

impl Row {
    /// The difference in `f64`: one rounding an entry. (Spelt out: `map` is not always inlined.)
    #[inline]
    fn rounded(self) -> [f64; 3] {
        let Self(u, v) = self;
        [
            f64::from(u[0]) - f64::from(v[0]),
            f64::from(u[1]) - f64::from(v[1]),
            f64::from(u[2]) - f64::from(v[2]),
        ]
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
    let rows = [Row(b, a), Row(c, a), of.row(a)];
    let (det, permanent) = rounded_det(&rows);
    // The filter's error, 2^-50 of the permanent, is then 2^-40 of the determinant.
    if det.abs() > permanent / 1024.0 { det } else { expansion_of_det(rows).value() }
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
    // A minor of two products of single rounded differences errs by at most (3 + 16ε)ε times the sum of their
    // magnitudes (Shewchuk 1997, section 4.3, bound A of two dimensions); one that is surely not zero decides.
    let (u, v) = (Row(b, a).rounded(), Row(c, a).rounded());
    for (i, j) in [(0, 1), (1, 2), (2, 0)] {
        let (p, q) = (u[i] * v[j], u[j] * v[i]);
        if (p - q).abs() > (3.0 + 16.0 * EPSILON) * EPSILON * (p.abs() + q.abs()) {
            return false;
        }
    }
    (0..3).all(|axis| turn(a, b, c, axis).is_zero())
}

/// Half an ulp of 1 in `f64`: the largest relative error of one rounding.
const EPSILON: f64 = f64::EPSILON / 2.0;

/// Bound A of Shewchuk 1997, section 4.3: with entries that are single rounded differences, the evaluation
/// below errs by at most this times the sum of the products' magnitudes.
const FILTER: f64 = (7.0 + 56.0 * EPSILON) * EPSILON;

/// The determinant in `f64`, and the sum of its products' magnitudes.
#[inline(always)]
fn rounded_det(rows: &[Row; 3]) -> (f64, f64) {
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

/// Step 1: the filter. Everything else is rare and lives behind one call.
#[inline(always)]
fn sign_of_det(rows: [Row; 3]) -> Sign {
    match filtered_sign_of_det(&rows) {
        Some(sign) => sign,
        None => exact_sign_of_det(rows),
    }
}

/// `None` where rounding may have decided.
#[inline(always)]
fn filtered_sign_of_det(rows: &[Row; 3]) -> Option<Sign> {
    let (det, permanent) = rounded_det(rows);
    let bound = FILTER * permanent;
    if det > bound {
        Some(Sign::Positive)
    } else if det < -bound {
        Some(Sign::Negative)
    } else if permanent == 0.0 {
        Some(Sign::Zero) // no product can underflow, so every one of them is exactly zero
    } else {
        None
    }
}

#[cold]
#[inline(never)]
fn exact_sign_of_det(rows: [Row; 3]) -> Sign {
    let whole = |rows: [Row; 3]| match rows.map(integers) {
        [Some(a), Some(b), Some(c)] => Some(integer_sign_of_det(a, b, c)),
        _ => None,
    };
    let expanded = |rows: [Row; 3]| expansion_of_det(rows).sign();
    whole(rows).unwrap_or_else(|| match nearer(&rows) {
        None => expanded(rows),
        Some(rows) => filtered_sign_of_det(&rows).or_else(|| whole(rows)).unwrap_or_else(|| expanded(rows)),
    })
}

/// Step 3: the same determinant with smaller entries, where that takes no rounding: of two rows that subtract the same
/// vector, as those of two vertices extruded from one light do, one becomes their difference. Far from the light
/// little else is left of them. `None` where no row becomes smaller by half.
fn nearer(rows: &[Row; 3]) -> Option<[Row; 3]> {
    let size = |row: Row| row.rounded().iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    for (i, j) in [(0, 1), (1, 2), (2, 0)] {
        let difference = Row(rows[i].0, rows[j].0);
        if rows[i].1 == rows[j].1 && 2.0 * size(difference) < size(rows[i]) {
            let mut rows = *rows;
            rows[i] = difference;
            return Some(rows);
        }
    }
    None
}

/// Step 2: a row as integers below 2⁴¹, scaled by a power of two of its own (which leaves the determinant's
/// sign alone); `None` where its entries span more bits.
fn integers(Row(u, v): Row) -> Option<[i64; 3]> {
    let mut row = [0.0_f64; 3];
    let mut largest = 0.0_f64;
    for i in 0..3 {
        let (head, tail) = two_diff(f64::from(u[i]), f64::from(v[i]));
        if tail != 0.0 {
            return None;
        }
        row[i] = head;
        largest = largest.max(head.abs());
    }
    // `largest` is 0 or a normal f64 in 2^-149 ..= 2^129, so the biased exponent below stays in range.
    let exponent = (largest.to_bits() >> 52) as i64 - 1023;
    let scale = if largest == 0.0 { 1.0 } else { f64::from_bits(((40 - exponent + 1023) as u64) << 52) };
    let mut scaled = [0_i64; 3];
    for i in 0..3 {
        let value = row[i] * scale; // exact
        scaled[i] = value as i64;
        if scaled[i] as f64 != value {
            return None;
        }
    }
    Some(scaled)
}

/// Entries below 2⁴¹ make minors below 2⁸³ and a determinant below 2¹²⁶.
fn integer_sign_of_det(a: [i64; 3], b: [i64; 3], c: [i64; 3]) -> Sign {
    let minor =
        |p: [i64; 3], q: [i64; 3]| i128::from(p[0]) * i128::from(q[1]) - i128::from(q[0]) * i128::from(p[1]);
    let det =
        i128::from(a[2]) * minor(b, c) + i128::from(b[2]) * minor(c, a) + i128::from(c[2]) * minor(a, b);
    Sign::of(det)
}

/// Step 4: each entry as head + tail, each product of three as four numbers, all of them added exactly.
fn expansion_of_det(rows: [Row; 3]) -> Expansion {
    let entries = rows.map(|Row(u, v)| [0, 1, 2].map(|i| two_diff(f64::from(u[i]), f64::from(v[i]))));
    let mut sum = Expansion::new();
    for (columns, even) in [
        ([0, 1, 2], true),
        ([1, 2, 0], true),
        ([2, 0, 1], true),
        ([0, 2, 1], false),
        ([1, 0, 2], false),
        ([2, 1, 0], false),
    ] {
        // Most differences are exact: their tails are 0, and whole products with them.
        let halves = |row: usize| {
            let (head, tail) = entries[row][columns[row]];
            [head, tail].into_iter().filter(|&part| part != 0.0)
        };
        for x in halves(0) {
            for y in halves(1) {
                for z in halves(2) {
                    let (head, tail) = two_product(x, if even { y } else { -y });
                    for (part, rest) in [two_product(head, z), two_product(tail, z)] {
                        sum.add(rest);
                        sum.add(part);
                    }
                }
            }
        }
    }
    sum
}

/// A sum of numbers, exact: components of growing magnitude that do not overlap (Shewchuk 1997, section 2.2).
struct Expansion {
    components: [f64; Self::MOST],
    len: usize,
}

impl Expansion {
    /// Six permutations, eight choices of head or tail, four numbers each.
    const MOST: usize = 6 * 8 * 4;

    fn new() -> Self {
        Self { components: [0.0; Self::MOST], len: 0 }
    }

    /// Grow-expansion with zero elimination: one component more at most.
    fn add(&mut self, number: f64) {
        if number == 0.0 {
            return;
        }
        let mut carry = number;
        let mut kept = 0;
        for i in 0..self.len {
            let (sum, error) = two_sum(carry, self.components[i]);
            carry = sum;
            if error != 0.0 {
                self.components[kept] = error;
                kept += 1;
            }
        }
        if carry != 0.0 {
            self.components[kept] = carry;
            kept += 1;
        }
        self.len = kept;
    }

    /// The sum, rounded.
    fn value(&self) -> f64 {
        self.components[..self.len].iter().sum()
    }

    /// The largest component outweighs all others together.
    fn sign(&self) -> Sign {
        Sign::of(self.components[..self.len].last().copied().unwrap_or_default())
    }
}

/// `a + b` as rounded sum and exact error (Knuth).
#[inline]
fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let b_virtual = sum - a;
    (sum, (a - (sum - b_virtual)) + (b - b_virtual))
}

/// `a − b` as rounded difference and exact error.
#[inline]
fn two_diff(a: f64, b: f64) -> (f64, f64) {
    two_sum(a, -b)
}

/// `a · b` as rounded product and exact error (Dekker, with Veltkamp's split).
#[inline]
fn two_product(a: f64, b: f64) -> (f64, f64) {
    let split = |x: f64| {
        let c = 134_217_729.0 * x; // 2^27 + 1
        let high = c - (c - x);
        (high, x - high)
    };
    let product = a * b;
    let ((a_high, a_low), (b_high, b_low)) = (split(a), split(b));
    (product, a_low * b_low - (((product - a_high * b_high) - a_low * b_high) - a_high * b_low))
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// Sign of the same determinant in whole numbers of 2⁻¹⁴⁹, by cofactors of the first row.
    fn reference(rows: [Row; 3]) -> i32 {
        use num_bigint::{BigInt, Sign as BigSign};
        let whole = |x: f32| {
            let bits = x.to_bits();
            let (exponent, fraction) = ((bits >> 23) & 0xff, bits & 0x7f_ffff);
            let mantissa = if exponent == 0 { fraction } else { fraction | 0x80_0000 };
            let magnitude = BigInt::from(mantissa) << (exponent.max(1) - 1);
            if x.is_sign_negative() { -magnitude } else { magnitude }
        };
        let m = rows.map(|Row(u, v)| [0, 1, 2].map(|i| whole(u[i]) - whole(v[i])));
        let det = &m[0][0] * (&m[1][1] * &m[2][2] - &m[1][2] * &m[2][1])
            - &m[0][1] * (&m[1][0] * &m[2][2] - &m[1][2] * &m[2][0])
            + &m[0][2] * (&m[1][0] * &m[2][1] - &m[1][1] * &m[2][0]);
        match det.sign() {
            BigSign::Minus => -1,
            BigSign::NoSign => 0,
            BigSign::Plus => 1,
        }
    }

    fn finite() -> impl Strategy<Value = f32> {
        prop_oneof![
            any::<f32>().prop_filter("finite", |x| x.is_finite()),
            (-8_i8..8).prop_map(f32::from),
            (-1000_i16..1000).prop_map(|x| f32::from(x) * 0.001),
            Just(f32::MAX),
            Just(f32::from_bits(1)),
        ]
    }

    fn vector() -> impl Strategy<Value = [f32; 3]> {
        [finite(), finite(), finite()]
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(4096))]

        #[test]
        fn predicate_every_step_equals_whole_numbers(
            u in [vector(), vector(), vector()],
            v in [vector(), vector(), vector()],
            tie in any::<bool>(),
            shared in any::<bool>(),
        ) {
            let mut rows = [0, 1, 2].map(|i| Row(u[i], v[i]));
            if shared {
                rows[1].1 = rows[0].1;
            }
            if tie {
                rows[2] = Row(v[0], u[0]); // row 2 = −row 0: exactly singular
            }
            let expected = reference(rows);
            prop_assert_eq!(sign_of_det(rows).value(), expected);
            prop_assert_eq!(expansion_of_det(rows).sign().value(), expected);
            if let Some(nearer) = nearer(&rows) {
                prop_assert_eq!(expansion_of_det(nearer).sign().value(), expected);
            }
            if let [Some(a), Some(b), Some(c)] = rows.map(integers) {
                prop_assert_eq!(integer_sign_of_det(a, b, c).value(), expected);
            }
        }
    }

    #[test]
    fn predicate_a_sign_that_is_flipped_would_be_seen() {
        // The sabotage of the comparison above: a permutation with the wrong parity changes this answer.
        let rows =
            [Row([1.0, 0.0, 0.0], [0.0; 3]), Row([0.0, 1.0, 0.0], [0.0; 3]), Row([0.0, 0.0, 1.0], [0.0; 3])];
        assert_eq!(expansion_of_det(rows).sign(), Sign::Positive);
        assert_eq!(expansion_of_det([rows[1], rows[0], rows[2]]).sign(), Sign::Negative);
        assert_eq!(sign_of_det([rows[1], rows[0], rows[2]]), Sign::Negative);
    }

    #[test]
    fn predicate_needs_no_expansion_for_vertices_extruded_from_far_away() {
        // Two rows that differ in their last bits: f64 cannot tell them apart, their difference is exact.
        let light = [1e17, -3e16, 2e16];
        let rows = [
            Row([0.1, 0.2, 0.3], light),
            Row([0.7, -0.4, 0.9], light),
            Row([0.3, 0.5, -0.2], [0.1, 0.2, 0.3]),
        ];
        assert_eq!(filtered_sign_of_det(&rows), None);
        let nearer = nearer(&rows).expect("two rows share the light");
        let sign = filtered_sign_of_det(&nearer).expect("this is easy");
        assert_eq!((sign.value(), sign_of_det(rows)), (reference(rows), sign));
        // The sabotage: the difference the other way turns the sign.
        let turned = [Row(nearer[0].1, nearer[0].0), nearer[1], nearer[2]];
        assert_ne!(filtered_sign_of_det(&turned), Some(sign));
    }

    #[test]
    fn predicate_agrees_with_the_robust_crate_one_ulp_off_a_plane() {
        let coord = |p: [f32; 3]| robust::Coord3D { x: p[0], y: p[1], z: p[2] };
        let [a, b, c] = [[0.1, 0.2, 0.3], [1.7, 0.3, 0.9], [0.4, 1.9, 1.1]];
        // Around where the plane lies over (0.55, 0.7).
        let wide = |p: [f32; 3]| glam::DVec3::from(p.map(f64::from));
        let normal = (wide(b) - wide(a)).cross(wide(c) - wide(a));
        let (x, y) = (0.55_f32, 0.7_f32);
        let step = normal.x * (f64::from(x) - wide(a).x) + normal.y * (f64::from(y) - wide(a).y);
        let on_plane = (wide(a).z - step / normal.z) as f32;
        let mut seen = [0; 3];
        for ulps in -40_i32..=40 {
            let d = [x, y, f32::from_bits(on_plane.to_bits().wrapping_add_signed(ulps))];
            let ours = orient3d(a, b, c, d);
            assert_eq!(ours, Sign::of(robust::orient3d(coord(a), coord(b), coord(c), coord(d))));
            seen[(ours.value() + 1) as usize] += 1;
        }
        assert!(seen[0] > 30 && seen[2] > 30, "{seen:?}");
    }

    #[test]
    fn height_of_a_sliver_is_right_where_f64_is_wrong() {
        // A plane through the origin but for seven units of 10^19; f64 alone gets its offset wrong by its size.
        let triangle = [
            [-3_067_175.0, 580_525.0, 2_914_486.0],
            [2_535_584.0, 2_212_702.0, -3_664_925.0],
            [-1_451_934.0, 29_291.0, 1_494_139.0],
        ];
        let of_origin = height(triangle, Homogeneous::point([0.0; 3]));
        assert_eq!(of_origin.abs(), 7.0);
        assert_eq!(Sign::of(of_origin), side_of_point(triangle, [0.0; 3]));
    }

    #[test]
    fn predicate_front_is_front_for_both_kinds_of_light() {
        let face = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        assert_eq!(side_of_light(face, &Light::point([0.0, 0.0, 1.0]).unwrap()), Sign::Positive);
        assert_eq!(side_of_light(face, &Light::directional([0.0, 0.0, -1.0]).unwrap()), Sign::Positive);
        assert_eq!(side_of_light(face, &Light::point([5.0, 5.0, 0.0]).unwrap()), Sign::Zero);
        assert_eq!(side_of_light(face, &Light::directional([0.0, 0.0, 1.0]).unwrap()), Sign::Negative);
        let [a, b, c] = face;
        let above = [0.0, 0.0, 1.0];
        assert_eq!(orient3d(a, b, c, above), -side_of_light(face, &Light::point(above).unwrap()));
    }

    #[test]
    fn predicate_homogeneous_cofactors_agree_wherever_the_pivot_stands() {
        let light = Light::point([3.0, 5.0, 7.0]).unwrap();
        let [a, b, c, d] = [[0.0, 0.1, 0.2], [1.0, 0.3, 0.1], [0.2, 1.0, 0.4], [0.5, 0.6, 2.0]];
        let points = [a, b, c, d].map(Homogeneous::point);
        assert_eq!(orient3d_homogeneous(points), orient3d(a, b, c, d));
        // An even permutation of the rows keeps the sign, an odd one turns it, with a point at infinity in
        // every place.
        let far = Homogeneous::extruded(d, &light);
        let [a, b, c, _] = points;
        let sign = orient3d_homogeneous([a, b, c, far]);
        assert_ne!(sign, Sign::Zero);
        assert_eq!(orient3d_homogeneous([b, c, a, far]), sign);
        assert_eq!(orient3d_homogeneous([far, a, b, c]), -sign);
        assert_eq!(orient3d_homogeneous([a, far, b, c]), sign);
        assert_eq!(orient3d_homogeneous([a, b, far, c]), -sign);
        assert_eq!(orient3d_homogeneous([far; 4]), Sign::Zero);
    }
}
