//! The command line: one module per command, and what they share.
//!
//! Results go to standard output, everything else to standard error. Every command has `Args`, its arguments,
//! and `run`.

mod caption;
mod chart;
mod child;
mod color;
mod error;
mod files;
mod input;
mod interrupt;
mod json;
mod lights;
mod load;
mod output;
mod page;
mod parsers;
mod pose;
mod progress;
mod resources;
mod search;
mod shadow;
#[cfg(feature = "gpu")]
mod stencil_render;
mod view;

mod check;
mod completions;
mod man;
mod prepare;
mod silhouette;
mod sketch;
mod volume;
mod verify;
mod plan;
mod render;
mod window;
mod ambient;
mod torture;
mod accuracy;
mod demo;

use std::ffi::OsString;
use std::io::{self, Write};
use std::process::ExitCode;

use clap::error::ErrorKind;
use clap::{Parser, Subcommand};

use error::Failure;

/// Turns meshes into verified shadows: crack reports, exact silhouettes, closed shadow volumes.
#[derive(Debug, Parser)]
#[command(
    name = "umbrage",
    version,
    max_term_width = 100,
    after_help = "Exit codes: 0 sound, or all methods agree; 1 cracks or disagreements found; 2 could not run; \
                  130 interrupted.\n\
                  Results go to standard output, notes, progress and errors to standard error."
)]
pub(crate) struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    Check(check::Args),
    Prepare(prepare::Args),
    Silhouette(silhouette::Args),
    Volume(volume::Args),
    Verify(verify::Args),
    Plan(plan::Args),
    Render(render::Args),
    View(window::Args),
    Ambient(ambient::Args),
    Torture(torture::Args),
    Accuracy(accuracy::Args),
    Demo(demo::Args),
    Completions(completions::Args),
    Man(man::Args),
}

impl Command {
    fn run(self) -> Result<Outcome, Failure> {
        match self {
            Self::Check(args) => check::run(args),
            Self::Prepare(args) => prepare::run(args),
            Self::Silhouette(args) => silhouette::run(args),
            Self::Volume(args) => volume::run(args),
            Self::Verify(args) => verify::run(args),
            Self::Plan(args) => plan::run(args),
            Self::Render(args) => render::run(args),
            Self::View(args) => window::run(args),
            Self::Ambient(args) => ambient::run(args),
            Self::Torture(args) => torture::run(args),
            Self::Accuracy(args) => accuracy::run(args),
            Self::Demo(args) => demo::run(args),
            Self::Completions(args) => completions::run(&args),
            Self::Man(args) => man::run(&args),
        }
    }
}

/// How a command that ran has ended; ascending, so that the worst of several is their maximum.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Outcome {
    /// Sound, or all methods agree.
    Sound = 0,
    /// Cracks or disagreements were found.
    Unsound = 1,
    /// Some of it could not be done; the error has been printed.
    Incomplete = 2,
}

/// Parses the arguments, runs the command, and returns the exit code.
pub(crate) fn main() -> ExitCode {
    let cli = match parse(std::env::args_os()) {
        Ok(cli) => cli,
        Err(error) => return ExitCode::from(answer(&error) as u8),
    };
    interrupt::watch();
    match cli.command.run() {
        Ok(outcome) => ExitCode::from(outcome as u8),
        Err(failure) => {
            output::say(&failure);
            ExitCode::from(Outcome::Incomplete as u8)
        }
    }
}

/// The parsed `arguments`, of which the first is the name of the command. Nothing is run.
pub(crate) fn parse(arguments: impl IntoIterator<Item = OsString>) -> Result<Cli, clap::Error> {
    Cli::try_parse_from(arguments)
}

/// Prints what the parser answers itself: help and version, or one line about a bad argument.
fn answer(error: &clap::Error) -> Outcome {
    if error.use_stderr() && error.kind() != ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand {
        output::say(usage(&error.to_string()));
        return Outcome::Incomplete;
    }
    match error.print().and_then(|()| io::stdout().flush()) {
        // A closed pipe is no reason to fail.
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            output::say(output::unwritable(error));
            Outcome::Incomplete
        }
        _ if error.use_stderr() => Outcome::Incomplete,
        _ => Outcome::Sound,
    }
}

