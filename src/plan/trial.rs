//! Trials: techniques without a bound are tried on the probe, where that costs little.

use super::candidates::Candidate;
use super::confidence::{CONFIDENCE, upper_bound};
use super::costs::Costs;
use super::probe::{Probe, Share};
use super::{Evidence, Scenery};
use crate::scene::Lamp;
use crate::shadow::{Request, Technique, Visibility};

/// Trials for one lamp: the truth at some samples of the probe is worked out once.
pub(super) struct Trials<'a> {
    scenery: &'a Scenery<'a>,
    lamp: &'a Lamp,
    samples: crate::shadow::Samples,
    truth: Option<Visibility>,
    /// Samples of the trial that see a surface.
    count: usize,
    /// Samples of the picture that do.
    seen: usize,
    /// What differs by more is wrong.
    light: f32,
}

impl<'a> Trials<'a> {
    /// On `count` samples of the probe, spread over it.
    pub(super) fn new(
        scenery: &'a Scenery<'a>,
        lamp: &'a Lamp,
        probe: &Probe,
        count: usize,
        light: f64,
    ) -> Self {
        let count = count.min(probe.hits.len());
        let at = |k: usize| (k as u128 * probe.hits.len() as u128 / count as u128) as usize;
        let points: Vec<_> = (0..count).map(|k| probe.hits[at(k)]).collect();
        let samples = scenery.samples.of_points(&points);
        Self { scenery, lamp, samples, truth: None, count, seen: probe.seen, light: light as f32 }
    }

    /// The technique that the others are compared with.
    pub(super) fn exact(lamp: &Lamp) -> Technique {
        if lamp.has_extent() { Technique::Area } else { Technique::Rays }
    }

    /// Whether the pictures' neighbors matter to it, which a trial does not have, or whether it is too slow.
    pub(super) fn can_try(candidate: &Candidate) -> bool {
        candidate.not_applicable.is_none()
            && !candidate.on_device
            && !matches!(
                candidate.technique,
                Technique::ContactBlur(_)
                    | Technique::ZPass
                    | Technique::ZPassPlus
                    | Technique::ZPassReversed
                    | Technique::None
                    | Technique::Dark
            )
    }

    /// The fraction of wrong samples, with its bound; `None` if the technique cannot be prepared.
    pub(super) fn run(&mut self, technique: Technique) -> Option<(Share, Evidence)> {
        let request = Request { casters: self.scenery.casters, lamp: self.lamp, samples: &self.samples };
        if self.truth.is_none() {
            self.truth = Some(Self::exact(self.lamp).shade(&request).ok()?);
        }
        let truth = self.truth.as_ref()?;
        let found = technique.shade(&request).ok()?;
        let differs = |(a, b): &(&f32, &f32)| (**a - **b).abs() > self.light;
        let wrong = found.values().iter().zip(truth.values()).filter(differs).count();
        let of_probe = wrong as f64 / self.count.max(1) as f64;
        let is_all = self.count == self.seen;
        let bound = if is_all { of_probe } else { upper_bound(wrong, self.count, CONFIDENCE) };
        Some((Share { of_probe, bound, is_all }, Evidence::Sampled))
    }

    /// The time of a trial, in nanoseconds: what does not depend on the samples, and the rest in proportion.
    pub(super) fn time(costs: &Costs, candidate: &Candidate, all: usize, count: usize) -> f64 {
        let part = count as f64 / all.max(1) as f64;
        let none = candidate.without_samples(costs);
        none + part * (candidate.time - none).max(0.0)
    }
}
