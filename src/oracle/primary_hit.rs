//! What an eye sees along a ray, and the point that stands for it.

use multiversion::multiversion;

use super::Intersection;
use super::{Hit, Oracle};
use crate::geom::Light;
use crate::geom::bvh::Step;
use crate::geom::predicate::{Homogeneous, Sign, height, side_of_point};
use crate::mesh::FaceId;

/// The first face along a ray, and a point just before it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PrimaryHit {
    /// Which face.
    pub face: FaceId,
    /// Its corners.
    pub corners: [[f32; 3]; 3],
    /// Which side of it the eye is on: positive in front, negative behind, never zero.
    pub side: Sign,
    /// How far, in lengths of the ray's direction. Rounded: for drawing, not for deciding.
    pub t: f64,
    /// The visible point: strictly on the eye's side of the face, so that the face itself never shadows it.
    pub point: [f32; 3],
}

impl Oracle {
    /// The first face that the ray from `origin` along `direction` passes through, be it at an edge or a corner;
    /// faces that the ray lies in are edge-on and not seen. Which faces it passes is decided exactly, the order
    /// of two at nearly the same distance by the rounded distance, and at the same distance by the face's id.
    ///
    /// `None` also for a direction that is zero or not finite.
    #[must_use]
    pub fn first_hit(&self, origin: [f32; 3], direction: [f32; 3]) -> Option<Hit> {
        first_slot(self, origin, direction, 0.0).map(|(slot, t)| Hit { face: FaceId(self.order[slot]), t })
    }

    /// What the eye at `origin` sees along `direction`: [`Oracle::first_hit`] with its visible point.
    ///
    /// Rounding alone would put half of all hit points behind their own face. The visible point is the hit if
    /// that lies strictly on the eye's side of its face, else the first such point going back towards the eye
    /// in steps of the hit's last place.
    #[must_use]
    pub fn first_visible(&self, origin: [f32; 3], direction: [f32; 3]) -> Option<PrimaryHit> {
        self.first_visible_beyond(origin, direction, 0.0)
    }

    /// As [`Oracle::first_visible`], past whatever is nearer than `nearest` lengths of the direction: what a camera
    /// with a near plane sees. The order of a face and that plane is decided by the rounded distance.
    #[must_use]
    pub fn first_visible_beyond(
        &self,
        origin: [f32; 3],
        direction: [f32; 3],
        nearest: f64,
    ) -> Option<PrimaryHit> {
        let (slot, t) = first_slot(self, origin, direction, nearest)?;
        let corners = self.triangles[slot];
        let side = side_of_point(corners, origin);
        let point = before(corners, side, origin, direction, t);
        Some(PrimaryHit { face: FaceId(self.order[slot]), corners, side, t, point })
    }
}

/// The place in `triangles` of the first face, and its distance. The walk has AVX2's instructions where the processor has them.
#[multiversion(targets("x86_64+avx2+bmi1+bmi2+lzcnt"))]
fn first_slot(oracle: &Oracle, origin: [f32; 3], direction: [f32; 3], nearest: f64) -> Option<(usize, f64)> {
    let towards = Light::directional(direction.map(|x| -x)).ok()?;
    let mut first: Option<(f64, u32, usize)> = None;
    oracle.meetings::<true>(origin, &towards, &oracle.way(origin, &towards), |slot, meeting| {
        let triangle = oracle.triangles[slot];
        if meeting == Intersection::Touching && side_of_point(triangle, origin).is_zero() {
            return Step::On;
        }
        let (t, face) = (distance(origin, &towards, triangle), oracle.order[slot]);
        // Of equal distances the lowest face, whatever the order of the tree.
        if t >= nearest && first.is_none_or(|(least, id, _)| (t, face) < (least, id)) {
            first = Some((t, face, slot));
            return Step::NoFarther(t * NEARLY);
        }
        Step::On
    });
    first.map(|(t, _, slot)| (slot, t))
}

/// The first `f32` point, going from the hit at `t` back to the eye, on its `side` of the face: steps of one unit
/// in the last place of the hit's largest coordinate, found by doubling and halving. At worst the eye itself.
fn before(corners: [[f32; 3]; 3], side: Sign, eye: [f32; 3], direction: [f32; 3], t: f64) -> [f32; 3] {
    let at = |t: f64| eye_point(eye, direction, t);
    let seen = |p: [f32; 3]| p.iter().all(|x| x.is_finite()) && side_of_point(corners, p) == side;
    let hit = at(t);
    if seen(hit) {
        return hit;
    }
    let largest = hit.iter().fold(0.0_f32, |most, x| most.max(x.abs())).min(f32::MAX);
    let ulp = f64::from(largest) - f64::from(largest.next_down());
    // Nor can a step be told from nothing that is below the spacing of t itself.
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
            break; // nothing lies between
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

/// Where the ray from `origin` to `towards` meets the plane of a triangle that it passes through: to 2⁻³⁸ of
/// itself, slivers included.
fn distance(origin: [f32; 3], towards: &Light, triangle: [[f32; 3]; 3]) -> f64 {
    let above = height(triangle, Homogeneous::point(origin));
    let climb = height(triangle, Homogeneous::light(towards));
    // Neither is zero: the ray would lie in the plane.
    (-above / climb).max(0.0)
}

/// A little more than the error of two distances, so that a face at nearly the same one is still met.
const NEARLY: f64 = 1.0 + 1.0 / (1_u64 << 36) as f64;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::Mesh;
    use crate::oracle::intersect;
    use crate::testing::shapes;

    /// Rays from a ring of eyes into the middle of things, fanned out a little.
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

    #[test]
    fn visible_point_is_found_for_a_hit_at_the_origin_and_for_tiny_directions() {
        // Steps of the hit's last place are below the spacing of t here, and would never end.
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
        // The middle of a side lies on its diagonal; then a corner, along the body diagonal.
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
            // What the step back is for.
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
