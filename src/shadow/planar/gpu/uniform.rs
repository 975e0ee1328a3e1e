//! The plane and light that the shader is given.

use bytemuck::{Pod, Zeroable};

use super::super::Plane;
use super::super::matrix::Flattening;
use crate::geom::Light;
use crate::gpu::raster::to_one;

/// Mirrors `struct Plane` in planar.wgsl.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(super) struct PlaneUniform {
    normal: [f32; 3],
    height: f32,
    origin: [f32; 3],
    light_w: f32,
    light: [f32; 3],
    padding: u32,
}

impl PlaneUniform {
    /// A plane with the light in front, for vertices that are multiplied by `scale`.
    pub(super) fn new(plane: &Plane, light: &Light, scale: f32) -> Self {
        let flattening = Flattening::<f64>::new(plane, light);
        let narrow = |v: [f64; 3]| v.map(|x| x as f32);
        let (light_w, by) = if light.is_directional() {
            let largest = flattening.light.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
            (0.0, f64::from(to_one(largest as f32)))
        } else {
            // All of (l, 1) by one power of two, in scaled lengths.
            let scaled = flattening.light.map(|x| x * f64::from(scale));
            let largest = scaled.iter().fold(1.0_f64, |most, x| most.max(x.abs()));
            let own = to_one(largest.min(f32::MAX.into()) as f32);
            (own, f64::from(own) * f64::from(scale))
        };
        Self {
            normal: narrow(plane.normal.to_array()),
            height: (flattening.height * by) as f32,
            origin: narrow((plane.origin * f64::from(scale)).to_array()),
            light_w,
            light: narrow(flattening.light.map(|x| x * by)),
            padding: 0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gpu::layout::assert_layout;

    #[test]
    fn planar_uniform_has_one_layout_in_rust_and_wgsl() {
        let source = format!("{}{}", crate::gpu::raster::SOURCE, super::super::SOURCE);
        assert_layout!(&source, "Plane", PlaneUniform: normal, height, origin, light_w, light, padding);
    }
}
