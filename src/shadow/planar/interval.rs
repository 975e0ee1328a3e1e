//! Intervals that contain a real number whatever was rounded: bounds of flattened faces.

use std::ops::{Add, Mul, Sub};

/// What a flattening computes with: `f64`, rounded, or [`Interval`], certain.
pub(super) trait Number: Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> {
    /// The number itself, without an error.
    fn of(x: f64) -> Self;

    /// The quotient of two numbers, moved to 0 … 1.
    fn share_of(self, whole: Self) -> Self;

    /// Whether the number is below zero, for certain.
    fn is_negative(self) -> bool;

    /// Whether the number is zero or above, for certain.
    fn is_not_negative(self) -> bool;
}

impl Number for f64 {
    fn of(x: f64) -> Self {
        x
    }

    fn share_of(self, whole: Self) -> Self {
        (self / whole).clamp(0.0, 1.0)
    }

    fn is_negative(self) -> bool {
        self < 0.0
    }

    fn is_not_negative(self) -> bool {
        self >= 0.0
    }
}

/// All real numbers from `low` to `high`. Every operation is rounded outwards.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Interval {
    pub(super) low: f64,
    pub(super) high: f64,
}

impl Interval {
    const ALL: Self = Self { low: f64::NEG_INFINITY, high: f64::INFINITY };

    fn outwards(low: f64, high: f64) -> Self {
        if low.is_nan() || high.is_nan() {
            return Self::ALL;
        }
        Self { low: low.next_down(), high: high.next_up() }
    }

    fn around(values: [f64; 4]) -> Self {
        if values.iter().any(|value| value.is_nan()) {
            return Self::ALL;
        }
        let low = values.iter().fold(f64::INFINITY, |least, &x| least.min(x));
        Self::outwards(low, values.iter().fold(f64::NEG_INFINITY, |most, &x| most.max(x)))
    }

    /// The part that is not negative; of a number below zero, zero.
    pub(super) fn at_least_zero(self) -> Self {
        Self { low: self.low.max(0.0), high: self.high.max(0.0) }
    }

    /// Whether the number is above zero, for certain.
    pub(super) fn is_positive(self) -> bool {
        self.low > 0.0
    }

    /// The quotient by a number that is not negative. Near a divisor of zero it has no bound on the side of
    /// its sign.
    pub(super) fn over(self, divisor: Self) -> Self {
        let Self { low, high } = divisor;
        if low > 0.0 {
            return Self::around([self.low / low, self.low / high, self.high / low, self.high / high]);
        }
        match (self.low > 0.0, self.high < 0.0) {
            (true, _) => Self { low: (self.low / high).next_down(), high: f64::INFINITY },
            (_, true) => Self { low: f64::NEG_INFINITY, high: (self.high / high).next_up() },
            _ => Self::ALL,
        }
    }
}

impl Number for Interval {
    fn of(x: f64) -> Self {
        Self { low: x, high: x }
    }

    fn share_of(self, whole: Self) -> Self {
        let share = match whole.low > 0.0 || whole.high < 0.0 {
            true => {
                let Self { low, high } = whole;
                Self::around([self.low / low, self.low / high, self.high / low, self.high / high])
            }
            false => Self::ALL,
        };
        Self { low: share.low.clamp(0.0, 1.0), high: share.high.clamp(0.0, 1.0) }
    }

    fn is_negative(self) -> bool {
        self.high < 0.0
    }

    fn is_not_negative(self) -> bool {
        self.low >= 0.0
    }
}

impl Add for Interval {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self::outwards(self.low + other.low, self.high + other.high)
    }
}

impl Sub for Interval {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        Self::outwards(self.low - other.high, self.high - other.low)
    }
}

impl Mul for Interval {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        Self::around([
            self.low * other.low,
            self.low * other.high,
            self.high * other.low,
            self.high * other.high,
        ])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::SplitMix64;

    /// Fractions of small integers have exact values: the interval of a rounded expression contains its exact
    /// value, which an expression without outward rounding misses.
    #[test]
    fn interval_contains_the_real_value_and_rounding_alone_does_not() {
        let mut random = SplitMix64(1);
        let mut missed = 0;
        for _ in 0..2000 {
            let mut whole = || 1.0 + random.below(1000) as f64;
            let (a, b, c) = (whole(), whole(), whole());
            // (a/b + c/b)·b − (a + c) = 0.
            let of = Interval::of;
            let found = (of(a).over(of(b)) + of(c).over(of(b))) * of(b) - of(a + c);
            assert!(found.low <= 0.0 && found.high >= 0.0 && found.high - found.low < 1e-11, "{found:?}");
            missed += usize::from((a / b + c / b) * b != a + c);
        }
        assert!(missed > 100, "{missed}");
    }

    #[test]
    fn interval_by_nothing_has_no_bound_on_its_own_side() {
        let by = Interval { low: 0.0, high: 2.0 };
        let quotient = |low, high| Interval { low, high }.over(by);
        assert!(quotient(4.0, 6.0).low > 1.99 && quotient(4.0, 6.0).high == f64::INFINITY);
        assert!(quotient(-6.0, -4.0).high < -1.99 && quotient(-6.0, -4.0).low == f64::NEG_INFINITY);
        assert_eq!(quotient(-1.0, 1.0), Interval::ALL);
        let share = Interval::of(1.0).share_of(Interval { low: -1.0, high: 3.0 });
        assert_eq!(share, Interval { low: 0.0, high: 1.0 });
    }
}
