//! `umbrage verify`: every judge against every other.

use std::path::{Path, PathBuf};

use serde_json::{Value, json};
use umbrage::oracle::Verdict;
use umbrage::scene::SceneLight;
use umbrage::verify::{Judge, Options, Stratum, Verification, Verifier};

use super::lights;
use super::machine::{AdapterArgs, ThreadArgs};
use super::output::{Output, Table, number, number32, plain};
use super::progress::Progress;
use super::source::{Source, SourceArgs};
use super::values::{seed, whole};
use super::{Failure, Outcome};

/// Every judge against every other: ray cast, winding numbers of the volume, whole-number arithmetic
///
/// Points are drawn where errors hide: on and near faces, in their planes, within two ulps of the shadow's
/// boundary. A disagreement is a bug in umbrage; a crack in the mesh is none.
#[derive(Clone, Debug, clap::Args)]
pub(crate) struct Args {
    #[command(flatten)]
    source: SourceArgs,

    /// How many points for each light, spread evenly over the strata
    #[arg(long, value_name = "N", default_value_t = 10_000, value_parser = whole, allow_negative_numbers = true)]
    points: usize,

    /// What the points are drawn from; the same seed gives the same points
    #[arg(long, value_name = "S", default_value_t = 1, value_parser = seed, allow_negative_numbers = true)]
    seed: u64,

    /// Print one JSON document instead of text
    #[arg(long)]
    json: bool,

    #[command(flatten)]
    threads: ThreadArgs,

    #[command(flatten)]
    adapter: AdapterArgs,

    /// Judge the pixels of a stencil pass too (not built yet)
    #[arg(long)]
    gpu: bool,

    /// Size of that picture, in pixels (not built yet)
    #[arg(long, value_name = "WxH")]
    size: Option<String>,

    /// Where its eye is, in mesh units (not built yet)
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true)]
    eye: Option<String>,

    /// What it looks at, in mesh units (not built yet)
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true)]
    target: Option<String>,

    /// Its vertical field of view, in degrees (not built yet)
    #[arg(long, value_name = "DEG", allow_negative_numbers = true)]
    fov: Option<String>,

    /// Where its mismatches are drawn (not built yet)
    #[arg(long, value_name = "OUT.png")]
    picture: Option<PathBuf>,
}

/// How many disagreements are shown with their places, for each light.
const SHOWN: usize = 10;

/// The points of one run stay in memory: 16 bytes each.
const MOST_POINTS: usize = 100_000_000;

impl Args {
    fn refuse_unbuilt(&self) -> Result<(), Failure> {
        self.adapter.refuse()?;
        let asked = [
            ("--gpu", self.gpu),
            ("--size", self.size.is_some()),
            ("--eye", self.eye.is_some()),
            ("--target", self.target.is_some()),
            ("--fov", self.fov.is_some()),
            ("--picture", self.picture.is_some()),
        ];
        match asked.into_iter().find(|(_, asked)| *asked) {
            Some((flag, _)) => Err(Failure::not_built(flag, "leave it out: points are judged without it")),
            None => Ok(()),
        }
    }
}

pub(crate) fn run(args: Args) -> Result<Outcome, Failure> {
    args.refuse_unbuilt()?;
    if !(1..=MOST_POINTS).contains(&args.points) {
        let problem = format!("--points {} is not between 1 and {MOST_POINTS}", args.points);
        return Err(Failure::new(problem, "run several seeds instead of one long run"));
    }
    args.threads.apply()?;
    let Source { format, mesh, lights, .. } = args.source.load()?;

    let progress = Progress::spinner("topology, proofs and tree");
    let verifier = Verifier::new(&mesh);
    drop(progress);
    let options = Options { points: args.points, seed: args.seed, keep: SHOWN };
    let progress = Progress::bar("judging points", (lights.len() * args.points) as u64);
    let results: Vec<Verification> = lights
        .iter()
        .map(|light| verifier.verify(&light.light, &options, &|points| progress.done(points)))
        .collect();
    drop(progress);

    let mut output = Output::new();
    if args.json {
        output.json(&document(&args.source.file.to_string_lossy(), format, &lights, &results))?;
    } else {
        output.text(text(&args.source.file, &lights, &results))?;
    }
    output.flush()?;
    let agreed = results.iter().all(Verification::agrees);
    Ok(if agreed { Outcome::Sound } else { Outcome::Unsound })
}

/// The strata and the judges, summed over the lights.
fn summed(results: &[Verification]) -> (Vec<Stratum>, Vec<Judge>) {
    let sum_rows =
        |a: Vec<Stratum>, b: &Verification| a.iter().zip(&b.strata).map(|(a, b)| a.plus(b)).collect();
    let sum_judges =
        |a: Vec<Judge>, b: &Verification| a.iter().zip(&b.judges).map(|(a, b)| a.plus(b)).collect();
    match results {
        [] => (Vec::new(), Vec::new()),
        [first, rest @ ..] => (
            rest.iter().fold(first.strata.clone(), sum_rows),
            rest.iter().fold(first.judges.clone(), sum_judges),
        ),
    }
}

