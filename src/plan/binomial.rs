//! Confidence bounds of a fraction, from independent draws: Clopper and Pearson, *The Use of Confidence or
//! Fiducial Limits Illustrated in the Case of the Binomial*, Biometrika 26, 1934.
//!
//! The bounds are those `p` at which as few wrong draws, or as many, have the probability `alpha`. This
//! probability is a sum of the binomial distribution, which is the regularized incomplete beta function
//! `I(1−p; n−k, k+1)`.
//!
//! # Effect of rounding
//!
//! A term of the sum is computed through the logarithms of factorials. For at most 2²⁶ draws these are below
//! 2³¹, and the few of them that are added err by less than 2³¹ · 2⁻⁵² together with the series' remainder.
//! So a probability is off by less than the factor 1 ± [`SLACK`]. The bounds are those of `alpha` made
//! smaller by it, and are rounded outwards by one step of the search.

/// See the head of this file.
const SLACK: f64 = 1.0 / (1 << 20) as f64;

/// The largest fraction that is not improbable at `alpha` if `wrong` of `draws` are wrong: 1 without draws.
///
/// At most 2²⁶ draws.
pub(super) fn upper(wrong: u64, draws: u64, alpha: f64) -> f64 {
    if wrong >= draws {
        return 1.0;
    }
    let alpha = alpha * (1.0 - SLACK);
    let (mut low, mut high) = (wrong as f64 / draws as f64, 1.0);
    // The probability of so few falls from more than alpha to 0.
    loop {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            return high;
        }
        match at_most(wrong, draws, middle) > alpha {
            true => low = middle,
            false => high = middle,
        }
    }
}

/// The least fraction that is not improbable at `alpha` if `wrong` of `draws` are wrong.
pub(super) fn lower(wrong: u64, draws: u64, alpha: f64) -> f64 {
    let rest = upper(draws - wrong.min(draws), draws, alpha);
    // Rounded down: 1 − rest is exact above one half, and otherwise errs by half a step of 1.
    if wrong == 0 || draws == 0 { 0.0 } else { (1.0 - rest - f64::EPSILON).max(0.0) }
}

/// The probability of `k` or fewer successes of `n`, for `k < n` and `k/n < p < 1`: the terms grow up to the
/// `k`-th, so they are summed from there down.
fn at_most(k: u64, n: u64, p: f64) -> f64 {
    let (count, all) = (k as f64, n as f64);
    let ways = ln_factorial(n) - ln_factorial(k) - ln_factorial(n - k);
    let last = (ways + count * p.ln() + (all - count) * (-p).ln_1p()).exp();
    let odds = (1.0 - p) / p;
    let (mut term, mut sum) = (1.0, 1.0);
    for i in (1..=k).rev() {
        let i = i as f64;
        term *= i / (all - i + 1.0) * odds;
        sum += term;
        if term < f64::EPSILON * sum {
            break;
        }
    }
    last * sum
}

/// `ln n!`: the product below 32, from there Stirling's series, whose remainder is below 2⁻⁵².
fn ln_factorial(n: u64) -> f64 {
    if n < 32 {
        return (2..=n).map(|i| i as f64).product::<f64>().ln();
    }
    let x = n as f64;
    let inverse = 1.0 / x;
    let square = inverse * inverse;
    let series = inverse * (1.0 / 12.0 - square * (1.0 / 360.0 - square * (1.0 / 1260.0 - square / 1680.0)));
    (x + 0.5) * x.ln() - x + 0.5 * std::f64::consts::TAU.ln() + series
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The same probability, summed from the other end.
    fn tail(k: u64, n: u64, p: f64) -> f64 {
        let (mut term, mut sum) = ((1.0 - p).powf(n as f64), 0.0);
        for i in 0..=k {
            sum += term;
            term *= (n - i) as f64 / (i + 1) as f64 * p / (1.0 - p);
        }
        sum
    }

    #[test]
    fn binomial_bounds_are_where_the_sums_say_and_outside_of_them() {
        for (wrong, draws) in [(0, 1), (0, 299), (1, 10), (3, 300), (9, 10), (40, 400), (150, 300), (31, 64)]
        {
            for alpha in [0.05, 0.01, 0.001] {
                let p = upper(wrong, draws, alpha);
                let sum = tail(wrong, draws, p);
                assert!(sum <= alpha && sum > alpha * (1.0 - 4.0 * SLACK), "{wrong} of {draws}: {p}: {sum}");
                if wrong > 0 {
                    let p = lower(wrong, draws, alpha);
                    let sum = 1.0 - tail(wrong - 1, draws, p);
                    assert!(sum <= alpha && sum > alpha * (1.0 - 1e-4), "{wrong} of {draws}: {p}: {sum}");
                }
            }
        }
        // The rule of three, the ends, and no draws.
        assert!((upper(0, 300, 0.05) * 100.0 - 1.0).abs() < 0.01);
        assert_eq!([upper(5, 5, 0.01), upper(0, 0, 0.01)], [1.0; 2]);
        assert_eq!([lower(0, 9, 0.01), lower(0, 0, 0.01)], [0.0; 2]);
    }

    #[test]
    fn binomial_bounds_of_many_draws_close_in() {
        let mut widths = Vec::new();
        for power in [8, 14, 20, 26] {
            let draws = 1 << power;
            let [low, high] = [lower(draws / 4, draws, 0.01), upper(draws / 4, draws, 0.01)];
            assert!(low < 0.25 && high > 0.25, "{low} {high}");
            widths.push(high - low);
        }
        // A width falls with the root of the draws: by eight per step.
        assert!(widths.windows(2).all(|pair| (7.0..9.0).contains(&(pair[0] / pair[1]))), "{widths:?}");
        assert!((ln_factorial(32) - (2..=32).map(|i| f64::from(i).ln()).sum::<f64>()).abs() < 1e-12);
    }
}
