//! Leaves of the silhouette tree: 32 edges of similar planes, evaluated at once.

use crate::facing::plane_tree::LEAF;
use crate::facing::planes::LocalLight;
use crate::facing::quantized;
use crate::facing::quantized::Quantized;

/// The planes of 32 edges as integers about a center of their own: the smaller the leaf, the finer they are.
///
/// Let `Nᵢ` be the numbers of a face's unit plane, normal and offset over the reach, `lᵢ` those of a light,
/// the last one `w` times the reach, and `λ` the largest magnitude among them; the light is in front where `F
/// = Σ Nᵢ·lᵢ/λ > 0`. A leaf has a center `c` of four `f32` and a radius `ρ ≥ |Nᵢ − cᵢ|`, at least 2⁻⁸. Its
/// integers are `qᵢ ≈ 16383·(Nᵢ − cᵢ)/ρ`, those of the light `pᵢ ≈ 32767·lᵢ/λ`, and the height of a plane is
/// `H = b + Σ ⌊qᵢ·pᵢ / 2¹⁶⌋` with `b ≈ f·Σ cᵢ·lᵢ/λ` and `f = 16383·32767 / (2¹⁶·ρ)`.
///
/// # The bound
///
/// The light is in front wherever `H ≥ 3` and behind wherever `H ≤ −7`.
///
/// Why: let `t = f·F`, whose sign is that of `F`. `Nᵢ` is known up to `2⁻²⁴ + 2⁻²⁶` (its rounding to `f32`,
/// and the error of its construction that is asked for; see [`Quantized`]), which is at most 0.32 of a unit
/// of `qᵢ`, so that `qᵢ` errs by less than 0.83, and `pᵢ` by less than 0.51. Their product errs by less than
/// `0.83·32767 + 0.51·16383`, which is less than `0.55·2¹⁶`, and four of them by less than 2.2 after the
/// division. `b` errs by half for rounding and less than 0.01 for `f` and the sum, which is of `f64`. Each
/// floor takes less than 1. So `H − 2.71 < t < H + 4 + 2.71`.
///
/// The sum of the four is at most 32764 and at least −32768. A `b` that would leave 16 bits is ±32767
/// instead, which moves `H` towards zero: not beyond −1 or −3, which decide nothing. Sums that would leave 16
/// bits saturate.
///
/// A light without a scale has only zeros and no base: `H = 0`, which decides nothing.
#[derive(Clone, Debug)]
#[repr(align(64))]
pub(super) struct Leaf {
    /// Integers of the faces along the edges, then of the faces against them.
    pub(super) numbers: [[i16; 2 * LEAF]; 4],
    center: [f32; 4],
    /// `f`.
    factor: f32,
}

/// In front if the height is at least this.
const FRONT: i16 = 3;
/// Behind if the height is at most this.
const BACK: i16 = -7;
/// The largest number of a plane, and of a light.
const MOST: [f64; 2] = [16383.0, 32767.0];
/// The least radius of a leaf, 2⁻⁸.
const LEAST_RADIUS: f64 = 1.0 / 256.0;

/// What is known of 32 edges, two bits each: 0 both faces on one side, 1 or 2 silhouette, 3 undecided.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Codes(u64);

impl Codes {
    const LOW: u64 = 0x5555_5555_5555_5555;

    /// From the heights of the faces along the edges, then of the faces against them.
    #[inline(always)]
    fn of(heights: &[i16; 2 * LEAF]) -> Self {
        let (along, against) = heights.split_at(LEAF);
        let mut codes = [0_u8; LEAF];
        for slot in 0..LEAF {
            let (a, b) = (along[slot], against[slot]);
            let (a_front, a_back, b_front, b_back) = (a >= FRONT, a <= BACK, b >= FRONT, b <= BACK);
            let known = (a_front | a_back) & (b_front | b_back);
            let open = 3 * u8::from(!known);
            codes[slot] = u8::from(a_front & b_back) | (u8::from(a_back & b_front) << 1) | open;
        }
        // Byte i of the result holds the codes at slots i, 8 + i, 16 + i and 24 + i.
        let mut packed = [0; 8];
        for i in 0..8 {
            packed[i] = codes[i] | codes[8 + i] << 2 | codes[16 + i] << 4 | codes[24 + i] << 6;
        }
        Self(u64::from_le_bytes(packed))
    }

