//! A lower bound of the distance of two convex hulls: of a point or a segment, and of a segment or a
//! triangle.
//!
//! Closest points are found as Christer Ericson, *Real-Time Collision Detection*, 2005, sections 5.1.5 and
//! 5.1.9 has them, rounded. They only give a direction: the bound is the gap of the hulls along it.

use glam::DVec3;

/// One to three points, whose hull is meant.
#[derive(Clone, Copy)]
pub(super) struct Points {
    at: [DVec3; 3],
    count: usize,
}

/// Rounding of a bound, in units of the largest coordinate: 64 · 2⁻⁵³. A direction n of length 1 within 4u
/// (u = 2⁻⁵³) and points with coordinates up to M: a coordinate seen from the start of the segment is off by
/// u·M, an end of the segment that was cut by 3u·M, each dot product of three terms by 8u·M with that, their
/// difference by 4u·M more, and dividing by the length of n takes 28u·M; 54u·M together.
pub(super) const ROUNDING: f64 = 64.0 / (1_u64 << 53) as f64;

impl Points {
    pub(super) fn of(points: &[[f64; 3]]) -> Self {
        let mut at = [DVec3::ZERO; 3];
        for (slot, &point) in at.iter_mut().zip(points) {
            *slot = point.into();
        }
        Self { at, count: points.len() }
    }

    fn iter(&self) -> impl Iterator<Item = DVec3> + '_ {
        self.at[..self.count].iter().copied()
    }

    /// Its sides: none of a point, one of a segment, three of a triangle.
    fn sides(&self) -> impl Iterator<Item = [DVec3; 2]> + '_ {
        let count = [0, 0, 1, 3][self.count];
        (0..count).map(|k| [self.at[k], self.at[(k + 1) % self.count]])
    }
}

/// A lower bound of the distance of two hulls, at least 0. `a` is a point or a segment. Where one crosses the
/// other it is 0.
pub(super) fn apart(a: Points, b: Points) -> f64 {
    apart_less(a, b, ROUNDING)
}

/// The bound less `rounding` times the largest coordinate.
pub(super) fn apart_less(a: Points, b: Points, rounding: f64) -> f64 {
    let most = a.iter().chain(b.iter()).fold(0.0, |most: f64, point| most.max(point.abs().max_element()));
    let slack = rounding * most;
    let towards = nearest(&a, &b);
    let bound = gap(&a, &b, towards);
    // Where the hulls nearly touch, the difference of two points says little about the direction. Normals of
    // faces, and of a segment and a side, say more.
    if bound > slack && bound >= 0.999_999 * towards.length() {
        return bound - slack;
    }
    let mut best = bound;
    if b.count == 3 {
        best = best.max(gap(&a, &b, (b.at[1] - b.at[0]).cross(b.at[2] - b.at[0])));
    }
    if a.count == 2 {
        let along = a.at[1] - a.at[0];
        for [from, to] in b.sides() {
            best = best.max(gap(&a, &b, along.cross(to - from)));
        }
    }
    (best - slack).max(0.0)
}

/// The gap between the projections of two hulls on a direction of any length and either sense; negative
/// where they overlap, and 0 without a direction.
fn gap(a: &Points, b: &Points, direction: DVec3) -> f64 {
    let Some(unit) = direction.try_normalize() else { return 0.0 };
    let range = |points: &Points| {
        points
            .iter()
            .map(|point| unit.dot(point))
            .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| [low.min(x), high.max(x)])
    };
    let ([low_a, high_a], [low_b, high_b]) = (range(a), range(b));
    (low_a - high_b).max(low_b - high_a)
}

/// About the vector from the nearest point of `b` to that of `a`, if they do not cross.
pub(super) fn nearest(a: &Points, b: &Points) -> DVec3 {
    let ends = a.iter().map(|point| point - on_hull(point, b));
    let corners = b.iter().filter(|_| a.count == 2).map(|point| on_hull(point, a) - point);
    let sides = b.sides().filter(|_| a.count == 2).map(|side| between([a.at[0], a.at[1]], side));
    let shorter = |u: DVec3, v: DVec3| if v.length_squared() < u.length_squared() { v } else { u };
    ends.chain(corners).chain(sides).reduce(shorter).unwrap_or(DVec3::ZERO)
}

/// The point of a hull that is nearest to `p`.
fn on_hull(p: DVec3, hull: &Points) -> DVec3 {
    match hull.count {
        1 => hull.at[0],
        2 => on_segment(p, [hull.at[0], hull.at[1]]),
        _ => on_triangle(p, hull.at),
    }
}

fn on_segment(p: DVec3, [a, b]: [DVec3; 2]) -> DVec3 {
    let along = b - a;
    let square = along.length_squared();
    let t = if square > 0.0 { ((p - a).dot(along) / square).clamp(0.0, 1.0) } else { 0.0 };
    a + t * along
}

/// Inside the triangle by the signs of three areas, otherwise on the nearest of its sides.
fn on_triangle(p: DVec3, [a, b, c]: [DVec3; 3]) -> DVec3 {
    let normal = (b - a).cross(c - a);
    let area = |from: DVec3, to: DVec3| (to - from).cross(p - from).dot(normal);
    let square = normal.length_squared();
    if square > 0.0 && area(a, b) >= 0.0 && area(b, c) >= 0.0 && area(c, a) >= 0.0 {
        return p - (p - a).dot(normal) / square * normal;
    }
    let sides = [[a, b], [b, c], [c, a]].map(|side| on_segment(p, side));
    sides.into_iter().min_by(|u, v| u.distance_squared(p).total_cmp(&v.distance_squared(p))).unwrap_or(a)
}

/// About the vector from the nearest point of `second` to that of `first`.
fn between([p, q]: [DVec3; 2], second: [DVec3; 2]) -> DVec3 {
    let (d, e, r) = (q - p, second[1] - second[0], p - second[0]);
    let (dd, ee, de, dr, er) = (d.dot(d), e.dot(e), d.dot(e), d.dot(r), e.dot(r));
    let across = dd * ee - de * de;
    let s = if across > 0.0 { ((de * er - dr * ee) / across).clamp(0.0, 1.0) } else { 0.0 };
    let at = p + s * d;
    let on_second = on_segment(at, second);
    on_segment(on_second, [p, q]) - on_second
}
