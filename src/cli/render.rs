//! `umbrage render`.

use super::{Failure, Outcome, unbuilt};

/// A picture with exact shadows (not built yet)
#[derive(Clone, Debug, clap::Args)]
pub(crate) struct Args {
    #[command(flatten)]
    rest: unbuilt::Rest,
}

pub(crate) fn run(args: Args) -> Result<Outcome, Failure> {
    unbuilt::run("render", args.rest)
}