    /// A bit at twice the index of each edge that has one face in front and the other behind.
    #[inline(always)]
    pub(super) fn changes(self) -> u64 {
        (self.0 ^ self.0 >> 1) & Self::LOW
    }

    /// For an edge of `changes`: 1 if the face against it is the one in front, otherwise 0.
    #[inline(always)]
    pub(super) fn against(self, twice_index: u32) -> u32 {
        (self.0 >> (twice_index + 1)) as u32 & 1
    }

    /// A bit at twice the index of each edge with a face whose side the integers leave open.
    #[inline(always)]
    pub(super) fn open(self) -> u64 {
        self.0 & self.0 >> 1 & Self::LOW
    }
}

impl Leaf {
    /// From 32 planes of faces along edges and 32 of faces against them, each given as `Nᵢ` above.
    pub(super) fn new(planes: &[[[f64; 4]; LEAF]; 2]) -> Self {
        let all = planes.as_flattened();
        let (mut low, mut high) = (all[0], all[0]);
        for plane in all {
            for i in 0..4 {
                low[i] = if plane[i] < low[i] { plane[i] } else { low[i] };
                high[i] = if plane[i] > high[i] { plane[i] } else { high[i] };
            }
        }
        let center = [0, 1, 2, 3].map(|i| ((low[i] + high[i]) / 2.0) as f32);
        let off = |x: f64, i: usize| x - f64::from(center[i]);
        let widest = (0..4)
            .fold(LEAST_RADIUS, |widest: f64, i| widest.max(off(low[i], i).abs()).max(off(high[i], i).abs()));
        let mut numbers = [[0; 2 * LEAF]; 4];
        for (slot, plane) in all.iter().enumerate() {
            for i in 0..4 {
                numbers[i][slot] = quantized::nearest(off(plane[i], i) / widest * MOST[0]);
            }
        }
        Self { numbers, center, factor: (MOST[0] * MOST[1] / 65536.0 / widest) as f32 }
    }

    /// The codes of all edges. Inlined, so that it uses the vector registers its caller is compiled for.
    #[inline(always)]
    pub(super) fn codes(&self, light: &LocalLight) -> Codes {
        let heights = self.heights(&light.quantized, &light.direction);
        Codes::of(&heights)
    }

    /// `H` of every plane.
    #[inline(always)]
    fn heights(&self, light: &Quantized, direction: &[f64; 4]) -> [i16; 2 * LEAF] {
        let (base, [x, y, z, w]) = (self.base(direction), &self.numbers);
        let mut heights = [0; 2 * LEAF];
        for slot in 0..2 * LEAF {
            let high = |q: i16, p: i16| ((i32::from(q) * i32::from(p)) >> 16) as i16;
            let first = high(x[slot], light[0]) + high(y[slot], light[1]);
            let second = high(z[slot], light[2]) + high(w[slot], light[3]);
            heights[slot] = (first + second).saturating_add(base);
        }
        heights
    }

    /// `b`.
    #[inline(always)]
    fn base(&self, direction: &[f64; 4]) -> i16 {
        let [x, y, z, w] = self.center.map(f64::from);
        let sum = (x * direction[0] + y * direction[1]) + (z * direction[2] + w * direction[3]);
        let base = (f64::from(self.factor) * sum).clamp(-MOST[1], MOST[1]);
        quantized::nearest(base) // 0 for NaN
    }
}

