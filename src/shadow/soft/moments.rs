//! Filtered moments of depth: the techniques `vsm` and `msm`.
//!
//! (William Donnelly and Andrew Lauritzen, *Variance Shadow Maps*, I3D 2006; Christoph Peters and Reinhard
//! Klein, *Moment Shadow Mapping*, I3D 2015.) Two or four moments of the depths under the penumbra's window
//! bound the part of it that lies before the receiver. Where there are two depths the bound is exact; where
//! there are more, light leaks. The width is that of `pcss` with all blockers, and does not grow the cost of
//! the filter: sums over boxes come from a summed-area table.

use super::horizon::AboveHorizon;
use super::light_map::{LightMap, Receiver};
use super::sums::Sums;
use super::{SoftMapOptions, Taps};
use crate::caster::CasterGroup;
use crate::scene::Lamp;
use crate::shadow::LampShadow;
use crate::shadow::map::{MapError, Spread};
use crate::shadow::{Claim, Samples, Visibility};

/// Least variance: rounding and the slope within a texel.
const LEAST_VARIANCE: f64 = 1e-7;
/// Part of the moments that is replaced by those of the two ends of the range, so that rounding does not
/// invert them.
const MIXED: f64 = 3e-5;
/// By how much a receiver is moved towards the light, of the range of depths.
const MOVED: f64 = 1e-3;

/// Moment shadows with N moments.
#[derive(Debug)]
struct Moments<'a, const N: usize> {
    map: LightMap<'a>,
    layers: Vec<(Linear, Sums<N>)>,
}

/// Linear depth of one layer: 0 at its nearest texel, 1 at its farthest. Reversed depth crowds at 0, where
/// variance would vanish.
#[derive(Clone, Copy, Debug)]
struct Linear {
    is_parallel: bool,
    nearest: f64,
    farthest: f64,
}

impl Linear {
    fn of(spread: Spread, texels: &[f32]) -> Self {
        let drawn = || texels.iter().filter(|d| **d > 0.0).map(|&d| f64::from(d));
        let (least, most) = (drawn().fold(f64::INFINITY, f64::min), drawn().fold(0.0, f64::max));
        let is_parallel = matches!(spread, Spread::Parallel { .. });
        let distance = |d| distance(is_parallel, d);
        Self { is_parallel, nearest: distance(most), farthest: distance(least) }
    }

    /// Of a reversed depth; 1 where nothing is stored.
    fn at(&self, d: f64) -> f64 {
        let depth = (distance(self.is_parallel, d) - self.nearest) / (self.farthest - self.nearest);
        // A layer without texels, or with a single depth: nothing lies before anything.
        if depth.is_nan() { 1.0 } else { depth.clamp(0.0, 1.0) }
    }
}

/// A distance from the light, in some unit.
fn distance(is_parallel: bool, d: f64) -> f64 {
    if is_parallel { -d } else { 1.0 / d }
}

fn moments<'a, const N: usize>(
    casters: &'a CasterGroup<'a>,
    lamp: &Lamp,
    options: SoftMapOptions,
) -> Result<Box<dyn LampShadow + 'a>, MapError>
where
    Moments<'a, N>: LampShadow,
{
    let map = LightMap::prepare(casters, lamp, options.size)?;
    let space = *map.space();
    let side = options.size as usize;
    let layer = |texels: &[f32]| {
        let depth = Linear::of(space.spread(), texels);
        // Where nothing is stored, nothing lies before the farthest.
        let at = |d: f32| if d > 0.0 { depth.at(f64::from(d)) } else { 1.0 };
        let sums = Sums::of(side, space.layers(), |index| powers(at(texels[index])));
        sums.map(|sums| (depth, sums)).map_err(|bytes| MapError::Memory {
            size: options.size,
            layers: space.layers(),
            bytes,
        })
    };
    let layers = map.map.texels().chunks_exact(side * side).map(layer).collect::<Result<_, _>>()?;
    Ok(Box::new(AboveHorizon::new(Moments::<N> { layers, map }, lamp)))
}

/// z, z² and so on.
fn powers<const N: usize>(z: f64) -> [f64; N] {
    let mut power = 1.0;
    [(); N].map(|()| {
        power *= z;
        power
    })
}

pub(in crate::shadow) fn vsm<'a>(
    casters: &'a CasterGroup<'a>,
    lamp: &Lamp,
    options: SoftMapOptions,
) -> Result<Box<dyn LampShadow + 'a>, MapError> {
    moments::<2>(casters, lamp, options)
}

pub(in crate::shadow) fn msm<'a>(
    casters: &'a CasterGroup<'a>,
    lamp: &Lamp,
    options: SoftMapOptions,
) -> Result<Box<dyn LampShadow + 'a>, MapError> {
    moments::<4>(casters, lamp, options)
}

impl<const N: usize> Moments<'_, N> {
    fn value(&self, receiver: &mut Receiver<'_>, lit: impl Fn([f64; N], f64) -> f64) -> f64 {
        let Some(half) = receiver.penumbra(Taps::All) else { return 1.0 };
        // Beyond the rim of a cube's layer the window ends.
        let (depth, sums) = &self.layers[receiver.layer];
        receiver.reads += 4;
        lit(sums.mean(receiver.at, half), depth.at(receiver.d))
    }
}

