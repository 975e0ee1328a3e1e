//! The device form of techniques, beside their CPU form.

mod counted;
mod maps;

use self::counted::Counted;
use self::maps::{MapForms, Passes};
use super::Spread;
use super::shadow::{ShadowAccuracy, ShadowRow, mark_dominated, timed};
use crate::caster::{CasterGroup, GpuCaster};
use crate::gpu::{Gpu, GpuError, wgpu};
use crate::shadow::planar::gpu::{GpuGround, PlanarPass};
use crate::shadow::stencil::{StencilMethod, StencilPass};
use crate::shadow::{Claim, Depth, GpuSamples, Request, Samples, Technique, Visibility};
use crate::verify::errors::{Errors, Made, Truth};
use crate::verify::pixels::PlanarFootprint;

/// The techniques with a device form, and the method that counts every shell.
const ON_DEVICE: [(Technique, Option<StencilMethod>); 3] = [
    (Technique::Stencil, None),
    (Technique::ZFail, Some(StencilMethod::ZFail)),
    (Technique::ZPass, Some(StencilMethod::ZPass)),
];

impl ShadowAccuracy {
    /// Adds a row per technique with a device form, for one sample per pixel; nothing for other views.
    /// Several casters are one on the device: one map, one count over all of them. Samples within the
    /// rasterizer's footprint are not judged.
    ///
    /// # Errors
    ///
    /// [`GpuError`] if the view or the volumes do not fit the device.
    pub fn add_device(
        &mut self,
        gpu: &Gpu,
        casters: &CasterGroup<'_>,
        samples: &Samples,
        rounds: u32,
    ) -> Result<(), GpuError> {
        if samples.per_side() != 1 || casters.casters().is_empty() {
            return Ok(());
        }
        let too_large = GpuError::NotBuilt("more than 2³² corners of all casters together");
        let joined = casters.joined().map_err(|_| too_large)?;
        let joined = joined.as_ref().map(|caster| {
            let group = CasterGroup::new(vec![caster]);
            // Seen are the casters, unless more is.
            match casters.seen_caster() {
                Some(seen) => group.seen_with(seen),
                None => group,
            }
        });
        let casters = joined.as_ref().unwrap_or(casters);
        let [caster] = casters.casters() else { return Ok(()) };
        let (lamp, truth) = (self.lamp.clone(), self.truth.clone());
        let request = Request { casters, lamp: &lamp, samples };
        let pass = StencilPass::new(gpu, Depth::Plane)?;
        let (on_device, upload_ms) =
            timed(|| GpuCaster::upload(gpu, casters.seen_caster().unwrap_or(caster)));
        let on_device = on_device?;
        let (projection, size) = (samples.projection(), samples.size());
        let drawn = on_device.samples(projection, size, Depth::Plane)?;
        let counted =
            Counted { gpu, caster, request: &request, truth: &truth, pass, drawn, on_device, rounds };
        let prepare_ms = self.counting_ms + upload_ms;
        for (technique, method) in ON_DEVICE {
            self.rows.push(counted.row(technique, method, prepare_ms)?);
        }
        let others = self.rows.clone().into_iter().filter(|row| row.device.is_none());
        for technique in others.map(|row| row.technique) {
            let row = match technique {
                Technique::ZPassPlus => counted.zpass_plus(prepare_ms),
                Technique::Hybrid(options) => counted.masked(options, prepare_ms),
                _ => continue,
            };
            match row {
                // Counts that the stencil does not hold.
                Err(GpuError::NotBuilt(lacks)) => self.cpu_only.push((technique, lacks)),
                row => self.rows.push(row?),
            }
        }
        let drawn = &counted.drawn;
        let passes = Passes::new(gpu)?;
        MapForms::new(gpu, &passes, &request, &truth, drawn, rounds)?
            .add_rows(&mut self.rows, &mut self.cpu_only)?;
        self.add_planar(gpu, &request, &truth, drawn, rounds)?;
        mark_dominated(&mut self.rows);
        Ok(())
    }

    /// The row of `planar`, if it was measured on the CPU: the samples of the plane on the device, all others
    /// by the exact rays of the CPU.
    fn add_planar(
        &mut self,
        gpu: &Gpu,
        request: &Request<'_>,
        truth: &Truth,
        drawn: &GpuSamples,
        rounds: u32,
    ) -> Result<(), GpuError> {
        let on_cpu = self.rows.iter().find(|row| matches!(row.technique, Technique::Planar(_))).cloned();
        let (Some(on_cpu), [caster]) = (on_cpu, request.casters.casters()) else { return Ok(()) };
        let Technique::Planar(options) = on_cpu.technique else { return Ok(()) };
        let (samples, light) = (request.samples, request.light());
        let Some(plane) = options.plane.plane(samples, light) else { return Ok(()) };
        let pass = PlanarPass::new(gpu)?;
        let (ground, upload_ms) = timed(|| {
            let seen = request.casters.seen_caster().unwrap_or(caster);
            GpuGround::new(gpu, plane, seen, caster, &GpuCaster::upload(gpu, caster)?)
        });
        let ground = ground?;
        let frame = || {
            let visibility = pass.visibility(drawn, &ground, light)?;
            gpu.attempt(|| gpu.device().poll(wgpu::PollType::wait_indefinitely()))?.ok();
            Ok::<_, GpuError>(visibility)
        };
        let visibility = frame()?;
        let (values, readback_ms) = timed(|| visibility.download(gpu));
        let frames = (0..rounds.max(1)).map(|_| timed(frame)).map(|(found, ms)| found.map(|_| ms));
        let frames = frames.collect::<Result<Vec<f64>, _>>()?;
        let is_on_plane = |index: usize| samples.hits()[index].is_some_and(|hit| plane.holds(hit.corners));
        let values = values?.into_iter().zip(&on_cpu.values).enumerate();
        let values: Vec<f32> =
            values.map(|(index, (value, &ray))| if is_on_plane(index) { value } else { ray }).collect();
        let claim = Claim::WithinFootprint;
        let shown = Visibility::from_values(samples, light, values, claim);
        let around =
            PlanarFootprint::new(request.casters, plane, *light, samples.projection(), samples.size());
        let width = samples.size().width() as usize;
        let footprint =
            shown.values().iter().zip(&on_cpu.values).enumerate().map(|(index, (value, exact))| {
                let [x, y] = [index % width, index / width].map(|k| k as f64 + 0.5);
                value != exact && around.changes(x, y)
            });
        let made = Made { footprint: &footprint.collect::<Vec<bool>>(), ..Made::default() };
        let errors = Errors::of(request, &shown, truth, &made);
        self.rows.push(ShadowRow {
            device: Some(gpu.name()),
            claim,
            holds: errors.hold(claim),
            errors,
            prepare_ms: upload_ms,
            frame_ms: Spread::of(frames),
            readback_ms: Some(readback_ms),
            bytes: (ground.bytes() + samples.len()) as u64,
            values: shown.values().to_vec(),
            ..on_cpu
        });
        Ok(())
    }
}
