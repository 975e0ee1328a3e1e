//! `umbrage accuracy`: error against time.

mod ambient;
mod chart;
mod csv;
mod json;
mod shadow;
mod text;

use std::path::{Path, PathBuf};

use serde_json::Value;
use umbrage::accuracy::{Accuracy, MOST_LIGHTS, Method, Options, Question};
use umbrage::geom::Light;
use umbrage::scene::Lamp;
use umbrage::shadow::Technique;
use umbrage::view::Size;
use umbrage::write::write_atomic;

use super::ambient::rays;
use super::files;
use super::input::{CastArgs, Source, SourceArgs};
use super::lights::LightArgs;
use super::load::MeshArgs;
use super::output::{self, Output};
use super::parsers::{large, refuse_overwriting, require_folder, seed};
use super::pose::PoseArgs;
use super::progress::Progress;
use super::render::parse_samples;
use super::resources::{AdapterArgs, ThreadArgs};
use super::view::ViewArgs;
use super::{Failure, Outcome, lights};

/// Help of `--threads` where times are measured.
const THREADS: &str =
    "How many threads read and prepare, from 1 to 1024; queries are timed on one thread [default: 1]";

/// Error against time: how often each method is wrong, and how long it takes
///
/// Plain f32, filtered exact and always exact arithmetic answer the same queries in the same run, taking
/// turns on one thread, and every answer is compared with that of big integers. Queries come in strata, from
/// scattered ones to those where rounding decides; where two answers are right (a tie), plain methods may
/// give either, and exact ones must say so. A wrong answer of an exact method is a bug in umbrage.
///
/// For shadow, every technique draws the same view; for ambient, rays and disks are compared with the
/// analytic openness. For example: umbrage accuracy ambient model.glb --svg ambient.svg
#[derive(Clone, Debug, clap::Args)]
#[command(mut_arg("threads", |threads| threads.help(THREADS)))]
pub(crate) struct Args {
    /// What is decided
    #[arg(value_enum)]
    what: What,

    /// Mesh files, or folders of such, or - for standard input: obj, gltf, glb, stl, ply, off, md2, 3mf; also
    /// in gzip or ZIP; recognized by their content, then by their extension
    #[arg(required = true, value_name = "FILE")]
    files: Vec<PathBuf>,

    #[command(flatten)]
    mesh: MeshArgs,

    #[command(flatten)]
    pose: PoseArgs,

    #[command(flatten)]
    cast: CastArgs,

    #[command(flatten)]
    lights: LightArgs,

    /// About how many queries per stratum, at most 10000000; for facing no more than 4096 per face
    /// [default: 1000000 for facing, 10000 for visibility, 1000 for ambient]
    ///
    /// 10000, 10_000 and 1e4 are the same. For facing a query is a face and a light, and every light is asked
    /// about all faces; for visibility it is a point and a light; for ambient it is a vertex with a normal,
    /// and they are evenly spaced among all.
    #[arg(long, value_name = "N", value_parser = large, allow_negative_numbers = true)]
    queries: Option<u64>,

    /// How many rounds are timed; the median is reported
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = rounds, allow_negative_numbers = true)]
    rounds: u32,

    /// How many rays from each point, at most 1048576; several numbers are separated by commas; for ambient
    /// [default: 4,16,64,256]
    ///
    /// Each number is measured without and with the mean over neighbors. For example: --rays 28,32,100.
    #[arg(long, value_name = "N", value_parser = rays, value_delimiter = ',', allow_negative_numbers = true)]
    rays: Vec<u32>,

    /// Seed of lights and points; the same seed gives the same answers, whatever the times
    #[arg(long, value_name = "S", default_value_t = 1, value_parser = seed, allow_negative_numbers = true)]
    seed: u64,

    #[command(flatten)]
    view: ViewArgs,

    /// Width and height of the view in pixels, each at most 16384; for shadow [default: 480x270]
    #[arg(long, value_name = "WxH", allow_hyphen_values = true)]
    size: Option<Size>,

    /// How many samples each pixel of the view has: 1, 4, 9 or 16; for shadow [default: 1]
    #[arg(long, value_name = "N", value_parser = parse_samples, allow_negative_numbers = true)]
    samples: Option<u32>,

    /// Write a table with a row for each file, method and stratum [default: nothing is written]
    #[arg(long, value_name = "OUT.csv")]
    csv: Option<PathBuf>,

    /// Draw wrong answers against time, a mark for each method or technique [default: nothing is drawn]
    #[arg(long, value_name = "OUT.svg")]
    svg: Option<PathBuf>,

    /// Write a page with charts, the table, and what each technique draws beside the truth; for shadow
    /// [default: nothing is written]
    #[arg(long, value_name = "OUT.html")]
    html: Option<PathBuf>,

    /// A technique to measure, with options if need be; may be repeated; for shadow [default: all techniques
    /// with their default options, and those with a device form on an adapter too]
    ///
    /// For example: --shadow rays --shadow samples:n=16 --shadow samples:n=256.
    #[arg(long, value_name = "TECHNIQUE")]
    shadow: Vec<Technique>,

    /// Add a large floor below everything: lowest in z for stl, md2 and 3mf, lowest in y for others; for
    /// shadow
    #[arg(long)]
    ground: bool,

    /// Print one JSON document instead of text
    #[arg(long)]
    json: bool,

    #[command(flatten)]
    threads: ThreadArgs,

    #[command(flatten)]
    adapter: AdapterArgs,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum What {
    /// Which side of each face a light is on
    Facing,
    /// Whether a point is in shadow
    Visibility,
    /// How much of each light reaches the visible points, by every technique
    Shadow,
    /// How much of the sky reaches the vertices, by rays and by disks
    Ambient,
}

