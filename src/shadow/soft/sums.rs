//! Summed-area tables: means over boxes of any size at the cost of four corners.
//!
//! (Franklin Crow, *Summed-Area Tables for Texture Mapping*, SIGGRAPH 1984.) In `f64`: a sum over 2²⁰ texels
//! keeps 32 bits of each.

/// Most bytes of all tables of a map.
const MOST_BYTES: usize = 1 << 32;

/// Sums of `N` values per texel.
#[derive(Debug)]
pub(in crate::shadow) struct Sums<const N: usize> {
    /// Texels along a side.
    side: usize,
    /// Sums over all texels above and to the left of a corner, by rows of `side + 1`.
    corners: Vec<[f64; N]>,
}

impl<const N: usize> Sums<N> {
    /// One of `tables` tables. The error is the number of bytes of all, where they do not fit.
    pub(in crate::shadow) fn of(
        side: usize,
        tables: usize,
        value: impl Fn(usize) -> [f64; N],
    ) -> Result<Self, usize> {
        let row_len = side + 1;
        let count = row_len * row_len;
        let bytes = tables * count * size_of::<[f64; N]>();
        let mut corners = Vec::new();
        if bytes > MOST_BYTES || corners.try_reserve_exact(count).is_err() {
            return Err(bytes);
        }
        corners.resize(count, [0.0; N]);
        for j in 0..side {
            let mut row = [0.0; N];
            for i in 0..side {
                let value = value(j * side + i);
                for k in 0..N {
                    row[k] += value[k];
                    corners[(j + 1) * row_len + i + 1][k] = corners[j * row_len + i + 1][k] + row[k];
                }
            }
        }
        Ok(Self { side, corners })
    }

    /// The mean over the part of a box that lies on the map, with fractions of texels. A box beside the map
    /// has the mean of the nearest rim.
    pub(in crate::shadow) fn mean(&self, at: [f64; 2], half: [f64; 2]) -> [f64; N] {
        let side = self.side as f64;
        let ends = [0, 1].map(|axis| {
            let low = (at[axis] - half[axis]).clamp(0.0, side - 1.0 / 256.0);
            [low, (at[axis] + half[axis]).clamp(low + 1.0 / 256.0, side)]
        });
        let area = (ends[0][1] - ends[0][0]) * (ends[1][1] - ends[1][0]);
        let [left, right] = ends[0];
        let [top, bottom] = ends[1];
        let [a, b, c, d] =
            [(left, top), (right, top), (left, bottom), (right, bottom)].map(|(x, y)| self.up_to(x, y));
        let mut mean = [0.0; N];
        for k in 0..N {
            mean[k] = (d[k] - b[k] - c[k] + a[k]) / area;
        }
        mean
    }

    /// The sum above and to the left of any point of the map: linear between corners.
    fn up_to(&self, x: f64, y: f64) -> [f64; N] {
        let [i, j] = [x, y].map(|t| (t.floor() as usize).min(self.side - 1));
        let [u, v] = [x - i as f64, y - j as f64];
        let row = self.side + 1;
        let [a, b, c, d] = [0, 1, row, row + 1].map(|step| self.corners[j * row + i + step]);
        let mut sum = [0.0; N];
        for k in 0..N {
            sum[k] = (1.0 - v) * ((1.0 - u) * a[k] + u * b[k]) + v * ((1.0 - u) * c[k] + u * d[k]);
        }
        sum
    }

    pub(super) fn bytes(&self) -> usize {
        size_of_val(&*self.corners)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::SplitMix64;
    use crate::shadow::soft::window::Window;

    #[test]
    fn sums_give_the_mean_over_any_box() {
        let mut random = SplitMix64(9);
        let values: Vec<f64> = (0..32 * 32).map(|_| random.unit()).collect();
        let sums = Sums::of(32, 1, |index| [values[index], 1.0]).unwrap();
        for _ in 0..500 {
            let at = [0; 2].map(|_| 32.0 * random.unit());
            let half = [0; 2].map(|_| 0.5 + 20.0 * random.unit().powi(2));
            let (mut sum, mut area) = (0.0, 0.0);
            Window { at, half, is_round: false }.for_each_texel([0, 32], |i, j, part| {
                sum += part * values[(32 * j + i) as usize];
                area += part;
            });
            let [mean, one] = sums.mean(at, half);
            assert!((mean - sum / area).abs() < 1e-9 && (one - 1.0).abs() < 1e-9, "{at:?} {half:?}");
        }
        // Beside the map, and around all of it.
        assert!(sums.mean([-90.0, 5.0], [1.0; 2])[0].is_finite());
        assert!((sums.mean([5.0; 2], [1e9; 2])[0] - values.iter().sum::<f64>() / 1024.0).abs() < 1e-9);
        // The bytes of all tables, where they are too many.
        assert_eq!(Sums::<4>::of(16_383, 6, |_| [0.0; 4]).unwrap_err(), 6 << 33);
    }
}
