//! `umbrage verify`: every method against every other.

mod json;
mod pixels;
#[cfg(feature = "gpu")]
mod stencil;
mod text;

use std::path::PathBuf;

use umbrage::verify::points::{Judge, Options, Stratum, Verification, Verifier};
use umbrage::view::Size;

use super::input::{Source, SourceArgs};
use super::output::Output;
use super::parsers::{large, refuse_overwriting, seed};
use super::progress::Progress;
use super::render::require_png;
use super::resources::{AdapterArgs, ThreadArgs};
use super::view::ViewArgs;
use super::{Failure, Outcome, lights};
use pixels::Pixels;
#[cfg(feature = "gpu")]
use stencil::Graphics;
pub(super) use text::text;

/// Every method against every other: ray cast, winding numbers of the volume, big integers, stencil pass
///
/// Points are drawn where errors hide: on and near faces, in their planes, within two ulps of the boundary of
/// the shadow. With --gpu every pixel of a stencil pass is compared with the ray cast too, once with z-fail
/// for all shells and, where z-pass is proven to be right for some shells, once with z-pass for those. A
/// disagreement is a bug in umbrage, or in a graphics driver; a crack in the mesh is none.
#[derive(Clone, Debug, clap::Args)]
pub(crate) struct Args {
    #[command(flatten)]
    source: SourceArgs,

    /// How many points per light, spread evenly over the strata; 1000000 and 1e6 are the same
    #[arg(long, value_name = "N", default_value_t = 10_000, value_parser = large, allow_negative_numbers = true)]
    points: u64,

    /// Seed of the points; the same seed gives the same points
    #[arg(long, value_name = "S", default_value_t = 1, value_parser = seed, allow_negative_numbers = true)]
    seed: u64,

    /// Print one JSON document instead of text
    #[arg(long)]
    json: bool,

    #[command(flatten)]
    threads: ThreadArgs,

    #[command(flatten)]
    adapter: AdapterArgs,

    /// Also compare every pixel of a stencil pass with the ray cast, for each light
    #[arg(long)]
    gpu: bool,

    /// Width and height of that picture in pixels, each at most 16384; with --gpu [default: 512x512]
    #[arg(long, value_name = "WxH", allow_hyphen_values = true)]
    size: Option<Size>,

    #[command(flatten)]
    view: ViewArgs,

    /// Draw that picture: gray where both agree, darker in shadow; with --gpu [default: nothing is drawn]
    ///
    /// Grazing pixels are yellow, unsure ones sky blue, overflows blue; all other pixels that differ are
    /// vermilion with a ring around them. The picture of a second light is OUT-2.png, and so on.
    #[arg(long, value_name = "OUT.png")]
    picture: Option<PathBuf>,
}

/// How many disagreements are listed with their positions, per light.
const SHOWN: usize = 10;

/// The points of one run stay in memory: 16 bytes each.
const MOST_POINTS: u64 = 100_000_000;

impl Args {
    /// Refuses options of the stencil pass if none was asked for.
    fn require_gpu(&self) -> Result<(), Failure> {
        let asked = [
            ("--size", self.size.is_some()),
            ("--eye, --target, --fov, --ortho, --camera and --near", self.view.was_asked_for()),
            ("--picture", self.picture.is_some()),
            ("--adapter", self.adapter.was_asked_for()),
        ];
        match asked.into_iter().find(|(_, asked)| *asked && !self.gpu) {
            Some((flag, _)) => {
                let problem = format!("{flag} without --gpu: only the stencil pass needs it");
                Err(Failure::new(problem, "add --gpu"))
            }
            None => Ok(()),
        }
    }

    /// Refuses a picture or camera that is bad, as far as the command line shows.
    fn require_view(&self) -> Result<(), Failure> {
        if let Some(path) = &self.picture {
            require_png(path)?;
        }
        refuse_overwriting("--picture", self.picture.as_deref(), &self.source.file)?;
        self.view.refuse()
    }
}

pub(crate) fn run(args: Args) -> Result<Outcome, Failure> {
    args.require_gpu()?;
    args.require_view()?;
    if !(1..=MOST_POINTS).contains(&args.points) {
        let problem = format!("--points {} is not between 1 and {MOST_POINTS}", args.points);
        return Err(Failure::new(problem, "run several seeds instead of one long run"));
    }
    args.threads.apply()?;
    let graphics = if args.gpu { Some(Graphics::open(&args.adapter)?) } else { None };
    let source = args.source.load()?;
    lights::note_centers(&source.lights);
    let Source { format, caster, lights, .. } = &source;

    let progress = Progress::spinner("topology, proofs and tree");
    let verifier = Verifier::new(caster);
    verifier.prepare();
    drop(progress);
    let points = args.points as usize; // at most MOST_POINTS
    let options = Options { points, seed: args.seed, keep: SHOWN };
    let progress = Progress::bar("verifying points", lights.len() as u64 * args.points);
    let results: Vec<Verification> = lights
        .iter()
        .map(|light| verifier.verify(light.light(), &options, &|points| progress.done(points)))
        .collect();
    drop(progress);
    let pixels = match graphics {
        Some(graphics) => Some(graphics.judge(&args, &source)?),
        None => None,
    };

    let mut output = Output::new();
    if args.json {
        let file = args.source.file.to_string_lossy();
        output.json(&json::document(&file, *format, lights, &results, pixels.as_ref()))?;
    } else {
        output.text(text::report(&args.source.file, lights, &results, pixels.as_ref()))?;
    }
    output.flush()?;
    let agreed = results.iter().all(Verification::agrees)
        && pixels.is_none_or(|pixels| pixels.counts().disagree() == 0);
    Ok(if agreed { Outcome::Sound } else { Outcome::Unsound })
}

/// This build has no graphics.
#[cfg(not(feature = "gpu"))]
enum Graphics {}

#[cfg(not(feature = "gpu"))]
impl Graphics {
    fn open(_: &AdapterArgs) -> Result<Self, Failure> {
        Err(Failure::new("--gpu: this build has no graphics", "build it with the feature `gpu`"))
    }

    fn judge(&self, _: &Args, _: &Source) -> Result<Pixels, Failure> {
        match *self {}
    }
}

/// The strata, summed over the lights.
fn strata(results: &[Verification]) -> Vec<Stratum> {
    let sum = |a: Vec<Stratum>, b: &Verification| a.iter().zip(&b.strata).map(|(a, b)| a.plus(b)).collect();
    let [first, rest @ ..] = results else { return Vec::new() };
    rest.iter().fold(first.strata.clone(), sum)
}

/// The methods checked for each light, the stencil passes last.
fn judges(results: &[Verification], pixels: Option<&Pixels>) -> Vec<Vec<Judge>> {
    let stencil = |light: usize| pixels.map(|pixels| pixels.lights[light].judges());
    let each = results.iter().enumerate();
    each.map(|(light, result)| {
        [&result.judges[..], stencil(light).as_ref().map_or(&[], |rows| &rows[..])].concat()
    })
    .collect()
}

/// The same, summed over the lights.
fn summed(judges: &[Vec<Judge>]) -> Vec<Judge> {
    let sum = |a: Vec<Judge>, b: &Vec<Judge>| a.iter().zip(b).map(|(a, b)| a.plus(b)).collect();
    let [first, rest @ ..] = judges else { return Vec::new() };
    rest.iter().fold(first.clone(), sum)
}

fn total(strata: &[Stratum]) -> Stratum {
    strata.iter().fold(Stratum { name: "all", ..Stratum::default() }, |sum, row| sum.plus(row))
}
