//! Ending when told to: Ctrl-C, SIGINT, SIGTERM, SIGHUP.

use std::process;

use umbrage::write;

use super::output::{counted, say};
use super::progress;

/// The exit code of a command that was interrupted, as shells give it for SIGINT.
const INTERRUPTED: i32 = 130;

/// From now on a signal that asks the program to end does so in order: no file is left half written, the terminal is
/// left clean, one line is said.
///
/// A signal that whoever started the program has it ignore (`nohup`, a job in the background of a script) stays
/// ignored; the others then end the program as they do any other.
pub(crate) fn watch() {
    let _ = ctrlc::try_set_handler(|| write::abandon(end));
}

fn end(written: usize) {
    progress::clear();
    match written {
        0 => say("interrupted; nothing was written"),
        _ => say(format_args!(
            "interrupted; {} written before, none in part",
            counted(written, "file was", "files were")
        )),
    }
    process::exit(INTERRUPTED)
}
