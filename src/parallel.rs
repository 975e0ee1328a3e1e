//! Parallel loops over rows, and fork-join, with serial versions where the feature `parallel` is off.

/// Calls `work` with the index and the elements of each row of `buffer`, on several threads if the feature
/// `parallel` is on. Each call sees only its own row, so the result does not depend on the order.
#[cfg(feature = "parallel")]
pub(crate) fn rows<T: Send>(buffer: &mut [T], width: usize, work: impl Fn(usize, &mut [T]) + Sync) {
    use rayon::prelude::*;
    buffer.par_chunks_mut(width).enumerate().for_each(|(y, row)| work(y, row));
}

#[cfg(not(feature = "parallel"))]
pub(crate) fn rows<T>(buffer: &mut [T], width: usize, work: impl Fn(usize, &mut [T])) {
    buffer.chunks_mut(width).enumerate().for_each(|(y, row)| work(y, row));
}

/// Runs both closures and returns both results, on two threads where available if the feature `parallel` is
/// on.
#[cfg(feature = "parallel")]
pub(crate) fn join<A: Send, B: Send>(a: impl FnOnce() -> A + Send, b: impl FnOnce() -> B + Send) -> (A, B) {
    rayon::join(a, b)
}

#[cfg(not(feature = "parallel"))]
pub(crate) fn join<A, B>(a: impl FnOnce() -> A, b: impl FnOnce() -> B) -> (A, B) {
    (a(), b())
}

/// Parallel reduction of a list: `of` maps each run of at most `grain` elements, and `both` combines
/// neighboring results. The split depends on the length alone, so the result does not depend on the thread
/// count.
pub(crate) fn fold<T: Sync, R: Send>(
    list: &[T],
    grain: usize,
    of: impl Fn(&[T]) -> R + Copy + Send + Sync,
    both: impl Fn(R, R) -> R + Copy + Send + Sync,
) -> R {
    if list.len() <= grain {
        return of(list);
    }
    let (left, right) = list.split_at(list.len() / 2);
    let (left, right) = join(|| fold(left, grain, of, both), || fold(right, grain, of, both));
    both(left, right)
}
