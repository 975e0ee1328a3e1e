//! Runs the stencil passes and compares their pixels with the ray cast.

use std::path::{Path, PathBuf};

use umbrage::caster::{Caster, GpuCaster};
use umbrage::geom::Light;
use umbrage::gpu::{Gpu, GpuError};
use umbrage::render::{MemoryError, verdict_color, verdicts};
use umbrage::scene::Lamp;
use umbrage::shadow::Depth;
use umbrage::shadow::stencil::{ShadowMask, ShellMethods, StencilMethod, StencilPass, StencilVolumes};
use umbrage::verify::pixels::{Comparison, PixelVerdict, Rendered, compare};
use umbrage::view::{Projection, Size};

use super::pixels::{LightPixels, PASSES, Pass, Pixels};
use super::{Args, SHOWN};
use crate::cli::caption::captioned;
use crate::cli::input::Source;
use crate::cli::parsers::{refuse_overwriting, require_folder};
use crate::cli::progress::Progress;
use crate::cli::resources::AdapterArgs;
use crate::cli::{Failure, output};

/// The pixels of a picture for which no size is asked, in a row and in a column.
const SIDE: u32 = 512;

/// The graphics adapter, opened before any work, so that a missing one is reported at once.
pub(super) struct Graphics(Gpu);

impl Graphics {
    pub(super) fn open(adapter: &AdapterArgs) -> Result<Self, Failure> {
        adapter.open("--gpu").map(Self)
    }

    pub(super) fn judge(&self, args: &Args, source: &Source) -> Result<Pixels, Failure> {
        let size = args.size.unwrap_or(Size::new(SIDE, SIDE).expect("in range"));
        let Source { cameras, bounds, up, .. } = source;
        let camera = args.view.choose(cameras, &args.source.file, bounds, *up, size)?;
        let projection = camera.projection(size, camera.near([source.seen().mesh()], size));
        if projection.is_orthographic() {
            return Err(GpuError::NotBuilt("an orthographic camera").into());
        }
        let job = Job {
            caster: &source.caster,
            seen: source.seen.as_ref(),
            lights: &source.lights,
            projection,
            near_asked: camera.near.is_some(),
            size,
            pictures: &pictures(args, source.lights.len())?,
        };
        judge(&self.0, &job)
    }
}

/// Where the pictures go, one a light.
fn pictures(args: &Args, lights: usize) -> Result<Vec<PathBuf>, Failure> {
    let Some(path) = &args.picture else { return Ok(Vec::new()) };
    require_folder(path)?;
    let paths: Vec<PathBuf> = (1..=lights).map(|light| output::numbered(path, light)).collect();
    for path in &paths {
        refuse_overwriting("--picture", Some(path), &args.source.file)?;
    }
    Ok(paths)
}
/// What is to be compared.
struct Job<'a> {
    caster: &'a Caster,
    /// All that is seen, if that is more than the caster.
    seen: Option<&'a Caster>,
    lights: &'a [Lamp],
    projection: Projection,
    /// Whether the distance of the near plane comes from the user or the file.
    near_asked: bool,
    size: Size,
    /// The names of the pictures, one per light; empty for none.
    pictures: &'a [PathBuf],
}

/// Bytes per pixel in memory, at most: depth and counts as read back, two masks, two comparisons, a picture.
const PIXEL_BYTES: usize = 24;

/// Refuses a picture that memory could not hold, before any work.
fn require_memory(size: Size) -> Result<(), Failure> {
    let mut probe: Vec<u8> = Vec::new();
    let reserved = probe.try_reserve_exact(size.pixels().saturating_mul(PIXEL_BYTES));
    reserved.map_err(|_| Failure::new(MemoryError(size), "choose a smaller --size"))
}

fn judge(gpu: &Gpu, job: &Job<'_>) -> Result<Pixels, Failure> {
    require_memory(job.size)?;
    let progress = Progress::spinner("topology, proofs and shaders");
    let bench = Bench {
        gpu,
        job,
        pass: StencilPass::new(gpu, Depth::Plane)?,
        receivers: GpuCaster::upload(gpu, job.seen.unwrap_or(job.caster))?,
    };
    drop(progress);
    let mut lights = Vec::new();
    for (index, light) in job.lights.iter().enumerate() {
        let (pixels, comparison) = bench.judge_light(index, light.light())?;
        if let Some(path) = job.pictures.get(index) {
            draw(job, &comparison, path)?;
        }
        lights.push(pixels);
    }
    let Job { projection, near_asked, size, .. } = *job;
    Ok(Pixels { adapter: gpu.name(), size, projection, near_asked, lights })
}

struct Bench<'a> {
    gpu: &'a Gpu,
    job: &'a Job<'a>,
    pass: StencilPass,
    receivers: GpuCaster,
}

