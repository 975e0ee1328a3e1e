//! Floating-point filter for all five signs of a segment and a triangle at once.
//!
//! With the segment's start as origin, let a, b, c be the triangle's corners and d the segment's direction.
//! Let u = d·(b×c), v = d·(c×a), q = d·(a×b) and T = a·(b×c): determinants of three rows, each entry a
//! difference that is rounded once. The signs of −q, −u, −v say on which side the line passes each edge. The
//! signs of −T and u + v + q − wT say on which side of the triangle's plane the start and the light lie. The
//! five values share their differences and cross products.
//!
//! Error bounds. Let D be the largest |dᵢ|, and let M be at least as large as any coordinate of a corner.
//! Then a permanent is at most 6DM² (for T: 6M³). Each of its six products is at most DM² and has six
//! roundings (three differences, the inner product, the inner difference, the outer product). The two outer
//! sums are at most 4DM² and 6DM² and have one rounding each. So u, v and q err by at most
//! (36 + 4 + 6)·ε·DM²·(1 + 16ε) < 47ε·DM², and T errs by less than 47ε·M³. The light's side adds three of the
//! former, each at most 6DM², and T, at most 6M³, with three roundings of sums of at most 12DM², 18DM² and
//! 18DM² + 6M³. The light's side errs by less than (141 + 48)ε·DM² + (47 + 6)ε·M³ + O(ε²) < 190ε·(D + M)·M².

use crate::geom::predicate::filter::{EPSILON, Row, sign_of_det};
use crate::geom::predicate::{Homogeneous, Sign, side_of_point};

/// A segment from a point to a light, prepared for tests against many triangles.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SegmentFilter {
    from: [f32; 3],
    to: Homogeneous,
    start: [f64; 3],
    direction: [f64; 3],
    weight: f64,
    /// Error bound of the three edge signs −q, −u, −v.
    hand: f64,
    /// Error bound of the two plane signs −T, u + v + q − wT.
    side: f64,
}

/// The certain result of a segment and a triangle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Outcome {
    /// The segment and the triangle have no point in common.
    Missed,
    /// The segment properly crosses the triangle's interior, towards the side of this sign.
    Crossed(Sign),
    /// The filter cannot decide.
    Unsure,
}

/// Error bounds in units of [`EPSILON`]: of the edge signs, and of the plane signs. Above the derived 47 and
/// 190.
const BOUNDS: [f64; 2] = [48.0, 192.0];

impl SegmentFilter {
    /// The segment from `p` to `to`. No coordinate of a corner may differ from that of `p` by more than
    /// `reach`.
    #[inline]
    pub(crate) fn new(p: [f32; 3], to: Homogeneous, reach: f64) -> Self {
        Self::with_bounds(p, to, reach, BOUNDS)
    }

    #[inline(always)]
    fn with_bounds(p: [f32; 3], to: Homogeneous, reach: f64, [hand, side]: [f64; 2]) -> Self {
        let direction = to.row(p).rounded();
        let largest = larger(larger(direction[0].abs(), direction[1].abs()), direction[2].abs());
        let square = EPSILON * reach * reach;
        Self {
            from: p,
            to,
            start: [f64::from(p[0]), f64::from(p[1]), f64::from(p[2])],
            direction,
            weight: if to.is_finite() { 1.0 } else { 0.0 },
            hand: hand * square * largest,
            side: side * square * (largest + reach),
        }
    }

    /// Tests the segment against a triangle, as far as the result is certain.
    #[inline(always)]
    pub(crate) fn passes(&self, triangle: &[[f32; 3]; 3]) -> Outcome {
        let from = |corner: [f32; 3]| -> [f64; 3] {
            [
                f64::from(corner[0]) - self.start[0],
                f64::from(corner[1]) - self.start[1],
                f64::from(corner[2]) - self.start[2],
            ]
        };
        let [a, b, c] = [from(triangle[0]), from(triangle[1]), from(triangle[2])];
        let (bc, ca, ab) = (cross(b, c), cross(c, a), cross(a, b));
        let d = self.direction;
        let (u, v, q) = (dot(d, bc), dot(d, ca), dot(d, ab));
        let (least, most) = (smaller(smaller(u, v), q), larger(larger(u, v), q));
        if least < -self.hand && most > self.hand {
            return Outcome::Missed; // the line passes two edges on different sides
        }
        if !(least > self.hand || most < -self.hand) {
            return Outcome::Unsure;
        }
        // The line runs through the interior. The segment crosses if its ends lie on different sides of the
        // plane.
        let start = dot(a, bc);
        let light = u + v + q - self.weight * start;
        if !(start.abs() > self.side && light.abs() > self.side) {
            return self.passes_by_ends(triangle);
        }
        if (start > 0.0) != (light > 0.0) {
            return Outcome::Missed;
        }
        Outcome::Crossed(Sign::of(light))
    }

