//! The question, the answer, and the order of the tests.

use super::fault::{Fault, Faults};
use super::grid::Grid;
use super::reach::Reach;
use super::receivers::Receivers;
use super::shadowed::Shadowing;
use super::solids::{Solids, any_watertight};
use super::{Dropped, Pieces, RelevanceTest, TestSet, Triple, lamp};
use crate::caster::CasterGroup;
use crate::light_grid::Chain;
use crate::scene::Lamp;
use crate::shadow::Samples;
use crate::shadow::volume::parting::{Frustum, LampBox, Parting};

/// What is asked: which pieces can change a sample of a view, under one lamp.
#[derive(Clone, Copy, Debug)]
pub struct Question<'a> {
    /// The casters.
    pub casters: &'a CasterGroup<'a>,
    /// Their pieces.
    pub pieces: &'a Pieces,
    /// The lamp.
    pub lamp: &'a Lamp,
    /// The number of the lamp, which is only reported.
    pub number: usize,
    /// The samples, of the view of these casters.
    pub samples: &'a Samples,
    /// Whether the lamp's light falls to 0 at its range. If not, the range drops nothing.
    pub physical_falloff: bool,
    /// The lamp is dropped if it adds at most this many steps of eight bits to any sample. What it adds is
    /// bounded by its color times its intensity, as linear light on a white surface: scale the lamp to the
    /// picture first. 0: no lamp is dropped for being faint.
    pub level: f64,
    /// The tests that run.
    pub tests: TestSet,
}

/// Which shadows of a lamp have to be worked out.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Outcome {
    /// Those of the kept pieces.
    Shadows,
    /// None: whatever faces the lamp is lit.
    Unshadowed,
    /// None: no light of the lamp arrives at a sample, or none that counts.
    Dark,
}

/// What matters for one lamp.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Relevance {
    /// The numbers of the pieces that may change a sample, ascending. None if the lamp is dropped.
    pub kept: Vec<u32>,
    /// Which shadows have to be worked out.
    pub outcome: Outcome,
    /// What is left out, and by which test.
    pub dropped: Vec<Dropped>,
}

/// Finds what matters for one lamp. Linear in the pieces, and in the samples.
///
/// A lamp with an extent is tested by boxes, which hold for its penumbra too, and by what its shells enclose;
/// the tests that know one light alone drop nothing of it.
#[must_use]
pub fn relevant(question: &Question<'_>) -> Relevance {
    relevant_over(question, question.samples, Faults::default())
}

/// The same, with the tiles of other samples, and with a fault.
pub(super) fn relevant_over(question: &Question<'_>, tiled: &Samples, faults: Faults) -> Relevance {
    let Question { lamp, number, pieces, tests, .. } = *question;
    let mut answer = Answer { number, tests, fate: vec![None; pieces.len()], dropped: Vec::new() };
    if tests.has(RelevanceTest::Zero) && lamp::is_zero(lamp) {
        return answer.dark(RelevanceTest::Zero, 0.0);
    }
    let reach = Reach::of(lamp, question.physical_falloff, faults);
    let receivers = Receivers::of(tiled, lamp, &reach);
    answer.samples(RelevanceTest::Sky, receivers.sky);
    answer.samples(RelevanceTest::TurnedAway, receivers.turned_away);
    if tests.has(RelevanceTest::NoReceiver) && receivers.count == 0 {
        return answer.dark(RelevanceTest::NoReceiver, 0.0);
    }
    if tests.has(RelevanceTest::Faint) && question.level > 0.0 {
        let strongest = lamp::strongest(lamp, &reach, &receivers, question.physical_falloff);
        if strongest <= question.level {
            return answer.dark(RelevanceTest::Faint, 1.0);
        }
    }
    let mut solids = Solids::new(question, &receivers);
    if tests.has(RelevanceTest::Enclosed) && solids.enclose_lamp() {
        return answer.dark(RelevanceTest::Enclosed, 0.0);
    }
    answer.cast_beyond(question, &reach, &receivers, faults);
    if tests.has(RelevanceTest::Copy) {
        let copies = pieces.copies(question.casters);
        answer.test(RelevanceTest::Copy, |piece| copies[piece]);
    }
    if any_watertight(pieces) {
        answer.test(RelevanceTest::Nested, |piece| solids.nest(piece, faults));
    }
    // What follows asks for one light, and for a piece to be in its way.
    let wants = [RelevanceTest::Shadowed, RelevanceTest::NothingBehind, RelevanceTest::Known];
    if !lamp.has_extent() && wants.iter().any(|&test| tests.has(test)) && answer.keeps_any() {
        let chain = Chain::of(question.casters, lamp.light());
        let mut shadowing = Shadowing::new(question, &chain, faults);
        answer.test(RelevanceTest::Shadowed, |piece| shadowing.covers(piece));
        if answer.test_by_grid(question, &chain, &receivers) {
            return answer.dark(RelevanceTest::Known, 0.0);
        }
    }
    answer.finish()
}

