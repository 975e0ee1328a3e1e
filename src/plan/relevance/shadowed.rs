//! Pieces in the shadow of another one, by exact signs.
//!
//! Where the box of a piece meets neither a face of the other piece nor a side of its shadow volume, the
//! number of faces between a point of the box and the light is the same all over the box. If it is not 0 at
//! the center, every ray that the piece blocks is blocked by the other one, nearer to the light.

use super::Question;
use super::apart::Corners;
use super::fault::{Fault, Faults};
use crate::geom::Segment;
use crate::light_grid::Chain;
use crate::oracle::{Intersection, intersect};

/// Most faces of a piece that is tried as an occluder: larger ones are left to the light grid.
const MOST_FACES: usize = 128;
/// Face tests for one lamp; beyond that nothing is claimed.
const MOST_TESTS: usize = 1 << 14;

/// Finds pieces in the shadow of others.
pub(super) struct Shadowing<'a> {
    question: &'a Question<'a>,
    chain: &'a Chain<'a>,
    faults: Faults,
    tests: usize,
}

impl<'a> Shadowing<'a> {
    pub(super) fn new(question: &'a Question<'a>, chain: &'a Chain<'a>, faults: Faults) -> Self {
        Self { question, chain, faults, tests: MOST_TESTS }
    }

    /// Whether a piece surely lies in the shadow of another one.
    pub(super) fn covers(&mut self, piece: usize) -> bool {
        let pieces = self.question.pieces;
        let bounds = pieces.piece(piece).bounds;
        let center = bounds.center();
        let corners = Corners::of(bounds, self.faults);
        let (tree, segment) = (pieces.tree(), Segment::to_light(center, self.chain.light()));
        let mut is_covered = false;
        tree.walk(
            |aabb| segment.may_meet(aabb),
            |slot| {
                let other = tree.order()[slot] as usize;
                let occluder = pieces.piece(other);
                if other != piece && occluder.faces <= MOST_FACES && segment.may_meet(&occluder.bounds) {
                    is_covered = self.is_in_shadow_of(other, center, &corners);
                }
                !is_covered && self.tests > 0
            },
        );
        is_covered
    }

    fn is_in_shadow_of(&mut self, occluder: usize, center: [f32; 3], corners: &Corners) -> bool {
        let Question { pieces, casters, .. } = *self.question;
        let (chain, light) = (self.chain, self.chain.light());
        self.tests = self.tests.saturating_sub(pieces.piece(occluder).faces);
        let mut between = 0;
        for face in pieces.corners(casters, occluder) {
            match intersect(center, light, face) {
                Intersection::None => {}
                Intersection::Crossing(_) => between += 1,
                Intersection::Touching => return false,
            }
            if self.faults.has(Fault::NotStrict) {
                between += u32::from(!corners.is_off_face_strictly(face));
            }
        }
        if between == 0 {
            return false;
        }
        let mut faces = pieces.numbers(occluder).zip(pieces.corners(casters, occluder));
        faces.all(|(number, face)| {
            let (_, outline) = chain.edges(number);
            corners.is_off_face(face)
                && (0..3)
                    .filter(|k| outline & 1 << k != 0)
                    .all(|k| corners.is_off_side([face[k], face[(k + 1) % 3]], light))
        })
    }
}
