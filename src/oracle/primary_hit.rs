//! Primary hits: the first face along a ray from the eye, and the visible point to shade.

use multiversion::multiversion;

use super::{Hit, Intersection, Oracle};
use crate::geom::Light;
use crate::geom::bvh::Step;
use crate::geom::predicate::{Homogeneous, Sign, height, side_of_point};
use crate::mesh::FaceId;

/// First visible face along a ray, and a point just in front of the face; see [`Oracle::first_visible`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PrimaryHit {
    /// The face.
    pub face: FaceId,
    /// Corners of the face.
    pub corners: [[f32; 3]; 3],
    /// Side of the face that the eye is on: positive in front, negative behind, never zero.
    pub side: Sign,
    /// Distance, in lengths of the ray's direction. Rounded: for drawing, not for deciding.
    pub t: f64,
    /// The visible point, strictly on the eye's side of the face, so that the face itself never shadows the
    /// point.
    pub point: [f32; 3],
}

impl Oracle {
    /// First face that the ray from `origin` along `direction` passes through, at an edge or a corner
    /// included. A face that contains the ray is edge-on and not seen. The set of faces passed is decided
    /// exactly. Their order is decided by the rounded distance, and at equal distances by the face id.
    ///
    /// `None` if there is no such face, or if the direction is zero or not finite.
    ///
    /// ```
    /// use umbrage::oracle::Oracle;
    /// use umbrage::testing::shapes;
    /// let cube = shapes::cube();
    /// let hit = Oracle::build(&cube).first_hit([0.3, 0.1, 5.0], [0.0, 0.0, -1.0]).unwrap();
    /// assert_eq!(hit.t, 4.0);
    /// assert!(cube.corners(hit.face).iter().all(|corner| corner[2] == 1.0)); // a face of the top
    /// ```
    #[must_use]
    pub fn first_hit(&self, origin: [f32; 3], direction: [f32; 3]) -> Option<Hit> {
        first_slot(self, origin, direction, 0.0).map(|(slot, t)| Hit { face: FaceId(self.order[slot]), t })
    }

    /// First visible face from `origin` along `direction`, as [`Oracle::first_hit`], with its visible point.
    ///
    /// Rounding alone would put half of all hit points behind their own face. The visible point is the
    /// rounded hit point if this point lies strictly on the eye's side of the face. Otherwise it is the first
    /// such point back towards the eye, in steps of the hit point's last place.
    ///
    /// ```
    /// use umbrage::geom::predicate::{Sign, side_of_point};
    /// use umbrage::oracle::Oracle;
    /// use umbrage::testing::shapes;
    /// let oracle = Oracle::build(&shapes::cube());
    /// let hit = oracle.first_visible([0.3, 0.1, 5.0], [0.0, 0.0, -1.0]).unwrap();
    /// assert_eq!(side_of_point(hit.corners, hit.point), Sign::Positive); // in front of the face
    /// assert_eq!(hit.side, Sign::Positive);
    /// assert_eq!(oracle.first_visible([0.3, 0.1, 5.0], [0.0, 0.0, 1.0]), None);
    /// ```
    #[must_use]
    pub fn first_visible(&self, origin: [f32; 3], direction: [f32; 3]) -> Option<PrimaryHit> {
        self.first_visible_beyond(origin, direction, 0.0)
    }

    /// As [`Oracle::first_visible`], but ignoring faces nearer than `nearest` lengths of the direction, as a
    /// camera with a near plane does. A face near that plane is kept or ignored by its rounded distance.
    #[must_use]
    pub fn first_visible_beyond(
        &self,
        origin: [f32; 3],
        direction: [f32; 3],
        nearest: f64,
    ) -> Option<PrimaryHit> {
        let (slot, t) = first_slot(self, origin, direction, nearest)?;
        Some(self.visible_at(slot, origin, direction, t))
    }

    /// The hit of the face in a slot, which a ray passes at `t`.
    pub(super) fn visible_at(
        &self,
        slot: usize,
        origin: [f32; 3],
        direction: [f32; 3],
        t: f64,
    ) -> PrimaryHit {
        let corners = self.triangles[slot];
        let side = side_of_point(corners, origin);
        let point = before(corners, side, origin, direction, t);
        PrimaryHit { face: FaceId(self.order[slot]), corners, side, t, point }
    }
}

impl Oracle {
    /// Calls `visit` with every face that the ray passes through at a distance from `from` to `to`, by its
    /// rounded distance.
    pub(crate) fn for_each_hit(
        &self,
        origin: [f32; 3],
        direction: [f32; 3],
        [from, to]: [f64; 2],
        mut visit: impl FnMut(FaceId),
    ) {
        let Ok(towards) = Light::directional(direction.map(|x| -x)) else { return };
        self.meetings::<true>(origin, &towards, &self.way(origin, &towards), |slot, meeting| {
            let triangle = self.triangles[slot];
            if meeting != Intersection::Touching || !side_of_point(triangle, origin).is_zero() {
                let t = distance(origin, &towards, triangle);
                if from <= t && t <= to {
                    visit(FaceId(self.order[slot]));
                }
            }
            Step::NoFarther(to * NEARLY)
        });
    }
}

