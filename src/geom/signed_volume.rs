//! Signed volume of a triangle mesh, with an exact sign.
//!
//! Six times the volume is the sum of `det [a; b; c]` over the faces. The sum is computed in `f64` with a
//! running error bound. If the bound does not decide the sign, [`ExactVolume`] sums integer multiples of
//! 2⁻⁴⁴⁷.

use super::predicate::Sign;

/// The sum in `f64` relative to a reference point, with a bound on its error.
#[derive(Clone, Copy, Debug)]
pub(crate) struct VolumeSum {
    reference: [f64; 3],
    sum: f64,
    /// Sum of the magnitudes of all products, an upper bound of Σ |det|.
    permanent: f64,
    terms: u32,
}

impl VolumeSum {
    /// An empty sum. For a closed surface any reference point gives the same volume; one on the surface keeps
    /// the terms small.
    pub(crate) fn new(reference: [f64; 3]) -> Self {
        Self { reference, sum: 0.0, permanent: 0.0, terms: 0 }
    }

    #[inline]
    pub(crate) fn add(&mut self, corners: [[f32; 3]; 3]) {
        let r = self.reference;
        let from = |p: [f32; 3]| [f64::from(p[0]) - r[0], f64::from(p[1]) - r[1], f64::from(p[2]) - r[2]];
        let (a, b, c) = (from(corners[0]), from(corners[1]), from(corners[2]));
        let (bxcy, cxby) = (b[0] * c[1], c[0] * b[1]);
        let (cxay, axcy) = (c[0] * a[1], a[0] * c[1]);
        let (axby, bxay) = (a[0] * b[1], b[0] * a[1]);
        self.sum += a[2] * (bxcy - cxby) + b[2] * (cxay - axcy) + c[2] * (axby - bxay);
        self.permanent += (bxcy.abs() + cxby.abs()) * a[2].abs()
            + (cxay.abs() + axcy.abs()) * b[2].abs()
            + (axby.abs() + bxay.abs()) * c[2].abs();
        self.terms += 1;
    }

    pub(crate) fn value(&self) -> f64 {
        self.sum / 6.0
    }

    /// The sign, if the error cannot change it.
    ///
    /// The reference point must be exact in `f32`. A term errs by at most 8ε times its permanent (the bound
    /// of the predicate's filter, rounded up). Adding n numbers one after the other errs by at most (n − 1)ε
    /// times the sum of their magnitudes (Nicholas J. Higham, *Accuracy and Stability of Numerical
    /// Algorithms*, 2002, section 4.2). The permanents are summed with the same relative error; doubling the
    /// bound covers this error for all n that 32 bits can count.
    pub(crate) fn sign(&self) -> Option<Sign> {
        let epsilon = f64::EPSILON / 2.0;
        let bound = 2.0 * (8.0 + f64::from(self.terms)) * epsilon * self.permanent;
        if self.sum > bound {
            Some(Sign::Positive)
        } else if self.sum < -bound {
            Some(Sign::Negative)
        } else {
            None
        }
    }
}

/// The same sum relative to the origin, as an integer multiple of 2⁻⁴⁴⁷: digits of 32 bits, lowest first,
/// with room for carries (Ulrich Kulisch's long accumulator).
///
/// A product of three `f32` has at most 72 bits and is below 2³⁸⁴, so 831 bits hold any product. 32 digits
/// hold the sum over 2³² faces of six products each.
#[derive(Clone, Debug)]
pub(crate) struct ExactVolume {
    digits: [i64; 32],
    pending: u32,
}

impl ExactVolume {
    pub(crate) fn new() -> Self {
        Self { digits: [0; 32], pending: 0 }
    }

    pub(crate) fn add(&mut self, [a, b, c]: [[f32; 3]; 3]) {
        for (i, j, k, sign) in
            [(0, 1, 2, 1), (1, 2, 0, 1), (2, 0, 1, 1), (0, 2, 1, -1), (1, 0, 2, -1), (2, 1, 0, -1)]
        {
            self.add_product(sign, [a[i], b[j], c[k]]);
        }
    }

