//! The switch of every mutant: which change is in force. Copied into the crate under test.

use std::fs::{File, OpenOptions};
use std::io::Write;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU32, Ordering};

/// Not asked yet.
const UNKNOWN: u32 = u32::MAX;
/// No mutant, and each point that is reached goes to the file `UMBRAGE_MUTANT_TRACE`, once.
const TRACE: u32 = u32::MAX - 1;
/// No mutant.
const NONE: u32 = u32::MAX - 2;

/// The number of the mutant in force, from the environment variable `UMBRAGE_MUTANT`.
static ACTIVE: AtomicU32 = AtomicU32::new(UNKNOWN);
/// The file of the trace, and a bit for each point that is in it.
static SEEN: Mutex<Option<(File, Vec<u64>)>> = Mutex::new(None);

/// Which of the changes of the point that begins at number `first` is in force; a large number for none.
#[inline]
pub(crate) fn at(first: u32) -> u32 {
    let active = ACTIVE.load(Ordering::Relaxed);
    let active = if active >= TRACE { slow(active, first) } else { active };
    active.wrapping_sub(first)
}

#[cold]
fn slow(mut active: u32, first: u32) -> u32 {
    if active == UNKNOWN {
        let trace = std::env::var_os("UMBRAGE_MUTANT_TRACE");
        active = match std::env::var("UMBRAGE_MUTANT") {
            Ok(number) => number.parse().expect("UMBRAGE_MUTANT is the number of a mutant"),
            Err(_) if trace.is_some() => TRACE,
            Err(_) => NONE,
        };
        if let Some(path) = trace {
            let mut seen = SEEN.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
            if seen.is_none() {
                let file = OpenOptions::new().create(true).append(true).open(path).expect("the trace opens");
                *seen = Some((file, Vec::new()));
            }
        }
        ACTIVE.store(active, Ordering::Relaxed);
    }
    if active == TRACE {
        let mut seen = SEEN.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
        if let Some((file, bits)) = seen.as_mut() {
            let (word, bit) = (first as usize / 64, 1 << (first % 64));
            if bits.len() <= word {
                bits.resize(word + 1, 0_u64);
            }
            if bits[word] & bit == 0 {
                bits[word] |= bit;
                file.write_all(&first.to_le_bytes()).expect("the trace is written");
            }
        }
        return NONE;
    }
    active
}
