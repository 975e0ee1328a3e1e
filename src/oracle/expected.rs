//! First hits by verification: a face that is expected to be the first one is checked, not searched.
//!
//! A rasterizer, or the frame before, knows for most rays which face they see. If the ray passes that face,
//! only what is nearer has to be ruled out, and the search begins with a short ray, like that of a shadow. An
//! expectation that is wrong costs time and changes nothing: the answer is that of
//! [`Oracle::first_visible_beyond`], bit for bit.

use multiversion::multiversion;

use super::fault::{Fault, Faults};
use super::primary_hit::{NEARLY, Nearest, first_slot};
use super::{Intersection, Oracle, PrimaryHit};
use crate::geom::Light;
use crate::mesh::FaceId;

/// First hits of an oracle, with a face that is expected of each ray.
///
/// ```
/// use umbrage::mesh::FaceId;
/// use umbrage::oracle::{ExpectedHits, Oracle};
/// use umbrage::testing::shapes;
/// let oracle = Oracle::build(&shapes::cube());
/// let (eye, direction) = ([0.3, 0.1, 5.0], [0.0, 0.0, -1.0]);
/// let found = oracle.first_visible(eye, direction);
/// let hits = ExpectedHits::of(&oracle);
/// // Whatever is expected.
/// for face in (0..12).map(FaceId) {
///     assert_eq!(hits.first_visible_beyond(face, eye, direction, 0.0), found);
/// }
/// ```
#[derive(Clone, Debug)]
pub struct ExpectedHits<'a> {
    oracle: &'a Oracle,
    /// The slot of each face.
    slot_of: Vec<u32>,
    pub(super) faults: Faults,
}

impl<'a> ExpectedHits<'a> {
    /// Prepares for many rays. Linear in faces; 4 bytes per face.
    #[must_use]
    pub fn of(oracle: &'a Oracle) -> Self {
        let mut slot_of = vec![0; oracle.order.len()];
        for (slot, &face) in (0..).zip(&oracle.order) {
            slot_of[face as usize] = slot;
        }
        Self { oracle, slot_of, faults: Faults::default() }
    }

    /// As [`Oracle::first_visible_beyond`]. `expected` may be any face; if it is the visible one, the answer
    /// takes about as long as a shadow ray. A number that is no face expects nothing.
    #[must_use]
    pub fn first_visible_beyond(
        &self,
        expected: FaceId,
        origin: [f32; 3],
        direction: [f32; 3],
        nearest: f64,
    ) -> Option<PrimaryHit> {
        let (slot, t) = match self.slot_of.get(expected.index()) {
            Some(&slot) => {
                first_slot_at(self.oracle, slot as usize, origin, direction, nearest, self.faults)?
            }
            None => first_slot(self.oracle, origin, direction, nearest)?,
        };
        Some(self.oracle.visible_at(slot, origin, direction, t))
    }
}

