//! Points on the unit circle, the same bits on every platform.

use std::f64::consts::FRAC_PI_4;

/// Cosine and sine of `step / steps` of a full turn, within a few units in the last place.
///
/// Exact at multiples of a quarter turn, and bit-symmetric: mirrored angles have mirrored values. The angle
/// is reduced to an eighth of a turn in integers, then both series are summed to below 2⁻⁵⁸ of their first
/// term.
///
/// # Panics
///
/// Panics if `steps` is zero.
pub(super) fn turn(step: u64, steps: u64) -> [f64; 2] {
    let eighths = 8 * (step % steps);
    let (octant, rest) = (eighths / steps, eighths % steps);
    // Odd octants run backwards, so that every octant starts at an axis.
    let rest = if octant % 2 == 0 { rest } else { steps - rest };
    let x = rest as f64 / steps as f64 * FRAC_PI_4;
    let (mut cos, mut sin) = (1.0, 1.0);
    // Horner's scheme from the smallest term: xᵏ/k! for k up to 19 and x ≤ π/4.
    for k in (1..=9).rev() {
        let k = f64::from(k);
        cos = 1.0 - x * x * cos / ((2.0 * k - 1.0) * (2.0 * k));
        sin = 1.0 - x * x * sin / ((2.0 * k) * (2.0 * k + 1.0));
    }
    let (c, s) = (cos, x * sin);
    match octant {
        0 => [c, s],
        1 => [s, c],
        2 => [-s, c],
        3 => [-c, s],
        4 => [-c, -s],
        5 => [-s, -c],
        6 => [s, -c],
        _ => [c, -s],
    }
}

#[cfg(test)]
mod tests {
    use super::turn;

    #[test]
    fn turn_equals_the_platform_sine_and_cosine() {
        for steps in [1, 2, 3, 4, 7, 8, 360, 1009] {
            for step in 0..2 * steps {
                let angle = std::f64::consts::TAU * step as f64 / steps as f64;
                let [c, s] = turn(step, steps);
                // The naive angle itself is rounded: up to 4π with an error of an ulp or two of that.
                assert!((c - angle.cos()).abs() < 4e-15 && (s - angle.sin()).abs() < 4e-15, "{step}/{steps}");
            }
        }
    }

    #[test]
    fn turn_is_exact_on_the_axes_and_on_the_diagonal() {
        assert_eq!([0, 1, 2, 3].map(|k| turn(k, 4)), [[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]]);
        let [c, s] = turn(1, 8);
        assert!((c - s).abs() < 2.3e-16, "{c} {s}");
        assert_eq!(turn(5, 360), turn(365, 360));
    }
}
