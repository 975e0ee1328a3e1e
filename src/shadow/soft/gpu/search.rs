//! The technique `single-sample` on a device, with its search for the nearest edge.

use super::{GpuSoftMap, Shade, SoftPass};
use crate::caster::GpuCaster;
use crate::gpu::raster::{GpuSamples, GpuVisibility};
use crate::gpu::{Gpu, GpuError, Kernel, Shader, wgpu};
use crate::oracle::PrimaryHit;
use crate::scene::Lamp;
use crate::shadow::map::gpu::{GpuMap, MapPass, ROUNDING};
use crate::shadow::map::{LightSpace, Spread};
use crate::shadow::soft::around::{Around, Found};
use crate::shadow::soft::light_map::{Place, profile};
use crate::shadow::soft::{SingleSampleOptions, above_horizon};
use crate::shadow::{Answer, Claim, Request, Visibility};

const SEARCH: &str = include_str!("search.wgsl");

pub(in crate::shadow::soft) fn source() -> String {
    super::source(SEARCH)
}

/// The compiled passes, for one device.
#[derive(Clone, Debug)]
pub struct SearchPass {
    gpu: Gpu,
    soft: SoftPass,
    place: Kernel,
    search: Kernel,
    shade: Shade,
}

impl SearchPass {
    /// Compiles the shaders.
    ///
    /// # Errors
    ///
    /// [`GpuError::Lost`], [`GpuError::OutOfMemory`].
    pub fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        Self::of(gpu, &source())
    }

    /// The passes with one text of their shaders replaced, for the injected faults of tests.
    #[cfg(test)]
    pub(crate) fn with_fault(gpu: &Gpu, text: &str, fault: &str) -> Self {
        assert!(source().contains(text), "{text}");
        Self::of(gpu, &source().replace(text, fault)).expect("it compiles")
    }

    fn of(gpu: &Gpu, source: &str) -> Result<Self, GpuError> {
        let module = Shader::new("single-sample soft shadows", source).module(gpu)?;
        Ok(Self {
            gpu: gpu.clone(),
            soft: SoftPass::new(gpu)?,
            place: Kernel::new(gpu, &module, "place")?,
            search: Kernel::new(gpu, &module, "search")?,
            shade: Shade::new(gpu, &module, "single_sample")?,
        })
    }

    /// What stays valid while only the camera moves. Submits without waiting.
    ///
    /// # Errors
    ///
    /// As [`SoftPass::prepare`].
    pub fn prepare(&self, map: &GpuMap, lamp: &Lamp) -> Result<GpuSoftMap, GpuError> {
        self.soft.prepare(map, lamp)
    }

    /// The visible part of the lamp at every sample. Submits without waiting.
    ///
    /// # Errors
    ///
    /// [`GpuError::TooLarge`] if 64 bytes per sample do not fit a buffer; [`GpuError::OutOfMemory`];
    /// [`GpuError::Lost`].
    pub fn visibility(
        &self,
        samples: &GpuSamples,
        map: &GpuMap,
        soft: &GpuSoftMap,
    ) -> Result<GpuVisibility, GpuError> {
        let count = samples.size().pixels();
        let placed = self.place(samples, map, soft)?;
        let found = self.search(&placed, count, map, soft)?;
        self.shade.draw(&self.gpu, samples, map, &soft.lamp, &[(15, found.as_entire_binding())])
    }

    /// The receivers of all samples.
    pub(super) fn place(
        &self,
        samples: &GpuSamples,
        map: &GpuMap,
        soft: &GpuSoftMap,
    ) -> Result<wgpu::Buffer, GpuError> {
        let count = samples.size().pixels();
        let placed = self.gpu.storage::<Around>("receivers of a search", count)?;
        let (light, lamp) = (self.gpu.uniform(&map.uniform)?, self.gpu.uniform(&soft.lamp)?);
        let more = [
            (5, wgpu::BindingResource::TextureView(&samples.faces.view)),
            (6, light.as_entire_binding()),
            (8, lamp.as_entire_binding()),
            (12, placed.as_entire_binding()),
        ];
        let receivers = samples.receivers.bindings(&samples.uniform);
        let group = self.place.bind_all(&self.gpu, receivers.into_iter().chain(more))?;
        self.gpu.submit(|encoder| self.place.record(encoder, &group, count))?;
        Ok(placed)
    }

    /// The nearest change around each receiver.
    pub(super) fn search(
        &self,
        receivers: &wgpu::Buffer,
        count: usize,
        map: &GpuMap,
        soft: &GpuSoftMap,
    ) -> Result<wgpu::Buffer, GpuError> {
        let found = self.gpu.storage::<Found>("changes found by a search", count)?;
        let (light, lamp) = (self.gpu.uniform(&map.uniform)?, self.gpu.uniform(&soft.lamp)?);
        let group = self.search.bind_all(
            &self.gpu,
            [
                (6, light.as_entire_binding()),
                (7, wgpu::BindingResource::TextureView(&map.view)),
                (8, lamp.as_entire_binding()),
                (9, soft.pyramid.as_entire_binding()),
                (13, receivers.as_entire_binding()),
                (14, found.as_entire_binding()),
            ],
        )?;
        self.gpu.submit(|encoder| self.search.record(encoder, &group, count))?;
        Ok(found)
    }

    /// Shades samples of the processor: receivers are placed there, and searched around on the device.
    ///
    /// # Errors
    ///
    /// [`GpuError::NotBuilt`] for a size that is not one of a map, and for the options
    /// `adaptive` and `literal`; [`GpuError::Picture`] if the map is larger than the device allows;
    /// [`GpuError::TooLarge`], [`GpuError::Subnormal`], [`GpuError::OutOfMemory`], [`GpuError::Lost`].
    pub fn shade(
        &self,
        request: &Request<'_>,
        options: &SingleSampleOptions,
    ) -> Result<Visibility, GpuError> {
        let joined = request.casters.joined();
        let joined =
            joined.map_err(|_| GpuError::NotBuilt("more than 2³² corners of all casters together"))?;
        let Some(caster) = joined.as_ref().or(request.casters.casters().first().copied()) else {
            return Err(GpuError::NotBuilt("a map of no casters"));
        };
        if options.adaptive != 0 || options.literal {
            return Err(GpuError::NotBuilt("adaptive or literal single samples"));
        }
        let space = LightSpace::of_scene(request.casters, request.lamp, options.size);
        let space = space.map_err(|_| GpuError::NotBuilt("a map of this size"))?;
        let map = MapPass::new(&self.gpu)?.draw(&GpuCaster::upload(&self.gpu, caster)?, &space)?;
        let soft = self.prepare(&map, request.lamp)?;
        let around = |hit: &PrimaryHit| receiver(&space, request.lamp, hit);
        let placed: Vec<Around> = (request.samples.hits().iter())
            .map(|hit| hit.as_ref().and_then(around).unwrap_or_default())
            .collect();
        let receivers = self.gpu.upload("receivers of a search", &placed)?;
        let found = self.search(&receivers, placed.len(), &map, &soft)?;
        let found: Vec<Found> = self.gpu.download(&found, placed.len())?;
        let (samples, claim) = (request.samples, Claim::Approximate);
        let mut visibility = Visibility::of_indexed(samples, request.light(), claim, |index, hit| {
            let is_round = request.lamp.patch(hit.point).is_some_and(|patch| patch.is_round);
            let change = found[index];
            let distance = change.distance();
            let value = profile(is_round, if change.is_inner != 0 { -distance } else { distance });
            Answer { is_outside: placed[index].is_there == 0, ..Answer::of(value.clamp(0.0, 1.0) as f32) }
        });
        above_horizon(&mut visibility, samples, request.lamp);
        Ok(visibility)
    }
}

/// The receiver at a visible point, with what the rounding of a map on a device takes.
pub(super) fn receiver(space: &LightSpace, lamp: &Lamp, hit: &PrimaryHit) -> Option<Around> {
    let place = Place::of(space, lamp, hit)?;
    let rounding = match space.spread() {
        Spread::Parallel { .. } => f64::from(ROUNDING),
        Spread::Central { .. } => f64::from(ROUNDING) * place.d,
    };
    Around::of(&place, rounding)
}
