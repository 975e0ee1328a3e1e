//! The device form of techniques that count shadow volumes.

use crate::accuracy::Spread;
use crate::accuracy::shadow::{ShadowRow, timed};
use crate::caster::{Caster, GpuCaster};
use crate::gpu::{Gpu, GpuError, wgpu};
use crate::light_grid::{Chain, GridVerdict, LightGrid};
use crate::shadow::stencil::{
    Counting, MaskedPass, ReceiverTiles, StencilMethod, StencilPass, StencilVolumes, ZPassPlusPass,
    max_depth_complexity,
};
use crate::shadow::volume::GpuVolume;
use crate::shadow::{Claim, Depth, GpuSamples, GpuVisibility, GridOptions, Request, Technique, Visibility};
use crate::verify::errors::{Errors, Made, Truth};
use crate::verify::pixels::{PixelVerdict, Rendered, compare};

/// One caster under one lamp on a device.
pub(super) struct Counted<'f> {
    pub(super) gpu: &'f Gpu,
    pub(super) caster: &'f Caster,
    pub(super) request: &'f Request<'f>,
    pub(super) truth: &'f Truth,
    pub(super) pass: StencilPass,
    pub(super) drawn: GpuSamples,
    pub(super) on_device: GpuCaster,
    pub(super) rounds: u32,
}

impl Counted<'_> {
    /// Counts by one method, or by that of each shell.
    pub(super) fn row(
        &self,
        technique: Technique,
        method: Option<StencilMethod>,
        prepare_ms: f64,
    ) -> Result<ShadowRow, GpuError> {
        let (samples, light) = (self.request.samples, self.request.light());
        let (volumes, volume_ms) = self.volumes(method);
        let (uploaded, ms) = timed(|| volumes.upload_in_pieces(self.gpu, self.caster));
        let uploaded = uploaded?;
        let draws = uploaded.draws();
        // z-pass claims something only where it was chosen, not where it was asked for.
        let claim = match method {
            Some(StencilMethod::ZPass) => Claim::Approximate,
            _ => Claim::WithinFootprint,
        };
        // Where the volumes may count depends on the camera, so it is found again in each frame.
        let frame = || {
            let within = self.pass.within(ReceiverTiles::facing(samples, light));
            within.visibility(&self.drawn, &draws, volumes.counting())
        };
        self.measured(technique, claim, &volumes, prepare_ms + volume_ms + ms, frame)
    }

    /// z-pass from the counts at the near rectangle, which claims nothing: it has a band of one pixel.
    pub(super) fn zpass_plus(&self, prepare_ms: f64) -> Result<ShadowRow, GpuError> {
        let (volumes, volume_ms) = self.volumes(Some(StencilMethod::ZFail));
        if volumes.counting() != Counting::Stencil {
            return Err(GpuError::NotBuilt("z-pass from the near rectangle with counts of 256 or more"));
        }
        let pass = ZPassPlusPass::new(self.gpu, Depth::Plane)?;
        let (uploaded, ms) = timed(|| volumes.upload(self.gpu));
        let uploaded = uploaded?;
        let drawn: Vec<&GpuVolume> = uploaded.draws().iter().map(|draw| draw.volume).collect();
        let frame = || pass.visibility(&self.drawn, &drawn);
        let prepare_ms = prepare_ms + volume_ms + ms;
        self.measured(Technique::ZPassPlus, Claim::Approximate, &volumes, prepare_ms, frame)
    }

    /// The light grid of the CPU, and the device's stencil for the samples that it leaves undecided.
    pub(super) fn masked(&self, options: GridOptions, prepare_ms: f64) -> Result<ShadowRow, GpuError> {
        let (samples, light) = (self.request.samples, self.request.light());
        let (volumes, volume_ms) = self.volumes(None);
        let layers = max_depth_complexity(self.caster.mesh(), &volumes.signs, light, MaskedPass::LIMIT);
        if !layers.is_below() {
            return Err(GpuError::NotBuilt("a masked stencil with counts of 128 or more"));
        }
        let pass = MaskedPass::new(self.gpu, Depth::Plane)?;
        let (chain, chain_ms) = timed(|| Chain::of(self.request.casters, light));
        let (uploaded, ms) = timed(|| volumes.upload(self.gpu));
        let uploaded = uploaded?;
        let draws = uploaded.draws();
        let frame = || {
            let points = samples.hits().iter().flatten().map(|hit| hit.point);
            let grid = LightGrid::build(&chain, points, options.grid);
            let verdict = |hit: &Option<_>| hit.as_ref().map_or(GridVerdict::Dark, |hit| grid.verdict(hit));
            let verdicts: Vec<GridVerdict> = samples.hits().iter().map(verdict).collect();
            pass.visibility(&self.drawn, &draws, &verdicts)
        };
        let prepare_ms = prepare_ms + volume_ms + chain_ms + ms;
        let technique = Technique::Hybrid(options);
        self.measured(technique, Claim::WithinFootprint, &volumes, prepare_ms, frame)
    }

    fn volumes(&self, method: Option<StencilMethod>) -> (StencilVolumes, f64) {
        let (light, projection) = (self.request.light(), self.request.samples.projection());
        timed(|| self.caster.stencil_volumes(light, projection, None, method))
    }

    /// The row of a frame. The footprint is that of the volumes.
    fn measured(
        &self,
        technique: Technique,
        claim: Claim,
        volumes: &StencilVolumes,
        prepare_ms: f64,
        frame: impl Fn() -> Result<GpuVisibility, GpuError>,
    ) -> Result<ShadowRow, GpuError> {
        let (gpu, samples, light) = (self.gpu, self.request.samples, self.request.light());
        let frame = || {
            let visibility = frame()?;
            gpu.attempt(|| gpu.device().poll(wgpu::PollType::wait_indefinitely()))?.ok();
            Ok::<_, GpuError>(visibility)
        };
        let visibility = frame()?;
        let (values, readback_ms) = timed(|| visibility.download(gpu));
        let frames = (0..self.rounds.max(1)).map(|_| timed(frame)).map(|(found, ms)| found.map(|_| ms));
        let frames = frames.collect::<Result<Vec<f64>, _>>()?;
        let shown = Visibility::from_values(samples, light, values?, claim);
        let projection = samples.projection();
        let drawn = volumes.upload(gpu)?;
        let (draws, counting) = (drawn.draws(), volumes.counting());
        let mask = self.pass.mask(projection, samples.size(), &self.on_device, &draws, counting)?;
        let rendered = Rendered {
            caster: self.caster,
            seen: self.request.casters.seen_caster(),
            signs: &volumes.signs,
            light,
            projection,
            // Samples are cut at the near plane, too.
            seen_from: projection.near,
            mask: &mask,
            unsure: &[],
        };
        let verdicts = compare(&rendered, 0, &|_| {}).verdicts;
        let footprint: Vec<bool> = verdicts.iter().map(|&v| v == PixelVerdict::Grazing).collect();
        let made = Made { footprint: &footprint, ..Made::default() };
        let errors = Errors::of(self.request, &shown, self.truth, &made);
        Ok(ShadowRow {
            technique,
            device: Some(gpu.name()),
            claim,
            holds: errors.hold(claim),
            errors,
            asked_exactly: None,
            prepare_ms,
            frame_ms: Spread::of(frames),
            readback_ms: Some(readback_ms),
            reads: None,
            updates: None,
            bias_world: None,
            texel_world: None,
            bytes: (volumes.volumes.iter().map(|(_, volume)| volume.bytes()).sum::<usize>() + samples.len())
                as u64,
            dominated_by: None,
            values: shown.values().to_vec(),
        })
    }
}
