//! Clean exit on signals: Ctrl-C, SIGINT, SIGTERM, SIGHUP.

use std::process;
use std::sync::OnceLock;

use umbrage::write;

use super::output::{self, counted, say};
use super::progress;

/// The exit code of a command that was interrupted, as shells give it for SIGINT.
const INTERRUPTED: i32 = 130;

/// Installs the handler of signals that ask the program to exit: no file is left half written, the terminal
/// is left clean, and one line is printed. A second signal exits at once.
///
/// A signal that was set to be ignored when the program was started (`nohup`, a background job of a script)
/// stays ignored. If the handler cannot be installed, signals end the program as usual.
#[cfg(unix)]
pub(crate) fn watch() {
    use std::thread;
    use std::time::Duration;

    use signal_hook::iterator::Signals;
    use signal_hook::low_level;

    /// `timeout` sends its signal twice: long enough for the cleanup after the first one, too short for a
    /// person to notice.
    const GRACE: Duration = Duration::from_millis(100);

    let Ok(mut signals) = Signals::new(heeded()) else { return };
    thread::spawn(move || {
        let mut signals = signals.forever();
        if signals.next().is_some() {
            // In a thread of its own: standard error may be a pipe that nobody reads.
            thread::spawn(|| write::abandon(end));
            if signals.next().is_some() {
                thread::sleep(GRACE);
                low_level::exit(INTERRUPTED); // waits for no lock, flushes nothing
            }
        }
    });
}

/// The same for the signals of this system.
#[cfg(windows)]
pub(crate) fn watch() {
    let _ = ctrlc::try_set_handler(|| write::abandon(end));
}

/// The signals to handle: those that are not ignored. Where that is unknown, all but SIGHUP, which is the one
/// most often ignored.
#[cfg(unix)]
fn heeded() -> Vec<i32> {
    use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
    let ignored = std::fs::read_to_string("/proc/self/status").ok().and_then(|status| ignored(&status));
    let ignored = ignored.unwrap_or(1 << (SIGHUP - 1));
    [SIGHUP, SIGINT, SIGTERM].into_iter().filter(|signal| ignored >> (signal - 1) & 1 == 0).collect()
}

/// The ignored signals as bits, the first signal lowest, from the status of a process on Linux.
#[cfg(unix)]
fn ignored(status: &str) -> Option<u64> {
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"))?;
    u64::from_str_radix(mask.trim(), 16).ok()
}

/// What is to be done before an interrupted program exits.
static BEFORE_EXIT: OnceLock<fn()> = OnceLock::new();

/// Has a function called before an interrupted program exits; the first one stays.
pub(crate) fn before_exit(action: fn()) {
    let _ = BEFORE_EXIT.set(action);
}

fn end(written: usize) {
    if let Some(action) = BEFORE_EXIT.get() {
        action();
    }
    progress::clear();
    match written {
        0 if output::has_begun() => say("interrupted"),
        0 => say("interrupted; nothing was written"),
        _ => say(format_args!(
            "interrupted; {} written before, none in part",
            counted(written, "file was", "files were")
        )),
    }
    process::exit(INTERRUPTED)
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;

    #[test]
    fn signals_that_are_ignored_are_read_from_what_linux_says() {
        let status = "Name:\tx\nSigBlk:\t0000000000000002\nSigIgn:\t0000000000004001\nSigCgt:\tff\n";
        assert_eq!(ignored(status), Some(1 | 1 << 14));
        assert_eq!(ignored("SigIgn:\tnone\n"), None);
        assert_eq!(ignored("Name:\tx\n"), None);
    }
}
