//! What the shaders know of the camera and the light.

use bytemuck::{Pod, Zeroable};
use glam::{DVec2, DVec3};

use crate::geom::Light;
use crate::view::Projection;
use crate::view::Size;

/// Mirrors `struct Frame` in stencil.wgsl.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(crate) struct Frame {
    right: [f32; 3],
    pub(crate) scale: f32,
    up: [f32; 3],
    near: f32,
    forward: [f32; 3],
    light_scale: f32,
    ray_right: [f32; 3],
    vertex_count: u32,
    ray_up: [f32; 3],
    light_w: f32,
    ray_forward: [f32; 3],
    width: f32,
    eye: [f32; 3],
    height: f32,
    light: [f32; 3],
    unused: f32,
}

impl Frame {
    /// For receivers and volumes whose coordinates are `largest` at most. Without a light for receivers alone.
    pub(super) fn new(
        projection: &Projection,
        size: Size,
        largest: f32,
        light: Option<&Light>,
        vertex_count: u32,
    ) -> Self {
        let reach = projection.eye.iter().fold(largest, |most, x| most.max(x.abs()));
        let scale = to_one(reach);
        let ray = |x, y| projection.ray(DVec2::new(x, y));
        let middle = ray(0.0, 0.0);
        let narrow = |v: DVec3| v.as_vec3().into();
        let [lx, ly, lz, light_w] = light.map_or([0.0; 4], Light::homogeneous);
        // A directional light needs no common scale with the vertices.
        let light_reach = [lx, ly, lz].iter().fold(light_w * largest, |most, x| most.max(x.abs()));
        let light_scale = to_one(light_reach);
        Self {
            right: projection.right,
            scale,
            up: projection.up,
            near: projection.near * scale,
            forward: projection.forward,
            light_scale,
            ray_right: narrow(ray(1.0, 0.0) - middle),
            vertex_count,
            ray_up: narrow(ray(0.0, 1.0) - middle),
            light_w,
            ray_forward: narrow(middle),
            width: size.width() as f32, // at most 2¹⁴
            eye: projection.eye.map(|x| x * scale),
            height: size.height() as f32,
            light: [lx, ly, lz].map(|x| x * light_scale),
            unused: 0.0,
        }
    }
}

/// The power of two that brings `x` to between 1 and 2; as near to it as a normal number can.
fn to_one(x: f32) -> f32 {
    let exponent = (x.to_bits() >> 23 & 0xff) as i32 - 127;
    f32::from_bits(((127 - exponent).clamp(1, 254) as u32) << 23)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frame_scales_to_one_by_powers_of_two() {
        for x in [1.0, 1.5, 2.0, 3e-30, 1e30, 8e37, f32::MIN_POSITIVE] {
            let scale = to_one(x);
            assert!(scale.is_normal() && scale.to_bits() & 0x7f_ffff == 0, "{x}: {scale}");
            assert!((1.0..2.0).contains(&(x * scale)), "{x}: {scale}");
        }
        // The largest numbers would need a subnormal scale, the smallest one beyond the range; 0 stays 0.
        assert!(f32::MAX * to_one(f32::MAX) <= 4.0);
        assert!(to_one(0.0).is_normal() && to_one(f32::from_bits(1)).is_normal());
    }

    #[test]
    fn frame_stands_in_the_shader_as_it_does_here() {
        let module = naga::front::wgsl::parse_str(include_str!("../stencil.wgsl")).unwrap();
        let (_, frame) = module.types.iter().find(|(_, kind)| kind.name.as_deref() == Some("Frame")).unwrap();
        let naga::TypeInner::Struct { members, span } = &frame.inner else { panic!("a struct") };
        assert_eq!(*span as usize, size_of::<Frame>());
        macro_rules! offsets {
            ($($field:ident),*) => { [$((stringify!($field), std::mem::offset_of!(Frame, $field))),*] };
        }
        let here = offsets![
            right,
            scale,
            up,
            near,
            forward,
            light_scale,
            ray_right,
            vertex_count,
            ray_up,
            light_w,
            ray_forward,
            width,
            eye,
            height,
            light,
            unused
        ];
        let there = members.iter().map(|m| (m.name.as_deref().unwrap_or(""), m.offset as usize));
        assert_eq!(there.collect::<Vec<_>>(), here);
    }
}
