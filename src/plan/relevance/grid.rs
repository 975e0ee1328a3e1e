//! Pieces and samples by the light grid.

use std::cell::Cell;

use super::Question;
use super::receivers::Receivers;
use crate::light_grid::{Chain, GridVerdict, Occluders};
use crate::mesh::FaceId;
use crate::oracle::PrimaryHit;

/// Cells along each side.
const SIDE: u32 = 64;

/// The light grid of the samples that a lamp may light.
pub(super) struct Grid<'a> {
    question: &'a Question<'a>,
    chain: &'a Chain<'a>,
    receivers: &'a Receivers<'a>,
    occluders: Occluders<'a>,
}

impl<'a> Grid<'a> {
    /// The grid of the pieces that are still `kept`: of all faces that a ray crosses the nearest to the lamp
    /// is among theirs. `None` if a sample has no certain place in the grid.
    pub(super) fn build(
        question: &'a Question<'a>,
        chain: &'a Chain<'a>,
        receivers: &'a Receivers<'a>,
        kept: impl Fn(u32) -> bool,
    ) -> Option<Self> {
        let points = receivers.hits().map(|hit| hit.point);
        let casts = |face: u32| question.pieces.of_face(FaceId(face)).is_some_and(&kept);
        let occluders = Occluders::build(chain, points, SIDE, casts)?;
        Some(Self { question, chain, receivers, occluders })
    }

    /// Whether each piece of the grid may make a sample dark that is lit without it.
    pub(super) fn shadows(&self) -> Vec<bool> {
        let pieces = self.question.pieces;
        let shadows = vec![Cell::new(false); pieces.len()];
        let piece_of = |face: u32| pieces.of_face(FaceId(face));
        for (index, hit) in self.receivers.hits().enumerate() {
            let own = self.convex_own(hit);
            let waits = |piece: u32| Some(piece) != own && !shadows[piece as usize].get();
            let is_asked = |face: u32| piece_of(face).is_some_and(waits);
            self.occluders.for_each_before(index, hit, is_asked, |face| {
                if let Some(piece) = piece_of(face) {
                    shadows[piece as usize].set(true);
                }
            });
        }
        shadows.into_iter().map(Cell::into_inner).collect()
    }

    /// The piece of the visible face, if it surely does not shadow the point: all of it lies on the face's
    /// plane or beyond, and point and light are on the other side.
    fn convex_own(&self, hit: &PrimaryHit) -> Option<u32> {
        let piece = self.question.pieces.of_face(FaceId(self.chain.of_visible(hit)?))?;
        let own = self.question.pieces.piece(piece as usize);
        let is_free = match hit.side.value() {
            1 => own.nothing_in_front,
            _ => own.nothing_behind,
        };
        is_free.then_some(piece)
    }

    /// The numbers of samples that are proven lit and proven dark.
    pub(super) fn known(&self) -> [usize; 2] {
        let mut known = [0; 2];
        for (index, hit) in self.receivers.hits().enumerate() {
            match self.occluders.verdict(index, hit) {
                GridVerdict::Lit => known[0] += 1,
                GridVerdict::Dark => known[1] += 1,
                GridVerdict::Undecided => {}
            }
        }
        known
    }
}
