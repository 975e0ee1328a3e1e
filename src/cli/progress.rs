//! Progress on standard error, for what takes longer than a second.

use std::io::{self, IsTerminal};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, RecvTimeoutError, Sender};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::Duration;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

/// Delay before a bar appears: shorter work shows none.
const PATIENCE: Duration = Duration::from_secs(1);

/// A progress bar that appears after a second and disappears when dropped. There is none where standard error
/// is no terminal.
pub(crate) struct Progress {
    bar: ProgressBar,
    watch: Option<(Sender<()>, JoinHandle<()>)>,
    is_alone: bool,
}

/// Whether a bar of many steps stands for all that happens in each.
static ALONE: AtomicBool = AtomicBool::new(false);

/// The bar that may be on the terminal.
fn shown() -> MutexGuard<'static, Option<ProgressBar>> {
    static SHOWN: Mutex<Option<ProgressBar>> = Mutex::new(None);
    SHOWN.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Removes the bar from the terminal, if there is one: the program is about to exit.
pub(crate) fn clear() {
    if let Some(bar) = shown().take() {
        bar.finish_and_clear();
    }
}

impl Progress {
    /// Work of unknown length.
    pub(crate) fn spinner(what: impl Into<String>) -> Self {
        Self::start(what.into(), None)
    }

    /// Work of `total` steps; [`Progress::done`] counts them, from any thread.
    pub(crate) fn bar(what: impl Into<String>, total: u64) -> Self {
        Self::start(what.into(), Some(total))
    }

    fn start(what: String, total: Option<u64>) -> Self {
        let bar = ProgressBar::with_draw_target(total, ProgressDrawTarget::hidden());
        if !io::stderr().is_terminal() || ALONE.load(Ordering::Relaxed) {
            return Self { bar, watch: None, is_alone: false };
        }
        let template = match total {
            None => "{spinner} {msg} {elapsed}",
            Some(_) => "{msg} {wide_bar} {percent}% {eta}",
        };
        bar.set_style(ProgressStyle::with_template(template).expect("the templates above are well formed"));
        bar.set_message(what);
        let (stop, stopped) = mpsc::channel();
        let late = bar.clone();
        let watch = thread::spawn(move || {
            if stopped.recv_timeout(PATIENCE) == Err(RecvTimeoutError::Timeout) {
                let mut shown = shown();
                late.set_draw_target(ProgressDrawTarget::stderr());
                late.enable_steady_tick(Duration::from_millis(100));
                *shown = Some(late);
            }
        });
        Self { bar, watch: Some((stop, watch)), is_alone: false }
    }

    /// The same; no other appears while it is there.
    pub(crate) fn alone(mut self) -> Self {
        self.is_alone = true;
        ALONE.store(true, Ordering::Relaxed);
        self
    }

    /// Counts `steps` as done.
    pub(crate) fn done(&self, steps: u64) {
        self.bar.inc(steps);
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        if let Some((stop, watch)) = self.watch.take() {
            drop(stop); // wakes the watch, if it still waits
            let _ = watch.join();
            shown().take();
        }
        self.bar.finish_and_clear();
        if self.is_alone {
            ALONE.store(false, Ordering::Relaxed);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn progress_that_is_over_at_once_is_never_shown() {
        let progress = Progress::spinner("nothing");
        assert!(progress.bar.is_hidden());
        let bar = progress.bar.clone();
        drop(progress);
        assert!(bar.is_finished());
    }
}
