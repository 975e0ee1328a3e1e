//! The texels under a box or an ellipse, with the area of each.

/// Most strips along each side of a window. A wider window is cut into as many equal ones, and each reads the
/// texel in its middle: the cost of a lookup is bounded, and its error is that of a grid of as many points.
const MOST_STRIPS: u32 = 128;

/// An upright box around a position, or the ellipse in it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Window {
    pub(super) at: [f64; 2],
    pub(super) half: [f64; 2],
    pub(super) is_round: bool,
}

impl Window {
    /// Area in texels.
    pub(super) fn area(&self) -> f64 {
        let shape = if self.is_round { std::f64::consts::FRAC_PI_4 } else { 1.0 };
        4.0 * shape * self.half[0] * self.half[1]
    }

    /// Whether each of its texels is read.
    pub(super) fn is_whole(&self) -> bool {
        self.half.iter().all(|half| 2.0 * half + 2.0 <= f64::from(MOST_STRIPS))
    }

    /// Whether a part of it lies beyond the limits.
    pub(super) fn is_beyond(&self, [low, high]: [i64; 2]) -> bool {
        (0..2).any(|axis| {
            self.at[axis] - self.half[axis] < low as f64 || self.at[axis] + self.half[axis] > high as f64
        })
    }

    /// Calls `visit` with column, row and area of each texel within the limits. Without limits the areas add
    /// up to that of the window.
    pub(super) fn for_each_texel(&self, limits: [i64; 2], mut visit: impl FnMut(i64, i64, f64)) {
        let [low, high] = limits.map(|limit| limit as f64);
        let clamped = |at: f64, half: f64| [(at - half).max(low), (at + half).min(high)];
        for_each_strip(clamped(self.at[1], self.half[1]), |j, [top, bottom]| {
            let half = self.half[0] * self.mean_chord([top, bottom].map(|y| (y - self.at[1]) / self.half[1]));
            for_each_strip(clamped(self.at[0], half), |i, [left, right]| {
                visit(i, j, (right - left) * (bottom - top));
            });
        });
    }

    /// Mean half-width between two heights of the unit shape.
    fn mean_chord(&self, ends: [f64; 2]) -> f64 {
        if !self.is_round {
            return 1.0;
        }
        let [top, bottom] = ends.map(|t| t.clamp(-1.0, 1.0));
        let left_of = |t: f64| 0.5 * (t * (1.0 - t * t).sqrt() + t.asin());
        let height = bottom - top;
        if height > 0.0 { (left_of(bottom) - left_of(top)) / height } else { 0.0 }
    }
}

/// Calls `visit` with the texel and the ends of each strip.
fn for_each_strip([low, high]: [f64; 2], mut visit: impl FnMut(i64, [f64; 2])) {
    // Numbers that are none make no strips.
    if low.partial_cmp(&high) != Some(std::cmp::Ordering::Less) {
        return;
    }
    let most = f64::from(MOST_STRIPS);
    if high.ceil() - low.floor() <= most {
        for i in low.floor() as i64..high.ceil() as i64 {
            visit(i, [low.max(i as f64), high.min(i as f64 + 1.0)]);
        }
        return;
    }
    let step = (high - low) / most;
    for strip in 0..MOST_STRIPS {
        let from = low + f64::from(strip) * step;
        visit((from + 0.5 * step).floor() as i64, [from, from + step]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn window_areas_add_up_to_that_of_its_shape() {
        let everywhere = [i64::MIN / 4, i64::MAX / 4];
        for (half, is_round) in [[0.5, 0.5], [3.3, 1.2], [40.0, 63.9], [900.0, 70.0], [1e6, 0.5]]
            .into_iter()
            .flat_map(|half| [(half, false), (half, true)])
        {
            let window = Window { at: [7.3, -2.9], half, is_round };
            let (mut sum, mut left, mut count) = (0.0, 0.0, 0_u32);
            window.for_each_texel(everywhere, |i, _, area| {
                assert!(area > 0.0);
                sum += area;
                left += if i < 7 { area } else { 0.0 };
                count += 1;
            });
            assert!((sum / window.area() - 1.0).abs() < 1e-12, "{window:?} {sum}");
            assert!(count <= 129 * 129, "{count}");
            // Half lies to the left of the center, but for what lies in the center's own column or strip.
            let own = 1.0 / (2.0 * half[0]).min(64.0);
            assert!((left / sum - 0.5).abs() < own, "{window:?}");
            // Within limits, what lies beyond them is left out.
            window.for_each_texel([-3, 8], |i, j, _| assert!((-3..8).contains(&i) && (-3..8).contains(&j)));
        }
    }
}
