//! The built-in table.

use super::{CostKey, Costs, Step};
use crate::plan::Evidence;

/// Nanoseconds for each feature of a step, on one thread of a processor of 2020.
fn assumed(step: Step) -> &'static [f64] {
    match step {
        Step::Tree => &[10e3, 500.0],
        Step::Topology => &[20e3, 900.0],
        Step::Device => &[150e6],
        Step::Prepass => &[1e6, 12.0, 20.0],
        Step::Rays => &[20e3, 8.0, 25.0],
        Step::Hybrid => &[100e3, 8.0, 300.0, 320.0, 60.0, 25.0],
        Step::AliasFree => &[100e3, 8.0, 260.0, 560.0],
        Step::Counting => &[100e3, 8.0, 2000.0, 1300.0],
        Step::Counter => &[100e3, 30.0, 2000.0, 100.0],
        Step::Stencil => &[3e6, 15.0, 180.0, 30.0],
        Step::Planar => &[50e3, 8.0, 900.0, 90.0],
        Step::Map => &[50e3, 8.0, 600.0, 8.0, 60.0],
        Step::Samples => &[50e3, 8.0, 25.0],
        Step::Area => &[50e3, 8.0, 4000.0],
        Step::SoftMap => &[50e3, 8.0, 600.0, 9.0, 12.0],
        Step::SoftHybrid => &[50e3, 100.0, 600.0, 10.0, 30.0],
        Step::Plain => &[1e3, 8.0],
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
