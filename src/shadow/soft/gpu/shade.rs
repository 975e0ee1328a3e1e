//! The pass that fills a visibility texture from a soft map.

use super::LampUniform;
use crate::gpu::raster::{GpuSamples, GpuVisibility, Pipeline, everywhere};
use crate::gpu::{Gpu, GpuError, wgpu};
use crate::shadow::map::gpu::{GpuMap, bind};

/// A fragment shader that reads triangles, visible faces, the light and the lamp.
#[derive(Clone, Debug)]
pub(super) struct Shade(wgpu::RenderPipeline);

impl Shade {
    pub(super) fn new(gpu: &Gpu, module: &wgpu::ShaderModule, fragment: &str) -> Result<Self, GpuError> {
        let shade = Pipeline {
            vertex: "everywhere",
            fragment: Some(fragment),
            targets: &[Some(GpuVisibility::SOFT.into())],
            depth_stencil: None,
            layout: None,
        };
        Ok(Self(shade.build(gpu, module)?))
    }

    /// One value per sample, with what else the shader reads. Submits without waiting.
    pub(super) fn draw(
        &self,
        gpu: &Gpu,
        samples: &GpuSamples,
        map: &GpuMap,
        lamp: &LampUniform,
        more: &[(u32, wgpu::BindingResource<'_>)],
    ) -> Result<GpuVisibility, GpuError> {
        let (light, lamp) = (gpu.uniform(&map.uniform)?, gpu.uniform(lamp)?);
        let visibility = GpuVisibility::soft(gpu, samples.size())?;
        let shared = [
            (5, wgpu::BindingResource::TextureView(&samples.faces.view)),
            (6, light.as_entire_binding()),
            (8, lamp.as_entire_binding()),
        ];
        let all: Vec<_> = shared.into_iter().chain(more.iter().cloned()).collect();
        let group = bind(gpu, &self.0, &samples.receivers, &samples.uniform, &all)?;
        gpu.submit(|encoder| everywhere(visibility.0.begin(encoder, true), &self.0, Some(&group)))?;
        Ok(visibility)
    }
}
