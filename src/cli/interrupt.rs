//! Ending when told to: Ctrl-C, SIGINT, SIGTERM, SIGHUP.

use std::process;

use umbrage::write;

use super::output::{self, counted, say};
use super::progress;

/// The exit code of a command that was interrupted, as shells give it for SIGINT.
const INTERRUPTED: i32 = 130;

/// From now on a signal that asks the program to end does so in order: no file is left half written, the terminal is
/// left clean, one line is said. A second one ends it whatever is in the way.
///
/// A signal that whoever started the program has it ignore (`nohup`, a job in the background of a script) stays
/// ignored. Where watching is refused, signals end the program as they do any other.
#[cfg(unix)]
pub(crate) fn watch() {
    use std::thread;
    use std::time::Duration;

    use signal_hook::iterator::Signals;
    use signal_hook::low_level;

    /// `timeout` sends its signal twice: enough for what the first one has begun, too short for a person to notice.
    const GRACE: Duration = Duration::from_millis(100);

    let Ok(mut signals) = Signals::new(heeded()) else { return };
    thread::spawn(move || {
        let mut signals = signals.forever();
        if signals.next().is_some() {
            // Of its own: standard error may be a pipe that nobody reads.
            thread::spawn(|| write::abandon(end));
            if signals.next().is_some() {
                thread::sleep(GRACE);
                low_level::exit(INTERRUPTED); // waits for no lock, flushes nothing
            }
        }
    });
}

/// As above, as far as the system has such signals.
#[cfg(windows)]
pub(crate) fn watch() {
    let _ = ctrlc::try_set_handler(|| write::abandon(end));
}

/// The signals to end by: those that are not ignored. Where that cannot be known, all but the one that is ignored most.
#[cfg(unix)]
fn heeded() -> Vec<i32> {
    use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
    let ignored = std::fs::read_to_string("/proc/self/status").ok().and_then(|status| ignored(&status));
    let ignored = ignored.unwrap_or(1 << (SIGHUP - 1));
    [SIGHUP, SIGINT, SIGTERM].into_iter().filter(|signal| ignored >> (signal - 1) & 1 == 0).collect()
}

/// The ignored signals as bits, the first signal lowest, of what Linux says about a process.
#[cfg(unix)]
fn ignored(status: &str) -> Option<u64> {
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"))?;
    u64::from_str_radix(mask.trim(), 16).ok()
}

fn end(written: usize) {
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
