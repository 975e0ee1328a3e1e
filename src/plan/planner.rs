//! The planner: probe, relevance, light grid, candidates, choice.

use std::time::{Duration, Instant};

use super::candidates::{Candidate, Known, TREE};
use super::choose::{Chosen, Offer, SHARED, Wanted, choose, total};
use super::costs::{Costs, Step, Work, duration};
use super::probe::{FEWEST, GridProbe, LampProbe, MOST, Probe, Share};
use super::relevance::{Outcome, Pieces, Question, Relevance, RelevanceTest, TestSet, Triple, relevant};
use super::trial::Trials;
use super::{
    Budget, Evidence, GridFigures, GroupPlan, LampPlan, Prediction, Receivers, Rejected, Scenery, ShadowPlan,
};
use super::{effects, reason};
use crate::geom::Aabb;
use crate::light_grid::Chain;
use crate::scene::Lamp;
use crate::shadow::Technique;
use crate::shadow::planar::Ground;

/// Time that a plan may take whatever the picture takes, and at most, in nanoseconds.
const LEAST_PLANNING: f64 = 5e6;
const MOST_PLANNING: f64 = 2e9;
/// Part of the picture's predicted time that a plan may take.
const PLANNING_SHARE: f64 = 0.1;
/// Sides of the grids that are built for the choice.
const COARSE: u32 = 64;
const FINE: u32 = 256;

/// Chooses a technique for each lamp.
///
/// The plan depends on nothing but its arguments; only [`ShadowPlan::planning`] and the grids' times are
/// measured. Planning is kept, by the costs, to the larger one of 5 ms and a tenth of the picture's time, and
/// to about 2 s: a lamp that cannot be looked at within its part of that gets an exact technique.
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

struct Planner<'a> {
    scenery: &'a Scenery<'a>,
    budget: &'a Budget,
    costs: &'a Costs,
    probe: Probe,
    pieces: Pieces,
    /// Time for each lamp, in nanoseconds.
    allowance: f64,
    work: Work,
    widening: f64,
}

