//! `umbrage demo`.

use super::{Failure, Outcome, unbuilt};

/// All of it on a generated scene (not built yet)
#[derive(Clone, Debug, clap::Args)]
pub(crate) struct Args {
    #[command(flatten)]
    rest: unbuilt::Rest,
}

pub(crate) fn run(args: Args) -> Result<Outcome, Failure> {
    unbuilt::run("demo", args.rest)
}