impl What {
    /// The question per face or per point; `None` for those whose answers are no signs.
    fn question(self) -> Option<Question> {
        match self {
            Self::Facing => Some(Question::Facing),
            Self::Visibility => Some(Question::Visibility),
            Self::Shadow | Self::Ambient => None,
        }
    }
}

impl Args {
    /// One of the files, with the options for all of them.
    fn source(&self, file: &Path) -> SourceArgs {
        SourceArgs {
            file: file.to_owned(),
            mesh: self.mesh.clone(),
            pose: self.pose.clone(),
            cast: self.cast.clone(),
            lights: self.lights.clone(),
        }
    }

    /// Refuses options of the view for questions that have none.
    fn refuse_view(&self) -> Result<(), Failure> {
        let asked = [
            ("--size", self.size.is_some()),
            ("--samples", self.samples.is_some()),
            ("--html", self.html.is_some()),
            ("--shadow", !self.shadow.is_empty()),
            ("--ground", self.ground),
            ("--adapter", self.adapter.was_asked_for()),
            ("--eye, --target, --fov, --ortho, --camera and --near", self.view.was_asked_for()),
        ];
        match asked.into_iter().find(|(_, asked)| *asked) {
            None => Ok(()),
            Some((flag, _)) => {
                let problem = format!("{flag}: only `accuracy shadow` has a view");
                Err(Failure::new(problem, "leave it out, or measure shadow"))
            }
        }
    }

    /// Refuses lights for `ambient`, whose light is the sky.
    fn refuse_lights(&self) -> Result<(), Failure> {
        if !self.lights.were_asked_for() {
            return Ok(());
        }
        let problem = "--light: the light of `accuracy ambient` comes from the whole sky";
        Err(Failure::new(problem, "leave it out, or measure shadow"))
    }

    /// Refuses --rays for all but `ambient`.
    fn refuse_rays(&self) -> Result<(), Failure> {
        if self.rays.is_empty() || self.what == What::Ambient {
            return Ok(());
        }
        let problem = "--rays: only `accuracy ambient` casts a number of rays from each point";
        Err(Failure::new(problem, "leave it out, or measure ambient"))
    }

    /// How many queries are asked for.
    fn queries_or(&self, usual: u64) -> Result<u64, Failure> {
        let queries = self.queries.unwrap_or(usual);
        if (1..=MOST_QUERIES).contains(&queries) {
            return Ok(queries);
        }
        let problem = format!("--queries {queries} is not between 1 and {MOST_QUERIES}");
        Err(Failure::new(problem, "run several seeds instead of one long run"))
    }

    /// Refuses --queries for `shadow`, which has a view instead.
    fn refuse_queries(&self) -> Result<(), Failure> {
        if self.queries.is_none() {
            return Ok(());
        }
        let problem = "--queries: `accuracy shadow` asks about every sample of its view";
        Err(Failure::new(problem, "use --size and --samples"))
    }
}

fn rounds(text: &str) -> Result<u32, String> {
    match text.parse() {
        Ok(rounds @ 1..=1000) => Ok(rounds),
        _ => Err("write a whole number from 1 to 1000".to_owned()),
    }
}

/// Queries and their right answers stay in memory: up to 13 bytes per query and stratum.
const MOST_QUERIES: u64 = 10_000_000;

/// What was measured of one file.
struct Measured {
    format: Option<&'static str>,
    vertices: usize,
    faces: usize,
    lights: Vec<Lamp>,
    found: Accuracy,
}

/// A file, and what was measured of it or why nothing was.
struct FileResult {
    file: PathBuf,
    measured: Result<Measured, Failure>,
}

