//! Work that is shared by threads: rows of pixels.

/// Calls `work` with the number and the elements of each row of `buffer`: on several threads if the feature
/// `parallel` is on. Rows do not see each other, so the result does not depend on the order.
#[cfg(feature = "parallel")]
pub(crate) fn rows<T: Send>(buffer: &mut [T], width: usize, work: impl Fn(usize, &mut [T]) + Sync) {
    use rayon::prelude::*;
    buffer.par_chunks_mut(width).enumerate().for_each(|(y, row)| work(y, row));
}

#[cfg(not(feature = "parallel"))]
pub(crate) fn rows<T>(buffer: &mut [T], width: usize, work: impl Fn(usize, &mut [T])) {
    buffer.chunks_mut(width).enumerate().for_each(|(y, row)| work(y, row));
}
