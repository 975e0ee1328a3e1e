//! Confidence bounds of a fraction that was sampled.

/// Confidence of the bounds in a plan: 95 %.
pub(super) const CONFIDENCE: f64 = 0.95;

/// The upper confidence bound of a fraction, when `wrong` of `n` samples were wrong: the largest p for which
/// `wrong` or fewer of n are not improbable (Clopper and Pearson 1934). 1 without samples.
pub(super) fn upper_bound(wrong: usize, n: usize, confidence: f64) -> f64 {
    if wrong >= n {
        return 1.0;
    }
    let (k, n) = (wrong as f64, n as f64);
    // ln of the number of ways to choose k of n.
    let choices: f64 = (0..wrong).map(|i| ((n - i as f64) / (i as f64 + 1.0)).ln()).sum();
    // The probability of k or fewer, for p > k/n: the terms fall at least geometrically from the k-th on.
    let at_most = |p: f64| {
        let (mut term, mut sum) = (1.0, 1.0);
        for i in (1..=wrong).rev() {
            term *= i as f64 / (n - i as f64 + 1.0) * (1.0 - p) / p;
            sum += term;
            if term < sum * f64::EPSILON {
                break;
            }
        }
        (choices + k * p.ln() + (n - k) * (1.0 - p).ln()).exp() * sum
    };
    if wrong == 0 {
        return 1.0 - ((1.0 - confidence).ln() / n).exp();
    }
    let (mut low, mut high) = (k / n, 1.0);
    // Halved until the two are neighbors, and never more often than a double has bits.
    for _ in 0..64 {
        let middle = 0.5 * (low + high);
        match at_most(middle) > 1.0 - confidence {
            true => low = middle,
            false => high = middle,
        }
    }
    high
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn confidence_bound_is_where_so_few_wrong_ones_are_improbable() {
        // The tail is summed term by term, from the smallest number up.
        let tail = |wrong: usize, n: usize, p: f64| -> f64 {
            let (mut term, mut sum) = ((1.0 - p).powi(n as i32), 0.0);
            for i in 0..=wrong {
                sum += term;
                term *= (n - i) as f64 / (i as f64 + 1.0) * p / (1.0 - p);
            }
            sum
        };
        for (wrong, n) in [(0, 1), (0, 59), (0, 300), (1, 10), (3, 300), (9, 10), (40, 400), (150, 300)] {
            let bound = upper_bound(wrong, n, CONFIDENCE);
            assert!((tail(wrong, n, bound) - 0.05).abs() < 1e-9, "{wrong} of {n}: {bound}");
            assert!(bound > wrong as f64 / n as f64);
        }
        // The rule of three, and the ends.
        assert!((upper_bound(0, 300, CONFIDENCE) * 100.0 - 1.0).abs() < 0.01);
        assert_eq!((upper_bound(5, 5, CONFIDENCE), upper_bound(0, 0, CONFIDENCE)), (1.0, 1.0));
        // Many samples: close to the fraction itself, and no underflow.
        let bound = upper_bound(8192, 16384, CONFIDENCE);
        assert!((0.5..0.51).contains(&bound), "{bound}");
    }
}
