//! `umbrage torture`: adversarial queries.

mod json;
mod text;

use std::path::{Path, PathBuf};
use std::time::Instant;

use umbrage::testing::torture;
use umbrage::testing::torture::{Effort, Repro, ReproError};

use super::output::{self, Output};
use super::parsers::{large, require_folder, seed};
use super::progress::Progress;
use super::resources::ThreadArgs;
use super::{Failure, Outcome};

/// Adversarial queries: generated meshes, lights and points that attack exactness from every side
///
/// Small meshes, sound and damaged, tiny and huge, full of slivers and exact ties; lights on vertices, in
/// planes, or one ulp away from them; points on the surface and on the boundary of the shadow. The ray cast
/// and the winding number of the emitted volume have to agree on each query. A sample of the queries, and the
/// first ties of every round, are decided again with big integers. For comparison, plain f32 answers the same
/// queries, as in most programs. A disagreement is a bug in umbrage: it is minimized and written to a file.
///
/// The bound 3/n assumes independent queries, but the up to 256 queries of a round share mesh, light and
/// volume. The bound by rounds does not assume it.
#[derive(Clone, Debug, clap::Args)]
pub(crate) struct Args {
    /// How many queries, spread evenly over the strata; 1000000, 1_000_000 and 1e6 are the same
    #[arg(long, value_name = "N", default_value = "1000000", value_parser = large, allow_negative_numbers = true)]
    queries: u64,

    /// Seed of the random numbers; the same seed gives the same queries
    #[arg(long, value_name = "S", default_value_t = 1, value_parser = seed, allow_negative_numbers = true)]
    seed: u64,

    #[command(flatten)]
    threads: ThreadArgs,

    /// Print one JSON document instead of text
    #[arg(long)]
    json: bool,

    /// File for the first disagreement, minimized; nothing is written without one
    #[arg(long, value_name = "FILE.obj", default_value = "umbrage-torture-case.obj")]
    case: PathBuf,

    /// Decide the query of such a file again, and print what each method answers [default: none, queries are
    /// drawn]
    #[arg(long, value_name = "FILE.obj", conflicts_with_all = ["queries", "seed", "threads", "json", "case"])]
    replay: Option<PathBuf>,
}

/// How many disagreements are shown.
const SHOWN: usize = 10;

/// Three years at a million queries per second: a larger count is a typing error.
const MOST_QUERIES: u64 = 100_000_000_000_000;

pub(crate) fn run(args: Args) -> Result<Outcome, Failure> {
    if let Some(file) = &args.replay {
        return replay(file);
    }
    if !(1..=MOST_QUERIES).contains(&args.queries) {
        let problem = format!("--queries {} is not between 1 and {MOST_QUERIES}", args.queries);
        return Err(Failure::new(problem, "run several seeds instead of one long run"));
    }
    require_folder(&args.case)?;
    args.threads.apply()?;
    let options = Effort { queries: args.queries, seed: args.seed, keep: SHOWN };
    let progress = Progress::bar("judging queries", args.queries);
    let start = Instant::now();
    let found = torture::run(&options, &|queries| progress.done(queries));
    let seconds = start.elapsed().as_secs_f64();
    drop(progress);

    let case = found.case.as_ref().map(|_| args.case.as_path());
    // The report first: a full disk must not hide the findings.
    let mut output = Output::new();
    if args.json {
        output.json(&json::document(&found, args.seed, seconds, case))?;
    } else {
        output.text(text::report(&found, args.seed, seconds, case))?;
    }
    output.flush()?;
    if let Some(path) = case {
        found.write_case(args.seed, path)?;
        output::wrote(path);
    }
    Ok(if found.agrees() { Outcome::Sound } else { Outcome::Unsound })
}

fn replay(file: &Path) -> Result<Outcome, Failure> {
    let case = Repro::read(file)?;
    let ruling = case.judge();
    let mut output = Output::new();
    output.text(text::replay(file, &case, &ruling))?;
    output.flush()?;
    Ok(if ruling.agrees { Outcome::Sound } else { Outcome::Unsound })
}

/// Its message already has problem and remedy.
impl From<ReproError> for Failure {
    fn from(error: ReproError) -> Self {
        match error {
            ReproError::Mesh(error) => error.into(),
            error => Self::of(error.to_string(), None),
        }
    }
}
