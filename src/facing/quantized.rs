//! Planes in 8 bytes: integers that decide most sides, with a proven bound.

use crate::geom::{Facing, Light};

/// A plane `(n, d)` or a light `(l, w)` as four integers of at most [`MOST`] in magnitude.
///
/// With the unit plane `F(L) = N·(L − o) + w·D` of a face, its numbers are `qᵢ ≈ 32767·Nᵢ` and `q₃ ≈
/// 32767·D/r`, and those of a light `pᵢ ≈ k·(L − o)ᵢ` and `p₃ ≈ k·w·r`, where `r` is the reach of the mesh
/// and `k` brings the largest to 32767. [`height`] is `S = Σ ⌊qᵢ·pᵢ / 2¹⁶⌋`, which fits vector instructions
/// of the oldest processors.
///
/// # The bound
///
/// `F` is in front wherever `S ≥ 3` and behind wherever `S ≤ −7`.
///
/// Why: let `t = F·k·32767 / 2¹⁶`, whose sign is that of `F`. Each `qᵢ` is rounded to the nearest, from a
/// component that errs by at most `e + 2⁻²⁴` (its error from the construction, and its rounding to `f32`; see
/// [`FacePlanes`](super::FacePlanes)). With `e ≤ 2⁻²⁶`, which is asked for, that is less than 0.0025 of a
/// unit, so `|qᵢ − 32767·Nᵢ| ≤ 0.5025`. Each `pᵢ` errs by at most 0.5 and 32767 roundings of `f64`: `|pᵢ −
/// k·lᵢ| ≤ 0.5001`. Their product errs by at most `(0.5025 + 0.5001)·32767`, which is less than `0.502·2¹⁶`,
/// and four of them by less than 2.01 after the division. Each floor takes less than 1. So `S − 2.01 < t < S
/// + 4 + 2.01`.
///
/// A plane for which no such `e` is known is `[0; 4]`: then `S = 0`, which decides nothing. The same holds
/// where the reach is so small that `d` may have lost bits below the normal range, and where the light or the
/// reach leaves no scale. Sums that would leave 16 bits saturate, which keeps their sign.
pub(crate) type Quantized = [i16; 4];

/// In front if the height is at least this.
pub(crate) const FRONT: i16 = 3;
/// Behind if the height is at most this.
pub(crate) const BACK: i16 = -7;

const MOST: f64 = 32767.0;
/// 2⁻²⁶.
const MOST_ERROR: f32 = 1.0 / 67_108_864.0;
/// 2⁻¹⁰⁰: rounding an offset below the normal range, by 2⁻¹⁵⁰, is then below 2⁻⁵⁰ of it.
const LEAST_REACH: f32 = 1.0 / (1_u128 << 100) as f32;

/// From a unit normal and an offset that are known up to `error` per component (times `reach` for the
/// offset).
#[inline(always)]
pub(crate) fn of_plane([x, y, z]: [f32; 3], offset: f32, error: f32, reach: f32) -> Quantized {
    let known = (error <= MOST_ERROR) & (reach >= LEAST_REACH);
    let of = |x: f64| if known { nearest(x * MOST) } else { 0 };
    [of(x.into()), of(y.into()), of(z.into()), of(f64::from(offset) / f64::from(reach))]
}

/// A light relative to the local origin of planes, and the same before it is rounded: `lᵢ` over the largest
/// magnitude among them, with `l₃ = w·r`.
pub(crate) fn of_light(light: &Light, origin: [f32; 3], reach: f32) -> (Quantized, [f64; 4]) {
    let xyz = light.xyz().map(f64::from);
    let [x, y, z, w] = if light.is_directional() {
        [xyz[0], xyz[1], xyz[2], 0.0]
    } else {
        let [x, y, z] = [0, 1, 2].map(|i| xyz[i] - f64::from(origin[i]));
        [x, y, z, f64::from(reach)]
    };
    let scale = 1.0 / [x, y, z, w].iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    // Without a scale all are NaN or zero, and come out as zero.
    let direction = [x, y, z, w].map(|x| x * scale);
    (direction.map(|x| nearest(x * MOST)), direction)
}

/// The nearest integer; never −32768, and 0 for NaN.
#[inline(always)]
pub(crate) fn nearest(x: f64) -> i16 {
    ((x + 0.5_f64.copysign(x)) as i16).max(-i16::MAX)
}

/// `S` above.
#[inline(always)]
pub(crate) fn height(plane: Quantized, light: &Quantized) -> i16 {
    let high = |i: usize| ((i32::from(plane[i]) * i32::from(light[i])) >> 16) as i16;
    // A product of two is at most 2¹⁴ in magnitude, and at most 16383 if positive: the first sums fit.
    (high(0) + high(1)).saturating_add(high(2) + high(3))
}