/// Slot in `triangles` of the first face, and the distance of the face. The traversal uses AVX2 instructions
/// where the processor has them.
#[multiversion(targets("x86_64+avx2+bmi1+bmi2+lzcnt"))]
pub(super) fn first_slot(
    oracle: &Oracle,
    origin: [f32; 3],
    direction: [f32; 3],
    nearest: f64,
) -> Option<(usize, f64)> {
    let towards = Light::directional(direction.map(|x| -x)).ok()?;
    let mut first = Nearest::beyond(nearest);
    oracle.meetings::<true>(origin, &towards, &oracle.way(origin, &towards), |slot, meeting| {
        first.take(oracle, origin, &towards, slot, meeting)
    });
    first.slot()
}

/// The nearest face so far, among those that are not too near.
pub(super) struct Nearest {
    nearest: f64,
    /// Distance, face, slot.
    first: Option<(f64, u32, usize)>,
}

impl Nearest {
    pub(super) fn beyond(nearest: f64) -> Self {
        Self { nearest, first: None }
    }

    pub(super) fn t(&self) -> Option<f64> {
        self.first.map(|(t, ..)| t)
    }

    pub(super) fn slot(&self) -> Option<(usize, f64)> {
        self.first.map(|(t, _, slot)| (slot, t))
    }

    /// Takes a face that the ray meets, unless it is edge-on, too near, or not nearer.
    #[inline(always)]
    pub(super) fn take(
        &mut self,
        oracle: &Oracle,
        origin: [f32; 3],
        towards: &Light,
        slot: usize,
        meeting: Intersection,
    ) -> Step {
        let triangle = oracle.triangles[slot];
        if meeting == Intersection::Touching && side_of_point(triangle, origin).is_zero() {
            return Step::On;
        }
        let (t, face) = (distance(origin, towards, triangle), oracle.order[slot]);
        // Among equal distances the face with the lowest id, whatever the order of the BVH.
        if t >= self.nearest && self.first.is_none_or(|(least, id, _)| (t, face) < (least, id)) {
            self.first = Some((t, face, slot));
            return Step::NoFarther(t * NEARLY);
        }
        Step::On
    }
}

/// The first `f32` point on `side` of the face, going from the hit at `t` back to the eye. Steps are one unit
/// in the last place of the hit's largest coordinate; their number is found by doubling and bisection. In the
/// worst case the point is the eye.
fn before(corners: [[f32; 3]; 3], side: Sign, eye: [f32; 3], direction: [f32; 3], t: f64) -> [f32; 3] {
    let at = |t: f64| eye_point(eye, direction, t);
    let seen = |p: [f32; 3]| p.iter().all(|x| x.is_finite()) && side_of_point(corners, p) == side;
    let hit = at(t);
    if seen(hit) {
        return hit;
    }
    let largest = hit.iter().fold(0.0_f32, |most, x| most.max(x.abs())).min(f32::MAX);
    let ulp = f64::from(largest) - f64::from(largest.next_down());
    // A step below the spacing of t itself would have no effect.
    let (mut behind, mut step) = (0.0, ulp.max(0.5 * f64::EPSILON * t));
    while !seen(at(t - step)) {
        if step >= t {
            return eye;
        }
        (behind, step) = (step, 2.0 * step);
    }
    while step - behind > ulp {
        let middle = 0.5 * (behind + step);
        if middle <= behind || middle >= step {
            break; // no number lies between
        }
        if seen(at(t - middle)) {
            step = middle;
        } else {
            behind = middle;
        }
    }
    at(t - step)
}

fn eye_point(eye: [f32; 3], direction: [f32; 3], t: f64) -> [f32; 3] {
    std::array::from_fn(|i| (f64::from(eye[i]) + t.max(0.0) * f64::from(direction[i])) as f32)
}

/// Parameter at which the ray from `origin` to `towards` meets the plane of a triangle that the ray passes
/// through: with a relative error of at most 2⁻³⁸, slivers included.
pub(super) fn distance(origin: [f32; 3], towards: &Light, triangle: [[f32; 3]; 3]) -> f64 {
    let above = height(triangle, Homogeneous::point(origin));
    let climb = height(triangle, Homogeneous::light(towards));
    // Neither is zero, since otherwise the ray would lie in the plane.
    (-above / climb).max(0.0)
}

