//! The machine that the figures were measured on. No person, host or folder is named.

use std::fmt;
use std::hint::black_box;
use std::process::Command;
use std::time::{Instant, SystemTime, UNIX_EPOCH};

use crate::measure::median;

/// Machine, build and date of a run.
#[derive(Debug)]
pub(crate) struct Machine {
    /// UTC date, `YYYY-MM-DD-HHMM`.
    pub(crate) date: String,
    /// Bandwidth of a copy into memory that was written before, in bytes read plus bytes written per
    /// nanosecond.
    pub(crate) touched_bytes_per_ns: f64,
    /// Bandwidth of a copy into memory that is new to the process, page faults included.
    fresh_bytes_per_ns: f64,
    buffer_bytes: usize,
    quick: bool,
}

impl Machine {
    /// Collects the facts and measures the memory bandwidth.
    pub(crate) fn look(quick: bool) -> Self {
        let buffer_bytes = if quick { 1 << 24 } else { 1 << 28 };
        let (touched_bytes_per_ns, fresh_bytes_per_ns) = bandwidth(buffer_bytes);
        Self { date: date(), touched_bytes_per_ns, fresh_bytes_per_ns, buffer_bytes, quick }
    }
}

impl fmt::Display for Machine {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let cores = std::thread::available_parallelism().map_or("unknown".to_owned(), |n| n.to_string());
        writeln!(f, "date       {} UTC", self.date)?;
        writeln!(f, "cpu        {}", cpu())?;
        writeln!(f, "cores      {cores} to this process; every row uses one thread")?;
        writeln!(f, "system     {} {}", std::env::consts::OS, std::env::consts::ARCH)?;
        writeln!(f, "compiler   {}", compiler())?;
        writeln!(f, "umbrage    {}", commit())?;
        writeln!(f, "sizes      {}", if self.quick { "quick (times mean nothing)" } else { "full" })?;
        writeln!(
            f,
            "memory     copying {} MiB: {:.1} GB/s touched, {:.1} GB/s fresh (read + written)",
            self.buffer_bytes >> 20,
            self.touched_bytes_per_ns,
            self.fresh_bytes_per_ns
        )
    }
}

/// Bandwidth in bytes per nanosecond, touched and fresh: the medians of five copies each.
fn bandwidth(bytes: usize) -> (f64, f64) {
    let source = vec![1_u64; bytes / 8];
    let mut touched = source.clone();
    let rate = |start: Instant| 2.0 * bytes as f64 / start.elapsed().as_nanos() as f64;
    let (mut into_touched, mut into_fresh) = (Vec::new(), Vec::new());
    for _ in 0..5 {
        let start = Instant::now();
        touched.copy_from_slice(black_box(&source));
        black_box(&touched);
        into_touched.push(rate(start));
        let start = Instant::now();
        let fresh = black_box(black_box(&source).clone());
        into_fresh.push(rate(start));
        drop(fresh);
    }
    (median(into_touched), median(into_fresh))
}

/// The processor's name.
pub(crate) fn cpu() -> String {
    let text = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let name = text.lines().find_map(|line| line.strip_prefix("model name")?.split_once(':'));
    name.map_or("unknown".to_owned(), |(_, name)| name.trim().to_owned())
}

/// The first line of a program's output; empty if the program does not run.
fn line(program: &str, arguments: &[&str]) -> String {
    let output = Command::new(program).args(arguments).current_dir(env!("CARGO_MANIFEST_DIR")).output();
    let output = output.ok().filter(|output| output.status.success());
    output.map_or(String::new(), |output| String::from_utf8_lossy(&output.stdout).trim().replace('\n', " "))
}

fn compiler() -> String {
    let rustc = std::env::var("RUSTC").unwrap_or("rustc".to_owned());
    match line(&rustc, &["--version"]) {
        version if version.is_empty() => "unknown".to_owned(),
        version => version,
    }
}

fn commit() -> String {
    let commit = line("git", &["rev-parse", "--short=12", "HEAD"]);
    let changed = !line("git", &["status", "--porcelain", "--untracked-files=no"]).is_empty();
    match commit.as_str() {
        "" => "unknown".to_owned(),
        _ => format!("{commit}{}", if changed { " with changes" } else { "" }),
    }
}

/// The system clock's date and minute, UTC (Howard Hinnant, *chrono-Compatible Low-Level Date Algorithms*,
/// `civil_from_days`).
fn date() -> String {
    let seconds = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |since| since.as_secs());
    let days = seconds / 86_400 + 719_468;
    let (era, of_era) = (days / 146_097, days % 146_097);
    let year = (of_era - of_era / 1_460 + of_era / 36_524 - of_era / 146_096) / 365;
    let of_year = of_era - (365 * year + year / 4 - year / 100);
    let month = (5 * of_year + 2) / 153;
    let day = of_year - (153 * month + 2) / 5 + 1;
    let month = if month < 10 { month + 3 } else { month - 9 };
    let year = year + 400 * era + u64::from(month <= 2);
    let (hour, minute) = (seconds / 3600 % 24, seconds / 60 % 60);
    format!("{year:04}-{month:02}-{day:02}-{hour:02}{minute:02}")
}
