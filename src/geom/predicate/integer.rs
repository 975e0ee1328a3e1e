//! Step 2: integer arithmetic modulo a power of two.
//!
//! The filter leaves a determinant of at most `2 · FILTER · permanent`: about 49 leading bits are known to
//! cancel. So only the remainder of the determinant is needed, modulo a power of two that is larger than
//! twice its magnitude (the idea of Hervé Brönnimann, Ioannis Emiris, Victor Pan and Sylvain Pion, *Sign
//! determination in residue number systems*, 1999, with one modulus that the machine has). Entries of `b`
//! bits give a permanent of at most `6 · 2³ᵇ`. With `FILTER < 7.01 · 2⁻⁵³`, the determinant is below
//! `2 · 7.01 · 6 · 2^(3b − 53) < 2^(3b − 46)`:
//!
//! - 36 bits: below 2⁶², which `i64` holds, wrapping;
//! - 51 bits: below 2¹⁰⁷, which `i128` holds, wrapping.

use super::Sign;
use super::filter::Row;

/// Number of bits that the entries may span: the sum with the constant of [`whole`] keeps this many.
const BITS: u32 = 51;
/// Number of bits that the entries may span for `i64`.
const FEW: u32 = 36;
/// Number of lowest bits that are 0 if the entries fit `i64`.
pub(super) const SPARE: u32 = BITS - FEW;

/// The entries as differences in `f64`, and whether all of them are exact.
#[inline(always)]
fn entries(rows: [Row; 3]) -> ([f64; 9], bool) {
    let mut entries = [0.0; 9];
    let mut lost = 0;
    for i in 0..3 {
        for j in 0..3 {
            let (u, v) = (f64::from(rows[i].0[j]), f64::from(rows[i].1[j]));
            let difference = u - v;
            // Of the two checks, the one that subtracts the larger operand from the sum is exact (Dekker's
            // fast two-sum). So both find zero if and only if nothing was lost.
            lost |= ((u - difference) - v).to_bits() | ((difference + v) - u).to_bits();
            entries[3 * i + j] = difference;
        }
    }
    (entries, is_zero(lost))
}

/// Whether `bits` holds nothing but signs of zeros.
#[inline(always)]
fn is_zero(bits: u64) -> bool {
    bits << 1 == 0
}

/// The sign of a determinant that the filter could not decide. `None` if a difference is not exact in `f64`,
/// or if the entries span more than 51 bits.
#[inline(always)]
pub(super) fn sign_of_det(rows: [Row; 3]) -> Option<Sign> {
    let (entries, exact) = entries(rows);
    if exact { sign_of_entries(&entries, SPARE) } else { None }
}

/// As [`sign_of_det`], for rows and columns of different magnitudes. Every row, then every column, is scaled
/// by a power of two of its own. Scaling keeps the sign and the bits of the permanent.
pub(super) fn sign_of_scaled_det(rows: [Row; 3]) -> Option<Sign> {
    let (mut entries, exact) = entries(rows);
    if !exact {
        return None;
    }
    scale_lines(&mut entries, |line, scale, entries| line.iter().for_each(|&i| entries[i] *= scale));
    sign_of_entries(&entries, SPARE)
}

/// Calls `apply` to scale every row, then every column, by the power of two that brings its largest entry
/// into 1 ..< 2.
#[inline(always)]
fn scale_lines(entries: &mut [f64; 9], apply: impl Fn([usize; 3], f64, &mut [f64; 9])) {
    for (start, step) in [(0, 1), (3, 1), (6, 1), (0, 3), (1, 3), (2, 3)] {
        let line = [start, start + step, start + 2 * step];
        // The largest entry is 0 (a case that the filter decides), or in 2^-149 ..= 2^129 for a row, or in
        // 2^-278 ..< 2 for a column, whose rows are already scaled. The scale and the products are normal
        // numbers, so nothing is rounded.
        let largest = line.iter().map(|&i| entries[i].abs()).fold(0.0, f64::max);
        let exponent = largest.to_bits() >> 52;
        let scale = f64::from_bits((2 * 1023 - exponent.max(1)) << 52);
        apply(line, scale, entries);
    }
}

