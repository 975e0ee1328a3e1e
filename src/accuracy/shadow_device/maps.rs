//! The device form of techniques with a map.

use crate::accuracy::Spread;
use crate::accuracy::shadow::{ShadowRow, timed};
use crate::caster::GpuCaster;
use crate::gpu::{Gpu, GpuError, wgpu};
use crate::oracle::Verdict;
use crate::shadow::map::gpu::{GpuMap, HybridPass, IdPass, Lookup, MapPass, Marked};
use crate::shadow::map::{DepthSource, ExactOptions, Fit, LightSpace, MapOptions, PcfOptions};
use crate::shadow::soft::gpu::{PcssPass, SearchPass};
use crate::shadow::soft::{PcssOptions, Search, SingleSampleOptions};
use crate::shadow::{Claim, GpuSamples, GpuVisibility, Request, Technique, Visibility, is_front_lit};
use crate::verify::errors::{Errors, Made, Truth};

/// The compiled passes.
#[derive(Clone, Debug)]
pub(super) struct Passes {
    map: MapPass,
    hybrid: HybridPass,
    ids: IdPass,
    pcss: PcssPass,
    search: SearchPass,
}

impl Passes {
    pub(super) fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        Ok(Self {
            map: MapPass::new(gpu)?,
            hybrid: HybridPass::new(gpu)?,
            ids: IdPass::new(gpu)?,
            pcss: PcssPass::new(gpu)?,
            search: SearchPass::new(gpu)?,
        })
    }
}

/// One caster under one lamp on a device.
pub(super) struct MapForms<'f> {
    gpu: &'f Gpu,
    passes: &'f Passes,
    request: &'f Request<'f>,
    truth: &'f Truth,
    drawn: &'f GpuSamples,
    on_device: GpuCaster,
    upload_ms: f64,
    rounds: u32,
}

/// What was measured of a device form.
struct Measured {
    technique: Technique,
    values: Vec<f32>,
    prepare_ms: f64,
    frames: Vec<f64>,
    readback_ms: f64,
    bytes: usize,
    asked_exactly: Option<u64>,
}

impl<'f> MapForms<'f> {
    pub(super) fn new(
        gpu: &'f Gpu,
        passes: &'f Passes,
        request: &'f Request<'f>,
        truth: &'f Truth,
        drawn: &'f GpuSamples,
        rounds: u32,
    ) -> Result<Self, GpuError> {
        // What is seen beside the casters casts nothing.
        let caster = request.casters.casters()[0];
        let (on_device, upload_ms) = timed(|| GpuCaster::upload(gpu, caster));
        Ok(Self { gpu, passes, request, truth, drawn, on_device: on_device?, upload_ms, rounds })
    }

