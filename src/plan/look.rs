//! What is found out about a lamp before the choice: for as long as it is worth it.

use std::time::Instant;

use super::candidates::{Candidate, Known, PROOFS, TREE};
use super::costs::{Step, Work};
use super::effects;
use super::planner::{OF_GRIDS, PLANNING_SHARE, Planner, of_relevance, of_trials, tree_time};
use super::probe::{FEWEST, GridProbe, LampProbe, MOST, Share};
use super::relevance::{Dropped, Outcome, Question, Relevance, RelevanceTest, TestSet, Triple, relevant};
use super::run::can_be_reduced;
use super::trial::Trials;
use super::{Evidence, GridFigures};
use crate::light_grid::Chain;
use crate::scene::Lamp;
use crate::shadow::planar::Ground;
use crate::shadow::{Technique, is_front_lit};

/// Sides of the grids that are built for the choice.
const COARSE: u32 = 64;
const FINE: u32 = 256;
/// Times of the relevance tests, in nanoseconds: those by boxes and tiles, for each sample and piece; those
/// by solids, shadows and the light grid, for each sample, face and piece. Measured on `many-cubes` and a
/// city.
const BOX_SAMPLE: f64 = 40.0;
const BOX_PIECE: f64 = 3e3;
const GRID_SAMPLE: f64 = 500.0;
const GRID_FACE: f64 = 700.0;
const SOLID_PIECE: f64 = 50e3;
/// Time to copy a face that is kept, and to join it with its neighbors, in nanoseconds.
const COPYING: f64 = 250.0;

/// What was found out about a lamp.
pub(super) struct Looked {
    pub(super) relevance: Relevance,
    /// Whether it was looked for which pieces matter.
    pub(super) is_searched: bool,
    pub(super) facing: Share,
    pub(super) shadowed: f64,
    pub(super) penumbra: Option<Share>,
    pub(super) grid: Option<GridFigures>,
    pub(super) candidates: Vec<Candidate>,
    /// Whether the candidates run over the kept pieces alone.
    pub(super) is_reduced: bool,
    /// What was settled without a choice.
    pub(super) settled: Option<String>,
}

