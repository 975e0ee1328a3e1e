//! `umbrage verify`.

use super::{Failure, Outcome, unbuilt};

/// Every judge against every other (not built yet)
#[derive(Clone, Debug, clap::Args)]
pub(crate) struct Args {
    #[command(flatten)]
    rest: unbuilt::Rest,
}

pub(crate) fn run(args: Args) -> Result<Outcome, Failure> {
    unbuilt::run("verify", args.rest)
}
