//! Passes: disks that are hidden themselves count less.

use super::{Disks, open};

/// How the disks are summed up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Passes {
    /// A node of the tree whose radius is at most this share of its distance counts as one disk; 0 leaves out
    /// the tree.
    ///
    /// To move the disks of a node to its center, at a share θ, changes its part of the sum by at most
    /// 4θ/(1−θ)² of Σ a/πr²: both cosines and 1/r² move. That their normals are known by two sums only comes
    /// on top; it is without a bound, and smaller.
    pub theta: f64,
    /// How often everything is summed up, 1 or more. One pass is the rule on nearly convex scans, four where
    /// surfaces fold; two are worse than one.
    pub passes: u32,
    /// Whether a weight, from the third pass on, is the mean of the one before and the new one. Undamped,
    /// weights swing.
    pub damped: bool,
}

impl Default for Passes {
    fn default() -> Self {
        Self { theta: 0.5, passes: 1, damped: true }
    }
}

impl Disks {
    /// Sets the weights of the disks: 1 for the first pass; for the second one the openness of each disk;
    /// then means of the weight before and the openness. [`Disks::openness`] is the last pass.
    pub fn run(&mut self, passes: &Passes) {
        self.theta = passes.theta.max(0.0); // 0 for what is not a number
        let mut weights = vec![1.0; self.emitters.len()];
        self.tree.weigh(&weights);
        for pass in 1..passes.passes {
            for (weight, seen) in weights.iter_mut().zip(self.seen(&self.emitters)) {
                let open = open(seen.hidden);
                *weight = if pass > 1 && passes.damped { 0.5 * (*weight + open) } else { open };
            }
            self.tree.weigh(&weights);
        }
    }
}
