//! `--file-timeout`: each file in a process of its own, so that none can stop the others.
//!
//! The process is this program, called with the same arguments and one more, `--worker=FILE`. It prints a
//! [`Fragment`] as JSON, and the notes and errors of the file go to the standard error that both share.

use std::ffi::OsString;
use std::io::Read;
use std::path::Path;
use std::process::{Command, Stdio};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::thread;
use std::time::{Duration, Instant};

use super::Args;
use super::fragment::Fragment;
use super::report::{Drawings, examine};
use crate::cli::color::Painter;
use crate::cli::error::Failure;
use crate::cli::output::{self, Output};
use crate::cli::{Outcome, child};

/// The process of a worker: one file.
pub(super) fn work(file: &Path, args: &Args) -> Result<Outcome, Failure> {
    let report = examine(file, args, &mut Drawings::default());
    if let Err(failure) = &report {
        output::say(failure);
    }
    let painter = Painter::of_worker(args.worker_colors);
    let fragment = Fragment::of(file, &report, args, painter);
    let mut out = Output::new();
    out.line(fragment.to_json())?;
    out.flush()?;
    Ok(fragment.row.outcome())
}

/// Has a worker check a file.
pub(super) fn ask(file: &Path, limit: Duration, painter: Painter) -> Result<Fragment, Failure> {
    let begin = Instant::now();
    let failed = |problem: String, remedy: &str| Failure::new(problem, remedy).in_file(file);
    let cannot =
        |error| failed(format!("no process can be started for it: {error}"), "leave out --file-timeout");
    let program = std::env::current_exe().map_err(cannot)?;
    let mut arguments: Vec<OsString> = std::env::args_os().skip(1).collect();
    let mut worker = OsString::from("--worker=");
    worker.push(file);
    // Behind the name of the command: what follows `--` are files.
    arguments.insert(arguments.len().min(1), worker);
    if painter.is_on() {
        arguments.insert(1, "--worker-colors".into());
    }
    let mut command = Command::new(program);
    command.args(arguments).stdout(Stdio::piped());
    let mut stdout = child::start(&mut command).map_err(cannot)?.expect("it is a pipe");
    let (sender, receiver) = mpsc::channel();
    thread::spawn(move || {
        let mut bytes = Vec::new();
        let read = stdout.read_to_end(&mut bytes).map(|_| bytes);
        // The receiver is gone if the time is over.
        let _ = sender.send(read);
    });
    let bytes = match receiver.recv_timeout(limit) {
        Err(RecvTimeoutError::Timeout) => None,
        read => Some(read.ok().and_then(Result::ok).unwrap_or_default()),
    };
    // It has closed its output, and ends at once, but for a fault.
    let status = bytes.is_some().then(|| child::wait(Some(limit.saturating_sub(begin.elapsed())))).flatten();
    let (Some(bytes), Some(status)) = (bytes, status) else {
        child::end();
        let problem = format!("not finished within {} s", limit.as_secs_f64());
        return Err(failed(problem, "raise --file-timeout, or check it with --fast"));
    };
    Fragment::read(&bytes).ok_or_else(|| {
        let problem = format!("the process that checked it ended without a report ({status})");
        failed(problem, "give it more memory, or check the file alone to see why")
    })
}
