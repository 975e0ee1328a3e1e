//! The technique `pcss` on a device.

use super::{GpuSoftMap, SoftPass};
use crate::gpu::raster::{GpuSamples, GpuVisibility, Pipeline, everywhere};
use crate::gpu::{Gpu, GpuError, Shader, wgpu};
use crate::random::r2;
use crate::scene::Lamp;
use crate::shadow::map::gpu::{GpuMap, bind};
use crate::shadow::soft::{PcssOptions, Taps};

const PCSS: &str = include_str!("pcss.wgsl");

/// The compiled passes, for one device.
#[derive(Clone, Debug)]
pub struct PcssPass {
    gpu: Gpu,
    soft: SoftPass,
    look: wgpu::RenderPipeline,
}

impl PcssPass {
    /// Compiles the shaders.
    ///
    /// # Errors
    ///
    /// [`GpuError::Lost`], [`GpuError::OutOfMemory`].
    pub fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        Self::of(gpu, &super::source(PCSS))
    }

    /// The passes with one text of their shaders replaced, for the injected faults of tests.
    #[cfg(test)]
    pub(crate) fn with_fault(gpu: &Gpu, text: &str, fault: &str) -> Self {
        let source = super::source(PCSS);
        assert!(source.contains(text), "{text}");
        Self::of(gpu, &source.replace(text, fault)).expect("it compiles")
    }

    fn of(gpu: &Gpu, source: &str) -> Result<Self, GpuError> {
        let module = Shader::new("percentage-closer soft shadows", source).module(gpu)?;
        let look = Pipeline {
            vertex: "everywhere",
            fragment: Some("soft_visibility"),
            targets: &[Some(GpuVisibility::SOFT.into())],
            depth_stencil: None,
            layout: None,
        };
        Ok(Self { gpu: gpu.clone(), soft: SoftPass::new(gpu)?, look: look.build(gpu, &module)? })
    }

    /// What stays valid while only the camera moves. Submits without waiting.
    ///
    /// # Errors
    ///
    /// As [`SoftPass::prepare`].
    pub fn prepare(&self, map: &GpuMap, lamp: &Lamp) -> Result<GpuSoftMap, GpuError> {
        self.soft.prepare(map, lamp)
    }

    /// The visible part of the lamp at every sample; the map has the size that it was drawn with. Submits
    /// without waiting.
    ///
    /// # Errors
    ///
    /// [`GpuError::OutOfMemory`], [`GpuError::Lost`].
    pub fn visibility(
        &self,
        samples: &GpuSamples,
        map: &GpuMap,
        soft: &GpuSoftMap,
        options: &PcssOptions,
    ) -> Result<GpuVisibility, GpuError> {
        let count = |taps| match taps {
            Taps::All => 0,
            Taps::Some(count) => count,
        };
        let (blockers, taps) = (count(options.blockers), count(options.taps));
        let light = self.gpu.uniform(&map.uniform)?;
        let lamp = self.gpu.uniform(&soft.lamp.with_points(blockers, taps))?;
        let points: Vec<[f32; 2]> =
            (0..blockers.max(taps).max(1)).map(|index| r2(index).map(|x| x as f32)).collect();
        let points = self.gpu.upload("even points", &points)?;
        let visibility = GpuVisibility::soft(&self.gpu, samples.size())?;
        let more = [
            (5, wgpu::BindingResource::TextureView(&samples.faces.view)),
            (6, light.as_entire_binding()),
            (7, wgpu::BindingResource::TextureView(&map.view)),
            (8, lamp.as_entire_binding()),
            (9, soft.pyramid.as_entire_binding()),
            (12, points.as_entire_binding()),
        ];
        let group = bind(&self.gpu, &self.look, &samples.receivers, &samples.uniform, &more)?;
        self.gpu.submit(|encoder| {
            everywhere(visibility.0.begin(encoder, true), &self.look, Some(&group));
        })?;
        Ok(visibility)
    }
}