fn total(strata: &[Stratum]) -> Stratum {
    strata.iter().fold(Stratum { name: "all", ..Stratum::default() }, |sum, row| sum.plus(row))
}

/// What two columns mean.
const LEGEND: &str = "grazing: the ray to the light only touches a face, and either answer is right; rate below: \
                      with 95 % confidence, at most this part of such points is judged wrong";

/// The tables of strata and judges, each disagreement, the verdict, and a legend.
pub(super) fn text(file: &Path, lights: &[SceneLight], results: &[Verification]) -> String {
    let (strata, judges) = summed(results);
    let lit: Vec<String> = lights.iter().map(|light| lights::label(&light.light, &light.name)).collect();
    let mut points = Table::new(&["points", "judged", "agree", "grazing", "disagree", "rate below (95 %)"]);
    for row in strata.iter().chain([&total(&strata)]) {
        let bound = row.bound_95().map_or("-".to_owned(), |bound| format!("{bound:.1e}"));
        let counts = [row.points, row.agree, row.grazing, row.disagree].map(|count| count.to_string());
        points.row([row.name.to_owned()].into_iter().chain(counts).chain([bound]).collect());
    }
    let mut asked = Table::new(&["judge", "asked", "abstained", "contradicts the ray cast"]);
    for judge in &judges {
        let counts = [judge.points, judge.abstain, judge.disagree].map(|count| count.to_string());
        asked.row([judge.name.to_owned()].into_iter().chain(counts).collect());
    }
    let mut places = String::new();
    for (light, result) in lights.iter().zip(results) {
        for found in &result.disagreements {
            let [x, y, z] = found.point;
            places += &format!(
                "disagreement: {} at {x},{y},{z} ({}): {}\n",
                lights::label(&light.light, &light.name),
                found.stratum,
                found.what
            );
        }
    }
    let verdict = match total(&strata).disagree {
        0 => "all judges agree".to_owned(),
        1 => "1 disagreement".to_owned(),
        count => format!("{count} disagreements"),
    };
    let file = plain(&file.to_string_lossy());
    let lit = lit.join("  ");
    format!("{file}\nlights: {lit}\n\n{points}\n\n{asked}\n\n{places}verdict: {verdict}\n{LEGEND}\n")
}

fn document(file: &str, format: Option<&str>, lights: &[SceneLight], results: &[Verification]) -> Value {
    let (strata, judges) = summed(results);
    let mut document = json!({ "file": file, "format": format });
    let counts = counts(&strata, &judges);
    let each = lights.iter().zip(results).map(|(light, result)| {
        let mut entry = json!({ "light": light.light.to_string(), "name": lights::name(&light.name) });
        append(&mut entry, self::counts(&result.strata, &result.judges));
        let disagreements = result.disagreements.iter().map(|found| {
            json!({
                "stratum": found.stratum,
                "point": found.point.map(number32),
                "verdict": verdict(found.verdict),
                "what": found.what,
            })
        });
        append(&mut entry, json!({ "disagreements": disagreements.collect::<Vec<_>>() }));
        entry
    });
    append(&mut document, counts);
    append(&mut document, json!({ "lights": each.collect::<Vec<_>>() }));
    document
}

fn counts(strata: &[Stratum], judges: &[Judge]) -> Value {
    let mut counts = row(&total(strata));
    let strata = strata.iter().map(|stratum| {
        let mut entry = json!({ "name": stratum.name });
        append(&mut entry, row(stratum));
        entry
    });
    let judges = judges.iter().map(|judge| {
        json!({
            "name": judge.name,
            "points": judge.points,
            "abstain": judge.abstain,
            "disagree": judge.disagree,
        })
    });
    let rest = json!({
        "strata": strata.collect::<Vec<_>>(),
        "pixels": null,
        "pixel_agree": null,
        "pixel_grazing": null,
        "pixel_disagree": null,
        "judges": judges.collect::<Vec<_>>(),
    });
    append(&mut counts, rest);
    counts
}

fn row(stratum: &Stratum) -> Value {
    json!({
        "points": stratum.points,
        "agree": stratum.agree,
        "grazing": stratum.grazing,
        "disagree": stratum.disagree,
        "bound_95": stratum.bound_95().map(number),
    })
}

/// Adds the keys of one object to another, in order.
fn append(object: &mut Value, more: Value) {
    if let (Some(object), Value::Object(more)) = (object.as_object_mut(), more) {
        object.extend(more);
    }
}

fn verdict(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Lit => "lit",
        Verdict::Shadowed => "shadowed",
        Verdict::Grazing => "grazing",
    }
}