impl LampShadow for Moments<'_, 2> {
    fn shade(&self, samples: &Samples) -> Visibility {
        Visibility::of(samples, self.map.lamp.light(), Claim::Approximate, |hit| {
            self.map.answer(hit, |receiver| self.value(receiver, lit_by_two))
        })
    }

    fn bytes(&self) -> usize {
        self.map.bytes() + self.layers.iter().map(|(_, sums)| sums.bytes()).sum::<usize>()
    }

    fn texel_world(&self) -> Option<f64> {
        Some(self.map.texel_world())
    }

    fn bias_world(&self) -> Option<f64> {
        Some(self.map.bias_world())
    }
}

impl LampShadow for Moments<'_, 4> {
    fn shade(&self, samples: &Samples) -> Visibility {
        Visibility::of(samples, self.map.lamp.light(), Claim::Approximate, |hit| {
            self.map.answer(hit, |receiver| self.value(receiver, lit_by_four))
        })
    }

    fn bytes(&self) -> usize {
        self.map.bytes() + self.layers.iter().map(|(_, sums)| sums.bytes()).sum::<usize>()
    }

    fn texel_world(&self) -> Option<f64> {
        Some(self.map.texel_world())
    }

    fn bias_world(&self) -> Option<f64> {
        Some(self.map.bias_world())
    }
}

/// The most that may lie at or behind a depth `z` (Chebyshev's inequality).
fn lit_by_two([mean, square]: [f64; 2], z: f64) -> f64 {
    let variance = (square - mean * mean).max(LEAST_VARIANCE);
    if z <= mean { 1.0 } else { variance / (variance + (z - mean).powi(2)) }
}

/// The same of four moments (Hamburger): one less the least that lies before `z`.
fn lit_by_four(moments: [f64; 4], z: f64) -> f64 {
    // Mixed with the moments of depths that are half at 0 and half at 1.
    let b = moments.map(|moment| moment + MIXED * (0.5 - moment));
    let z = z - MOVED;
    // Solve the Hankel matrix (1 b0 b1; b0 b1 b2; b1 b2 b3)·c = (1, z, z²) by Cholesky's method.
    let l21 = b[0];
    let d2 = b[1] - l21 * l21;
    let l32 = (b[2] - b[0] * b[1]) / d2;
    let d3 = b[3] - b[1] * b[1] - l32 * l32 * d2;
    let y1 = z - b[0];
    let y2 = z * z - b[1] - l32 * y1;
    let c2 = y2 / d3;
    let c1 = y1 / d2 - l32 * c2;
    let c0 = 1.0 - b[0] * c1 - b[1] * c2;
    // Roots of c2·x² + c1·x + c0: the two other depths.
    let (p, q) = (c1 / c2, c0 / c2);
    let root = (0.25 * p * p - q).max(0.0).sqrt();
    let (x, y) = (-0.5 * p - root, -0.5 * p + root);
    if !(x + y).is_finite() {
        return lit_by_two([b[0], b[1]], z);
    }
    let before = match z {
        _ if z <= x => 0.0,
        // One depth lies before `z`: its weight.
        _ if z <= y => (z * y - b[0] * (z + y) + b[1]) / ((y - x) * (z - x)),
        _ => 1.0 - (x * y - b[0] * (x + y) + b[1]) / ((z - x) * (z - y)),
    };
    (1.0 - before).clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shadow::soft::tests::{SQUARE, SUN, disk_fraction, square_fraction, values, worst};

    /// The moments of depths with weights.
    fn of<const N: usize>(depths: &[(f64, f64)]) -> [f64; N] {
        let mut power = 0;
        [(); N].map(|()| {
            power += 1;
            depths.iter().map(|(z, weight)| weight * z.powi(power)).sum()
        })
    }

    #[test]
    fn moments_of_two_depths_tell_their_shares_and_those_of_three_leak() {
        for (z1, z2) in [(0.2, 0.7), (0.1, 0.3), (0.5, 0.95)] {
            for share in [0.1, 0.25, 0.5, 0.8] {
                let depths = [(z1, share), (z2, 1.0 - share)];
                let two = lit_by_two(of(&depths), z2);
                assert!((two - (1.0 - share)).abs() < 1e-5, "{z1} {z2} {share}: {two}");
                let four = lit_by_four(of(&depths), z2);
                assert!((four - (1.0 - share)).abs() < 0.03, "{z1} {z2} {share}: {four}");
                // In front of the first depth all is lit.
                assert!(
                    lit_by_two(of(&depths), 0.9 * z1) == 1.0 && lit_by_four(of(&depths), 0.9 * z1) > 0.99
                );
            }
        }
        // Three depths, all before the receiver, which is dark.
        let three = [(0.1, 0.4), (0.5, 0.4), (0.9, 0.2)];
        let leak = lit_by_two(of(&three), 0.95);
        assert!(leak > 0.2 && lit_by_four(of(&three), 0.95) < leak);
    }

    #[test]
    fn moments_equal_the_visible_part_of_an_aligned_half_plane() {
        for technique in ["vsm:size=256", "msm:size=256"] {
            let square = values(technique, SQUARE, 0.0);
            let error = worst(&square, |x| square_fraction(x, 0.0));
            assert!(error < 0.08, "{technique} {error}");
            // The box of a sun's disk has another profile.
            let error = worst(&values(technique, SUN, 0.0), disk_fraction);
            assert!(error < 0.15, "{technique} {error}");
            // The sabotage: half the width.
            assert!(worst(&square, |x| square_fraction(2.0 * x, 0.0)) > 0.2);
        }
    }
}