/// The slot of a leaf that holds the planes of the edge at an index: that of its code in [`Codes`].
pub(super) fn column(index: usize) -> usize {
    index / 4 + index % 4 * 8
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::SplitMix64;

    /// For many planes and lights, most of them nearly in the plane: how many are decided wrongly with bounds
    /// moved by `less` units, and how many are decided at all.
    fn decided(less: i16) -> (usize, usize) {
        let (mut random, mut wrong, mut count) = (SplitMix64(1), 0, 0);
        let mut number = || (random.next() >> 11) as f64 / (1_u64 << 52) as f64 - 1.0;
        for round in 0..4000 {
            // Leaves of all sizes about a plane, finer ones than the finest there is among them.
            let size = 0.5_f64.powi(round % 12);
            let center: [f64; 4] = std::array::from_fn(|_| number());
            let mut plane = || {
                let [x, y, z, d] = center.map(|x| x + size * number());
                let length = (x * x + y * y + z * z).sqrt();
                [x / length, y / length, z / length, d.clamp(-1.0, 1.0)]
            };
            let planes: [[[f64; 4]; LEAF]; 2] = std::array::from_fn(|_| std::array::from_fn(|_| plane()));
            let leaf = Leaf::new(&planes.map(|side| side.map(|plane| plane.map(|x| f64::from(x as f32)))));
            for at in 0..2 * LEAF {
                // Onto a plane, up to some units of the leaf.
                let plane = planes[at / LEAF][at % LEAF];
                let mut light: [f64; 4] = std::array::from_fn(|_| number());
                let off = number() * 20.0 / f64::from(leaf.factor);
                light[3] = (off - (0..3).map(|i| plane[i] * light[i]).sum::<f64>()) / plane[3];
                let scale = 1.0 / light.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
                let direction = light.map(|x| x * scale);
                let rounded = direction.map(|x| (x * MOST[1]).round() as i16);
                let heights = leaf.heights(&rounded, &direction);
                for (height, plane) in heights.iter().zip(planes.as_flattened()) {
                    let truth: f64 = (0..4).map(|i| plane[i] * direction[i]).sum();
                    let (front, back) = (*height >= FRONT - less, *height <= BACK + less);
                    count += usize::from(front || back);
                    // Nearer than `f64` resolves, either side is right.
                    wrong += usize::from(front && truth < -1e-15 || back && truth > 1e-15);
                }
            }
        }
        (wrong, count)
    }

    #[test]
    fn silhouette_leaf_is_never_wrong_about_a_side() {
        let (wrong, count) = decided(0);
        assert_eq!(wrong, 0);
        assert!(count > 1_000_000, "{count} is too few to say much");
    }

    #[test]
    fn silhouette_leaf_with_half_the_bound_is_caught() {
        assert!(decided(3).0 > 0);
    }

    #[test]
    fn silhouette_leaf_decides_nothing_for_a_light_without_a_scale() {
        let leaf = Leaf::new(&[[[0.6, 0.0, 0.8, 0.5]; LEAF]; 2]);
        assert_eq!(leaf.heights(&[0; 4], &[f64::NAN; 4]), [0; 2 * LEAF]);
        assert_eq!(leaf.heights(&[0; 4], &[0.0; 4]), [0; 2 * LEAF]);
    }

    #[test]
    fn silhouette_leaf_codes_are_at_the_indices_of_their_edges() {
        // The light overhead; four edges of each kind of pair, the rest flat.
        let (up, down, beside) = ([0.0, 0.0, 1.0, 0.0], [0.0, 0.0, -1.0, 0.0], [1.0, 0.0, 0.0, 0.0]);
        let kinds = [[up, up], [up, down], [down, up], [down, down], [beside, up], [down, beside]];
        let mut planes = [[[0.0; 4]; LEAF]; 2];
        for place in 0..LEAF {
            let pair = kinds[place % 6];
            (planes[0][column(place)], planes[1][column(place)]) = (pair[0], pair[1]);
        }
        let heights = Leaf::new(&planes).heights(&[0, 0, 32767, 0], &[0.0, 0.0, 1.0, 0.0]);
        let codes = Codes::of(&heights);
        for place in 0..LEAF as u32 {
            let (change, open) = (codes.changes() >> (2 * place) & 1, codes.open() >> (2 * place) & 1);
            assert_eq!([change, open], [[0, 0], [1, 0], [1, 0], [0, 0], [0, 1], [0, 1]][place as usize % 6]);
            assert!(change == 0 || codes.against(2 * place) == u32::from(place % 6 == 2));
        }
    }
}
