//! `umbrage plan`: which shadows a scene calls for, by which techniques, and why.

mod document;
mod drawn;
mod every;
mod options;
mod picture;
mod saved;
mod text;

use std::path::{Path, PathBuf};

use clap::builder::ArgPredicate;
use serde_json::Value;
use umbrage::caster::CasterGroup;
use umbrage::plan::{Budget, Costs, Scenery, ShadowPlan, plan};
use umbrage::render::Picture;
use umbrage::scene::Lamp;
use umbrage::shadow::Samples;
use umbrage::view::Size;
use umbrage::write::write_atomic;

pub(crate) use drawn::{FalloffArg, as_drawn, shaded};
pub(crate) use every::words as check_words;
pub(crate) use options::{measured_costs, read_costs};
#[cfg(any(all(test, feature = "gpu"), feature = "viewer"))]
pub(crate) use picture::known;
pub(crate) use saved::{Identity, Saved};

use super::input::{Source, SourceArgs};
use super::output::{self, Output};
use super::parsers::{refuse_overwriting, require_folder};
use super::progress::Progress;
use super::render::{parse_samples, require_png};
use super::resources::ThreadArgs;
use super::view::ViewArgs;
use super::{Failure, Outcome};
use every::Every;

/// Examples of `--help`.
const EXAMPLES: &str = "\
Examples:
  umbrage plan city.glb
  umbrage plan city.glb --budget error=0.01,time=16ms --all --thorough
  umbrage plan city.glb -o plan.json && umbrage render city.glb --shadow plan.json -o city.png
  umbrage plan --calibrate -o costs.json && umbrage plan city.glb --costs costs.json";

/// Shadows that a scene calls for: the cheapest technique for each light, within an error, and why
///
/// The budget says how many of the visible points may be wrong, and how long a picture may take. Without one
/// the plan is exact and takes the least time. What is not computed is listed with the reason. Nothing is
/// drawn; render --shadow auto draws what a plan says, and checks it.
///
/// Exit codes: 0 the budget is met, 1 it is not, 2 could not run.
#[derive(Clone, Debug, clap::Args)]
#[command(
    after_help = EXAMPLES,
    mut_arg("file", |file| file
        .required(false)
        .required_unless_present("calibrate")
        .default_value_if("calibrate", ArgPredicate::Equals("true".into()), "-"))
)]
pub(crate) struct Args {
    #[command(flatten)]
    source: SourceArgs,

    #[command(flatten)]
    view: ViewArgs,

    /// Width and height of the view in pixels, each at most 16384
    #[arg(long, value_name = "WxH", default_value = "960x540", allow_hyphen_values = true)]
    size: Size,

    /// How many samples each pixel of the view has: 1, 4, 9 or 16 [default: 1]
    #[arg(long, value_name = "N", value_parser = parse_samples, allow_negative_numbers = true)]
    samples: Option<u32>,

    /// Plan for points spread over all surfaces instead of a view
    #[arg(long, conflicts_with_all = ["eye", "camera", "near"])]
    no_camera: bool,

    /// What may be wrong, and how long a picture may take: error=F,light=F,level=N,time=16ms
    ///
    /// `error`: largest fraction of the visible points that may be wrong. `light`: a point is wrong if the
    /// fraction of a light that it sees differs by more than this [default: 0; 1/64 for a light with an
    /// extent]. `level`: a light that adds at most this many steps of 8 bits does not count. `time`: a wish;
    /// the error is a wall. [default: exact, in the least time]
    #[arg(long, value_name = "BUDGET", default_value = "", hide_default_value = true)]
    budget: Budget,

    /// Admit only errors that are exact or proven, and none that were sampled
    #[arg(long)]
    prove: bool,

    /// Times of this machine, as --calibrate wrote them [default: a built-in table]
    #[arg(long, value_name = "FILE")]
    costs: Option<PathBuf>,

    /// Measure the times of this machine first, for about two seconds
    ///
    /// Without SCENE they are written to -o, or to standard output, and nothing is planned. With SCENE they
    /// are used at once, and also written to --costs.
    #[arg(long)]
    calibrate: bool,

    /// How many pictures share what does not depend on the lights
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    frames: u32,

    /// Look for all that cannot matter, also where that takes longer than a tenth of the picture
    ///
    /// Without it such tests are left out, and the plan says so.
    #[arg(long)]
    thorough: bool,

    /// Run every technique that the plan considered, and print the truth beside each prediction
    #[arg(long)]
    all: bool,

    /// How the lights weaken with the distance
    #[arg(long, value_enum, default_value_t = FalloffArg::Plain)]
    falloff: FalloffArg,

    /// Draw in false colors what is proven about each point: lit, dark, undecided, in a penumbra, or of no
    /// concern [default: nothing is drawn]
    #[arg(long, value_name = "OUT.png")]
    picture: Option<PathBuf>,

    /// Add a large floor below everything: lowest in z for stl, md2 and 3mf, lowest in y for others
    #[arg(long)]
    ground: bool,

    /// Save the plan, for render --shadow plan.json [default: it is not saved]
    #[arg(short, long, value_name = "plan.json")]
    output: Option<PathBuf>,

    /// Print one JSON document instead of text
    #[arg(long)]
    json: bool,

    #[command(flatten)]
    threads: ThreadArgs,
}

