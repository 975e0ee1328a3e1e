//! How large a mesh is, and where.

use super::Draw;
use crate::verify::points::feature::rounded;

/// What is done to the coordinates of a shape, which are near 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Scale {
    /// Nothing.
    One,
    /// Times 1e-30, or down to where numbers have few bits left.
    Tiny,
    /// Times 1e30, or up to the end of `f32`.
    Huge,
    /// Axes, halves or vertices times factors of their own, of which at least two differ: 1, 1e-15, 1e12,
    /// 1e-30, 1e30.
    Mixed,
    /// Moved away by up to 2²⁰ times its size along each axis.
    Away,
}

const FACTORS: [f64; 5] = [1.0, 1e-15, 1e12, 1e-30, 1e30];

impl Scale {
    /// All scales, the simplest first.
    pub(crate) const ALL: [Self; 5] = [Self::One, Self::Tiny, Self::Huge, Self::Mixed, Self::Away];

    pub(crate) fn apply(self, draw: &mut dyn Draw, positions: &mut [[f32; 3]]) {
        let largest = f64::from(positions.iter().flatten().fold(f32::MIN_POSITIVE, |m, x| m.max(x.abs())));
        match self {
            Self::One => {}
            Self::Tiny => {
                let factor = draw.pick(&[1e-30, 1e-38, 0.5_f64.powi(140), 0.5_f64.powi(147)]);
                times(positions, |_, _| factor);
            }
            Self::Huge => {
                let most = f64::from(f32::MAX) / largest;
                let factor = draw.pick(&[1e30, 1e37, most, most]);
                times(positions, |_, _| factor);
            }
            Self::Mixed => {
                let first = draw.index(FACTORS.len());
                let second = (first + 1 + draw.index(FACTORS.len() - 1)) % FACTORS.len();
                let two = [first, second].map(|i| FACTORS[i]);
                let half = positions.len() / 2;
                match draw.below(3) {
                    0 => times(positions, |vertex, _| two[usize::from(vertex < half)]),
                    1 => {
                        let mut axes = [two[0], two[1], draw.pick(&FACTORS)];
                        axes.rotate_left(draw.index(3));
                        times(positions, |_, axis| axes[axis]);
                    }
                    _ => {
                        let mut each: Vec<f64> = positions.iter().map(|_| draw.pick(&FACTORS)).collect();
                        each.iter_mut().zip(two).for_each(|(factor, other)| *factor = other);
                        times(positions, |vertex, _| each[vertex]);
                    }
                }
            }
            Self::Away => {
                let offset = [(); 3].map(|()| draw.signed() * largest * f64::from(1 << 20));
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

/// 2ᵏ for k from −60 to 60, half of them from −4 to 4.
pub(crate) fn power_of_two(draw: &mut dyn Draw) -> f32 {
    let most = draw.pick(&[4, 60]);
    2.0_f32.powi(draw.between(-most, most))
}