    /// Adds a row for each row of the CPU whose technique and options have a device form.
    /// All others go to `cpu_only`, with what the device form lacks.
    pub(super) fn add_rows(
        &self,
        rows: &mut Vec<ShadowRow>,
        cpu_only: &mut Vec<(Technique, &'static str)>,
    ) -> Result<(), GpuError> {
        for on_cpu in rows.clone().into_iter().filter(|row| row.device.is_none()) {
            let measured = match on_cpu.technique {
                Technique::Map(options) | Technique::Pcf(PcfOptions(options)) => {
                    self.filtered(on_cpu.technique, options)
                }
                Technique::Hybrid3x3(options) => self.hybrid(options),
                Technique::MapIds(options) => self.ids(options),
                Technique::Pcss(options) => self.pcss(options),
                Technique::SingleSample(options) => self.single_sample(options),
                _ => continue,
            };
            match measured {
                // An option that only the CPU has.
                Err(GpuError::NotBuilt(lacks)) => cpu_only.push((on_cpu.technique, lacks)),
                measured => rows.push(self.row(on_cpu, measured?)),
            }
        }
        Ok(())
    }

    fn row(&self, on_cpu: ShadowRow, measured: Measured) -> ShadowRow {
        let (request, claim) = (self.request, Claim::Approximate);
        let shown = Visibility::from_values(request.samples, request.light(), measured.values, claim);
        let is_soft = on_cpu.technique.is_soft();
        let made = Made { texel: on_cpu.texel_world, is_soft, ..Made::default() };
        let errors = Errors::of(request, &shown, self.truth, &made);
        ShadowRow {
            technique: measured.technique,
            device: Some(self.gpu.name()),
            claim,
            holds: errors.hold(claim),
            errors,
            asked_exactly: measured.asked_exactly,
            prepare_ms: self.upload_ms + measured.prepare_ms,
            frame_ms: Spread::of(measured.frames),
            readback_ms: Some(measured.readback_ms),
            bytes: measured.bytes as u64,
            values: shown.values().to_vec(),
            // A device does not count what it reads.
            reads: on_cpu.reads.filter(|_| {
                matches!(
                    measured.technique,
                    Technique::Map(_) | Technique::Pcf(_) | Technique::Hybrid3x3(_) | Technique::MapIds(_)
                )
            }),
            ..on_cpu
        }
    }

    fn filtered(&self, technique: Technique, options: MapOptions) -> Result<Measured, GpuError> {
        if options.fit != Fit::Scene {
            return Err(GpuError::NotBuilt("a map fitted to the view"));
        }
        let lookup = Lookup { filter: options.filter, bias: options.bias };
        let (map, prepare_ms) = match options.depth {
            DepthSource::Plane => self.draw(options.size)?,
            DepthSource::Interpolated => {
                let space = self.space(options.size)?;
                self.waited(|| self.passes.map.draw_interpolated(&self.on_device, &space, lookup))?
            }
        };
        let look = || self.passes.map.visibility(self.drawn, &map, lookup);
        self.measured(technique, map.bytes(), prepare_ms, look)
    }

    fn pcss(&self, options: PcssOptions) -> Result<Measured, GpuError> {
        let (map, draw_ms) = self.draw(options.size)?;
        let (soft, ms) = self.waited(|| self.passes.pcss.prepare(&map, self.request.lamp))?;
        let look = || self.passes.pcss.visibility(self.drawn, &map, &soft, &options);
        self.measured(Technique::Pcss(options), map.bytes() + soft.bytes(), draw_ms + ms, look)
    }

    fn single_sample(&self, options: SingleSampleOptions) -> Result<Measured, GpuError> {
        if options.adaptive != 0 || options.literal {
            return Err(GpuError::NotBuilt("adaptive or literal single samples"));
        }
        let (map, draw_ms) = self.draw(options.size)?;
        let (soft, ms) = self.waited(|| self.passes.search.prepare(&map, self.request.lamp))?;
        let look = || self.passes.search.visibility(self.drawn, &map, &soft);
        let technique = Technique::SingleSample(SingleSampleOptions { search: Search::Device, ..options });
        self.measured(technique, map.bytes() + soft.bytes(), draw_ms + ms, look)
    }

    fn hybrid(&self, options: ExactOptions) -> Result<Measured, GpuError> {
        let (map, prepare_ms) = self.draw(options.size)?;
        let mark = || self.passes.hybrid.mark(self.drawn, &map, options.reach);
        self.marked(Technique::Hybrid3x3(options), map.bytes(), prepare_ms, mark)
    }

    fn ids(&self, options: ExactOptions) -> Result<Measured, GpuError> {
        let space = self.space(options.size)?;
        let (map, prepare_ms) = self.waited(|| self.passes.ids.draw(&self.on_device, &space))?;
        let mark = || self.passes.ids.mark(self.drawn, &map, options.reach);
        self.marked(Technique::MapIds(options), map.bytes(), prepare_ms, mark)
    }

    /// The time of a frame is that of the marks and of the exact answers; the marks that are read back in
    /// between are part of the read-back.
    fn marked(
        &self,
        technique: Technique,
        bytes: usize,
        prepare_ms: f64,
        mark: impl Fn() -> Result<Marked, GpuError>,
    ) -> Result<Measured, GpuError> {
        let frame = || {
            let (marked, mark_ms) = self.waited(&mark)?;
            let (asked, readback_ms) = timed(|| marked.download(self.gpu));
            let asked = asked?;
            let ((is_dark, rays), exact_ms) = timed(|| self.exactly(&asked));
            let (visibility, resolve_ms) =
                self.waited(|| self.passes.hybrid.resolve(&marked, &asked, &is_dark))?;
            Ok::<_, GpuError>((visibility, rays, mark_ms + exact_ms + resolve_ms, readback_ms))
        };
        let (visibility, rays, _, marks_ms) = frame()?;
        let (values, readback_ms) = timed(|| visibility.download(self.gpu));
        let frames = (0..self.rounds.max(1)).map(|_| frame().map(|(_, _, ms, _)| ms));
        Ok(Measured {
            technique,
            values: values?,
            prepare_ms,
            frames: frames.collect::<Result<_, _>>()?,
            readback_ms: marks_ms + readback_ms,
            // A byte and a bit per sample.
            bytes: bytes + self.request.samples.len() * 9 / 8,
            asked_exactly: Some(rays),
        })
    }

    /// Whether each of these samples is in shadow, by the exact ray cast, and the number of rays.
    fn exactly(&self, asked: &[u32]) -> (Vec<bool>, u64) {
        const RUN: usize = 64;
        let (hits, light) = (self.request.samples.hits(), self.request.light());
        let oracle = self.request.casters.oracle();
        let mut verdicts = vec![None; asked.len()];
        crate::parallel::rows(&mut verdicts, RUN, |run, verdicts| {
            for (verdict, &sample) in verdicts.iter_mut().zip(&asked[run * RUN..]) {
                let hit = hits[sample as usize].as_ref().filter(|hit| is_front_lit(hit, light));
                *verdict = hit.map(|hit| oracle.verdict(hit.point, light));
            }
        });
        let is_dark = verdicts.iter().map(|&verdict| verdict == Some(Verdict::Shadowed)).collect();
        (is_dark, verdicts.iter().flatten().count() as u64)
    }

    fn measured(
        &self,
        technique: Technique,
        bytes: usize,
        prepare_ms: f64,
        look: impl Fn() -> Result<GpuVisibility, GpuError>,
    ) -> Result<Measured, GpuError> {
        let (visibility, _) = self.waited(&look)?;
        let (values, readback_ms) = timed(|| visibility.download(self.gpu));
        let frames = (0..self.rounds.max(1)).map(|_| self.waited(&look).map(|(_, ms)| ms));
        Ok(Measured {
            technique,
            values: values?,
            prepare_ms,
            frames: frames.collect::<Result<_, _>>()?,
            readback_ms,
            // Two bytes per sample.
            bytes: bytes + 2 * self.request.samples.len(),
            asked_exactly: None,
        })
    }

    /// The map of the scene, and the time to draw it.
    fn draw(&self, size: u32) -> Result<(GpuMap, f64), GpuError> {
        let space = self.space(size)?;
        self.waited(|| self.passes.map.draw(&self.on_device, &space))
    }

    fn space(&self, size: u32) -> Result<LightSpace, GpuError> {
        let space = LightSpace::of_scene(self.request.casters, self.request.lamp, size);
        space.map_err(|_| GpuError::NotBuilt("a map of this size"))
    }

    /// The result of work on the device once it is done, and its time.
    fn waited<T>(&self, work: impl Fn() -> Result<T, GpuError>) -> Result<(T, f64), GpuError> {
        let (result, ms) = timed(|| {
            let result = work()?;
            self.gpu.attempt(|| self.gpu.device().poll(wgpu::PollType::wait_indefinitely()))?.ok();
            Ok(result)
        });
        result.map(|result| (result, ms))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accuracy::ShadowAccuracy;
    use crate::caster::{Caster, CasterGroup};
    use crate::gpu::tests::gpu;
    use crate::mesh::Mesh;
    use crate::scene::Lamp;
    use crate::shadow::{Depth, PrepareError, Samples};
    use crate::testing::shapes;
    use crate::view::{Camera, Size, Up};

    const TECHNIQUES: [&str; 10] = [
        "map:size=128,filter=nearest",
        "pcf:size=128",
        "hybrid-3x3:size=128",
        "pcss:size=128",
        "single-sample:size=128",
        "map-ids:size=128",
        "map:size=128,bias=offset,depth=interpolated",
        "pcf:size=128,bias=normal",
        // What has no form on a device gets no row; an option without one is told.
        "single-sample:size=128,adaptive=4",
        "vsm:size=128",
    ];

    /// The rows of a device, each with that of the CPU.
    fn rows(gpu: &Gpu, passes: &Passes, lamp: &str) -> Vec<[ShadowRow; 2]> {
        let floor = shapes::translated(&shapes::scaled(&shapes::sheet(1), 12.0), [-6.0, -6.0, -2.0]);
        let caster = Caster::new(Mesh::concat(&[floor, shapes::torus(24, 12, 2.0, 0.7)]).unwrap());
        let casters = CasterGroup::new(vec![&caster]);
        let size = Size::new(64, 48).unwrap();
        let projection = Camera::fit(&casters.bounds(), Up::Z, size.aspect()).projection(size, 0.125);
        let view = |casters: &CasterGroup<'_>| Ok(Samples::of_view(casters, &projection, size, 1).unwrap());
        let lamps = [lamp.parse::<Lamp>().unwrap()];
        let techniques = TECHNIQUES.map(|technique| technique.parse().unwrap());
        let (samples, mut found) =
            ShadowAccuracy::measure::<PrepareError>(&casters, &lamps, &techniques, view, 1, &|_| {}).unwrap();
        let found = found.remove(0);
        let mut rows = found.rows;
        let drawn =
            GpuCaster::upload(gpu, &caster).unwrap().samples(&projection, size, Depth::Plane).unwrap();
        let request = Request { casters: &casters, lamp: &lamps[0], samples: &samples };
        let forms = MapForms::new(gpu, passes, &request, &found.truth, &drawn, 1).unwrap();
        let mut cpu_only = Vec::new();
        forms.add_rows(&mut rows, &mut cpu_only).unwrap();
        let [(only, lacks)] = cpu_only[..] else { panic!("{cpu_only:?}") };
        assert_eq!(only.to_string(), "single-sample:size=128,adaptive=4");
        assert_eq!(lacks, "adaptive or literal single samples");
        let on_device = rows.split_off(TECHNIQUES.len());
        rows.into_iter().zip(on_device).map(|(cpu, device)| [cpu, device]).collect()
    }

    #[test]
    fn accuracy_of_maps_on_a_device_is_that_of_the_cpu_and_a_fault_changes_it() {
        let Some(gpu) = gpu() else { return };
        let passes = Passes::new(&gpu).unwrap();
        for lamp in ["directional:0.4,0.2,-1,angle=4", "spot:3,4,9:-0.3,-0.4,-0.9:35,radius=0.4"] {
            let found = rows(&gpu, &passes, lamp);
            assert_eq!(found.len(), 8);
            for [cpu, device] in &found {
                let text = format!("{lamp} {}", device.technique);
                assert_eq!(cpu.technique.name(), device.technique.name());
                assert!(device.device.is_some() && device.readback_ms.is_some(), "{text}");
                // The CPU tests faces exactly; a device asks where rounding might decide.
                let asks = cpu.asked_exactly.is_some() || cpu.technique.name() == "map-ids";
                assert_eq!(device.asked_exactly.is_some(), asks, "{text}");
                let (a, b) = (cpu.errors.mean, device.errors.mean);
                assert!((a - b).abs() < 0.004 && cpu.errors.judged == device.errors.judged, "{text} {a} {b}");
            }
            assert_eq!(found[4][1].technique.to_string(), "single-sample:size=128,search=device");
            assert!(found[2][1].asked_exactly.unwrap() > 10);
            assert!(found[5][1].errors.acne == 0, "{:?}", found[5][1].errors);
        }
    }

    /// Several casters have one map, whose faces are numbered over all of them. Fault injected: only the
    /// first caster is drawn.
    #[test]
    fn accuracy_of_several_casters_on_a_device_is_that_of_the_cpu() {
        let Some(gpu) = gpu() else { return };
        let floor = shapes::translated(&shapes::scaled(&shapes::sheet(1), 12.0), [-6.0, -6.0, -2.0]);
        let casters = [floor, shapes::torus(24, 12, 2.0, 0.7), shapes::translated(&shapes::cube(), [2.0; 3])]
            .map(Caster::new);
        let casters = CasterGroup::new(casters.iter().collect());
        let size = Size::new(64, 48).unwrap();
        let projection = Camera::fit(&casters.bounds(), Up::Z, size.aspect()).projection(size, 0.125);
        let view = |casters: &CasterGroup<'_>| Ok(Samples::of_view(casters, &projection, size, 1).unwrap());
        let lamps = ["spot:3,4,9:-0.3,-0.4,-0.9:35".parse::<Lamp>().unwrap()];
        let techniques =
            ["zfail", "map:size=128", "map-ids:size=128", "hybrid-3x3:size=128", "pcss:size=128"];
        let techniques = techniques.map(|technique| technique.parse().unwrap());
        let (samples, found) =
            ShadowAccuracy::measure::<PrepareError>(&casters, &lamps, &techniques, view, 1, &|_| {}).unwrap();
        let first = CasterGroup::new(vec![casters.casters()[0]]);
        let [right, wrong] = [&casters, &first].map(|drawn| {
            let mut found = found[0].clone();
            found.add_device(&gpu, drawn, &samples, 1).unwrap();
            found.rows
        });
        let on_device = |rows: &[ShadowRow], name| {
            let row = rows.iter().find(|row| row.device.is_some() && row.technique.name() == name);
            row.cloned().expect("it has a row")
        };
        for cpu in &found[0].rows {
            let name = cpu.technique.name();
            let [right, wrong] = [&right, &wrong].map(|rows| on_device(rows, name).errors);
            assert!(right.judged * 100 > cpu.errors.judged * 95, "{name} {right:?}");
            assert!(
                (right.mean - cpu.errors.mean).abs() < 0.004,
                "{name} {} {}",
                right.mean,
                cpu.errors.mean
            );
            assert!(wrong.mean > right.mean + 0.02, "{name} {} {}", wrong.mean, right.mean);
        }
    }

    /// Fault injected: a wrong visibility texture is in the errors of its row.
    #[test]
    fn accuracy_of_a_wrong_texture_of_a_device_shows_in_its_row() {
        let Some(gpu) = gpu() else { return };
        let dark = ("return lit / (lit + dark);", "return 0.5 * lit / (lit + dark);");
        let nearest = ("select(1.0, 0.0, blocks(", "select(0.0, 1.0, blocks(");
        let lamp = "directional:0.4,0.2,-1,angle=4";
        let right = rows(&gpu, &Passes::new(&gpu).unwrap(), lamp);
        for (row, (text, fault)) in [(1, dark), (0, nearest)] {
            let map = MapPass::with_fault(&gpu, text, fault);
            let wrong = rows(&gpu, &Passes { map, ..Passes::new(&gpu).unwrap() }, lamp);
            let [right, wrong] = [&right, &wrong].map(|rows| rows[row][1].errors.mean);
            assert!(wrong > 1.02 * right, "{text} {right} {wrong}");
        }
        let pcss = PcssPass::with_fault(&gpu, "1.0 - found.share", "found.share");
        let search =
            SearchPass::with_fault(&gpu, "select(distance, -distance,", "select(-distance, distance,");
        let wrong = rows(&gpu, &Passes { pcss, search, ..Passes::new(&gpu).unwrap() }, lamp);
        for row in [3, 4] {
            let [right, wrong] = [&right, &wrong].map(|rows| rows[row][1].errors.mean);
            assert!(wrong > 2.0 * right, "{row} {right} {wrong}");
        }
    }
}