/// What was asked for, as reports repeat it.
struct Asked {
    question: Question,
    options: Options,
}

pub(crate) fn run(mut args: Args) -> Result<Outcome, Failure> {
    args.files = files::expand(args.files);
    args.refuse_rays()?;
    let Some(question) = args.what.question() else {
        match args.what {
            What::Ambient => args.refuse_lights().and_then(|()| args.refuse_view())?,
            _ => args.refuse_queries()?,
        }
        refuse_outputs(&args)?;
        args.threads.apply_or_one()?;
        return if args.what == What::Ambient { ambient::run(&args) } else { shadow::run(&args) };
    };
    let asked = refuse(&args, question)?;
    args.threads.apply_or_one()?;
    let mut out = Output::new();
    let mut outcome = Outcome::Sound;
    let mut results = Vec::new();
    for (index, file) in args.files.iter().enumerate() {
        let measured = measure(file, &args, &asked);
        outcome = outcome.max(match &measured {
            Ok(measured) if measured.found.exact_is_right() => Outcome::Sound,
            Ok(_) => Outcome::Unsound,
            Err(failure) => {
                output::say(failure);
                Outcome::Incomplete
            }
        });
        if let (Ok(measured), false) = (&measured, args.json) {
            if index > 0 {
                out.text("\n")?;
            }
            out.text(text::report(file, measured, &asked))?;
            out.flush()?;
        }
        results.push(FileResult { file: file.clone(), measured });
    }
    if args.json {
        out.json(&json::document(&results, &asked))?;
    }
    out.flush()?;
    // Files hold what was measured; where that is nothing, there are none.
    if results.iter().any(|result| result.measured.is_ok()) {
        save(args.csv.as_deref(), || csv::table(&results, asked.question))?;
        save(args.svg.as_deref(), || chart::svg(&chart::of_queries(&results, &asked)))?;
    }
    Ok(outcome)
}

/// Refuses bad arguments before any work is done.
fn refuse(args: &Args, question: Question) -> Result<Asked, Failure> {
    args.refuse_view()?;
    let queries = args.queries_or(question.usual_queries())?;
    refuse_outputs(args)?;
    let options = Options { queries, seed: args.seed, rounds: args.rounds };
    Ok(Asked { question, options })
}

/// Refuses outputs that cannot be written, judging by their names.
fn refuse_outputs(args: &Args) -> Result<(), Failure> {
    for (option, path, extension) in
        [("--csv", &args.csv, "csv"), ("--svg", &args.svg, "svg"), ("--html", &args.html, "html")]
    {
        let Some(path) = path else { continue };
        if path.extension().is_none_or(|found| !found.eq_ignore_ascii_case(extension)) {
            let remedy = format!("name a file that ends in .{extension}");
            return Err(Failure::new(format_args!("{option} writes another format"), remedy).in_file(path));
        }
        for file in &args.files {
            refuse_overwriting(option, Some(path), file)?;
        }
        require_folder(path)?;
    }
    Ok(())
}

fn measure(file: &Path, args: &Args, asked: &Asked) -> Result<Measured, Failure> {
    let Asked { question, options } = asked;
    let Source { format, caster, lights, .. } = args.source(file).load()?;
    lights::note_centers(&lights);
    let mesh = caster.into_mesh();
    if lights.len() > MOST_LIGHTS {
        let (file, count) = (file.display(), lights.len());
        output::say(format_args!("note: {file}: using {MOST_LIGHTS} of {count} lights, evenly spread"));
    }
    let plain: Vec<Light> = lights.iter().map(|light| *light.light()).collect();
    let progress = Progress::bar(format!("measuring {}", file.display()), question.steps(options));
    let found = question.measure(&mesh, &plain, options, &|steps| progress.done(steps));
    drop(progress);
    let none = || Failure::new("there are no faces to ask about", "name a mesh that has some").in_file(file);
    let found = found.ok_or_else(none)?;
    Ok(Measured { format, vertices: mesh.vertex_count(), faces: mesh.face_count(), lights, found })
}

fn save(path: Option<&Path>, text: impl FnOnce() -> String) -> Result<(), Failure> {
    let Some(path) = path else { return Ok(()) };
    let text = text();
    write_atomic(path, |out| out.write_all(text.as_bytes()))?;
    output::wrote(path);
    Ok(())
}

impl Measured {
    /// The first method, with which the rest is compared.
    fn baseline(&self) -> &Method {
        &self.found.methods[0]
    }
}

impl FileResult {
    /// The file's name for a document.
    fn name(&self) -> Value {
        self.file.to_string_lossy().into()
    }
}
