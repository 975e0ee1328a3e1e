//! Another process that works for this one, one at a time: an interrupt ends it, too.

use std::io;
use std::process::{Child, ChildStdout, Command, ExitStatus};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use super::interrupt;

/// The process that is running.
static RUNNING: Mutex<Option<Child>> = Mutex::new(None);

fn running() -> MutexGuard<'static, Option<Child>> {
    RUNNING.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Ends the process before this program exits, and keeps another one from being started: the lock stays
/// taken.
fn abandon() {
    let mut running = running();
    if let Some(child) = running.take() {
        kill(child);
    }
    std::mem::forget(running);
}

fn kill(mut child: Child) {
    // It may have ended by itself.
    let _ = child.kill();
    let _ = child.wait();
}

/// Starts a process; its standard output, if the command asks for a pipe. The one before must have ended.
pub(crate) fn start(command: &mut Command) -> io::Result<Option<ChildStdout>> {
    interrupt::before_exit(abandon);
    // Under the lock: an interrupt finds each process that was started.
    let mut slot = running();
    Ok(slot.insert(command.spawn()?).stdout.take())
}

/// The status with which the process ends; `None` if it goes on after `limit`, and then it is killed.
pub(crate) fn wait(limit: Option<Duration>) -> Option<ExitStatus> {
    /// Between two looks.
    const STEP: Duration = Duration::from_millis(1);
    let begin = Instant::now();
    loop {
        // Not held while waiting, so that an interrupt can end it.
        let status = running().as_mut()?.try_wait();
        match status {
            Ok(Some(status)) => {
                running().take();
                return Some(status);
            }
            Ok(None) if limit.is_none_or(|limit| begin.elapsed() < limit) => thread::sleep(STEP),
            _ => {
                end();
                return None;
            }
        }
    }
}

/// Kills the process, if there is one.
pub(crate) fn end() {
    let child = running().take();
    child.into_iter().for_each(kill);
}
