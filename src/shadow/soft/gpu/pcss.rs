//! The technique `pcss` on a device.

use super::{GpuSoftMap, Shade, SoftPass};
use crate::gpu::raster::{GpuSamples, GpuVisibility};
use crate::gpu::{Gpu, GpuError, Shader, wgpu};
use crate::random::r2;
use crate::scene::Lamp;
use crate::shadow::map::gpu::GpuMap;
use crate::shadow::soft::{PcssOptions, Taps};

const PCSS: &str = include_str!("pcss.wgsl");

/// The compiled passes, for one device.
#[derive(Clone, Debug)]
pub struct PcssPass {
    gpu: Gpu,
    soft: SoftPass,
    look: Shade,
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
        let look = Shade::new(gpu, &module, "soft_visibility")?;
        Ok(Self { gpu: gpu.clone(), soft: SoftPass::new(gpu)?, look })
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
        let points: Vec<[f32; 2]> =
            (0..blockers.max(taps).max(1)).map(|index| r2(index).map(|x| x as f32)).collect();
        let points = self.gpu.upload("even points", &points)?;
        let more = [
            (7, wgpu::BindingResource::TextureView(&map.view)),
            (9, soft.pyramid.as_entire_binding()),
            (12, points.as_entire_binding()),
        ];
        self.look.draw(&self.gpu, samples, map, &soft.lamp.with_points(blockers, taps), &more)
    }
}