/// The message of the parser as problem and remedy: its first paragraph, and its tip, if there is one.
pub(crate) fn usage(text: &str) -> Failure {
    let fold = |paragraph: &str| paragraph.split_whitespace().collect::<Vec<_>>().join(" ");
    let mut paragraphs = text.split("\n\n").map(fold);
    let first = paragraphs.next().unwrap_or_default();
    let problem = first.strip_prefix("error: ").unwrap_or(&first);
    // The messages of our own parsers have the remedy already.
    let said = problem.split_once("; write ").or_else(|| problem.split_once(": write "));
    if let Some((problem, remedy)) = said {
        return Failure::new(problem, format_args!("write {remedy}"));
    }
    // A mistyped option is likelier than a file of that name, which the other tip is about (`to pass …`).
    let tip = paragraphs
        .find_map(|paragraph| paragraph.strip_prefix("tip: ").map(str::to_owned))
        .filter(|tip| !tip.starts_with("to pass"));
    Failure::new(problem, tip.as_deref().unwrap_or("--help lists what is allowed"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn usage_errors_are_problem_and_remedy() {
        for (arguments, line) in [
            (
                "check a --weld -1",
                "invalid value '-1' for '--weld <exact|none|DIST>'; write exact, none, or a distance above 0 in \
                 mesh units",
            ),
            (
                "check a --scope planet",
                "invalid value 'planet' for '--scope <SCOPE>' [possible values: mesh, primitive, scene]; --help \
                 lists what is allowed",
            ),
            ("check a --bogus", "unexpected argument '--bogus' found; --help lists what is allowed"),
            (
                "silhouette a --light -1,2,3",
                "invalid value '-1,2,3' for '--light <LIGHT>': `-1,2,3` is not a light; write point:X,Y,Z, \
                 directional:X,Y,Z (the way the light travels), spot:X,Y,Z:DX,DY,DZ:OUTER[,INNER] or \
                 rect:X,Y,Z:X,Y,Z:X,Y,Z",
            ),
            ("chekc a", "unrecognized subcommand 'chekc'; a similar subcommand exists: 'check'"),
            (
                "check",
                "the following required arguments were not provided: <FILE>...; --help lists what is allowed",
            ),
            (
                "verify a --points -1",
                "invalid value '-1' for '--points <N>'; write a whole number, as 1000000 or 1e6",
            ),
        ] {
            let error = Cli::try_parse_from(["umbrage"].into_iter().chain(arguments.split(' '))).unwrap_err();
            assert_eq!(usage(&error.to_string()).to_string(), line, "{arguments}");
        }
    }

    #[test]
    fn cli_definition_is_consistent() {
        <Cli as clap::CommandFactory>::command().debug_assert();
    }

    /// Runs a command on this thread, and asserts that it builds no part twice of the same faces and
    /// positions.
    fn builds_each_part_once(arguments: &[&str]) -> Vec<umbrage::testing::BuiltPart> {
        let words = ["umbrage"].iter().chain(arguments).map(OsString::from);
        let command = parse(words).unwrap().command;
        let (outcome, parts) = umbrage::testing::record_built(|| command.run());
        assert!(outcome.is_ok_and(|outcome| outcome != Outcome::Incomplete), "{arguments:?}");
        let mut sorted: Vec<String> = parts.iter().map(|part| format!("{part:?}")).collect();
        sorted.sort_unstable();
        for pair in sorted.windows(2) {
            assert_ne!(pair[0], pair[1], "{arguments:?} builds a part twice");
        }
        parts.into_iter().map(|(part, _)| part).collect()
    }

    #[test]
    fn demo_and_verify_build_each_part_of_a_caster_once() {
        use umbrage::testing::BuiltPart;
        let folder = tempfile::tempdir().unwrap();
        let out = folder.path().join("demo");
        let demo = builds_each_part_once(&["demo", "--short", "--out", out.to_str().unwrap()]);
        for part in [BuiltPart::Topology, BuiltPart::Planes, BuiltPart::Proofs, BuiltPart::Oracle] {
            assert!(demo.contains(&part), "{part:?} is not recorded");
        }
        let scene = out.join("scene.glb");
        let verify = ["verify", scene.to_str().unwrap(), "--points", "50", "--light", "point:3,9,5"];
        builds_each_part_once(&verify);
        #[cfg(feature = "gpu")]
        match umbrage::gpu::Gpu::new(None) {
            Ok(_) => {
                builds_each_part_once(&[&verify[..], &["--gpu", "--size", "64x48"]].concat());
            }
            Err(error) => {
                let required = std::env::var("UMBRAGE_REQUIRE_GPU").is_ok_and(|value| value == "1");
                assert!(!required, "{error}");
                eprintln!("skipped: verify --gpu: {error}");
            }
        }
        // A command that built something twice would be seen.
        let (_, parts) = umbrage::testing::record_built(|| {
            let mesh = umbrage::testing::shapes::cube();
            [0; 2].map(|_| umbrage::oracle::Oracle::build(&mesh))
        });
        assert_eq!(parts[0], parts[1]);
    }

    #[test]
    fn outcome_two_outranks_one() {
        assert_eq!(Outcome::Unsound.max(Outcome::Incomplete) as u8, 2);
        assert_eq!(Outcome::Unsound.max(Outcome::Sound) as u8, 1);
    }
}
