//! The command line: one file a command, and what they share.
//!
//! Standard output is the result, standard error the talk. Every command is `Args`, which says what can be
//! asked, and `run`, which does it.

mod error;
mod lights;
mod load;
mod machine;
mod output;
mod progress;

mod check;
mod silhouette;
mod volume;
mod verify;
mod render;
mod unbuilt;
mod demo;

use std::process::ExitCode;

use clap::{Parser, Subcommand};

use error::Failure;

/// Turns meshes into verified shadows: crack reports, exact silhouettes, closed shadow volumes.
#[derive(Debug, Parser)]
#[command(
    name = "umbrage",
    version,
    max_term_width = 100,
    after_help = "Exit codes: 0 sound, or all judges agree; 1 cracks or disagreements found; 2 could not run.\n\
                  Results go to standard output, notes, progress and errors to standard error."
)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    Check(check::Args),
    Silhouette(silhouette::Args),
    Volume(volume::Args),
    Verify(verify::Args),
    Render(render::Args),
    /// Adversarial queries (not built yet)
    Torture(unbuilt::Rest),
    /// Error against time (not built yet)
    Accuracy(unbuilt::Rest),
    Demo(demo::Args),
}

impl Command {
    fn run(self) -> Result<Outcome, Failure> {
        match self {
            Self::Check(args) => check::run(args),
            Self::Silhouette(args) => silhouette::run(args),
            Self::Volume(args) => volume::run(args),
            Self::Verify(args) => verify::run(args),
            Self::Render(args) => render::run(args),
            Self::Torture(args) => unbuilt::run("torture", args),
            Self::Accuracy(args) => unbuilt::run("accuracy", args),
            Self::Demo(args) => demo::run(args),
        }
    }
}

/// How a command that ran has ended; ascending, so that the worst of several is their maximum.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Outcome {
    /// Sound, or all judges agree.
    Sound = 0,
    /// Cracks or disagreements were found.
    Unsound = 1,
    /// Some of it could not be done; what was in the way has been said.
    Incomplete = 2,
}

/// Parses the arguments, runs the command, and gives the exit code.
pub(crate) fn main() -> ExitCode {
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(error) => {
            // Help and version come this way too, with code 0; a closed pipe is no reason to fail.
            let _ = error.print();
            return ExitCode::from(if error.use_stderr() { Outcome::Incomplete as u8 } else { 0 });
        }
    };
    match cli.command.run() {
        Ok(outcome) => ExitCode::from(outcome as u8),
        Err(failure) => {
            output::say(&failure);
            ExitCode::from(Outcome::Incomplete as u8)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cli_definition_is_consistent() {
        <Cli as clap::CommandFactory>::command().debug_assert();
    }

    #[test]
    fn outcome_two_outranks_one() {
        assert_eq!(Outcome::Unsound.max(Outcome::Incomplete) as u8, 2);
        assert_eq!(Outcome::Unsound.max(Outcome::Sound) as u8, 1);
    }
}