    /// Decides a line through the interior by exact signs of the two ends. Relative to a corner, a point just
    /// in front of a face, such as a point on a surface, is far from a tie.
    #[inline(never)]
    fn passes_by_ends(&self, &triangle: &[[f32; 3]; 3]) -> Outcome {
        let [a, b, c] = triangle;
        let here = side_of_point(triangle, self.from);
        let there = sign_of_det([Row(b, a), Row(c, a), self.to.row(a)]);
        if here == there || here.is_zero() || there.is_zero() {
            return Outcome::Missed; // the open segment does not contain its ends
        }
        Outcome::Crossed(there)
    }
}

#[inline(always)]
fn cross(u: [f64; 3], v: [f64; 3]) -> [f64; 3] {
    [u[1] * v[2] - v[1] * u[2], u[2] * v[0] - v[2] * u[0], u[0] * v[1] - v[0] * u[1]]
}

#[inline(always)]
fn dot(u: [f64; 3], v: [f64; 3]) -> f64 {
    u[0] * v[0] + u[1] * v[1] + u[2] * v[2]
}

// Without `min` and `max`, which also test for NaN.
#[inline(always)]
fn larger(x: f64, y: f64) -> f64 {
    if x > y { x } else { y }
}

#[inline(always)]
fn smaller(x: f64, y: f64) -> f64 {
    if x < y { x } else { y }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::{Facing, Light};
    use crate::oracle::{Intersection, intersect};
    use crate::random::SplitMix64;

    /// A triangle, and a point and a light on a line through the triangle's interior, an edge or a corner, or
    /// in its plane. In half the cases one coordinate of the point is changed by an ulp. Coordinates are
    /// integers of up to 24 bits, so most cases are exact ties.
    fn case(random: &mut SplitMix64) -> ([[f32; 3]; 3], [f32; 3], Light) {
        let most = [4, 1 << 10, 1 << 20][random.below(3)];
        let scale = [1.0, 0.1, 1.0 / 1024.0][random.below(3)];
        let mut whole = |most: usize| random.below(2 * most + 1) as f32 - most as f32;
        let mut vector = |most: usize| [(); 3].map(|()| whole(most));
        let (a, side, third, way) = (vector(most), vector(most), vector(most), vector(most));
        let along = |from: [f32; 3], t: f32, by: [f32; 3]| [0, 1, 2].map(|i| from[i] + t * by[i]);
        let b = along(a, 4.0, side);
        let through = match random.below(4) {
            0 => a,
            1 => along(a, 1.0, side),
            2 => along(along(a, 1.0, side), 1.0, third),
            _ => along(a, -3.0, side),
        };
        let way = if random.below(3) == 0 { side } else { way };
        let mut p = along(through, [0.0, 1.0, 1.0][random.below(3)], way);
        let light = along(through, -[1.0, 3.0, 8.0][random.below(3)], way);
        let c = if random.below(4) == 0 { along(a, 1.0, way) } else { along(a, 4.0, third) };
        if random.below(2) == 0 {
            let axis = random.below(3);
            p[axis] = if random.below(2) == 0 { p[axis].next_up() } else { p[axis].next_down() };
        }
        let scaled = |p: [f32; 3]| p.map(|x| x * scale);
        let light = match random.below(3) {
            0 if way != [0.0; 3] => Light::directional(scaled(way)).unwrap(),
            _ => Light::point(scaled(light)).unwrap(),
        };
        ([a, b, c].map(scaled), scaled(p), light)
    }

    /// Numbers of wrong claims, of cases called unsure, and of all cases.
    fn wrong_claims(bounds: [f64; 2]) -> [usize; 3] {
        let mut random = SplitMix64(5);
        let mut counts = [0; 3];
        for _ in 0..300_000 {
            let (triangle, p, light) = case(&mut random);
            let reach =
                triangle.iter().flat_map(|v| [0, 1, 2].map(|i| (f64::from(v[i]) - f64::from(p[i])).abs()));
            let way =
                SegmentFilter::with_bounds(p, Homogeneous::light(&light), reach.fold(0.0, f64::max), bounds);
            let claim = match way.passes(&triangle) {
                Outcome::Missed => Some(Intersection::None),
                Outcome::Crossed(Sign::Positive) => Some(Intersection::Crossing(Facing::Front)),
                Outcome::Crossed(_) => Some(Intersection::Crossing(Facing::Back)),
                Outcome::Unsure => None,
            };
            counts[0] += usize::from(claim.is_some_and(|claim| claim != intersect(p, &light, triangle)));
            counts[1] += usize::from(claim.is_none());
            counts[2] += 1;
        }
        counts
    }

    #[test]
    fn way_claims_only_what_exact_signs_say_and_smaller_bounds_are_caught() {
        let [wrong, unsure, all] = wrong_claims(BOUNDS);
        assert!(wrong == 0 && unsure * 10 > all && unsure < all, "{wrong} wrong, {unsure} unsure of {all}");
        for bounds in [[0.0, BOUNDS[1]], [BOUNDS[0], 0.0]] {
            assert!(wrong_claims(bounds)[0] > 0, "{bounds:?}");
        }
    }
}
