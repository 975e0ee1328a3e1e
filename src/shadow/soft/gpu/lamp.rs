//! A lamp with an extent as shaders take it.

use bytemuck::{Pod, Zeroable};
use glam::DVec3;

use crate::scene::Lamp;
use crate::shadow::map::Spread;
use crate::shadow::map::gpu::GpuMap;

/// Mirrors `struct SoftLamp` in soft.wgsl.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(super) struct LampUniform {
    across: [f32; 3],
    radius: f32,
    along: [f32; 3],
    per_extent: f32,
    center: [f32; 3],
    is_round: u32,
    blockers: u32,
    taps: u32,
    per_size: f32,
    spare: u32,
}

/// Squares of larger numbers are none.
const MOST: f64 = 1e18;

impl LampUniform {
    pub(super) fn new(lamp: &Lamp, map: &GpuMap) -> Self {
        let (space, scale) = (map.space(), map.uniform.scale());
        let size = f64::from(space.size());
        let (unit, per_extent) = match space.spread() {
            Spread::Parallel { .. } => (1.0, space.penumbra_scale(1.0)),
            Spread::Central { tan, near } => (scale, size / (2.0 * tan * near * scale)),
        };
        // Where it is seen from matters for a disk alone, and there for its directions alone.
        let patch = lamp.patch([0.0; 3]);
        let turns = patch.as_ref().is_some_and(|patch| patch.is_round && !patch.is_directional);
        let edges = patch.as_ref().map_or([DVec3::ZERO; 2], |patch| [patch.across, patch.along]);
        let short = |v: DVec3| (v * unit).clamp(DVec3::splat(-MOST), DVec3::splat(MOST)).as_vec3().to_array();
        let [across, along] = edges.map(short);
        let center = patch.as_ref().map_or(DVec3::ZERO, |patch| match patch.is_directional {
            true => patch.center,
            false => patch.center - space.origin(),
        });
        Self {
            across,
            radius: if turns { (edges[0].length() * unit).min(MOST) as f32 } else { 0.0 },
            along,
            per_extent: per_extent.min(MOST) as f32,
            center: short(center),
            is_round: patch.is_some_and(|patch| patch.is_round).into(),
            blockers: 0,
            taps: 0,
            per_size: 1.0 / space.size() as f32,
            spare: 0,
        }
    }

    /// With a number of points for the search of blockers and for the filter; 0 for all texels.
    pub(super) fn with_points(self, blockers: u32, taps: u32) -> Self {
        Self { blockers, taps, ..self }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gpu::Shader;
    use crate::gpu::layout::assert_layout;

    #[test]
    fn lamp_with_extent_has_one_layout_in_rust_and_wgsl() {
        assert_layout!(
            Shader::new("", &super::super::search_source()).source(), "SoftLamp",
            LampUniform: across, radius, along, per_extent, center, is_round, blockers, taps, per_size, spare
        );
    }
}
