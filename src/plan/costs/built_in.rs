//! The built-in table.

use super::{CostKey, Costs, Step};
use crate::plan::Evidence;

/// Nanoseconds for each feature of a step, on one thread: fitted to a record of three meshes on a shared
/// virtual machine of two cores, and rounded.
fn assumed(step: Step) -> &'static [f64] {
    match step {
        Step::Tree => &[10e3, 490.0],
        Step::Proofs => &[20e3, 1000.0],
        Step::Device => &[150e6],
        Step::Prepass => &[1e6, 12.0, 20.0],
        Step::Rays => &[20e3, 34.0, 36.0],
        Step::Hybrid => &[100e3, 34.0, 250.0, 310.0, 60.0, 36.0],
        Step::AliasFree => &[100e3, 34.0, 300.0, 570.0],
        Step::Counting => &[100e3, 34.0, 500.0, 5000.0],
        Step::Counter => &[100e3, 60.0, 4000.0, 100.0],
        Step::Stencil => &[3e6, 200.0, 150.0, 10.0],
        Step::Planar => &[50e3, 34.0, 900.0, 790.0, 36.0],
        Step::Map => &[50e3, 34.0, 240.0, 550.0, 7.5, 16.0],
        Step::Samples => &[50e3, 34.0, 37.0],
        Step::Area => &[50e3, 34.0, 5000.0],
        Step::SoftMap => &[50e3, 34.0, 240.0, 550.0, 10.0, 20.0],
        Step::SoftHybrid => &[50e3, 34.0, 600.0, 10.0, 50.0],
        // No side of a face is asked for.
        Step::Plain => &[1e3, 9.0],
    }
}

impl Default for Costs {
    fn default() -> Self {
        let coefficients = Step::ALL.map(|step| assumed(step).to_vec()).to_vec();
        Self { evidence: Evidence::Assumed, key: CostKey::here(), coefficients }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn costs_have_a_coefficient_for_each_feature() {
        let costs = Costs::default();
        for (index, step) in Step::ALL.into_iter().enumerate() {
            assert_eq!(step as usize, index);
            assert_eq!(costs.coefficients(step).len(), step.features().len(), "{}", step.name());
        }
    }
}
