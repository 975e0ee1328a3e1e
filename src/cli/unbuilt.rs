//! Commands that the parser knows and nothing runs yet.

use std::ffi::OsString;

use super::{Failure, Outcome};

#[derive(Clone, Debug, clap::Args)]
pub(crate) struct Rest {
    #[arg(hide = true, trailing_var_arg = true, allow_hyphen_values = true)]
    _rest: Vec<OsString>,
}

pub(crate) fn run(name: &str, _rest: Rest) -> Result<Outcome, Failure> {
    Err(Failure::not_built(name, "`umbrage --help` lists the commands"))
}
