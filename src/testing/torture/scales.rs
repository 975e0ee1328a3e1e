//! How large a mesh is, and where.

use crate::random::SplitMix64;
use crate::verify::points::draw::rounded;

/// What is done to the coordinates of a shape, which are near 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Scale {
    /// Nothing.
    One,
    /// Times 1e-30, or down to where numbers have few bits left.
    Tiny,
    /// Times 1e30, or up to the end of `f32`.
    Huge,
    /// Axes, halves or vertices times factors of their own, of which at least two differ.
    ///
    /// 1e-30, 1e-15, 1, 1e12 and 1e30.
    Mixed,
    /// Moved away by up to 2²⁰ times its size along each axis.
    Away,
}

impl Scale {
    pub(crate) fn apply(self, positions: &mut [[f32; 3]], random: &mut SplitMix64) {
        let largest = f64::from(positions.iter().flatten().fold(f32::MIN_POSITIVE, |m, x| m.max(x.abs())));
        let factors = [1e-30, 1e-15, 1.0, 1e12, 1e30];
        match self {
            Self::One => {}
            Self::Tiny => {
                let factor = [1e-30, 1e-38, 0.5_f64.powi(140), 0.5_f64.powi(147)][random.below(4)];
                times(positions, |_, _| factor);
            }
            Self::Huge => {
                let most = f64::from(f32::MAX) / largest;
                let factor = [1e30, 1e37, most, most][random.below(4)];
                times(positions, |_, _| factor);
            }
            Self::Mixed => {
                let first = random.below(factors.len());
                let second = (first + 1 + random.below(factors.len() - 1)) % factors.len();
                let [first, second] = [first, second].map(|i| factors[i]);
                let (mut axes, halves) =
                    ([first, second, factors[random.below(factors.len())]], [first, second]);
                axes.rotate_left(random.below(3));
                let half = positions.len() / 2;
                match random.below(3) {
                    0 => times(positions, |_, axis| axes[axis]),
                    1 => times(positions, |vertex, _| halves[usize::from(vertex < half)]),
                    _ => {
                        let mut each: Vec<f64> =
                            positions.iter().map(|_| factors[random.below(factors.len())]).collect();
                        each.iter_mut().zip(halves).for_each(|(factor, other)| *factor = other);
                        times(positions, |vertex, _| each[vertex]);
                    }
                }
            }
            Self::Away => {
                let offset = [(); 3].map(|()| (random.unit() - 0.5) * largest * f64::from(1 << 21));
                for p in positions {
                    *p = rounded([0, 1, 2].map(|i| f64::from(p[i]) + offset[i]));
                }
            }
        }
    }
}

/// Multiplies each coordinate by the factor for its vertex and axis, and rounds.
fn times(positions: &mut [[f32; 3]], factor: impl Fn(usize, usize) -> f64) {
    for (vertex, p) in positions.iter_mut().enumerate() {
        *p = rounded([0, 1, 2].map(|axis| f64::from(p[axis]) * factor(vertex, axis)));
    }
}
