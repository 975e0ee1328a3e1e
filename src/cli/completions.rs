//! `umbrage completions`: what a shell completes.

use clap::CommandFactory;
use clap_complete::Shell;

use super::output::Output;
use super::{Cli, Failure, Outcome};

/// Completions of commands and options, for a shell
///
/// For example: umbrage completions bash > ~/.local/share/bash-completion/completions/umbrage; umbrage
/// completions fish > ~/.config/fish/completions/umbrage.fish.
#[derive(Clone, Debug, clap::Args)]
pub(crate) struct Args {
    /// The shell
    #[arg(value_name = "SHELL")]
    shell: Shell,
}

pub(crate) fn run(args: &Args) -> Result<Outcome, Failure> {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut Cli::command(), "umbrage", &mut script);
    let mut out = Output::new();
    out.text(String::from_utf8_lossy(&script))?;
    out.flush()?;
    Ok(Outcome::Sound)
}
