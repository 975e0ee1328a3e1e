//! Costs: the time of each step, as a sum of counts that are known before it runs.

mod built_in;
mod calibrate;
#[cfg(feature = "files")]
mod file;
mod fit;
mod work;

use std::time::Duration;

#[cfg(feature = "files")]
pub use file::CostsError;
pub use work::{Step, Work};

use super::Evidence;

/// What the steps cost on one machine: for each, nanoseconds per unit of what it works on.
///
/// The default is a built-in table. [`Costs::calibrate`] measures.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Costs {
    /// Where the costs come from: assumed for the built-in table, sampled if they were measured.
    pub evidence: Evidence,
    /// The machine.
    pub key: CostKey,
    /// Coefficients of each step, in the order of [`Step::ALL`] and of [`Step::features`]; none is negative.
    coefficients: Vec<Vec<f64>>,
}

/// What costs depend on: they are those of another machine if one of these differs.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub struct CostKey {
    /// Name of the graphics adapter; empty without one.
    pub adapter: String,
    /// Its driver; empty without one.
    pub driver: String,
    /// Name of the processor; its architecture if it has none.
    pub cpu: String,
    /// Number of threads.
    pub threads: usize,
    /// Version of this crate.
    pub version: String,
}

impl CostKey {
    /// This machine, without a graphics adapter.
    #[must_use]
    pub fn here() -> Self {
        Self {
            adapter: String::new(),
            driver: String::new(),
            cpu: cpu_name(),
            threads: threads(),
            version: env!("CARGO_PKG_VERSION").to_owned(),
        }
    }

    /// The same with a graphics adapter.
    #[must_use]
    pub fn with_adapter(self, adapter: &str, driver: &str) -> Self {
        Self { adapter: adapter.to_owned(), driver: driver.to_owned(), ..self }
    }

    /// The parts that differ, each as `name: theirs here, ours there`; empty if none does.
    #[must_use]
    pub fn differences(&self, other: &Self) -> Vec<String> {
        let threads = [self, other].map(|key| key.threads.to_string());
        let parts = [
            ("adapter", [&self.adapter, &other.adapter]),
            ("driver", [&self.driver, &other.driver]),
            ("cpu", [&self.cpu, &other.cpu]),
            ("threads", [&threads[0], &threads[1]]),
            ("version", [&self.version, &other.version]),
        ];
        let differing = parts.into_iter().filter(|(_, [own, others])| own != others);
        differing.map(|(name, [own, others])| format!("{name}: `{own}`, not `{others}`")).collect()
    }
}

#[cfg(feature = "parallel")]
fn threads() -> usize {
    rayon::current_num_threads()
}

#[cfg(not(feature = "parallel"))]
fn threads() -> usize {
    1
}

/// The processor's name where the system tells it in a file.
fn cpu_name() -> String {
    let told = std::fs::read_to_string("/proc/cpuinfo").ok().and_then(|text| {
        let line = text.lines().find(|line| line.starts_with("model name"))?;
        Some(line.split_once(':')?.1.trim().to_owned())
    });
    told.unwrap_or_else(|| std::env::consts::ARCH.to_owned())
}

impl Costs {
    /// Costs with the coefficients of one step changed by a factor.
    #[must_use]
    pub fn scaled(mut self, step: Step, factor: f64) -> Self {
        self.coefficients[step as usize].iter_mut().for_each(|coefficient| *coefficient *= factor);
        self
    }

    /// Coefficients of a step, in nanoseconds, in the order of [`Step::features`].
    #[must_use]
    pub fn coefficients(&self, step: Step) -> &[f64] {
        &self.coefficients[step as usize]
    }

    /// The predicted time of a step, in nanoseconds.
    #[must_use]
    pub fn nanoseconds(&self, step: Step, work: &Work) -> f64 {
        let counts = step.counts(work, self.key.threads);
        self.coefficients(step).iter().zip(counts).map(|(coefficient, count)| coefficient * count).sum()
    }

    /// The predicted time of a step.
    #[must_use]
    pub fn time(&self, step: Step, work: &Work) -> Duration {
        duration(self.nanoseconds(step, work))
    }
}

/// A duration of nanoseconds; the longest one where there are too many.
pub(super) fn duration(nanoseconds: f64) -> Duration {
    Duration::try_from_secs_f64(nanoseconds * 1e-9).unwrap_or(Duration::MAX)
}