/// What was found out about a lamp.
pub(super) struct Looked {
    pub(super) relevance: Relevance,
    pub(super) facing: Share,
    pub(super) shadowed: f64,
    pub(super) penumbra: Option<Share>,
    grid: Option<GridFigures>,
    pub(super) candidates: Vec<Candidate>,
    /// What was settled without a choice.
    settled: Option<String>,
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
        let picture = lamps * costs.nanoseconds(Step::Rays, &work) + tree_time(scenery, costs, &work);
        let allowance = (PLANNING_SHARE * picture).clamp(LEAST_PLANNING, MOST_PLANNING) / lamps;
        // A quarter for the probe: a side and a ray for each sample.
        let one = costs.nanoseconds(Step::Rays, &Work { samples: 1e3, facing: 1e3, ..work }) / 1e3;
        let most = ((0.25 * allowance / one.max(1.0)) as usize).clamp(FEWEST, MOST);
        let probe = Probe::of(scenery, most);
        let seen = Aabb::around(scenery.samples.hits().iter().flatten().map(|hit| hit.point));
        let widening = (scenery.casters.bounds().diagonal() / seen.diagonal()).max(1.0);
        let widening = if widening.is_finite() { widening } else { 1.0 };
        Self { scenery, budget, costs, probe, pieces: Pieces::of(scenery.casters), allowance, work, widening }
    }

    /// Looks at a lamp, for as long as it is worth it.
    fn look(&self, number: usize, lamp: &Lamp) -> Looked {
        let relevance = self.relevance(number, lamp);
        let casts = relevance.outcome == Outcome::Shadows && self.can_cast();
        let probe = self.probe.lamp(self.scenery, lamp, casts);
        let facing = self.probe.share(probe.facing.len());
        let mut looked = Looked {
            relevance,
            facing,
            shadowed: self.shadowed(&probe, None),
            penumbra: (!lamp.has_extent()).then_some(Share::NONE),
            grid: None,
            candidates: Vec::new(),
            settled: None,
        };
        match looked.relevance.outcome {
            Outcome::Shadows => self.look_at_shadows(lamp, &probe, &mut looked),
            outcome => self.settle(outcome, &mut looked),
        }
        looked
    }

    /// Which pieces matter; all of them if the tests would take too long.
    fn relevance(&self, number: usize, lamp: &Lamp) -> Relevance {
        let all = self.scenery.samples;
        let question = |samples, tests| Question {
            casters: self.scenery.casters,
            pieces: &self.pieces,
            lamp,
            number,
            samples,
            physical_falloff: self.scenery.physical_falloff,
            // Lamps that are dropped may add up: each gets an equal part of what the budget allows.
            level: self.budget.level / self.scenery.lamps.len().max(1) as f64,
            tests,
        };
        // Some 10 ns for each sample, and 1 µs for each piece.
        let time = 10.0 * all.len() as f64 + 1e3 * self.pieces.len() as f64;
        // The tests are cheap against a picture, and a picture is worth more than the least planning time.
        if time <= self.allowance.max(LEAST_PLANNING)
            && self.scenery.lamps.len() as f64 * time <= MOST_PLANNING
        {
            return relevant(&question(all, TestSet::ALL));
        }
        // Whether the lamp shines does not depend on the samples.
        let none = all.of_points(&[]);
        relevant(&question(&none, TestSet::only(RelevanceTest::Zero)))
    }

    /// Whether rays for the probe cost little: the tree is there, or built soon.
    fn can_cast(&self) -> bool {
        let lamps = self.scenery.lamps.len().max(1) as f64;
        tree_time(self.scenery, self.costs, &self.work) <= 0.5 * self.allowance * lamps
    }

    fn shadowed(&self, probe: &LampProbe, grid: Option<GridProbe>) -> f64 {
        let share = |count: f64| count / self.probe.hits.len().max(1) as f64;
        match (probe.shadowed, grid) {
            (Some(count), _) => share(count as f64),
            (None, Some(grid)) => share(grid.dark as f64 + 0.5 * grid.undecided as f64),
            (None, None) => 0.0,
        }
    }

    /// A lamp without shadows, or without light.
    fn settle(&self, outcome: Outcome, looked: &mut Looked) {
        let technique = if outcome == Outcome::Dark { Technique::Dark } else { Technique::None };
        let of_lamp = |dropped: &&super::relevance::Dropped| dropped.what == Triple::Lamp;
        let dropped = looked.relevance.dropped.iter().find(of_lamp);
        // What is below the level is no wrong sample: the budget's own bound is what the others are held to.
        let faint = dropped.is_some_and(|dropped| dropped.test == RelevanceTest::Faint);
        let evidence = if faint { Evidence::Proven } else { Evidence::Exact };
        let work = Work { facing: looked.facing.of_probe * self.work.samples, ..self.work };
        looked.candidates = vec![Candidate::plain(technique, work, self.costs, evidence)];
        looked.penumbra = Some(Share::NONE);
        let why = dropped.map_or("nothing is left to work out", |dropped| effects::because(dropped.test));
        looked.settled = Some(why.to_owned());
    }

    fn look_at_shadows(&self, lamp: &Lamp, probe: &LampProbe, looked: &mut Looked) {
        let start = Instant::now();
        let facing = probe.facing.len() as f64;
        let seen = self.probe.seen as f64;
        let work = Work { facing: looked.facing.of_probe * seen, ..self.work };
        let grid_time = |side: u32| {
            let own = Work { samples: facing, facing, side: side.into(), unsure: 0.0, ..work };
            // The soft grid holds more cells, and looks at more of them.
            let extent = if lamp.has_extent() { 3.0 } else { 1.0 };
            extent * self.costs.nanoseconds(Step::Hybrid, &own)
        };
        let rays =
            self.costs.nanoseconds(Step::Rays, &work) + tree_time(self.scenery, self.costs, &self.work);
        let exact = if lamp.has_extent() {
            self.costs.nanoseconds(Step::Area, &Work { unsure: work.facing, ..work })
        } else {
            rays
        };
        let allowance = self.allowance.max(PLANNING_SHARE * exact / self.scenery.lamps.len() as f64);
        let (mut found, mut soft) = (None, None);
        if facing > 0.0 && grid_time(COARSE) <= 0.5 * allowance {
            let chain = Chain::of(self.scenery.casters, lamp.light());
            let look = |side| {
                let soft = lamp.has_extent().then(|| self.probe.soft(probe, &chain, lamp, side));
                (self.probe.grid(probe, &chain, side), soft)
            };
            let (coarse, maybe) = look(COARSE);
            (found, soft) = (Some(coarse), maybe);
            // A finer one only if it is cheap against what it may save, or if its bound is needed.
            let is_cheap = 10.0 * grid_time(FINE) <= rays.max(exact) && self.allows_error();
            let share = maybe.map(|soft| self.probe.share(soft.maybe));
            let is_needed = share.is_some_and(|share| {
                share.bound > self.budget.error && share.of_probe <= 8.0 * self.budget.error
            });
            if (is_cheap || is_needed) && grid_time(FINE) <= 0.5 * allowance {
                let (fine, maybe) = look(FINE);
                (found, soft) = (Some(fine), maybe);
            }
        }
        if let Some(soft) = soft {
            looked.penumbra = Some(self.probe.share(soft.maybe));
        }
        looked.shadowed = self.shadowed(probe, found);
        looked.grid = found.map(|grid| GridFigures {
            side: grid.side,
            undecided: self.probe.share(grid.undecided).of_probe,
            maybe_penumbra: soft.map(|soft| self.probe.share(soft.maybe).of_probe),
            time: start.elapsed(),
        });
        let dark = probe.shadowed.map(|dark| self.probe.share(dark));
        let lit = probe.shadowed.map(|dark| self.probe.share(probe.facing.len() - dark));
        let known = Known {
            work,
            has_device: self.scenery.device.is_some(),
            has_extent: lamp.has_extent(),
            facing: looked.facing,
            dark,
            lit,
            undecided: found.map(|grid| (grid.side, self.probe.share(grid.undecided))),
            penumbra: looked.penumbra,
            widening: self.widening,
            on_plane: self.on_plane(lamp),
        };
        looked.candidates = known.candidates(self.costs);
        if self.allows_error() {
            self.try_some(lamp, allowance, &mut looked.candidates);
        }
    }

    fn allows_error(&self) -> bool {
        !self.scenery.prove && (self.budget.error > 0.0 || self.budget.least_error)
    }

    /// The fraction of the probe's samples that face the lamp which lie on the plane of most of them.
    fn on_plane(&self, lamp: &Lamp) -> f64 {
        let light = lamp.light();
        let some: Vec<_> =
            self.probe.hits.iter().step_by(self.probe.hits.len().div_ceil(FEWEST).max(1)).copied().collect();
        let facing: Vec<_> = some.into_iter().filter(|hit| crate::shadow::is_front_lit(hit, light)).collect();
        let Some(plane) = Ground::Most.plane(&self.scenery.samples.of_points(&facing), light) else {
            return 0.0;
        };
        let on_plane = facing.iter().filter(|hit| plane.holds(hit.corners)).count();
        on_plane as f64 / facing.len().max(1) as f64
    }

    /// Tries techniques that no bound admits, from the fastest on, until one is good enough, no more can pay,
    /// or the time for it is spent.
    fn try_some(&self, lamp: &Lamp, allowance: f64, candidates: &mut [Candidate]) {
        let most = if self.budget.least_error { 1.0 } else { self.budget.error };
        // So many right ones show that no more than this fraction is wrong; a third more let one be wrong.
        let count = ((4.0 / most) as usize).clamp(300, MOST);
        let light = self.budget.light_of(lamp.has_extent());
        let time_of = |candidate: &Candidate| {
            let with_tree = candidate.shared & TREE != 0;
            candidate.time + if with_tree { tree_time(self.scenery, self.costs, &self.work) } else { 0.0 }
        };
        let fastest = |candidates: &[Candidate]| {
            let admissible = candidates.iter().filter(|candidate| candidate.is_admissible(false, most));
            admissible.map(time_of).fold(f64::INFINITY, f64::min)
        };
        let mut order: Vec<usize> = (0..candidates.len()).collect();
        order.sort_by(|&a, &b| candidates[a].time.total_cmp(&candidates[b].time));
        let mut left = 0.5 * allowance;
        let exact = candidates.iter().find(|candidate| candidate.technique == Trials::exact(lamp));
        let truth =
            exact.map_or(f64::INFINITY, |exact| Trials::time(self.costs, exact, self.probe.seen, count));
        let (mut trials, mut has_truth) = (Trials::new(self.scenery, lamp, &self.probe, count, light), false);
        for index in order {
            let candidate = &candidates[index];
            let is_bounded = candidate.error.is_some_and(|(share, _)| share.bound <= most);
            if is_bounded || !Trials::can_try(candidate) || time_of(candidate) >= fastest(candidates) {
                continue;
            }
            let time = Trials::time(self.costs, candidate, self.probe.seen, count)
                + if has_truth { 0.0 } else { truth };
            if time > left {
                continue;
            }
            left -= time;
            has_truth = true;
            if let Some(found) = trials.run(candidate.technique) {
                candidates[index].error = Some(found);
            }
        }
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
    fn shared(&self) -> [f64; SHARED] {
        let frames = f64::from(self.scenery.frames.max(1));
        let time = |step| self.costs.nanoseconds(step, &self.work);
        [
            tree_time(self.scenery, self.costs, &self.work),
            // Pieces are made of topology: it is there after the plan.
            0.0,
            time(Step::Device) / frames,
            time(Step::Prepass),
        ]
    }

    fn report(
        &self,
        looked: Vec<Looked>,
        chosen: &Chosen,
        wall: Option<f64>,
        is_within: bool,
        over_time: Option<String>,
    ) -> ShadowPlan {
        let Self { scenery, budget, costs, .. } = *self;
        let evidence = |pick: &Candidate| pick.error.map_or(Evidence::Assumed, |(_, evidence)| evidence);
        let picks: Vec<&Candidate> =
            looked.iter().zip(&chosen.picks).map(|(looked, &pick)| &looked.candidates[pick]).collect();
        let weakest = picks.iter().map(|pick| evidence(pick)).fold(Evidence::Exact, Evidence::weaker);
        let estimate: f64 = picks.iter().filter_map(|pick| Some(pick.error?.0.of_probe)).sum();
        let total = Prediction {
            error: estimate.min(1.0),
            evidence: weakest,
            bound: chosen.error.min(1.0),
            time: duration(chosen.time),
            time_evidence: costs.evidence,
        };
        // How many lamps need each shared part: a rival pays for what no other lamp has paid for.
        let mut users = [0_usize; SHARED];
        for pick in &picks {
            for (bit, users) in users.iter_mut().enumerate() {
                *users += usize::from(pick.shared >> bit & 1);
            }
        }
        let effects = effects::effects(scenery, budget, &self.pieces, &looked, &picks);
        let not_computed = effects::not_computed(scenery, &looked, &effects);
        let shared = self.shared();
        let lamps = (looked.iter().zip(&chosen.picks).enumerate())
            .map(|(number, (looked, &pick))| {
                let own_users = looked.candidates[pick].shared;
                let with_shared = |candidate: &Candidate| {
                    let is_extra = |bit: usize| users[bit] == usize::from(own_users >> bit & 1);
                    let extra = (0..SHARED).filter(|&bit| candidate.shared >> bit & 1 == 1 && is_extra(bit));
                    candidate.time + extra.map(|bit| shared[bit]).sum::<f64>()
                };
                // Of the error, what the other lamps leave.
                let left =
                    wall.map(|wall| wall - (chosen.error - reason::offer(&looked.candidates[pick]).error));
                self.lamp_plan(number, looked, pick, wall, left, with_shared)
            })
            .collect();
        ShadowPlan {
            budget: *budget,
            samples: self.probe.seen,
            probed: self.probe.hits.len(),
            lamps,
            dropped: looked.into_iter().flat_map(|looked| looked.relevance.dropped).collect(),
            effects,
            total,
            not_computed,
            over_time,
            meets_budget: is_within && wall.is_none_or(|wall| chosen.error <= wall),
            planning: Duration::ZERO,
        }
    }

    fn lamp_plan(
        &self,
        number: usize,
        looked: &Looked,
        pick: usize,
        wall: Option<f64>,
        left: Option<f64>,
        with_shared: impl Fn(&Candidate) -> f64,
    ) -> LampPlan {
        let Self { scenery, costs, .. } = *self;
        let candidate = &looked.candidates[pick];
        let lamp = &scenery.lamps[number];
        let own = reason::Rival { candidate, time: with_shared(candidate) };
        let prediction = |candidate: &Candidate| {
            candidate.error.map(|(share, evidence)| Prediction {
                error: share.of_probe,
                evidence,
                bound: share.bound,
                time: duration(with_shared(candidate)),
                time_evidence: costs.evidence,
            })
        };
        let mut rivals: Vec<reason::Rival<'_>> = (looked.candidates.iter().enumerate())
            .filter(|&(index, rival)| {
                index != pick && rival.is_admissible(scenery.prove, left.unwrap_or(1.0).max(0.0))
            })
            .map(|(_, candidate)| reason::Rival { candidate, time: with_shared(candidate) })
            .collect();
        rivals.sort_by(|a, b| a.time.total_cmp(&b.time));
        let penumbra = looked.penumbra.filter(|_| lamp.has_extent());
        let why = looked.settled.clone();
        let own_error = reason::offer(candidate).error;
        let rejected =
            (looked.candidates.iter().enumerate()).filter(|(index, _)| *index != pick).map(|(_, other)| {
                let time = with_shared(other);
                Rejected {
                    technique: other.technique,
                    on_device: other.on_device,
                    prediction: prediction(other).filter(|_| other.not_applicable.is_none()),
                    why: reason::rejected(other, scenery.prove, wall, time, (own.time, own_error)),
                }
            });
        LampPlan {
            lamp: number,
            name: effects::lamp_name(lamp, number),
            facing: looked.facing.of_probe,
            shadowed: looked.shadowed,
            pieces: self.pieces.len(),
            kept: looked.relevance.kept.clone(),
            groups: vec![GroupPlan {
                receivers: Receivers::All,
                samples: (looked.facing.of_probe * self.probe.seen as f64).round() as usize,
                technique: candidate.technique,
                on_device: candidate.on_device,
                prediction: prediction(candidate).unwrap_or(Prediction {
                    error: 1.0,
                    evidence: Evidence::Assumed,
                    bound: 1.0,
                    time: duration(own.time),
                    time_evidence: costs.evidence,
                }),
                reason: why.unwrap_or_else(|| reason::chosen(own, penumbra, wall, &rivals)),
                rejected: rejected.collect(),
            }],
            grid: looked.grid,
        }
    }
}

/// The time of the ray tree for each picture, in nanoseconds; 0 where it is built already.
fn tree_time(scenery: &Scenery<'_>, costs: &Costs, work: &Work) -> f64 {
    let frames = f64::from(scenery.frames.max(1));
    if scenery.has_tree { 0.0 } else { costs.nanoseconds(Step::Tree, work) / frames }
}
