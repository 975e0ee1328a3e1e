//! The probe: some samples that are looked at before the choice.

use super::confidence::{CONFIDENCE, upper_bound};
use super::{Evidence, Scenery};
use crate::light_grid::{Chain, GridVerdict, LightGrid, SoftGrid, SoftVerdict};
use crate::oracle::{PrimaryHit, Verdict};
use crate::random::SplitMix64;
use crate::scene::Lamp;
use crate::shadow::is_front_lit;

/// Most samples of a probe.
pub(super) const MOST: usize = 1 << 14;
/// Fewest, so that a bound of 1 % can be seen.
pub(super) const FEWEST: usize = 1 << 9;

/// Samples of a picture, evenly spread and jittered; the same ones for every lamp.
#[derive(Clone, Debug)]
pub(super) struct Probe {
    /// The visible points of the probe.
    pub(super) hits: Vec<PrimaryHit>,
    /// Number of samples of the picture that see a surface.
    pub(super) seen: usize,
}

/// A fraction of the samples, as the probe tells it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Share {
    /// The fraction in the probe.
    pub(super) of_probe: f64,
    /// Its upper bound: itself if the probe is all samples, otherwise that of 95 % confidence.
    pub(super) bound: f64,
    /// Whether the probe is all samples.
    pub(super) is_all: bool,
}

/// What the probe tells about one lamp.
#[derive(Clone, Debug)]
pub(super) struct LampProbe {
    /// Indices of the probe's samples that face the lamp.
    pub(super) facing: Vec<u32>,
    /// Number of those that are dark, by exact rays to the lamp's center; `None` if no ray was cast.
    pub(super) shadowed: Option<usize>,
}

/// What a light grid tells about the probe.
#[derive(Clone, Copy, Debug)]
pub(super) struct GridProbe {
    pub(super) side: u32,
    /// Number of samples without a proof.
    pub(super) undecided: usize,
    /// Number that are proven dark.
    pub(super) dark: usize,
}

/// What a light grid tells about the probe and the extent of the lamp.
#[derive(Clone, Copy, Debug)]
pub(super) struct SoftProbe {
    /// Number of samples that may be in a penumbra.
    pub(super) maybe: usize,
    /// Number that are proven dark.
    pub(super) dark: usize,
}

impl Probe {
    /// `most` samples, one of each stratum, or all that there are.
    pub(super) fn of(scenery: &Scenery<'_>, most: usize) -> Self {
        let seen: Vec<&PrimaryHit> = scenery.samples.hits().iter().flatten().collect();
        let count = most.min(seen.len());
        let start = |k: usize| (k as u128 * seen.len() as u128 / count as u128) as usize;
        let mut random = SplitMix64(0x70_726f_6265);
        let hits = (0..count).map(|k| {
            let (first, end) = (start(k), start(k + 1));
            *seen[first + random.below(end - first)]
        });
        Self { hits: hits.collect(), seen: seen.len() }
    }

    /// The fraction of all samples that this many of the probe stand for.
    pub(super) fn share(&self, count: usize) -> Share {
        let n = self.hits.len();
        let of_probe = if n == 0 { 0.0 } else { count as f64 / n as f64 };
        let is_all = n == self.seen;
        let bound = if is_all { of_probe } else { upper_bound(count, n, CONFIDENCE) };
        Share { of_probe, bound, is_all }
    }

    /// Which samples face a lamp, and which of them are dark.
    pub(super) fn lamp(&self, scenery: &Scenery<'_>, lamp: &Lamp, cast: bool) -> LampProbe {
        let light = lamp.light();
        let facing = (0..).zip(&self.hits).filter(|(_, hit)| is_front_lit(hit, light));
        let facing: Vec<u32> = facing.map(|(index, _)| index).collect();
        let shadowed = cast.then(|| {
            let points: Vec<[f32; 3]> = self.at(&facing).map(|hit| hit.point).collect();
            let mut verdicts = vec![Verdict::Lit; points.len()];
            scenery.casters.oracle().verdicts_into(&points, light, &mut verdicts);
            verdicts.iter().filter(|verdict| **verdict == Verdict::Shadowed).count()
        });
        LampProbe { facing, shadowed }
    }

    fn at<'a>(&'a self, indices: &'a [u32]) -> impl Iterator<Item = &'a PrimaryHit> + Clone {
        indices.iter().map(|&index| &self.hits[index as usize])
    }

    /// What the light grid of the lamp's center proves about the samples that face it.
    pub(super) fn grid(&self, lamp: &LampProbe, chain: &Chain<'_>, side: u32) -> GridProbe {
        let grid = LightGrid::build(chain, self.at(&lamp.facing).map(|hit| hit.point), side);
        let mut found = GridProbe { side, undecided: 0, dark: 0 };
        for hit in self.at(&lamp.facing) {
            match grid.verdict(hit) {
                GridVerdict::Lit => {}
                GridVerdict::Dark => found.dark += 1,
                GridVerdict::Undecided => found.undecided += 1,
            }
        }
        found
    }

    /// What it proves about the whole extent of the lamp.
    pub(super) fn soft(&self, probe: &LampProbe, chain: &Chain<'_>, lamp: &Lamp, side: u32) -> SoftProbe {
        let grid = SoftGrid::build(chain, lamp, self.at(&probe.facing).map(|hit| hit.point), side);
        let mut found = SoftProbe { maybe: 0, dark: 0 };
        for hit in self.at(&probe.facing) {
            match grid.verdict(hit) {
                SoftVerdict::Lit => {}
                SoftVerdict::Dark => found.dark += 1,
                SoftVerdict::Maybe => found.maybe += 1,
            }
        }
        found
    }
}

impl Share {
    /// Nothing.
    pub(super) const NONE: Self = Self { of_probe: 0.0, bound: 0.0, is_all: true };

    /// Evidence of the bound.
    pub(super) fn evidence(self) -> Evidence {
        if self.is_all { Evidence::Proven } else { Evidence::Sampled }
    }

    /// Both together: the samples of one or of the other.
    pub(super) fn or(self, other: Self) -> Self {
        Self {
            of_probe: (self.of_probe + other.of_probe).min(1.0),
            bound: (self.bound + other.bound).min(1.0),
            is_all: self.is_all && other.is_all,
        }
    }

    /// The share with its size changed by a law that was measured, and is not proven.
    pub(super) fn scaled(self, factor: f64) -> Self {
        let scale = |share: f64| (factor * share).min(1.0);
        Self { of_probe: scale(self.of_probe), bound: scale(self.bound), is_all: false }
    }
}
