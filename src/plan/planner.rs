//! The planner: probe, relevance, light grid, candidates, choice.

use std::time::Instant;

use super::choose::{Chosen, Offer, SHARED, Wanted, choose, total};
use super::costs::{Costs, Step, Work};
use super::look::Looked;
use super::probe::{FEWEST, MOST, Probe};
use super::relevance::Pieces;
use super::{Budget, Scenery, ShadowPlan};
use super::{effects, reason};
use crate::geom::Aabb;

/// Time that a plan may take whatever the picture takes, and at most, in nanoseconds.
pub(super) const LEAST_PLANNING: f64 = 5e6;
pub(super) const MOST_PLANNING: f64 = 2e9;
/// Part of the picture's predicted time that a plan may take.
pub(super) const PLANNING_SHARE: f64 = 0.1;
/// Parts of the planning time: of the probe, of relevance, of the light grids, of trials. The rest is for
/// pieces and candidates.
const OF_PROBE: f64 = 0.2;
const OF_RELEVANCE: f64 = 0.3;
pub(super) const OF_GRIDS: f64 = 0.2;
const OF_TRIALS: f64 = 0.2;
/// What relevance takes from the trials where there is a graphics adapter: there each caster that is kept is
/// drawn whole, so that one that is dropped saves more; and nothing is tried on a device.
const FOR_DEVICE: f64 = 0.1;

/// The part of the planning time for relevance.
pub(super) fn of_relevance(has_device: bool) -> f64 {
    if has_device { OF_RELEVANCE + FOR_DEVICE } else { OF_RELEVANCE }
}

/// The part of the planning time for trials.
pub(super) fn of_trials(has_device: bool) -> f64 {
    if has_device { OF_TRIALS - FOR_DEVICE } else { OF_TRIALS }
}

/// Time of the first hit of a sample on one thread, and time to find the pieces, for each face, in
/// nanoseconds.
const FIRST_HIT: f64 = 350.0;
const PIECES: f64 = 100.0;

/// Chooses a technique for each lamp.
///
/// The plan depends on nothing but its arguments; only [`ShadowPlan::planning`] and the grids' times are
/// measured. Planning is kept, by the costs, to the larger one of 5 ms and a tenth of the picture's time, its
/// first hits included, and to about 2 s: tests that would take longer are left out, and a lamp that cannot
/// be looked at within its part of that gets an exact technique.
#[must_use]
pub fn plan(scenery: &Scenery<'_>, budget: &Budget, costs: &Costs) -> ShadowPlan {
    let start = Instant::now();
    let planner = Planner::new(scenery, budget, costs);
    let lamps: Vec<Looked> =
        scenery.lamps.iter().enumerate().map(|(number, lamp)| planner.look(number, lamp)).collect();
    let mut plan = planner.choose(lamps);
    plan.planning = start.elapsed();
    plan
}

pub(super) struct Planner<'a> {
    pub(super) scenery: &'a Scenery<'a>,
    pub(super) budget: &'a Budget,
    pub(super) costs: &'a Costs,
    pub(super) probe: Probe,
    pub(super) pieces: Pieces,
    /// Time for each lamp, in nanoseconds.
    pub(super) allowance: f64,
    pub(super) work: Work,
    pub(super) widening: f64,
}

impl<'a> Planner<'a> {
    fn new(scenery: &'a Scenery<'a>, budget: &'a Budget, costs: &'a Costs) -> Self {
        let lamps = scenery.lamps.len().max(1) as f64;
        let count = scenery.samples.hits().iter().flatten().count() as f64;
        let faces: usize = scenery.casters.casters().iter().map(|caster| caster.mesh().face_count()).sum();
        let work = Work {
            samples: scenery.samples.len() as f64,
            facing: 0.5 * count,
            faces: faces as f64,
            ..Work::default()
        };
        let first_hits = FIRST_HIT * work.samples / costs.key.threads.max(1) as f64;
        let picture =
            first_hits + lamps * costs.nanoseconds(Step::Rays, &work) + tree_time(scenery, costs, &work);
        let all = (PLANNING_SHARE * picture).clamp(LEAST_PLANNING, MOST_PLANNING);
        let allowance = all / lamps;
        // A side and a ray for each sample.
        let one = costs.nanoseconds(Step::Rays, &Work { samples: 1e3, facing: 1e3, ..work }) / 1e3;
        let most = ((OF_PROBE * allowance / one.max(1.0)) as usize).clamp(FEWEST, MOST);
        let probe = Probe::of(scenery, most);
        // Looking for the shells of a large mesh takes longer than a picture by rays.
        let pieces =
            if scenery.thorough || PIECES * work.faces <= of_relevance(scenery.device.is_some()) * all {
                Pieces::of(scenery.casters)
            } else {
                Pieces::whole(scenery.casters)
            };
        let seen = Aabb::around(scenery.samples.hits().iter().flatten().map(|hit| hit.point));
        let widening = (scenery.casters.bounds().diagonal() / seen.diagonal()).max(1.0);
        let widening = if widening.is_finite() { widening } else { 1.0 };
        Self { scenery, budget, costs, probe, pieces, allowance, work, widening }
    }