/// As [`first_slot`], beginning with an expected slot.
#[multiversion(targets("x86_64+avx2+bmi1+bmi2+lzcnt"))]
fn first_slot_at(
    oracle: &Oracle,
    expected: usize,
    origin: [f32; 3],
    direction: [f32; 3],
    nearest: f64,
    faults: Faults,
) -> Option<(usize, f64)> {
    let towards = Light::directional(direction.map(|x| -x)).ok()?;
    let way = oracle.way(origin, &towards);
    let mut first = Nearest::beyond(nearest);
    let meeting = match oracle.meeting(origin, &towards, &way, expected) {
        Intersection::None if faults.has(Fault::PassesUnasked) => Intersection::Touching,
        meeting => meeting,
    };
    if meeting != Intersection::None {
        first.take(oracle, origin, &towards, expected, meeting);
    }
    let Some(t) = first.t() else { return first_slot(oracle, origin, direction, nearest) };
    if !faults.has(Fault::NothingNearer) {
        oracle.meetings_to::<false>(origin, &towards, &way, Some(t * NEARLY), |slot, meeting| {
            first.take(oracle, origin, &towards, slot, meeting)
        });
    }
    first.slot()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::Mesh;
    use crate::testing::shapes;
    use crate::view::{Camera, Rays, Size, Up};

    /// Expectations of the pixels of a picture.
    #[derive(Clone, Copy, Debug, PartialEq)]
    enum Expect {
        /// The face that is seen.
        Own,
        /// The face that the next pixel sees.
        Neighbor,
        /// The face that the first frame sees.
        LastFrame,
        /// Any face, or none.
        Any,
    }

    /// Pixels whose hit is not that of the full search, pixels that expect the face that they see, and all
    /// that see one.
    fn compare(expect: Expect, fault: Option<Fault>) -> [usize; 3] {
        let sheet = shapes::translated(&shapes::sheet(3), [0.4, 1.2, 0.3]);
        let meshes = [shapes::torus(24, 12, 2.0, 0.7), shapes::figure_eight_prism(), sheet];
        let doubled =
            Mesh::concat(&[shapes::cube(), shapes::cube(), shapes::cuboid([-3.0; 3], [3.0, -2.0, 3.0])]);
        let size = Size::new(48, 36).unwrap();
        let mut found = [0; 3];
        for mesh in [Mesh::concat(&meshes).unwrap(), doubled.unwrap()] {
            let oracle = Oracle::build(&mesh);
            let hits = ExpectedHits { faults: Faults(fault), ..ExpectedHits::of(&oracle) };
            let mut last: Vec<Option<FaceId>> = Vec::new();
            for frame in 0..3 {
                let eye = [4.0 + 0.05 * frame as f32, 3.0, 5.0];
                let camera = Camera::look_at(eye, [0.0; 3], 1.0, Up::Y).unwrap();
                // The last frame cuts into the scene.
                let near = if frame == 2 { 5.5 } else { 0.1 };
                let projection = camera.projection(size, near);
                let rays = Rays::new(&projection, size);
                let ray = |index: usize| {
                    let [x, y] = [index % 48, index / 48].map(|i| i as f64 + 0.5);
                    let ray = rays.ray(x, y);
                    (ray.origin, ray.direction)
                };
                let all = (0..size.pixels()).map(|index| {
                    let (origin, direction) = ray(index);
                    oracle.first_visible_beyond(origin, direction, near.into())
                });
                let all: Vec<Option<PrimaryHit>> = all.collect();
                if frame == 0 {
                    last = all.iter().map(|hit| hit.map(|hit| hit.face)).collect();
                }
                for (index, own) in all.iter().enumerate() {
                    let of = |hit: &Option<PrimaryHit>| hit.map(|hit| hit.face);
                    let expected = match expect {
                        Expect::Own => of(own),
                        Expect::Neighbor => of(&all[(index + 1) % all.len()]),
                        Expect::LastFrame => last[index],
                        Expect::Any => Some(FaceId::new(index * 7 % (mesh.face_count() + 3))),
                    };
                    let expected = expected.unwrap_or(FaceId(u32::MAX));
                    let (origin, direction) = ray(index);
                    let verified = hits.first_visible_beyond(expected, origin, direction, near.into());
                    found[0] += usize::from(verified != *own);
                    found[1] += usize::from(Some(expected) == of(own));
                    found[2] += usize::from(own.is_some());
                }
            }
        }
        found
    }

    #[test]
    fn expected_hits_are_those_of_the_full_search_whatever_is_expected() {
        for expect in [Expect::Own, Expect::Neighbor, Expect::LastFrame, Expect::Any] {
            let [wrong, expected, seen] = compare(expect, None);
            assert_eq!(wrong, 0, "{expect:?}");
            let least = if expect == Expect::Any { 0 } else { seen / 3 };
            assert!(expected >= least && seen > 3000, "{expect:?}: {expected} of {seen}");
        }
    }

    #[test]
    fn expected_hits_that_are_not_verified_are_wrong() {
        for fault in [Fault::PassesUnasked, Fault::NothingNearer] {
            for expect in [Expect::Neighbor, Expect::LastFrame] {
                let [wrong, ..] = compare(expect, Some(fault));
                assert!(wrong > 3, "{fault:?} {expect:?}: {wrong}");
            }
        }
    }
}
