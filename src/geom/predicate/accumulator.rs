//! Step 3: the six products as integer multiples of 2⁻⁴⁴⁷, summed without rounding.
//!
//! A fixed-point accumulator as long as the range of the products (Ulrich Kulisch, *Computer Arithmetic and
//! Validity*, 2013, section 8). An entry `u − v` is one factor of at most 42 bits, or two factors of 24. So a
//! product is below 2¹²⁶, and a shift aligns it with the accumulator. At most 6 · 8 products are summed.

use super::Sign;
use super::filter::Row;

/// Number of 64-bit digits of a partial sum. A product is below 2³⁸⁷, and a sum of 48 products is below 2³⁹³:
/// in units of 2⁻⁴⁴⁷, below 2⁸⁴⁰. The shift of a product is at most 3 · 253 = 759, so its three digits start
/// at the twelfth digit or before.
const DIGITS: usize = 14;

/// A factor `mantissa · 2^(shift − 149)`, with a mantissa below 2⁴².
#[derive(Clone, Copy, Default)]
pub(super) struct Part {
    mantissa: i64,
    shift: u32,
}

/// An exact sum, kept as the magnitudes of its positive and of its negative terms, each an integer multiple
/// of 2⁻⁴⁴⁷.
pub(super) struct Accumulator {
    piles: [[u64; DIGITS]; 2],
}

impl Accumulator {
    /// The exact determinant.
    pub(super) fn of_det(rows: &[Row; 3]) -> Self {
        Self::of_det_of(rows, parts)
    }

    /// As [`Accumulator::of_det`], with entries split into factors by `parts`.
    pub(super) fn of_det_of(rows: &[Row; 3], parts: impl Fn(f32, f32) -> [Part; 2]) -> Self {
        let entries = rows.map(|Row(u, v)| [0, 1, 2].map(|i| parts(u[i], v[i])));
        let mut sum = Self { piles: [[0; DIGITS]; 2] };
        for (columns, odd) in [
            ([0, 1, 2], false),
            ([1, 2, 0], false),
            ([2, 0, 1], false),
            ([0, 2, 1], true),
            ([1, 0, 2], true),
            ([2, 1, 0], true),
        ] {
            for x in present(&entries[0][columns[0]]) {
                for y in present(&entries[1][columns[1]]) {
                    for z in present(&entries[2][columns[2]]) {
                        sum.add(x, y, z, odd);
                    }
                }
            }
        }
        sum
    }

    #[inline]
    fn add(&mut self, x: &Part, y: &Part, z: &Part, odd: bool) {
        // The product of the first two has at most 84 bits, that of all three at most 126.
        let product = i128::from(x.mantissa) * i128::from(y.mantissa) * i128::from(z.mantissa);
        let shift = x.shift + y.shift + z.shift;
        let (digit, bit) = ((shift / 64) as usize, shift % 64);
        let pile = &mut self.piles[usize::from((product < 0) != odd)];
        let size = product.unsigned_abs();
        let (low, high) = (size << bit, (size >> 1) >> (127 - bit));
        let mut carry = false;
        for (digit, part) in pile[digit..].iter_mut().zip([low as u64, (low >> 64) as u64, high as u64]) {
            let (sum, first) = digit.overflowing_add(part);
            let (sum, second) = sum.overflowing_add(u64::from(carry));
            (*digit, carry) = (sum, first | second);
        }
        let mut next = digit + 3;
        while carry {
            (pile[next], carry) = pile[next].overflowing_add(1);
            next += 1;
        }
    }

    /// The sign of the sum: the comparison of the two partial sums.
    pub(super) fn sign(&self) -> Sign {
        let [added, taken] = &self.piles;
        for i in (0..DIGITS).rev() {
            if added[i] != taken[i] {
                return if added[i] > taken[i] { Sign::Positive } else { Sign::Negative };
            }
        }
        Sign::Zero
    }

    /// The sum in `f64`, with a relative error of at most 2⁻⁵⁰.
    pub(super) fn value(&self) -> f64 {
        let [added, taken] = &self.piles;
        let (sign, large, small) = match self.sign() {
            Sign::Zero => return 0.0,
            Sign::Positive => (1.0, added, taken),
            Sign::Negative => (-1.0, taken, added),
        };
        let mut value = 0.0;
        let mut borrow = false;
        let mut unit = f64::from_bits((1023 - 447) << 52);
        for (&large, &small) in large.iter().zip(small) {
            let (digit, first) = large.overflowing_sub(small);
            let (digit, second) = digit.overflowing_sub(u64::from(borrow));
            borrow = first | second;
            value += digit as f64 * unit; // from the lowest digit up
            unit *= 2.0_f64.powi(64);
        }
        sign * value
    }
}

/// The nonzero factors.
#[inline]
fn present(parts: &[Part; 2]) -> impl Iterator<Item = &Part> {
    parts.iter().filter(|part| part.mantissa != 0)
}

/// `u − v` as at most two factors: one if `u` and `v` are so close in exponent that a mantissa holds the
/// difference.
pub(super) fn parts(u: f32, v: f32) -> [Part; 2] {
    let (u, v) = (part(u), part(-v));
    if u.mantissa == 0 {
        return [v, Part::default()];
    }
    if v.mantissa == 0 {
        return [u, Part::default()];
    }
    let shift = u.shift.min(v.shift);
    if u.shift.max(v.shift) - shift > 17 {
        return [u, v];
    }
    let at = |part: Part| part.mantissa << (part.shift - shift);
    [Part { mantissa: at(u) + at(v), shift }, Part::default()]
}

/// A number as its 24-bit mantissa and its shift.
fn part(x: f32) -> Part {
    let bits = x.to_bits();
    let (exponent, fraction) = ((bits >> 23) & 0xff, i64::from(bits & 0x7f_ffff));
    let size = if exponent == 0 { fraction } else { fraction | 0x80_0000 };
    Part { mantissa: if x.is_sign_negative() { -size } else { size }, shift: exponent.max(1) - 1 }
}
