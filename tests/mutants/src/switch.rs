//! The switch of every mutant: which change is in force. Copied into the crate under test.

use std::fs::{File, OpenOptions};
use std::io::Write;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};

/// Not asked yet.
const UNKNOWN: u32 = u32::MAX;
/// No mutant, and each point that is reached goes to the file `UMBRAGE_MUTANT_TRACE`, once.
const TRACE: u32 = u32::MAX - 1;
/// No mutant.
const NONE: u32 = u32::MAX - 2;

/// The number of the mutant in force, from the environment variable `UMBRAGE_MUTANT`.
static ACTIVE: AtomicU32 = AtomicU32::new(UNKNOWN);
/// The file of the trace.
static FILE: Mutex<Option<File>> = Mutex::new(None);
/// Whether a point is in the trace.
static SEEN: [AtomicBool; 1 << 16] = [const { AtomicBool::new(false) }; 1 << 16];

/// Which of the changes of the point that begins at number `first` is in force; a large number for none.
#[inline]
pub(crate) fn at(first: u32) -> u32 {
    let active = ACTIVE.load(Ordering::Relaxed);
    let active = if active >= TRACE { slow(active, first) } else { active };
    active.wrapping_sub(first)
}

#[inline(never)]
fn slow(active: u32, first: u32) -> u32 {
    if active == UNKNOWN {
        start();
        return at(first).wrapping_add(first);
    }
    let seen = &SEEN[first as usize];
    if !seen.load(Ordering::Relaxed) && !seen.swap(true, Ordering::Relaxed) {
        let mut file = FILE.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
        let file = file.as_mut().expect("the trace is open");
        file.write_all(&first.to_le_bytes()).expect("the trace is written");
    }
    NONE
}

/// Reads the variables.
fn start() {
    let mut file = FILE.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
    if ACTIVE.load(Ordering::Relaxed) != UNKNOWN {
        return;
    }
    let mut active = NONE;
    if let Ok(number) = std::env::var("UMBRAGE_MUTANT") {
        active = number.parse().expect("UMBRAGE_MUTANT is the number of a mutant");
    } else if let Some(path) = std::env::var_os("UMBRAGE_MUTANT_TRACE") {
        let opened = OpenOptions::new().create(true).append(true).open(path);
        *file = Some(opened.expect("the trace opens"));
        active = TRACE;
    }
    ACTIVE.store(active, Ordering::Relaxed);
}
