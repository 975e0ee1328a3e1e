//! A stable sort of pairs (key, value) by the key's lowest bits: digit by digit, the lowest first.
//!
//! Each digit is a counting sort (Marco Zagha and Guy E. Blelloch, *Radix Sort for Vector Multiprocessors*,
//! 1991): every invocation counts and later moves a run of pairs of its own, in order. The time does not
//! depend on the keys.

use bytemuck::{Pod, Zeroable};

use super::{Gpu, GpuError, Kernel, Scan, ScanOf, Shader};

/// Pairs that one invocation counts and moves. Longer runs leave a large device idle; shorter ones have more
/// counts to add up, one for each run and digit: here half as many as there are pairs.
const RUN: usize = 128;

/// Largest number of bits of a digit. Each further bit doubles the counts, and the positions that are written
/// to at once: on a software adapter four bits cost a fifth more time than six, and nine more than twice as
/// much.
const DIGIT_BITS: u32 = 6;

/// The compiled kernels.
#[derive(Clone, Debug)]
pub(crate) struct Sort {
    count_digits: Kernel,
    scatter: Kernel,
    scan: Scan,
}

/// The sort of two buffers, which can be recorded any number of times.
#[derive(Clone, Debug)]
pub(crate) struct SortOf {
    sort: Sort,
    /// Bindings for counting and for moving, per digit.
    digits: Vec<[wgpu::BindGroup; 2]>,
    positions: ScanOf,
    runs: usize,
}

/// The struct of the same name in the shader.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
struct Digit {
    count: u32,
    runs: u32,
    shift: u32,
    largest: u32,
}

/// Keys, and a value with each.
#[derive(Clone, Debug)]
pub(crate) struct Pairs {
    pub(crate) keys: wgpu::Buffer,
    pub(crate) values: wgpu::Buffer,
}

impl Sort {
    pub(crate) fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        Self::from_shader(gpu, &shader(include_str!("sort.wgsl")))
    }

    fn from_shader(gpu: &Gpu, shader: &Shader) -> Result<Self, GpuError> {
        let module = shader.module(gpu)?;
        Ok(Self {
            count_digits: Kernel::new(gpu, &module, "count_digits")?,
            scatter: Kernel::new(gpu, &module, "scatter")?,
            scan: Scan::new(gpu)?,
        })
    }

    /// Prepares the sort of the first `count` of `pairs` by the lowest `bits` bits of their keys. `spare`
    /// holds as many and is overwritten. Returns the buffers that will hold the sorted pairs, and then the
    /// others.
    pub(crate) fn of<'a>(
        &self,
        gpu: &Gpu,
        pairs: &'a Pairs,
        spare: &'a Pairs,
        count: usize,
        bits: u32,
    ) -> Result<(SortOf, [&'a Pairs; 2]), GpuError> {
        let runs = count.div_ceil(RUN);
        // Digits of nearly equal size.
        let rounds = bits.div_ceil(DIGIT_BITS);
        let size = bits.div_ceil(rounds.max(1));
        let counts = runs << size;
        let positions = gpu.storage::<u32>("positions of digits", counts + 1)?;
        let (mut from, mut to) = (pairs, spare);
        let mut digits = Vec::new();
        for shift in (0..rounds).map(|round| round * size) {
            let largest = (1 << size.min(bits - shift)) - 1;
            let digit = gpu.uniform(&Digit { count: count as u32, runs: runs as u32, shift, largest })?;
            digits.push([
                self.count_digits.bind(gpu, &[(0, &from.keys), (2, &positions), (5, &digit)])?,
                self.scatter.bind(
                    gpu,
                    &[
                        (0, &from.keys),
                        (1, &from.values),
                        (2, &positions),
                        (3, &to.keys),
                        (4, &to.values),
                        (5, &digit),
                    ],
                )?,
            ]);
            (from, to) = (to, from);
        }
        let positions = self.scan.of(gpu, &positions, counts)?;
        Ok((SortOf { sort: self.clone(), digits, positions, runs }, [from, to]))
    }
}

impl SortOf {
    pub(crate) fn record(&self, encoder: &mut wgpu::CommandEncoder) {
        for [count_digits, scatter] in &self.digits {
            self.sort.count_digits.record(encoder, count_digits, self.runs);
            self.positions.record(encoder);
            self.sort.scatter.record(encoder, scatter, self.runs);
        }
    }
}