/// The sign of a determinant of exact differences. The `spare` lowest of their 51 bits must be 0 for `i64`.
#[inline(always)]
fn sign_of_entries(entries: &[f64; 9], spare: u32) -> Option<Sign> {
    let (mut whole, bits) = whole(entries)?;
    if bits & ((1 << spare) - 1) == 0 {
        whole.iter_mut().for_each(|x| *x >>= spare);
        Some(Sign::of(det_64(whole)))
    } else {
        Some(Sign::of(det_128(whole)))
    }
}

/// The entries as integers below 2⁵¹ in a common unit, and the bitwise or of all of them.
#[inline(always)]
fn whole(entries: &[f64; 9]) -> Option<([i64; 9], i64)> {
    // Without `max`, which also tests for NaN, and without `map`: closures on arrays are not always inlined.
    let larger = |x: f64, y: f64| if x.abs() > y.abs() { x.abs() } else { y.abs() };
    let [a, b, c, d, e, f, g, h, i] = *entries;
    let largest = larger(larger(larger(a, b), larger(c, d)), larger(larger(larger(e, f), larger(g, h)), i));
    // The largest entry is below 2^(e+1). The sum of an entry and 1.5 · 2^(e+2) lies in 2^(e+2) ..= 2^(e+3),
    // where numbers are multiples of 2^(e-50). The bits of the sum count those multiples.
    let exponent = largest.to_bits() >> 52;
    let unit = f64::from_bits(((exponent + 2) << 52) | (1 << 51));
    let mut whole = [0_i64; 9];
    let (mut lost, mut bits) = (0, 0);
    for i in 0..9 {
        let sum = entries[i] + unit;
        lost |= ((sum - unit) - entries[i]).to_bits();
        whole[i] = (sum.to_bits() as i64).wrapping_sub(unit.to_bits() as i64);
        bits |= whole[i];
    }
    is_zero(lost).then_some((whole, bits))
}

/// The determinant modulo 2⁶⁴.
#[inline(always)]
fn det_64([ax, ay, az, bx, by, bz, cx, cy, cz]: [i64; 9]) -> i64 {
    let minor = |p: i64, q: i64, r: i64, s: i64| p.wrapping_mul(s).wrapping_sub(q.wrapping_mul(r));
    let (x, y, z) = (minor(bx, by, cx, cy), minor(cx, cy, ax, ay), minor(ax, ay, bx, by));
    az.wrapping_mul(x).wrapping_add(bz.wrapping_mul(y)).wrapping_add(cz.wrapping_mul(z))
}

/// The determinant modulo 2¹²⁸. Minors of entries below 2⁵¹ are below 2¹⁰³.
#[inline(always)]
fn det_128([ax, ay, az, bx, by, bz, cx, cy, cz]: [i64; 9]) -> i128 {
    let minor =
        |p: i64, q: i64, r: i64, s: i64| i128::from(p) * i128::from(s) - i128::from(q) * i128::from(r);
    let (x, y, z) = (minor(bx, by, cx, cy), minor(cx, cy, ax, ay), minor(ax, ay, bx, by));
    let times = |x: i64, minor: i128| i128::from(x).wrapping_mul(minor);
    times(az, x).wrapping_add(times(bz, y)).wrapping_add(times(cz, z))
}

/// Whether [`sign_of_det`] answers in `i64`.
#[cfg(test)]
pub(super) fn is_small(rows: [Row; 3]) -> bool {
    whole(&entries(rows).0).is_some_and(|(_, bits)| bits & ((1 << SPARE) - 1) == 0)
}

/// As [`sign_of_det`] with another number of spare bits, whether or not the differences are exact: a fault
/// that a test must catch.
#[cfg(test)]
pub(super) fn sign_without_checks(rows: [Row; 3], spare: u32) -> Option<Sign> {
    sign_of_entries(&entries(rows).0, spare)
}

/// As [`sign_of_scaled_det`] with a fault in the scaling of a row or column: a fault that a test must catch.
#[cfg(test)]
pub(super) fn sign_of_scaled_badly(
    rows: [Row; 3],
    apply: impl Fn([usize; 3], f64, &mut [f64; 9]),
) -> Option<Sign> {
    let (mut entries, exact) = entries(rows);
    if !exact {
        return None;
    }
    scale_lines(&mut entries, apply);
    sign_of_entries(&entries, SPARE)
}