/// A plan with what it was made for.
struct Planned<'a> {
    file: &'a Path,
    size: Size,
    lamps: &'a [Lamp],
    plan: &'a ShadowPlan,
    /// What running it gave, with `--all`.
    every: Option<&'a Every>,
}

pub(crate) fn run(args: Args) -> Result<Outcome, Failure> {
    args.refuse()?;
    args.threads.apply()?;
    let is_alone = args.calibrate && args.source.file == Path::new("-");
    let costs = match args.calibrate {
        true => {
            let costs = measured_costs();
            let path = if is_alone { args.output.as_deref() } else { args.costs.as_deref() };
            match path {
                Some(path) => save(path, &costs.to_json())?,
                None if is_alone => Output::new().text(costs.to_json())?,
                None => {}
            }
            costs
        }
        false => read_costs(args.costs.as_deref())?,
    };
    if is_alone {
        return Ok(Outcome::Sound);
    }
    args.plan(&costs)
}

impl Args {
    fn refuse(&self) -> Result<(), Failure> {
        if self.no_camera {
            let problem = "not built yet: --no-camera";
            return Err(Failure::new(problem, "leave it out: the plan is for a view"));
        }
        for (option, output) in [("--output", &self.output), ("--picture", &self.picture)] {
            refuse_overwriting(option, output.as_deref(), &self.source.file)?;
            output.as_deref().map_or(Ok(()), require_folder)?;
        }
        self.picture.as_deref().map_or(Ok(()), require_png)?;
        self.view.refuse()
    }

    fn plan(&self, costs: &Costs) -> Result<Outcome, Failure> {
        let file = &self.source.file;
        let mut source = self.source.load()?;
        require_faces(&source, file)?;
        let camera = self.view.choose(&source.cameras, file, &source.bounds, source.up, self.size)?;
        if self.ground {
            source.add_ground().map_err(|error| Failure::new(error, "leave out --ground").in_file(file))?;
        }
        let projection = camera.projection(self.size, camera.near([source.seen().mesh()], self.size));
        let physical = self.falloff == FalloffArg::Physical;
        let lamps = as_drawn(&source.lights, &shaded(&source, self.source.lights.were_asked_for(), physical));
        let progress = Progress::spinner("planning");
        let casters = source.group();
        let samples = Samples::of_view(&casters, &projection, self.size, self.samples.unwrap_or(1))
            .map_err(|error| Failure::new(error, "choose a smaller --size").in_file(file))?;
        require_seen(&samples, file)?;
        let mut scenery = Scenery::new(&casters, &lamps, &samples);
        scenery.physical_falloff = physical;
        scenery.frames = self.frames;
        scenery.prove = self.prove;
        scenery.thorough = self.thorough;
        let plan = plan(&scenery, &self.budget, costs);
        drop(progress);
        let every = self.all.then(|| Every::run(&scenery, &plan)).transpose()?;

        let planned =
            Planned { file, size: self.size, lamps: &source.lights, plan: &plan, every: every.as_ref() };
        let mut out = Output::new();
        match self.json {
            true => out.json(&planned.document())?,
            false => out.text(planned.text())?,
        }
        out.flush()?;
        if let Some(path) = &self.output {
            let identity = Identity::of(&source, &camera, self.size, self.falloff);
            save(path, &format!("{:#}\n", saved::document(planned.document(), &plan, &identity)))?;
        }
        if let Some(path) = &self.picture {
            self.draw(&casters, &lamps, &samples)?.write_png(path)?;
            output::wrote(path);
        }
        let failed = every.as_ref().is_some_and(Every::failed);
        Ok(if plan.meets_budget && !failed { Outcome::Sound } else { Outcome::Unsound })
    }

    fn draw(&self, casters: &CasterGroup<'_>, lamps: &[Lamp], samples: &Samples) -> Result<Picture, Failure> {
        let progress = Progress::spinner("drawing");
        let (picture, legend) = picture::draw(casters, lamps, samples)
            .map_err(|error| Failure::new(error, "choose a smaller --size"))?;
        drop(progress);
        output::say(format_args!("{legend}"));
        Ok(picture)
    }
}

/// Refuses a scene in which nothing is seen or casts.
pub(crate) fn require_faces(source: &Source, file: &Path) -> Result<(), Failure> {
    match source.seen().mesh().face_count() {
        0 => {
            let problem = "there are no faces to cast or to receive a shadow";
            Err(Failure::new(problem, "name a mesh that has some").in_file(file))
        }
        _ => Ok(()),
    }
}

/// Refuses a view of nothing.
fn require_seen(samples: &Samples, file: &Path) -> Result<(), Failure> {
    match samples.hits().iter().any(Option::is_some) {
        true => Ok(()),
        false => {
            let problem = "the view shows no surface that could receive a shadow";
            Err(Failure::new(problem, "turn it with --eye and --target, or choose a --camera").in_file(file))
        }
    }
}

fn save(path: &Path, text: &str) -> Result<(), Failure> {
    write_atomic(path, |out| out.write_all(text.as_bytes()))?;
    output::wrote(path);
    Ok(())
}

/// A value, or null.
fn or_null(value: Option<impl Into<Value>>) -> Value {
    value.map_or(Value::Null, Into::into)
}