/// The heights of planes that are given component by component.
///
/// Not inlined, and with lengths that the compiler does not know: otherwise it is unrolled instead of
/// vectorized.
#[inline(never)]
pub(crate) fn heights([x, y, z, w]: [&[i16]; 4], light: &Quantized, heights: &mut [i16]) {
    for ((((to, x), y), z), w) in heights.iter_mut().zip(x).zip(y).zip(z).zip(w) {
        *to = height([*x, *y, *z, *w], light);
    }
}

/// The planes of all faces, one array per component.
#[derive(Clone, Debug)]
pub(crate) struct QuantizedPlanes([Vec<i16>; 4]);

impl QuantizedPlanes {
    /// From one list per component, all of one length.
    pub(crate) fn new(lists: [Vec<i16>; 4]) -> Self {
        Self(lists)
    }

    pub(crate) fn get(&self, face: usize) -> Quantized {
        let [x, y, z, w] = &self.0;
        [x[face], y[face], z[face], w[face]]
    }

    /// The integers of all faces, those of a face together.
    pub(crate) fn all(&self) -> Vec<Quantized> {
        (0..self.0[0].len()).map(|face| self.get(face)).collect()
    }

    /// The sides of a run of faces, [`Facing::EdgeOn`] where they are left open. Returns how many are.
    ///
    /// Not inlined: within a loop over runs it is not vectorized.
    #[inline(never)]
    pub(crate) fn look(&self, light: &Quantized, first: usize, facing: &mut [Facing]) -> usize {
        let [x, y, z, w] = [0, 1, 2, 3].map(|i| &self.0[i][first..first + facing.len()]);
        // No branches and no bounds checks, so that it is compiled to vector instructions.
        for ((((facing, x), y), z), w) in facing.iter_mut().zip(x).zip(y).zip(z).zip(w) {
            let height = height([*x, *y, *z, *w], light);
            *facing = if height >= FRONT {
                Facing::Front
            } else if height <= BACK {
                Facing::Back
            } else {
                Facing::EdgeOn
            };
        }
        let mut open = 0;
        // A byte counts to 255.
        for part in facing.chunks(128) {
            open +=
                usize::from(part.iter().fold(0, |open, &facing| open + u8::from(facing == Facing::EdgeOn)));
        }
        open
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `F` of the bound's proof for a light given by its numbers, in units of `k`.
    fn true_height(plane: [f64; 4], light: [f64; 4]) -> f64 {
        (0..4).map(|i| plane[i] * light[i]).sum()
    }

    fn numbers(seed: &mut u64) -> [f64; 4] {
        std::array::from_fn(|_| {
            *seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (*seed >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
        })
    }

    /// For many planes and lights, most of them nearly in the plane: how many are decided wrongly with bounds
    /// moved by `less` units, and how many are decided at all.
    fn decided(less: i16) -> (usize, usize) {
        let (mut seed, mut wrong, mut count) = (1, 0, 0);
        for round in 0..200_000 {
            let [x, y, z, d] = numbers(&mut seed);
            let length = (x * x + y * y + z * z).sqrt();
            let plane = [x / length, y / length, z / length, d];
            let mut light = numbers(&mut seed);
            // Onto the plane, up to some units.
            let off = (round % 41 - 20) as f64 / 16384.0;
            light[3] = (off - (0..3).map(|i| plane[i] * light[i]).sum::<f64>()) / d;
            let scale = MOST / light.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
            let (q, p) = (plane.map(|x| nearest(x * MOST)), light.map(|x| nearest(x * scale)));
            let (height, truth) = (height(q, &p), true_height(plane, light));
            let (front, back) = (height >= FRONT - less, height <= BACK + less);
            count += usize::from(front || back);
            wrong += usize::from(front && truth <= 0.0 || back && truth >= 0.0);
        }
        (wrong, count)
    }

    #[test]
    fn facing_by_integers_is_never_wrong_near_a_plane() {
        let (wrong, count) = decided(0);
        assert_eq!(wrong, 0);
        assert!(count > 50_000, "{count} is too few to say much");
    }

    #[test]
    fn facing_by_integers_with_half_the_bound_is_caught() {
        assert!(decided(3).0 > 0);
    }

    #[test]
    fn facing_of_planes_and_lights_without_integers_is_left_open() {
        let unknown = [
            of_plane([1.0, 0.0, 0.0], 0.0, f32::INFINITY, 1.0),
            of_plane([1.0, 0.0, 0.0], 0.0, 1e-7, 1.0),
            of_plane([1.0, 0.0, 0.0], 0.0, 1e-15, 1e-38),
        ];
        assert_eq!(unknown, [[0; 4]; 3]);
        let origin = Light::point([0.0; 3]).unwrap();
        assert_eq!(of_light(&origin, [0.0; 3], 0.0).0, [0; 4]);
        assert_eq!(of_light(&origin, [0.0; 3], f32::INFINITY).0, [0; 4]);
        let far = Light::point([f32::MAX, f32::MIN, 0.0]).unwrap();
        assert_eq!(of_light(&far, [f32::MIN, f32::MAX, 0.0], 1.0).0, [32767, -32767, 0, 0]);
    }
}
