//! `umbrage man`: manual pages.

use std::path::{Path, PathBuf};

use clap::{Command, CommandFactory};
use umbrage::write;

use super::{Cli, Failure, Outcome, output};

/// Manual pages: umbrage.1, and one for each command
///
/// For example: umbrage man ~/.local/share/man/man1; man umbrage-check.
#[derive(Clone, Debug, clap::Args)]
pub(crate) struct Args {
    /// The folder that the pages are written into; it is made if it is not there
    #[arg(value_name = "FOLDER")]
    folder: PathBuf,
}

pub(crate) fn run(args: &Args) -> Result<Outcome, Failure> {
    let failed = |error| {
        let problem = format!("the folder cannot be made: {error}");
        Failure::new(problem, "name another folder").in_file(&args.folder)
    };
    std::fs::create_dir_all(&args.folder).map_err(failed)?;
    let command = Cli::command();
    page(&args.folder, "umbrage", command.clone())?;
    for part in command.get_subcommands() {
        let name = format!("umbrage-{}", part.get_name());
        page(&args.folder, &name, part.clone().display_name(&name).bin_name(name.replacen('-', " ", 1)))?;
    }
    output::wrote(&args.folder);
    Ok(Outcome::Sound)
}

fn page(folder: &Path, name: &str, command: Command) -> Result<(), Failure> {
    let path = folder.join(format!("{name}.1"));
    let man = clap_mangen::Man::new(command.version(env!("CARGO_PKG_VERSION"))).title(name);
    Ok(write::write_atomic(&path, |out| man.render(out))?)
}
