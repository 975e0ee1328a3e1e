//! How large errors are: mean, 99th percentile, maximum.

use super::{Errors, Fraction};

/// The magnitudes of errors, as they are collected.
#[derive(Default)]
pub(super) struct Magnitudes {
    /// |value − truth| of every judged sample.
    differences: Vec<f32>,
    sum: f64,
    sum_signed: f64,
    /// Sum and number in penumbrae.
    penumbra: (f64, u64),
    pub(super) off: u64,
}

impl Magnitudes {
    pub(super) fn add(&mut self, value: f32, truth: Fraction) {
        let difference = f64::from(value) - truth.visible;
        let size = difference.abs();
        self.differences.push(size as f32);
        self.sum += size;
        self.sum_signed += difference;
        if truth.visible > 1.0 / 256.0 && truth.visible < 255.0 / 256.0 {
            self.penumbra.0 += size;
            self.penumbra.1 += 1;
        }
        // A value is the truth rounded to the nearest f32 of at most 1.
        self.off += u64::from(size > truth.bound + f64::from(f32::EPSILON) / 4.0);
    }

    pub(super) fn finish(mut self, errors: &mut Errors) {
        let count = errors.judged.max(1) as f64;
        (errors.mean, errors.mean_signed) = (self.sum / count, self.sum_signed / count);
        (errors.p99, errors.max) = percentile_and_max(&mut self.differences);
        let (sum, count) = self.penumbra;
        errors.penumbra_mean = (count > 0).then(|| sum / count as f64);
    }
}

/// The 99th percentile (the value that 99 of 100 do not exceed), and the maximum.
pub(super) fn percentile_and_max(differences: &mut [f32]) -> (f64, f64) {
    let Some(last) = differences.len().checked_sub(1) else { return (0.0, 0.0) };
    let at = (differences.len() * 99).div_ceil(100) - 1;
    let (_, p99, above) = differences.select_nth_unstable_by(at, f32::total_cmp);
    let p99 = *p99;
    let max = if at == last { p99 } else { above.iter().fold(p99, |most, &x| most.max(x)) };
    (f64::from(p99), f64::from(max))
}
