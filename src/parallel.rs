//! Parallel loops over rows, sums, and fork-join, with serial versions where the feature `parallel` is off.

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

/// Adds all numbers below `count` to results that start `empty`, and joins these in the order of the numbers.
///
/// `add` and `join` have to give the same sum wherever the numbers are cut into runs; memory does not grow
/// with `count`.
#[cfg(all(feature = "parallel", feature = "verify"))]
pub(crate) fn sum<R: Send>(
    count: u64,
    empty: impl Fn() -> R + Send + Sync,
    add: impl Fn(R, u64) -> R + Send + Sync,
    join: impl Fn(R, R) -> R + Send + Sync,
) -> R {
    use rayon::prelude::*;
    (0..count).into_par_iter().fold(&empty, add).reduce(&empty, join)
}

#[cfg(all(not(feature = "parallel"), feature = "verify"))]
pub(crate) fn sum<R>(
    count: u64,
    empty: impl Fn() -> R,
    add: impl Fn(R, u64) -> R,
    join: impl Fn(R, R) -> R,
) -> R {
    join(empty(), (0..count).fold(empty(), add))
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

#[cfg(test)]
mod tests {
    use super::sum;

    #[test]
    fn parallel_sum_joins_in_order_whatever_the_threads() {
        let add = |mut list: Vec<u64>, number| {
            list.push(number);
            list
        };
        let list = sum(1000, Vec::new, add, |a, b| [a, b].concat());
        assert_eq!(list, (0..1000).collect::<Vec<u64>>());
        assert!(sum(0, Vec::new, add, |a, b| [a, b].concat()).is_empty());
        // The sabotage: joined in reverse, the order of the numbers is lost.
        let reversed = sum(1000, Vec::new, add, |a: Vec<u64>, b| [b, a].concat());
        assert!(reversed.len() == 1000 && (cfg!(not(feature = "parallel")) || reversed != list));
    }
}