fn shader(body: &str) -> Shader {
    Shader::new("sort", body).constant("RUN", "u32", RUN).constant("DIGITS", "u32", 1 << DIGIT_BITS)
}

#[cfg(test)]
mod tests {
    use super::super::tests::{gpu, limited_gpu};
    use super::*;
    use crate::random::SplitMix64;

    fn naive(keys: &[u32], bits: u32) -> Vec<(u32, u32)> {
        let mut pairs: Vec<_> = keys.iter().copied().zip(0..).collect();
        pairs.sort_by_key(|pair| u64::from(pair.0) & ((1 << bits) - 1)); // stable
        pairs
    }

    fn sorted(gpu: &Gpu, sort: &Sort, keys: &[u32], bits: u32) -> Vec<(u32, u32)> {
        let count = keys.len();
        let values: Vec<u32> = (0..count as u32).collect();
        let upload = |name, values: &[u32]| gpu.upload(name, values).unwrap();
        let pairs = Pairs { keys: upload("keys", keys), values: upload("values", &values) };
        let spare = Pairs { keys: upload("keys", keys), values: upload("values", &values) };
        let (of, [result, _]) = sort.of(gpu, &pairs, &spare, count, bits).unwrap();
        gpu.submit(|encoder| of.record(encoder)).unwrap();
        let keys: Vec<u32> = gpu.download(&result.keys, count).unwrap();
        keys.into_iter().zip(gpu.download(&result.values, count).unwrap()).collect()
    }

    fn keys(count: usize, below: usize) -> Vec<u32> {
        let mut random = SplitMix64(count as u64);
        (0..count).map(|_| random.below(below) as u32).collect()
    }

    #[test]
    fn sort_equals_a_stable_sort_on_the_host() {
        let Some(gpu) = gpu() else { return };
        let sort = Sort::new(&gpu).unwrap();
        for count in [1, 2, RUN - 1, RUN, RUN + 1, 64 * RUN + 1, 100_003] {
            for bits in [0, 1, DIGIT_BITS, DIGIT_BITS + 1, 17, 32] {
                let keys = keys(count, 1 << 32);
                assert_eq!(
                    sorted(&gpu, &sort, &keys, bits),
                    naive(&keys, bits),
                    "{count} pairs, {bits} bits"
                );
            }
        }
        let equal = vec![7; 3 * RUN];
        assert_eq!(sorted(&gpu, &sort, &equal, 32), naive(&equal, 32));
    }

    #[test]
    fn sort_of_more_workgroups_than_a_row_holds_equals_the_hosts() {
        let Some(gpu) = limited_gpu(|limits| limits.max_compute_workgroups_per_dimension = 2) else { return };
        let keys = keys(200 * RUN, 1 << 32);
        assert_eq!(sorted(&gpu, &Sort::new(&gpu).unwrap(), &keys, 32), naive(&keys, 32));
    }

    #[test]
    fn sort_by_too_few_bits_is_caught() {
        let Some(gpu) = gpu() else { return };
        let keys = keys(1000, 1 << 12);
        let sort = Sort::new(&gpu).unwrap();
        assert_ne!(sorted(&gpu, &sort, &keys, 11), naive(&keys, 12));
    }

    #[test]
    fn sort_digit_has_one_layout_in_rust_and_wgsl() {
        let shader = shader(include_str!("sort.wgsl"));
        crate::gpu::layout::assert_layout!(shader.source(), "Digit", Digit: count, runs, shift, largest);
    }

    #[test]
    fn sort_that_is_not_stable_is_caught() {
        let Some(gpu) = gpu() else { return };
        let keys = keys(1000, 1 << 4);
        let source = include_str!("sort.wgsl");
        let backwards = source.replace("let i = start + step;", "let i = start + length - 1u - step;");
        assert_ne!(source, backwards);
        let sort = Sort::from_shader(&gpu, &shader(&backwards)).unwrap();
        let found = sorted(&gpu, &sort, &keys, 4);
        assert!(found.is_sorted_by_key(|pair| pair.0));
        assert_ne!(found, naive(&keys, 4));
    }
}
