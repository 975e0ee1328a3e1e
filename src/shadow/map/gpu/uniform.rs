//! A light's space as shaders take it.

use bytemuck::{Pod, Zeroable};
use glam::DVec3;

use super::Lookup;
use crate::gpu::raster::to_one;
use crate::shadow::map::bias::Reach;
use crate::shadow::map::{Bias, DepthSource, Filter, LightSpace, Rule, Spread};

/// Mirrors `struct Light` in map.wgsl.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(in crate::shadow) struct LightUniform {
    right: [[f32; 4]; 6],
    up: [[f32; 4]; 6],
    axis: [[f32; 4]; 6],
    origin: [f32; 3],
    scale: f32,
    half: f32,
    per_half: f32,
    lowest: f32,
    per_range: f32,
    near: f32,
    is_central: u32,
    layers: u32,
    layer: u32,
    size: f32,
    side: f32,
    is_tent: u32,
    way: u32,
    reach: f32,
    slack: f32,
    rounding: f32,
    bias: f32,
}

/// Allowance for `f32`: the depth of a plane is a sum of three products of numbers of at most about 1, with
/// coefficients of five roundings each.
pub(in crate::shadow) const ROUNDING: f32 = 1.0 / (1 << 20) as f32;

/// The values of `way` in map.wgsl.
const RECEIVER: u32 = 0;
const TEXEL: u32 = 1;
const ADDED: u32 = 2;
const MULTIPLIED: u32 = 3;
const NORMAL: u32 = 4;

impl LightUniform {
    /// For casters whose coordinates are at most `largest` in magnitude.
    pub(super) fn new(space: &LightSpace, largest: f32) -> Self {
        let origin = space.origin().as_vec3();
        let scale = to_one(origin.abs().max_element().max(largest));
        let wide = f64::from(scale);
        let row = |v: DVec3| v.as_vec3().extend(0.0).to_array();
        let rows = |of: fn(&super::super::Frame) -> DVec3| space.frames.map(|frame| row(of(&frame)));
        let (half, lowest, range, near, is_central) = match space.spread() {
            Spread::Parallel { half, lowest, range } => (half * wide, lowest * wide, range * wide, 0.0, 0),
            Spread::Central { tan, near } => (tan, 0.0, 1.0, near * wide, 1),
        };
        Self {
            right: rows(|frame| frame.right),
            up: rows(|frame| frame.up),
            axis: rows(|frame| frame.axis),
            origin: (origin * scale).to_array(),
            scale,
            half: half as f32,
            per_half: (1.0 / half) as f32,
            lowest: lowest as f32,
            per_range: (1.0 / range) as f32,
            near: near as f32,
            is_central,
            layers: space.layers() as u32, // 1 or 6
            layer: 0,
            size: space.size() as f32,
            side: 0.0,
            is_tent: 0,
            way: RECEIVER,
            reach: 0.0,
            slack: 0.5,
            rounding: ROUNDING,
            bias: 0.0,
        }
    }

    /// The power of two that lengths are multiplied by.
    pub(in crate::shadow) fn scale(&self) -> f64 {
        self.scale.into()
    }

    /// For drawing one layer.
    pub(super) fn with_layer(self, layer: u32) -> Self {
        Self { layer, ..self }
    }

    /// For a lookup of a map in `space`; `None` if the device has no form of it.
    pub(super) fn with_lookup(self, space: &LightSpace, depth: DepthSource, lookup: Lookup) -> Option<Self> {
        let (side, is_tent) = match lookup.filter {
            Filter::Nearest => (0.0, 0),
            Filter::Bilinear => (1.0, 0),
            Filter::Box3 => (3.0, 0),
            Filter::Box5 => (5.0, 0),
            Filter::Tent3 => (3.0, 1),
            Filter::Tent5 => (5.0, 1),
            Filter::Poisson16 | Filter::Poisson64 => return None,
        };
        let rule = Rule::new(lookup.bias, lookup.filter.reach(), depth, space);
        let Reach::Square(reach) = rule.reach() else { return None };
        // A position on the map has an error of a few units of an f32 of the map's side.
        let reach = reach as f32 + self.size * 4.0 * f32::EPSILON;
        let (way, bias) = match (lookup.bias, space.spread()) {
            (Bias::Receiver, _) => (RECEIVER, 0.0),
            (Bias::Texel, _) => (TEXEL, 0.0),
            (Bias::Constant, _) | (Bias::Range, Spread::Parallel { .. }) => (ADDED, rule.steepest(1.0)),
            (Bias::Range, Spread::Central { .. }) => (MULTIPLIED, rule.steepest(1.0)),
            (Bias::Normal, _) => (NORMAL, 0.0),
            (Bias::Offset, _) if depth == DepthSource::Interpolated => (ADDED, 0.0),
            (Bias::Offset | Bias::Second, _) => return None,
        };
        Some(Self { side, is_tent, way, bias: bias as f32, reach, ..self })
    }

    /// For the question whether the texels up to `reach` agree. A texel blocks if it lies above the
    /// receiver's plane at its center by more than the plane changes over one texel.
    pub(super) fn with_agreement(self, reach: u32) -> Self {
        Self { way: TEXEL, slack: 1.0, reach: reach as f32, ..self } // at most 16
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gpu::layout::assert_layout;

    #[test]
    fn light_of_a_map_has_one_layout_in_rust_and_wgsl() {
        assert_layout!(
            &format!("{}{}", crate::gpu::raster::SOURCE, super::super::SOURCE),
            "Light",
            LightUniform: right, up, axis, origin, scale, half, per_half, lowest, per_range, near, is_central,
            layers, layer, size, side, is_tent, way, reach, slack, rounding, bias
        );
    }
}
