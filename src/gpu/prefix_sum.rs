//! Exclusive prefix sums, which turn counts into positions: they fix the order of everything that a shader
//! writes.
//!
//! Reduce, scan, spread (Guy E. Blelloch, *Prefix Sums and Their Applications*, 1990, §1.3), with a run of
//! values for each invocation instead of barriers between them.

use super::{Gpu, GpuError, Kernel, Shader};

/// Values that one invocation adds up.
const RUN: usize = 64;

/// The compiled kernels.
#[derive(Clone, Debug)]
pub(crate) struct Scan {
    sum_runs: Kernel,
    spread: Kernel,
    spread_one: Kernel,
}

/// The scan of one buffer, which can be recorded any number of times.
#[derive(Clone, Debug)]
pub(crate) struct ScanOf {
    scan: Scan,
    /// From the values to ever fewer sums: bindings for [`Scan::sum_runs`] and [`Scan::spread`], and the
    /// runs.
    levels: Vec<(wgpu::BindGroup, wgpu::BindGroup, usize)>,
    top: wgpu::BindGroup,
}

impl Scan {
    pub(crate) fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        let module = shader().module(gpu)?;
        Ok(Self {
            sum_runs: Kernel::new(gpu, &module, "sum_runs")?,
            spread: Kernel::new(gpu, &module, "spread")?,
            spread_one: Kernel::new(gpu, &module, "spread_one")?,
        })
    }

    /// Prepares the scan of the first `count` values of a buffer that holds one more: each value becomes the
    /// sum of all before it, and the last one the total. Sums wrap at 2³².
    pub(crate) fn of(&self, gpu: &Gpu, values: &wgpu::Buffer, count: usize) -> Result<ScanOf, GpuError> {
        let mut levels = Vec::new();
        let (mut values, mut count) = (values.clone(), count);
        while count > RUN {
            let runs = count.div_ceil(RUN);
            let sums = gpu.storage::<u32>("sums of runs", runs + 1)?;
            let size = gpu.uniform(&[count as u32, 0, 0, 0])?;
            let buffers = [(0, &values), (1, &sums), (2, &size)];
            let bindings = (self.sum_runs.bind(gpu, &buffers)?, self.spread.bind(gpu, &buffers)?, runs);
            levels.push(bindings);
            (values, count) = (sums, runs);
        }
        let size = gpu.uniform(&[count as u32, 0, 0, 0])?;
        let top = self.spread_one.bind(gpu, &[(0, &values), (2, &size)])?;
        Ok(ScanOf { scan: self.clone(), levels, top })
    }
}

impl ScanOf {
    pub(crate) fn record(&self, encoder: &mut wgpu::CommandEncoder) {
        for (sum_runs, _, runs) in &self.levels {
            self.scan.sum_runs.record(encoder, sum_runs, *runs);
        }
        self.scan.spread_one.record(encoder, &self.top, 1);
        for (_, spread, runs) in self.levels.iter().rev() {
            self.scan.spread.record(encoder, spread, *runs);
        }
    }
}

fn shader() -> Shader {
    Shader::new("scan", include_str!("prefix_sum.wgsl")).constant("RUN", "u32", RUN)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gpu::tests::gpu;

    fn naive(values: &[u32]) -> Vec<u32> {
        let mut sums = vec![0_u32];
        sums.extend(values.iter().scan(0_u32, |sum, value| {
            *sum = sum.wrapping_add(*value);
            Some(*sum)
        }));
        sums
    }

    fn scanned(gpu: &Gpu, values: &[u32], count: usize) -> Vec<u32> {
        let mut padded = values.to_vec();
        padded.push(7); // the total comes here
        let buffer = gpu.upload("values", &padded).unwrap();
        let scan = Scan::new(gpu).unwrap().of(gpu, &buffer, count).unwrap();
        gpu.submit(|encoder| scan.record(encoder)).unwrap();
        gpu.download(&buffer, values.len() + 1).unwrap()
    }

    #[test]
    fn scan_equals_adding_up_one_by_one() {
        let Some(gpu) = gpu() else { return };
        for n in [0, 1, 2, 63, 64, 65, 4095, 4096, 4097, 300_001] {
            let values: Vec<u32> = (0..n as u32).map(|i| i.wrapping_mul(2_654_435_761) >> 20).collect();
            assert_eq!(scanned(&gpu, &values, n), naive(&values), "{n} values");
        }
    }

    #[test]
    fn scan_that_leaves_out_the_last_value_is_caught() {
        let Some(gpu) = gpu() else { return };
        let values = vec![1; 200];
        assert_ne!(scanned(&gpu, &values, 199), naive(&values));
    }
}