/// What has been found so far.
struct Answer {
    number: usize,
    tests: TestSet,
    /// The test that drops each piece.
    fate: Vec<Option<RelevanceTest>>,
    dropped: Vec<Dropped>,
}

impl Answer {
    fn drop(&mut self, what: Triple, test: RelevanceTest, bound: f64) {
        self.dropped.push(Dropped { lamp: self.number, what, test, bound });
    }

    fn samples(&mut self, test: RelevanceTest, count: usize) {
        if self.tests.has(test) && count > 0 {
            self.drop(Triple::Samples(count), test, 0.0);
        }
    }

    /// The lamp lights nothing.
    fn dark(mut self, test: RelevanceTest, bound: f64) -> Relevance {
        self.drop(Triple::Lamp, test, bound);
        Relevance { kept: Vec::new(), outcome: Outcome::Dark, dropped: self.dropped }
    }

    /// Drops the pieces, of those still kept, for which `is_irrelevant` holds.
    fn test(&mut self, test: RelevanceTest, mut is_irrelevant: impl FnMut(usize) -> bool) {
        if self.tests.has(test) {
            for (piece, fate) in self.fate.iter_mut().enumerate() {
                if fate.is_none() && is_irrelevant(piece) {
                    *fate = Some(test);
                }
            }
        }
    }

    /// Drops what casts no shadow on a sample that the lamp may light, by boxes.
    fn cast_beyond(
        &mut self,
        question: &Question<'_>,
        reach: &Reach,
        receivers: &Receivers<'_>,
        faults: Faults,
    ) {
        let Question { pieces, lamp, samples, casters, .. } = *question;
        let bounds = |piece: usize| &pieces.piece(piece).bounds;
        if !reach.is_endless() {
            self.test(RelevanceTest::OutOfReach, |piece| !reach.may_meet(bounds(piece)));
        }
        let light = LampBox::of(lamp);
        if self.tests.has(RelevanceTest::Parted) {
            let frustum = Frustum::of(samples.projection(), samples.size(), &casters.bounds());
            let mut parting = Parting::new(light, faults.has(Fault::BoxInView));
            self.test(RelevanceTest::Parted, |piece| parting.parts_view(&frustum, bounds(piece)));
        }
        let mut parting = Parting::new(light, faults.has(Fault::NoExtruded));
        self.test(RelevanceTest::Tiles, |piece| {
            receivers.tiles.all_apart(|tile| parting.parts_box(tile, bounds(piece)))
        });
    }

    fn keeps_any(&self) -> bool {
        self.fate.iter().any(Option::is_none)
    }

    /// Drops what shadows no sample by the light grid; whether the grid proves all samples dark.
    fn test_by_grid(
        &mut self,
        question: &Question<'_>,
        chain: &Chain<'_>,
        receivers: &Receivers<'_>,
    ) -> bool {
        let [finds, knows] =
            [RelevanceTest::NothingBehind, RelevanceTest::Known].map(|test| self.tests.has(test));
        if !finds && !knows {
            return false;
        }
        let kept = |piece: u32| self.fate[piece as usize].is_none();
        let Some(grid) = Grid::build(question, chain, receivers, kept) else { return false };
        if finds {
            let shadows = grid.shadows();
            self.test(RelevanceTest::NothingBehind, |piece| !shadows[piece]);
        }
        if !knows {
            return false;
        }
        let [lit, dark] = grid.known();
        self.samples(RelevanceTest::Known, lit + dark);
        dark == receivers.count
    }

    fn finish(mut self) -> Relevance {
        let mut kept = Vec::new();
        for piece in 0..self.fate.len() {
            match self.fate[piece] {
                None => kept.push(piece as u32), // no more than faces
                Some(test) => self.drop(Triple::Piece(piece as u32), test, 0.0),
            }
        }
        let is_unblocked = kept.is_empty() && self.tests.has(RelevanceTest::Unblocked);
        if is_unblocked {
            self.drop(Triple::Lamp, RelevanceTest::Unblocked, 0.0);
        }
        let outcome = if is_unblocked { Outcome::Unshadowed } else { Outcome::Shadows };
        Relevance { kept, outcome, dropped: self.dropped }
    }
}
