//! How much memory each stage takes at its peak: measured by an allocator that counts, held against the figures that
//! the documentation states, on ordinary meshes and on hostile ones.
//!
//! A binary of its own, since there is one allocator a program. `--nocapture` prints the figures.

mod files;
mod frames;
mod large;
mod inputs;
mod stack;
mod stages;

use std::sync::{Mutex, MutexGuard, PoisonError};

use peak_alloc::PeakAlloc;

#[global_allocator]
static MEMORY: PeakAlloc = PeakAlloc;

/// Everything is counted, whichever thread asks: one test at a time.
fn alone() -> MutexGuard<'static, ()> {
    static ALONE: Mutex<()> = Mutex::new(());
    ALONE.lock().unwrap_or_else(PoisonError::into_inner)
}

/// What `work` gives, and how many bytes it held at most, what it gives included.
fn peak<T>(work: impl FnOnce() -> T) -> (T, usize) {
    MEMORY.reset_peak_usage();
    let before = MEMORY.current_usage();
    let result = work();
    (result, MEMORY.peak_usage().saturating_sub(before))
}

#[test]
fn memory_of_a_copy_more_is_seen() {
    let _alone = alone();
    let bytes = vec![7_u8; 1 << 20];
    let (one, held) = peak(|| bytes.clone());
    // The threads of the test harness take and free some bytes meanwhile.
    let about = |bytes: usize| bytes - 4096..bytes + 4096;
    assert!(about(1 << 20).contains(&held), "{held}");
    drop(one);
    // The sabotage: a copy that is gone before the work ends.
    let (_, held) = peak(|| {
        drop(bytes.clone());
        (bytes.clone(), bytes.clone())
    });
    assert!(held >= about(2 << 20).start, "{held}");
}