impl Bench<'_> {
    /// The passes of one light, and all of them as one comparison.
    fn judge_light(&self, index: usize, light: &Light) -> Result<(LightPixels, Comparison), Failure> {
        let [zfail, auto] = PASSES.map(|(asked, _)| asked);
        let casting = self.cast(light, Some(StencilMethod::ZFail));
        let mask = self.mask(&casting)?;
        let mut worst = self.compare(index, light, &casting, &mask);
        let mut passes = vec![describe(zfail, &casting, &worst)];

        let casting = self.cast(light, None);
        if casting.methods.count(StencilMethod::ZPass) > 0 {
            let chosen = self.mask(&casting)?;
            if counts_the_same(&mask, &chosen) {
                passes.push(describe(auto, &casting, &worst));
            } else {
                let comparison = self.compare(index, light, &casting, &chosen);
                passes.push(describe(auto, &casting, &comparison));
                for (worst, verdict) in worst.verdicts.iter_mut().zip(comparison.verdicts) {
                    *worst = (*worst).max(verdict);
                }
            }
        }
        Ok((LightPixels { passes, counts: worst.counts() }, worst))
    }

    fn cast(&self, light: &Light, method: Option<StencilMethod>) -> StencilVolumes {
        self.job.caster.stencil_volumes(light, &self.job.projection, None, method)
    }

    fn mask(&self, casting: &StencilVolumes) -> Result<ShadowMask, Failure> {
        let volumes = casting.upload(self.gpu)?;
        let Job { projection, size, .. } = self.job;
        Ok(self.pass.mask(projection, *size, &self.receivers, &volumes.draws(), casting.counting())?)
    }

    fn compare(
        &self,
        index: usize,
        light: &Light,
        casting: &StencilVolumes,
        mask: &ShadowMask,
    ) -> Comparison {
        let Job { caster, seen, lights, projection, size, near_asked, .. } = self.job;
        let what = format!("comparing pixels, light {} of {}", index + 1, lights.len());
        let progress = Progress::bar(what, size.height().into());
        // The volumes come from exact signs: no face is unsure.
        let seen_from = if *near_asked { projection.near } else { 0.0 };
        let signs = &casting.signs;
        let rendered =
            Rendered { caster, seen: *seen, signs, light, projection, seen_from, mask, unsure: &[] };
        compare(&rendered, SHOWN, &|rows| progress.done(rows))
    }
}

/// Whether two masks are equal in every pixel: then their verdicts are the same.
fn counts_the_same(a: &ShadowMask, b: &ShadowMask) -> bool {
    let mut pixels = (0..a.size().height()).flat_map(|y| (0..a.size().width()).map(move |x| (x, y)));
    a.counting() == b.counting() && pixels.all(|(x, y)| a.count(x, y) == b.count(x, y))
}

fn describe(asked: &'static str, casting: &StencilVolumes, comparison: &Comparison) -> Pass {
    Pass {
        asked,
        method: method(&casting.methods),
        reason: casting.methods.summary(),
        counting: casting.counting().name(),
        counting_reason: casting.layers.to_string(),
        counts: comparison.counts(),
        mismatches: comparison.mismatches.clone(),
    }
}

/// The method of all shells.
fn method(plan: &ShellMethods) -> &'static str {
    match (plan.count(StencilMethod::ZPass), plan.count(StencilMethod::ZFail)) {
        (0, _) => StencilMethod::ZFail.name(),
        (_, 0) => StencilMethod::ZPass.name(),
        _ => "mixed",
    }
}

/// Draws a comparison, and says what its colors mean.
fn draw(job: &Job<'_>, comparison: &Comparison, path: &Path) -> Result<(), Failure> {
    let progress = Progress::bar("drawing", job.size.height().into());
    let seen = job.seen.unwrap_or(job.caster).oracle();
    let picture = verdicts(seen, &job.projection, comparison, &|rows| progress.done(rows));
    drop(progress);
    let picture = picture.map_err(|error| Failure::new(error, "leave out --picture"))?;
    let occur: Vec<PixelVerdict> =
        PixelVerdict::ALL.into_iter().filter(|&verdict| comparison.count(verdict) > 0).collect();
    let keys = occur.iter().map(|&verdict| {
        let ringed = if verdict == PixelVerdict::Real { ", ringed" } else { "" };
        let words = format!("{}{ringed}: {}", verdict.name(), comparison.count(verdict));
        (verdict_color(verdict).1, words)
    });
    let real = comparison.count(PixelVerdict::Real);
    let numbers = format!("{} of {} pixels differ for no known reason", real, job.size.pixels());
    let lines = ["Stencil pass against exact ray cast, pixel by pixel", &numbers];
    captioned(picture, &lines, &keys.collect::<Vec<_>>()).write_png(path)?;
    let meaning = occur.iter().map(|&verdict| match verdict {
        PixelVerdict::Real => format!("{} real (ringed)", verdict_color(verdict).0),
        _ => format!("{} {}", verdict_color(verdict).0, verdict.name()),
    });
    let meaning = meaning.collect::<Vec<_>>().join(", ");
    output::say(format_args!("wrote {}: {meaning}", output::plain(&path.to_string_lossy())));
    Ok(())
}
