//! A receiver as the search of single-sample soft shadows takes it, on the CPU and on a device: 64 bytes.
//!
//! Both twins have the same results bit by bit. Lengths are integers, in [`UNITS`] per texel. Depths are
//! `f32`. The change of the receiver's plane per texel has 15 binary digits and is multiplied by integers of
//! 8, so that products are exact, and a device that fuses a product with a sum rounds as one that does not.
//! (Rounding the change errs by 2⁻¹⁶ of it, 1/450 of a texel's change at the farthest texel; the slack is
//! half a texel's.) Quotients are compared by products of 64 bits.
//!
//! What is assumed of a device: sums and single products round to nearest, and are not reordered. On a cube
//! whose side is no power of two a depth across a seam is rounded twice, and must not be fused.

#[cfg(feature = "gpu")]
use bytemuck::{Pod, Zeroable};

use super::light_map::Place;

/// Units of length per texel.
pub(super) const UNITS: i32 = 128;
/// A distance whose square is below 2³¹.
const MOST_GAP: f32 = 46_340.0;
/// A half-width whose square is below 2³²: 512 texels.
const MOST_WIDTH: f32 = 65_535.0;
/// Larger numbers take a lamp larger than any map, too.
const MOST_SCALE: f64 = 1e18;
/// A depth, or change of depth per texel, that is no longer one: the receiver is edge-on, or at the light.
const MOST_DEPTH: f64 = 1e9;

/// A receiver. Mirrors `struct Around` in search.wgsl.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "gpu", derive(Pod, Zeroable))]
pub(super) struct Around {
    /// The own texel's column and row.
    pub(super) own: [i32; 2],
    /// Position within it, below [`UNITS`].
    pub(super) within: [u32; 2],
    /// Change of the plane's depth per column and row.
    pub(super) slope: [f32; 2],
    /// Units of half-width per difference of depth, along columns and rows.
    pub(super) k: [f32; 2],
    /// By how much distances are longer along each axis, in terms of the wider penumbra.
    pub(super) aspect: [f32; 2],
    /// Depth of the plane at the center of the own texel.
    pub(super) plane: f32,
    /// Depth of the receiver.
    pub(super) depth: f32,
    pub(super) bias: f32,
    pub(super) layer: u32,
    /// 1, or 0 for a sample that the map has no answer for.
    pub(super) is_there: u32,
    spare: u32,
}

/// The nearest change: squares of its distance and of its penumbra's half-width, in units. Both are 1 where
/// nothing is near. Mirrors `struct Found` in search.wgsl.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "gpu", derive(Pod, Zeroable))]
pub(super) struct Found {
    pub(super) gap: u32,
    pub(super) width: u32,
    /// Whether the receiver is in the hard shadow.
    pub(super) is_inner: u32,
    spare: u32,
}

impl Around {
    /// With a bias that is greater by `rounding`. `None` for a receiver that is edge-on, or at the light.
    pub(super) fn of(place: &Place, rounding: f64) -> Option<Self> {
        let steepest = place.slope[0].abs() + place.slope[1].abs();
        if !(steepest < MOST_DEPTH && place.d < MOST_DEPTH) {
            return None;
        }
        let widest = place.k[0].max(place.k[1]);
        let own = place.at.map(|t| t.floor() as i64);
        let beyond = [0, 1].map(|axis| place.at[axis] - own[axis] as f64);
        Some(Self {
            own: own.map(|t| t as i32), // on a map
            within: beyond.map(|part| ((part * f64::from(UNITS)) as u32).min(UNITS as u32 - 1)),
            slope: place.slope.map(|slope| short(slope as f32)),
            k: place.k.map(|k| (f64::from(UNITS) * k.min(MOST_SCALE)) as f32),
            aspect: place.k.map(|k| if k > 0.0 { (widest / k) as f32 } else { 1.0 }),
            plane: place.plane(own[0], own[1]) as f32,
            depth: place.d as f32,
            bias: (place.bias + rounding) as f32,
            layer: place.layer as u32, // below 6
            is_there: 1,
            spare: 0,
        })
    }

    pub(super) fn plane_at(&self, [i, j]: [i32; 2]) -> f32 {
        self.plane + self.slope[0] * i as f32 + self.slope[1] * j as f32
    }

    /// Half-width of the penumbra of a blocker that is above the plane by a difference of depth.
    pub(super) fn width_of(&self, above: f32) -> u32 {
        (self.k[0].max(self.k[1]) * above).clamp(64.0, MOST_WIDTH) as u32
    }

    /// The square of the least distance between the receiver and a square of texels.
    pub(super) fn gap_to(&self, offset: [i32; 2], side: i32) -> u32 {
        let [x, y] = [0, 1].map(|axis| {
            let low = offset[axis] * UNITS - self.within[axis] as i32; // below UNITS
            let gap = low.max(-(low + side * UNITS)).max(0);
            (gap as f32 * self.aspect[axis]).min(MOST_GAP) as u32
        });
        x * x + y * y
    }
}

impl Found {
    pub(super) fn new([gap, width]: [u32; 2], is_inner: bool) -> Self {
        Self { gap, width, is_inner: is_inner.into(), spare: 0 }
    }

    /// Nothing blocks, near or far.
    #[cfg(all(test, feature = "gpu"))]
    pub(super) const OPEN: Self = Self { gap: 1, width: 1, is_inner: 0, spare: 0 };

    /// The distance in half-widths, at most 1.
    pub(super) fn distance(self) -> f64 {
        (f64::from(self.gap) / f64::from(self.width)).sqrt().min(1.0)
    }
}

/// The nearest number of 15 binary digits.
fn short(x: f32) -> f32 {
    f32::from_bits((x.to_bits() + (1 << 8)) & !((1 << 9) - 1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn around_has_products_that_are_exact() {
        let mut random = crate::random::SplitMix64(1);
        for _ in 0..10_000 {
            let x = ((random.unit() - 0.5) * (-40.0 * random.unit()).exp2()) as f32;
            let slope = short(x);
            assert!((slope - x).abs() <= x.abs() / 32768.0, "{x}");
            let texels = random.below(512) as f32;
            assert_eq!(f64::from(slope * texels), f64::from(slope) * f64::from(texels));
        }
        assert_eq!((short(0.0), short(-1.5)), (0.0, -1.5));
    }

    #[cfg(feature = "gpu")]
    #[test]
    fn around_has_one_layout_in_rust_and_wgsl() {
        use crate::gpu::layout::assert_layout;
        let shader = crate::gpu::Shader::new("", &super::super::gpu::search_source());
        assert_layout!(
            shader.source(), "Around",
            Around: own, within, slope, k, aspect, plane, depth, bias, layer, is_there, spare
        );
        assert_layout!(shader.source(), "Found", Found: gap, width, is_inner, spare);
    }
}
