//! Watertight pieces around lamps, samples and other pieces.

use hashbrown::HashMap;

use super::apart::{Corners, winding};
use super::fault::Faults;
use super::receivers::Receivers;
use super::{Pieces, Question};
use crate::scene::Lamp;
use crate::shadow::volume::parting::LampBox;

/// Face tests, boxes and samples that are looked at for one lamp; beyond that nothing is claimed.
const MOST_TESTS: usize = 1 << 16;

/// Answers about watertight pieces, for one lamp and its samples.
pub(super) struct Solids<'a> {
    question: &'a Question<'a>,
    receivers: &'a Receivers<'a>,
    tests: usize,
    /// Of pieces that were asked about, whether they wind around neither the lamp nor a sample.
    hollow: HashMap<usize, bool>,
}

impl<'a> Solids<'a> {
    pub(super) fn new(question: &'a Question<'a>, receivers: &'a Receivers<'a>) -> Self {
        Self { question, receivers, tests: MOST_TESTS, hollow: HashMap::new() }
    }

    /// Whether a watertight piece winds around the lamp and around no sample: then it shadows all samples.
    ///
    /// The segment from such a sample to the lamp crosses the piece, for its winding number differs between
    /// the ends.
    pub(super) fn enclose_lamp(&mut self) -> bool {
        let Question { lamp, pieces, .. } = *self.question;
        if lamp.light().is_directional() || lamp.has_extent() {
            return false;
        }
        let at = lamp.light().xyz();
        let around = |piece: &usize| {
            let piece = pieces.piece(*piece);
            piece.watertight && piece.bounds.contains(at)
        };
        (0..pieces.len()).filter(around).any(|piece| {
            self.winding(piece, at).is_some_and(|winding| winding != 0) && self.holds_no_sample(piece)
        })
    }

    /// Whether a piece lies in a watertight piece that winds around neither the lamp nor a sample: then each
    /// segment that meets it crosses the other one, on both sides of it.
    pub(super) fn nest(&mut self, piece: usize, faults: Faults) -> bool {
        let pieces = self.question.pieces;
        let bounds = pieces.piece(piece).bounds;
        let (tree, corners) = (pieces.tree(), Corners::of(bounds, faults));
        let mut is_nested = false;
        tree.walk(
            |aabb| aabb.overlaps(&bounds),
            |slot| {
                let other = tree.order()[slot] as usize;
                let solid = pieces.piece(other);
                let may_hold = other != piece && solid.watertight && solid.bounds.contains_box(&bounds);
                is_nested = may_hold && self.holds_box(other, &corners, bounds.center());
                !is_nested && self.take(1)
            },
        );
        is_nested
    }

    /// Whether a box lies in a piece that winds around neither the lamp nor a sample.
    fn holds_box(&mut self, solid: usize, corners: &Corners, center: [f32; 3]) -> bool {
        let Question { pieces, casters, .. } = *self.question;
        self.take(pieces.piece(solid).faces)
            && pieces.corners(casters, solid).all(|face| corners.is_off_face(face))
            && self.winding(solid, center).is_some_and(|winding| winding != 0)
            && self.is_hollow(solid)
    }

    fn is_hollow(&mut self, piece: usize) -> bool {
        if let Some(&known) = self.hollow.get(&piece) {
            return known;
        }
        let known = self.holds_no_lamp(piece) && self.holds_no_sample(piece);
        self.hollow.insert(piece, known);
        known
    }

    fn holds_no_lamp(&mut self, piece: usize) -> bool {
        let lamp: &Lamp = self.question.lamp;
        if LampBox::of(lamp).is_off(&self.question.pieces.piece(piece).bounds) {
            return true;
        }
        !lamp.has_extent() && self.winding(piece, lamp.light().xyz()) == Some(0)
    }

    fn holds_no_sample(&mut self, piece: usize) -> bool {
        let bounds = self.question.pieces.piece(piece).bounds;
        let receivers = self.receivers;
        let mut tiles = receivers.tiles.overlapping(&bounds);
        tiles.all(|tile| {
            self.take(tile.len() / 16)
                && tile
                    .filter_map(|sample| receivers.hit(sample))
                    .filter(|hit| bounds.contains(hit.point))
                    .all(|hit| self.winding(piece, hit.point) == Some(0))
        })
    }

    /// The winding number of a piece around a point; `None` also if there were too many tests.
    fn winding(&mut self, piece: usize, p: [f32; 3]) -> Option<i32> {
        let Question { pieces, casters, .. } = *self.question;
        self.take(pieces.piece(piece).faces).then(|| winding(pieces.corners(casters, piece), p))?
    }

    /// Spends some tests; whether there were as many.
    fn take(&mut self, tests: usize) -> bool {
        let is_left = self.tests >= tests;
        self.tests = self.tests.saturating_sub(tests);
        is_left
    }
}

/// Whether any piece is watertight.
pub(super) fn any_watertight(pieces: &Pieces) -> bool {
    pieces.iter().any(|piece| piece.watertight)
}
