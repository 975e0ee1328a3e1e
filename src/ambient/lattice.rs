//! Directions of rays: a lattice on the hemisphere whose density is the cosine to the normal.

use std::f64::consts::TAU;

use glam::DVec3;

use crate::random::SplitMix64;

/// The golden ratio less one: its multiples fill the circle evenly.
const GOLDEN: f64 = 0.618_033_988_749_894_9;

/// A rank-1 lattice of N points in the unit square, for shifts of any size.
#[derive(Clone, Debug)]
pub(super) struct Lattice {
    /// Cosine and sine of each point's angle.
    turns: Vec<[f64; 2]>,
}

impl Lattice {
    pub(super) fn new(rays: u32) -> Self {
        let turn = |i: u32| TAU * (f64::from(i) * GOLDEN).fract();
        Self { turns: (0..rays).map(|i| [turn(i).cos(), turn(i).sin()]).collect() }
    }

    /// The directions around `normal`, each with the density of its cosine, of length 1 but for rounding;
    /// over the whole sphere, evenly, without one.
    pub(super) fn directions(
        &self,
        normal: Option<[f32; 3]>,
        [up, around]: [f64; 2],
    ) -> impl Iterator<Item = [f32; 3]> {
        let (sin, cos) = (TAU * around).sin_cos();
        let [right, ahead, normal_or_z] = basis(normal.unwrap_or([0.0, 0.0, 1.0]));
        let step = 1.0 / self.turns.len() as f64;
        self.turns.iter().enumerate().map(move |(i, &[x, y])| {
            let u = ((i as f64 + 0.5) * step + up).fract();
            let [radius, height] = match normal {
                Some(_) => [u.sqrt(), (1.0 - u).sqrt()],
                None => [2.0 * (u * (1.0 - u)).sqrt(), 1.0 - 2.0 * u],
            };
            let direction = radius * (x * cos - y * sin) * right
                + radius * (x * sin + y * cos) * ahead
                + height * normal_or_z;
            direction.to_array().map(|x| x as f32)
        })
    }
}

/// Two directions at right angles to a normal, and itself (Tom Duff and others, *Building an Orthonormal
/// Basis, Revisited*, 2017).
fn basis(normal: [f32; 3]) -> [DVec3; 3] {
    let n = DVec3::from(normal.map(f64::from));
    let sign = 1_f64.copysign(n.z);
    let a = -1.0 / (sign + n.z);
    let b = n.x * n.y * a;
    [
        DVec3::new(1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x),
        DVec3::new(b, sign + n.y * n.y * a, -n.y),
        n,
    ]
}

/// The shift of a receiver's lattice: the same for equal positions in any order and on any thread, and for
/// positions that are scaled by a power of two.
pub(super) fn shift(seed: u64, p: [f32; 3]) -> [f64; 2] {
    let largest = f64::from(p.iter().fold(0.0_f32, |most, x| most.max(x.abs())));
    // 2^−e for a number with the exponent e. Those of `f32` are far from the ends of the range of `f64`.
    let scale = f64::from_bits((2046 - (largest.to_bits() >> 52)) << 52);
    let hash = p.iter().fold(seed, |hash, &x| SplitMix64(hash ^ (f64::from(x) * scale).to_bits()).next());
    let mut random = SplitMix64(hash);
    [random.unit(), random.unit()]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sum(directions: impl Iterator<Item = [f32; 3]>) -> DVec3 {
        directions.map(|d| DVec3::from(d.map(f64::from))).sum()
    }

    #[test]
    fn directions_are_units_above_the_horizon_with_the_mean_cosine_of_two_thirds() {
        let lattice = Lattice::new(4096);
        let root = 0.5_f32.sqrt();
        for normal in [[0.0, 0.0, 1.0], [0.0, 0.0, -1.0], [root, -root, 0.0], [0.6, 0.0, -0.8]] {
            let n = DVec3::from(normal.map(f64::from));
            for shift in [[0.0, 0.0], [0.3, 0.9]] {
                for direction in lattice.directions(Some(normal), shift) {
                    let d = DVec3::from(direction.map(f64::from));
                    assert!((d.length() - 1.0).abs() < 1e-6 && d.dot(n) > -1e-6, "{d} {n}");
                }
                let mean = sum(lattice.directions(Some(normal), shift)) / 4096.0;
                assert!((mean - n * 2.0 / 3.0).length() < 2e-3, "{mean}");
            }
        }
        // Evenly over the sphere: no mean direction, and a third of the squares along each axis.
        let whole: Vec<[f32; 3]> = lattice.directions(None, [0.2, 0.4]).collect();
        assert!(sum(whole.iter().copied()).length() < 2e-3 * 4096.0);
        for axis in 0..3 {
            let square: f32 = whole.iter().map(|d| d[axis] * d[axis]).sum::<f32>() / 4096.0;
            assert!((square - 1.0 / 3.0).abs() < 2e-3);
        }
    }

    #[test]
    fn shifts_differ_between_points_and_seeds_and_not_with_powers_of_two() {
        let p = [0.3, -1.7, 0.0];
        for scale in [2_f32.powi(-100), 2_f32.powi(100), 1.0] {
            assert_eq!(shift(1, p.map(|x| x * scale)), shift(1, p));
        }
        assert_ne!(shift(2, p), shift(1, p));
        assert_ne!(shift(1, [0.3, -1.7, 1e-30]), shift(1, p));
        assert_ne!(shift(1, [-1.7, 0.3, 0.0]), shift(1, p));
        // The origin and the ends of the range have shifts too.
        for p in [[0.0; 3], [f32::MAX; 3], [f32::from_bits(1), 0.0, 0.0]] {
            assert!(shift(1, p).iter().all(|u| (0.0..1.0).contains(u)));
        }
    }
}