/// Slightly more than the relative error of two distances, so that a face at nearly the same distance is
/// still visited.
pub(super) const NEARLY: f64 = 1.0 + 1.0 / (1_u64 << 36) as f64;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::Mesh;
    use crate::oracle::intersect;
    use crate::testing::shapes;

    /// Rays from a ring of eyes towards the middle, fanned out slightly.
    fn rays() -> impl Iterator<Item = ([f32; 3], [f32; 3])> {
        (0..4000_u32).map(|i| {
            let noise = |k: u32| (i.wrapping_mul(k) >> 12) as f32 / (1 << 20) as f32 - 0.5;
            let turn = i as f32 * 0.01;
            let eye = [4.0 * turn.cos(), 1.5 + noise(2_654_435_761), 4.0 * turn.sin()];
            (
                eye,
                [
                    -eye[0] + noise(2_246_822_519),
                    -eye[1] + noise(3_266_489_917),
                    -eye[2] + noise(668_265_263),
                ],
            )
        })
    }

    #[test]
    fn first_hit_is_what_a_loop_over_all_faces_finds() {
        for mesh in [shapes::torus_knot(2, 3, 60, 8, 0.3), shapes::menger_sponge(1), shapes::double_sheet()] {
            let oracle = Oracle::build(&mesh);
            let mut hits = 0;
            for (origin, direction) in rays() {
                let towards = Light::directional(direction.map(|x| -x)).unwrap();
                let naive = (0..mesh.face_count())
                    .map(FaceId::new)
                    .filter(|&face| match intersect(origin, &towards, mesh.corners(face)) {
                        Intersection::None => false,
                        Intersection::Crossing(_) => true,
                        Intersection::Touching => !side_of_point(mesh.corners(face), origin).is_zero(),
                    })
                    .map(|face| Hit { face, t: distance(origin, &towards, mesh.corners(face)) })
                    .min_by(|a, b| a.t.total_cmp(&b.t));
                assert_eq!(oracle.first_hit(origin, direction), naive);
                hits += usize::from(naive.is_some());
            }
            assert!(hits > 100, "{hits} hits");
        }
    }

    /// Slivers and slabs in planes that differ by ulps: their rounded distances are not in the order of their
    /// boxes, and a search that stops at the first distance misses the least.
    #[test]
    fn first_hit_among_faces_at_nearly_the_same_distance_is_the_least_of_all() {
        let mut state = 1_u64;
        let mut random = move || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 40) as f32 / (1 << 24) as f32
        };
        let mut differing = 0;
        for _ in 0..60 {
            let (mut positions, mut triangles) = (Vec::new(), Vec::new());
            for face in 0..64_u32 {
                let turn = 6.3 * random();
                let (sin, cos) = turn.sin_cos();
                for (along, across) in [(-3.0, 0.01), (3.0, 0.01), (0.3 * random(), -1.0 - random())] {
                    let z = f32::from_bits(1.0_f32.to_bits() + (3.0 * random()) as u32);
                    positions.push([along * cos - across * sin, along * sin + across * cos, z]);
                }
                triangles.push([3 * face, 3 * face + 1, 3 * face + 2]);
            }
            let mesh = Mesh::new(positions, triangles).unwrap();
            let oracle = Oracle::build(&mesh);
            for _ in 0..100 {
                let origin = [2.0 * random() - 1.0, 2.0 * random() - 1.0, 3.0 + random()];
                let direction = [0.2 * random() - 0.1, 0.2 * random() - 0.1, -1.0];
                differing += farther_than_the_first(&mesh, &oracle, origin, direction);
            }
        }
        assert!(differing > 1000, "{differing}");
    }

    /// Asserts that the first hit is the nearest of all faces; how many lie farther.
    fn farther_than_the_first(mesh: &Mesh, oracle: &Oracle, origin: [f32; 3], direction: [f32; 3]) -> usize {
        let towards = Light::directional(direction.map(|x| -x)).unwrap();
        let all: Vec<Hit> = (0..mesh.face_count())
            .map(FaceId::new)
            .filter(|&face| intersect(origin, &towards, mesh.corners(face)) != Intersection::None)
            .map(|face| Hit { face, t: distance(origin, &towards, mesh.corners(face)) })
            .collect();
        let naive = all.iter().copied().min_by(|a, b| a.t.total_cmp(&b.t));
        assert_eq!(oracle.first_hit(origin, direction), naive);
        all.iter().filter(|hit| naive.is_some_and(|least| hit.t > least.t)).count()
    }

    /// Slivers around one corner, aimed at: all their boxes begin there, and their rounded distances lie on
    /// both sides of it. Coordinates beyond the range of boxes in `f32`, whose own slack would hide this.
    #[test]
    fn first_hit_at_a_corner_of_many_slivers_is_the_least_of_all() {
        let scale = 2.0_f32.powi(70);
        let mut random = crate::random::SplitMix64(5);
        let mut random = move || random.unit() as f32;
        let mut differing = 0;
        for _ in 0..40 {
            let (mut positions, mut triangles) = (vec![[0.0, 0.0, 0.0]], Vec::new());
            for face in 0..64_u32 {
                let (sin, cos) = (6.3 * random()).sin_cos();
                let (long, deep, wide) = (1.0 + random(), random(), 1e-3 * random());
                positions.push([long * cos, long * sin, -deep]);
                positions.push([0.7 * long * cos - wide * sin, 0.7 * long * sin + wide * cos, -0.7 * deep]);
                triangles.push([2 * face + 1, 2 * face + 2, 0]);
            }
            let positions = positions.into_iter().map(|p| p.map(|x| x * scale)).collect();
            let mesh = Mesh::new(positions, triangles).unwrap();
            let oracle = Oracle::build(&mesh);
            for _ in 0..20 {
                // The corner is the origin: the opposite of the eye leads to it, exactly.
                let origin = [random() - 0.5, random() - 0.5, 2.0 + random()].map(|x| x * scale);
                let direction = origin.map(|x| -x);
                differing += farther_than_the_first(&mesh, &oracle, origin, direction);
            }
        }
        assert!(differing > 1000, "{differing}");
    }

    #[test]
    fn visible_point_is_found_for_a_hit_at_the_origin_and_for_tiny_directions() {
        // Steps of the hit's last place are below the spacing of t here: the search would never end.
        let flat = vec![[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [0.0, 1.0, 0.0]];
        let oracle = Oracle::build(&Mesh::new(flat, vec![[0, 1, 2]]).unwrap());
        let eye = [0.0, 0.0, 4.0];
        let seen = oracle.first_visible(eye, [0.0, 0.0, -1.0]).unwrap();
        assert_eq!(side_of_point(seen.corners, seen.point), seen.side);
        let tilted = vec![[-1.0, -1.0, 0.3], [1.0, -1.0, -0.2], [0.0, 1.0, 0.7]];
        let oracle = Oracle::build(&Mesh::new(tilted, vec![[0, 1, 2]]).unwrap());
        for tiny in [1e-30, 1e-38] {
            let seen = oracle.first_visible(eye, [0.0, 0.0, -tiny]).unwrap();
            assert_eq!(side_of_point(seen.corners, seen.point), seen.side);
        }
    }

    #[test]
    fn first_hit_at_an_edge_or_a_corner_does_not_fall_through() {
        let oracle = Oracle::build(&shapes::cube());
        let bounds = oracle.bounds();
        let (high, middle) = (bounds.high, bounds.center());
        // The middle of a side lies on its diagonal. The second ray meets a corner, along the body diagonal.
        let side = [middle[0], middle[1], high[2] + 4.0];
        assert_eq!(oracle.first_hit(side, [0.0, 0.0, -1.0]).map(|hit| hit.t), Some(4.0));
        let corner = high.map(|x| x + 4.0);
        assert_eq!(oracle.first_hit(corner, [-1.0; 3]).map(|hit| hit.t), Some(4.0));
        assert_eq!(oracle.first_hit(corner, [0.0; 3]), None);
    }

    #[test]
    fn visible_point_lies_before_its_face_and_within_the_last_places_of_the_hit() {
        for offset in [0.0, 1000.0] {
            let mesh = shapes::translated(&shapes::torus_knot(2, 3, 60, 8, 0.3), [offset; 3]);
            let oracle = Oracle::build(&mesh);
            let (mut seen, mut behind) = (0, 0);
            for (eye, direction) in rays() {
                let eye = eye.map(|x| x + offset);
                let Some(visible) = oracle.first_visible(eye, direction) else { continue };
                seen += 1;
                assert_eq!(
                    side_of_point(visible.corners, visible.point),
                    side_of_point(visible.corners, eye)
                );
                let hit = eye_point(eye, direction, visible.t);
                behind += i32::from(side_of_point(visible.corners, hit) != visible.side);
                let slack = (0..3).map(|i| (hit[i] - visible.point[i]).abs()).fold(0.0, f32::max);
                assert!(slack <= 1e-4 * (1.0 + offset), "{slack}");
            }
            // The case that the step back exists for.
            assert!(behind * 4 > seen && seen > 1000, "{behind} of {seen} hits are behind their face");
        }
    }

    #[test]
    fn visible_point_exists_at_the_ends_of_the_range() {
        for scale in [1e-38, 1e-3, 1e37] {
            let mesh = shapes::scaled(&shapes::icosphere(1), scale);
            let oracle = Oracle::build(&mesh);
            for (eye, direction) in rays().take(200) {
                let eye = eye.map(|x| x * scale);
                if let Some(visible) = oracle.first_visible(eye, direction) {
                    assert_eq!(side_of_point(visible.corners, visible.point), visible.side);
                }
            }
        }
    }
}