    fn add_product(&mut self, mut sign: i64, factors: [f32; 3]) {
        let (mut mantissa, mut shift) = (1_u128, 0);
        for factor in factors {
            let bits = factor.to_bits();
            let (exponent, fraction) = (bits >> 23 & 0xff, bits & 0x7f_ffff);
            mantissa *= u128::from(if exponent == 0 { fraction } else { fraction | 0x80_0000 });
            shift += exponent.max(1) as usize - 1;
            if factor.is_sign_negative() {
                sign = -sign;
            }
        }
        mantissa <<= shift % 32;
        for digit in &mut self.digits[shift / 32..shift / 32 + 4] {
            *digit += sign * i64::from(mantissa as u32);
            mantissa >>= 32;
        }
        self.pending += 1;
        if self.pending == 1 << 30 {
            self.carry(); // each product has added less than 2³² to a digit
        }
    }

    /// Propagates the carries: all digits but the last are then in 0 .. 2³².
    fn carry(&mut self) {
        self.pending = 0;
        let mut carry = 0;
        let (last, digits) = self.digits.split_last_mut().expect("there are 32");
        for digit in digits {
            *digit += carry;
            carry = *digit >> 32;
            *digit &= 0xffff_ffff;
        }
        *last += carry;
    }

    pub(crate) fn sign(mut self) -> Sign {
        self.carry();
        let [rest @ .., last] = self.digits;
        match last.signum() {
            -1 => Sign::Negative,
            0 if rest.iter().all(|&digit| digit == 0) => Sign::Zero,
            _ => Sign::Positive,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::predicate::orient3d;

    fn sign(faces: &[[[f32; 3]; 3]]) -> Sign {
        let mut exact = ExactVolume::new();
        faces.iter().for_each(|&face| exact.add(face));
        exact.sign()
    }

    fn tetrahedron([a, b, c, d]: [[f32; 3]; 4]) -> [[[f32; 3]; 3]; 4] {
        [[a, b, c], [a, d, b], [b, d, c], [c, d, a]]
    }

    #[test]
    fn volume_of_a_tetrahedron_has_the_sign_of_its_orientation() {
        let mut state = 1_u32;
        let mut next = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let scale = [1e-38, 1.0, 1.0, 3e38][(state >> 3) as usize % 4];
            ((state >> 8) as f32 / 8_388_608.0 - 1.0) * scale
        };
        for _ in 0..2000 {
            let points: [[f32; 3]; 4] = std::array::from_fn(|_| std::array::from_fn(|_| next()));
            let faces = tetrahedron(points);
            let expected = orient3d(points[0], points[1], points[2], points[3]);
            assert_eq!(sign(&faces), expected, "{points:?}");
            let inverted = faces.map(|[a, b, c]| [a, c, b]);
            assert_eq!(sign(&inverted), -expected);
            let mut sum = VolumeSum::new(points[0].map(f64::from));
            faces.iter().for_each(|&face| sum.add(face));
            assert!(sum.sign().is_none_or(|sign| sign == expected));
        }
    }

    #[test]
    fn volume_of_a_double_sided_sheet_is_exactly_zero() {
        let [a, b, c] = [[0.1, 0.2, 0.3], [1e30, -0.7, 1e-30], [3.3, 1e-40, -5e10]];
        assert_eq!(sign(&[[a, b, c], [a, c, b]]), Sign::Zero);
        assert_eq!(sign(&[[a, b, c], [c, b, a], [a, b, c]]), sign(&[[a, b, c]]));
    }

    #[test]
    fn volume_that_forgets_a_carry_would_be_seen() {
        let one = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let tiny = one.map(|row| row.map(|x| -x * f32::from_bits(1)));
        let mut exact = ExactVolume::new();
        exact.add(one);
        exact.add(tiny);
        assert_eq!(exact.clone().sign(), Sign::Positive); // 1 − 2⁻⁴⁴⁷
        exact.add([one[1], one[0], one[2]]);
        assert_eq!(exact.clone().sign(), Sign::Negative); // −2⁻⁴⁴⁷
        exact.digits[31] = 0; // fault injected: the sign is in the digit that only carries reach
        exact.carry();
        exact.digits[31] = 0;
        assert_eq!(exact.sign(), Sign::Positive);
    }
}
