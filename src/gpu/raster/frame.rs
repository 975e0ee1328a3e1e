//! The camera and light that shaders are given.

use bytemuck::{Pod, Zeroable};
use glam::{DVec2, DVec3};

use crate::geom::Light;
use crate::gpu::GpuError;
use crate::view::{Projection, ProjectionKind, Size};

/// Mirrors `struct Frame` in raster.wgsl.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(crate) struct Frame {
    right: [f32; 3],
    /// The power of two that coordinates are multiplied by.
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
    plane_stride: u32,
}

impl Frame {
    /// For triangles whose coordinates are at most `largest` in magnitude, without a light. Refuses
    /// projections whose depth the shaders do not have.
    pub(crate) fn new(projection: &Projection, size: Size, largest: f32) -> Result<Self, GpuError> {
        match projection.kind {
            ProjectionKind::InfinitePerspective => {}
            ProjectionKind::Perspective { .. } => return Err(GpuError::NotBuilt("a far plane")),
            ProjectionKind::Orthographic { .. } => return Err(GpuError::NotBuilt("an orthographic camera")),
        }
        let reach = projection.eye.iter().fold(largest, |most, x| most.max(x.abs()));
        let scale = to_one(reach);
        let ray = |x, y| projection.ray(DVec2::new(x, y));
        let middle = ray(0.0, 0.0);
        let narrow = |v: DVec3| v.as_vec3().into();
        Ok(Self {
            right: projection.right,
            scale,
            up: projection.up,
            near: projection.near * scale,
            forward: projection.forward,
            light_scale: to_one(0.0),
            ray_right: narrow(ray(1.0, 0.0) - middle),
            vertex_count: 0,
            ray_up: narrow(ray(0.0, 1.0) - middle),
            light_w: 0.0,
            ray_forward: narrow(middle),
            width: size.width() as f32, // at most 2¹⁴
            eye: projection.eye.map(|x| x * scale),
            height: size.height() as f32,
            light: [0.0; 3],
            plane_stride: 0,
        })
    }

    /// For shaders that need the normals of faces and no camera.
    pub(crate) fn without_camera(largest: f32, stride: u32) -> Self {
        Self { scale: to_one(largest), plane_stride: stride, ..Self::zeroed() }
    }

    /// With normals of faces, whose components are stored `stride` numbers apart.
    pub(crate) fn with_planes(self, stride: u32) -> Self {
        Self { plane_stride: stride, ..self }
    }

    /// With a light, for a volume of `vertex_count` finite vertices whose coordinates are at most `largest`.
    pub(crate) fn with_light(self, light: &Light, largest: f32, vertex_count: u32) -> Self {
        let [lx, ly, lz, light_w] = light.homogeneous();
        // A directional light needs no common scale with the vertices.
        let reach = [lx, ly, lz].iter().fold(light_w * largest, |most, x| most.max(x.abs()));
        let light_scale = to_one(reach);
        Self { light_scale, vertex_count, light_w, light: [lx, ly, lz].map(|x| x * light_scale), ..self }
    }
}

/// The power of two that scales `x` to between 1 and 2, or the nearest one that is a normal number.
pub(crate) fn to_one(x: f32) -> f32 {
    let exponent = (x.to_bits() >> 23 & 0xff) as i32 - 127;
    f32::from_bits(((127 - exponent).clamp(1, 254) as u32) << 23)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gpu::layout::assert_layout;

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
    fn frame_has_one_layout_in_rust_and_wgsl() {
        assert_layout!(
            crate::gpu::raster::SOURCE,
            "Frame",
            Frame: right, scale, up, near, forward, light_scale, ray_right, vertex_count, ray_up, light_w,
            ray_forward, width, eye, height, light, plane_stride
        );
    }
}