    /// Chooses among the candidates of all lamps.
    fn choose(&self, looked: Vec<Looked>) -> ShadowPlan {
        let Self { scenery, budget, .. } = *self;
        let wall = (!budget.least_error).then_some(budget.error);
        let within = budget.time.map(|time| time.as_secs_f64() * 1e9);
        let admissible = |most: f64| -> (Vec<Vec<usize>>, Vec<Vec<Offer>>) {
            let of_lamp = |looked: &Looked| {
                let candidates = looked.candidates.iter().enumerate();
                let admissible =
                    candidates.filter(|(_, candidate)| candidate.is_admissible(scenery.prove, most));
                admissible.map(|(index, candidate)| (index, reason::offer(candidate))).unzip()
            };
            looked.iter().map(of_lamp).unzip()
        };
        let shared = self.shared();
        let best = |most: f64, wanted: Wanted| {
            let (indices, offers) = admissible(most);
            let chosen = choose(&offers, &shared, wanted)?;
            let picks = indices.iter().zip(&chosen.picks).map(|(indices, &pick)| indices[pick]).collect();
            Some((Chosen { picks, ..chosen }, offers))
        };
        let least_error = |time: f64| best(1.0, Wanted::LeastError { time });
        let found = match (wall, within) {
            (Some(error), _) => best(error, Wanted::LeastTime { error }),
            (None, within) => least_error(within.unwrap_or(f64::INFINITY)),
        };
        // An exact technique is always admissible, so there is always a choice.
        let chosen = found.map_or_else(|| self.first_exact(&looked), |(chosen, _)| chosen);
        let is_within = within.is_none_or(|within| chosen.time <= within);
        let mut over_time = None;
        if let Some(within) = within.filter(|_| !is_within)
            && let Some((other, _)) = least_error(within)
        {
            let Chosen { picks, error, time } = other;
            over_time = Some(effects::best_within(scenery, &looked, &picks, error, time, within));
        }
        self.report(looked, &chosen, wall, is_within, over_time)
    }

    /// The first exact candidate of each lamp, which runs everywhere.
    fn first_exact(&self, looked: &[Looked]) -> Chosen {
        let exact = |looked: &Looked| {
            looked.candidates.iter().position(|candidate| candidate.is_admissible(true, 0.0)).unwrap_or(0)
        };
        let offers: Vec<Vec<Offer>> =
            looked.iter().map(|looked| looked.candidates.iter().map(reason::offer).collect()).collect();
        total(&offers, &self.shared(), looked.iter().map(exact).collect())
    }

    /// Times of what lamps share, for each picture.
    pub(super) fn shared(&self) -> [f64; SHARED] {
        let frames = f64::from(self.scenery.frames.max(1));
        let time = |step| self.costs.nanoseconds(step, &self.work);
        [
            tree_time(self.scenery, self.costs, &self.work),
            time(Step::Proofs) / frames,
            time(Step::Device) / frames,
            time(Step::Prepass),
        ]
    }
}

/// The time of the ray tree for each picture, in nanoseconds; 0 where it is built already.
pub(super) fn tree_time(scenery: &Scenery<'_>, costs: &Costs, work: &Work) -> f64 {
    let frames = f64::from(scenery.frames.max(1));
    if scenery.has_tree { 0.0 } else { costs.nanoseconds(Step::Tree, work) / frames }
}