impl Planner<'_> {
    /// Looks at a lamp, for as long as it is worth it.
    pub(super) fn look(&self, number: usize, lamp: &Lamp) -> Looked {
        let (relevance, is_searched) = self.relevance(number, lamp);
        let casts = relevance.outcome == Outcome::Shadows && self.can_cast();
        let probe = self.probe.lamp(self.scenery, lamp, casts);
        let facing = self.probe.share(probe.facing.len());
        let mut looked = Looked {
            relevance,
            is_searched,
            facing,
            shadowed: self.shadowed(&probe, None),
            penumbra: (!lamp.has_extent()).then_some(Share::NONE),
            grid: None,
            candidates: Vec::new(),
            is_reduced: false,
            settled: None,
        };
        match looked.relevance.outcome {
            Outcome::Shadows => self.look_at_shadows(lamp, &probe, &mut looked),
            outcome => self.settle(outcome, &mut looked),
        }
        looked
    }

    /// Which pieces matter, and whether that was looked for: all of them if the tests would take too long.
    fn relevance(&self, number: usize, lamp: &Lamp) -> (Relevance, bool) {
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
        let (samples, pieces, faces) = (all.len() as f64, self.pieces.len() as f64, self.work.faces);
        let by_boxes = [RelevanceTest::Nested, RelevanceTest::Shadowed, RelevanceTest::NothingBehind];
        let by_boxes =
            by_boxes.into_iter().fold(TestSet::ALL.without(RelevanceTest::Known), TestSet::without);
        // The strongest tests that the time is enough for.
        let boxes = BOX_SAMPLE * samples + BOX_PIECE * pieces;
        let dear = GRID_SAMPLE * samples + GRID_FACE * faces + SOLID_PIECE * pieces;
        let sets = [(TestSet::ALL, boxes + dear), (by_boxes, boxes)];
        let share = of_relevance(self.scenery.device.is_some());
        let allowed = if self.scenery.thorough { f64::INFINITY } else { share * self.allowance };
        let fitting = sets.into_iter().find(|(_, time)| *time <= allowed);
        match fitting.filter(|_| self.pieces.are_shells()) {
            Some((tests, _)) => (relevant(&question(all, tests)), true),
            None => {
                // Whether the lamp shines does not depend on the samples.
                let none = all.of_points(&[]);
                (relevant(&question(&none, TestSet::only(RelevanceTest::Zero))), false)
            }
        }
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
        let of_lamp = |dropped: &&Dropped| dropped.what == Triple::Lamp;
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
        if facing > 0.0 && grid_time(COARSE) <= OF_GRIDS * allowance {
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
            if (is_cheap || is_needed) && grid_time(FINE) <= OF_GRIDS * allowance {
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
        if let Some(reduced) = self.reduced(&known, &looked.relevance)
            && self.least_exact(&reduced) < self.least_exact(&looked.candidates)
        {
            (looked.candidates, looked.is_reduced) = (reduced, true);
        }
        if self.allows_error() {
            self.try_some(lamp, allowance, &mut looked.candidates);
        }
    }

    /// The candidates over the kept pieces alone: each lamp has a tree and proofs of its own then.
    fn reduced(&self, known: &Known, relevance: &Relevance) -> Option<Vec<Candidate>> {
        if relevance.kept.len() == self.pieces.len() || !can_be_reduced(self.scenery.casters) {
            return None;
        }
        let faces: usize = relevance.kept.iter().map(|&piece| self.pieces.piece(piece as usize).faces).sum();
        let work = Work { faces: faces as f64, ..known.work };
        let mut candidates = Known { work, ..*known }.candidates(self.costs);
        for candidate in &mut candidates {
            for (bit, step) in [(TREE, Step::Tree), (PROOFS, Step::Proofs)] {
                if candidate.shared & bit != 0 {
                    candidate.time += self.costs.nanoseconds(step, &work);
                    candidate.shared &= !bit;
                }
            }
            if !matches!(candidate.technique, Technique::None | Technique::Dark) {
                candidate.time += COPYING * work.faces;
            }
        }
        Some(candidates)
    }

    /// The least time of a candidate that is exact, with the tree.
    fn least_exact(&self, candidates: &[Candidate]) -> f64 {
        let exact = candidates.iter().filter(|candidate| candidate.is_admissible(true, 0.0));
        exact.map(|candidate| self.time_with_tree(candidate)).fold(f64::INFINITY, f64::min)
    }

    fn time_with_tree(&self, candidate: &Candidate) -> f64 {
        let has_tree = candidate.shared & TREE != 0;
        candidate.time + if has_tree { tree_time(self.scenery, self.costs, &self.work) } else { 0.0 }
    }

    fn allows_error(&self) -> bool {
        !self.scenery.prove && (self.budget.error > 0.0 || self.budget.least_error)
    }

    /// The fraction of the probe's samples that face the lamp which lie on the plane of most of them.
    fn on_plane(&self, lamp: &Lamp) -> f64 {
        let light = lamp.light();
        let some: Vec<_> =
            self.probe.hits.iter().step_by(self.probe.hits.len().div_ceil(FEWEST).max(1)).copied().collect();
        let facing: Vec<_> = some.into_iter().filter(|hit| is_front_lit(hit, light)).collect();
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
        // If all are right, three times the inverse shows that no more are wrong; one more lets one be wrong.
        let count = ((4.0 / most) as usize).clamp(300, MOST);
        let light = self.budget.light_of(lamp.has_extent());
        let time_of = |candidate: &Candidate| self.time_with_tree(candidate);
        let fastest = |candidates: &[Candidate]| {
            let admissible = candidates.iter().filter(|candidate| candidate.is_admissible(false, most));
            admissible.map(time_of).fold(f64::INFINITY, f64::min)
        };
        let mut order: Vec<usize> = (0..candidates.len()).collect();
        order.sort_by(|&a, &b| candidates[a].time.total_cmp(&candidates[b].time));
        let mut left = of_trials(self.scenery.device.is_some()) * allowance;
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
}
