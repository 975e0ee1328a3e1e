//! Exact segment–triangle intersection: how the open segment from a point to a light meets a triangle,
//! decided by signs alone.

use crate::geom::predicate::{
    Homogeneous, Sign, orient3d_homogeneous, side_of_light, side_of_point, turn_homogeneous,
};
use crate::geom::{Facing, Light};

/// Relation of a segment and a triangle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Intersection {
    /// The segment and the triangle have no point in common.
    None,
    /// The segment touches the triangle without properly crossing it.
    Touching,
    /// The segment properly crosses the triangle's interior. The value is the side of the triangle that the
    /// light is on.
    Crossing(Facing),
}

/// Relation of the open segment from `p` to `light` and the closed triangle.
///
/// ```
/// use umbrage::geom::{Facing, Light};
/// use umbrage::oracle::{Intersection, intersect};
/// let triangle = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]];
/// let light = Light::point([1.0, 1.0, 1.0])?;
/// assert_eq!(intersect([1.0, 1.0, -1.0], &light, triangle), Intersection::Crossing(Facing::Front));
/// assert_eq!(intersect([1.0, 1.0, 0.0], &light, triangle), Intersection::None); // ends do not count
/// # Ok::<(), umbrage::geom::LightError>(())
/// ```
///
/// First, `p` and the light are compared with the triangle's plane. If both lie on one side, or exactly one
/// lies in the plane, there is no intersection, since an open segment does not contain its ends. If they lie
/// on opposite sides, the line is compared with the three edges: it passes all on the same side (a crossing),
/// passes some on different sides (none), or meets an edge (touching). If both lie in the plane, an exact
/// test in two dimensions decides.
#[inline]
#[must_use]
pub fn intersect(p: [f32; 3], light: &Light, triangle: [[f32; 3]; 3]) -> Intersection {
    let here = side_of_point(triangle, p);
    let there = side_of_light(triangle, light);
    if here == there {
        return if here.is_zero() && meets_in_plane(p, light, triangle) {
            Intersection::Touching
        } else {
            Intersection::None
        };
    }
    if here.is_zero() || there.is_zero() {
        return Intersection::None;
    }
    let [a, b, c] = [point(triangle[0]), point(triangle[1]), point(triangle[2])];
    let (p, l) = (point(p), Homogeneous::light(light));
    let first = orient3d_homogeneous([p, l, a, b]);
    let second = orient3d_homogeneous([p, l, b, c]);
    if first == -second && !first.is_zero() {
        return Intersection::None;
    }
    let edges = [first, second, orient3d_homogeneous([p, l, c, a])];
    match (edges.contains(&Sign::Positive), edges.contains(&Sign::Negative), edges.contains(&Sign::Zero)) {
        (true, true, _) => Intersection::None,
        (_, _, true) => Intersection::Touching,
        _ => Intersection::Crossing(if there == Sign::Positive { Facing::Front } else { Facing::Back }),
    }
}

/// Whether the segment meets the triangle if all points lie in one plane, or if the triangle has no plane.
#[cold]
fn meets_in_plane(p: [f32; 3], light: &Light, [a, b, c]: [[f32; 3]; 3]) -> bool {
    if !light.is_directional() && p == light.xyz() {
        return false; // the open segment is empty
    }
    let Some(axis) = (0..3).find(|&axis| !turn(axis, a, b, point(c)).is_zero()) else {
        return meets_line(p, light, [a, b, c]);
    };
    // Projection along `axis` is one-to-one on the plane. Segment and triangle are disjoint iff a line along
    // one of their sides separates them: the segment's own line, with all corners strictly on one side, or an
    // edge's line, with the whole open segment strictly beyond.
    let corners = [a, b, c].map(|corner| turn(axis, p, corner, Homogeneous::light(light)));
    if corners[0] == corners[1] && corners[1] == corners[2] && !corners[0].is_zero() {
        return false;
    }
    let inside = turn(axis, a, b, point(c));
    ![(a, b), (b, c), (c, a)].into_iter().any(|(from, to)| {
        let ends = [turn(axis, from, to, point(p)), turn(axis, from, to, Homogeneous::light(light))];
        ends.iter().all(|&end| end != inside) && ends.iter().any(|end| !end.is_zero())
    })
}

/// Whether the segment meets a degenerate triangle: a closed segment from `u` to `v`, or a point.
fn meets_line(p: [f32; 3], light: &Light, mut corners: [[f32; 3]; 3]) -> bool {
    corners.sort_by(|a, b| a.partial_cmp(b).expect("coordinates are finite"));
    let [u, _, v] = corners;
    let l = Homogeneous::light(light);
    if u == v {
        return (0..3).all(|axis| turn(axis, p, u, l).is_zero()) && overlaps_on_line(p, light, u, v);
    }
    if !orient3d_homogeneous([Homogeneous::point(p), l, point(u), point(v)]).is_zero() {
        return false;
    }
    for axis in 0..3 {
        let [to_p, to_l] = [point(p), l].map(|end| turn(axis, u, v, end));
        let [from_u, from_v] = [u, v].map(|end| turn(axis, p, end, l));
        if [to_p, to_l, from_u, from_v].iter().any(|sign| !sign.is_zero()) {
            // Projection along this axis is one-to-one on their plane: the segments meet iff each separates
            // the other's ends.
            return to_p == -to_l && !to_p.is_zero() && from_u != from_v;
        }
    }
    overlaps_on_line(p, light, u, v)
}

/// Whether, with all points on one line, the open segment from `p` to the light overlaps the closed segment
/// from `u` to `v`.
fn overlaps_on_line(p: [f32; 3], light: &Light, u: [f32; 3], v: [f32; 3]) -> bool {
    (0..3).all(|axis| {
        let (low, high) = (u[axis].min(v[axis]), u[axis].max(v[axis]));
        let (from, to) = (p[axis], light.xyz()[axis]);
        let moves = if light.is_directional() { to != 0.0 } else { to != from };
        if !moves {
            return low <= from && from <= high;
        }
        let (first, last) = match light.is_directional() {
            false => (from.min(to), from.max(to)),
            true if to > 0.0 => (from, f32::INFINITY),
            true => (f32::NEG_INFINITY, from),
        };
        low < last && high > first
    })
}

fn point(p: [f32; 3]) -> Homogeneous {
    Homogeneous::point(p)
}

fn turn(axis: usize, a: [f32; 3], b: [f32; 3], c: Homogeneous) -> Sign {
    turn_homogeneous(a, b, c, axis)
}

#[cfg(test)]
mod tests {
    use super::*;

    const TRIANGLE: [[f32; 3]; 3] = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]];

    fn to(p: [f32; 3], l: [f32; 3]) -> Intersection {
        intersect(p, &Light::point(l).unwrap(), TRIANGLE)
    }

    #[test]
    fn meet_through_the_inside_crosses_and_names_the_side_of_the_light() {
        assert_eq!(to([1.0, 1.0, -1.0], [1.0, 1.0, 1.0]), Intersection::Crossing(Facing::Front));
        assert_eq!(to([1.0, 1.0, 1.0], [1.0, 1.0, -1.0]), Intersection::Crossing(Facing::Back));
        let up = Light::directional([0.0, 0.0, -1.0]).unwrap();
        assert_eq!(intersect([1.0, 1.0, -1.0], &up, TRIANGLE), Intersection::Crossing(Facing::Front));
        assert_eq!(intersect([1.0, 1.0, 1.0], &up, TRIANGLE), Intersection::None);
    }

    #[test]
    fn meet_at_an_edge_or_a_corner_touches() {
        assert_eq!(to([2.0, 0.0, -1.0], [2.0, 0.0, 1.0]), Intersection::Touching);
        assert_eq!(to([4.0, 0.0, -1.0], [4.0, 0.0, 1.0]), Intersection::Touching);
        assert_eq!(to([5.0, 0.0, -1.0], [5.0, 0.0, 1.0]), Intersection::None);
    }

    #[test]
    fn meet_does_not_count_the_ends_of_the_segment() {
        assert_eq!(to([1.0, 1.0, 0.0], [1.0, 1.0, 5.0]), Intersection::None);
        assert_eq!(to([1.0, 1.0, -5.0], [1.0, 1.0, 0.0]), Intersection::None);
        assert_eq!(to([1.0, 1.0, 0.0], [1.0, 1.0, 0.0]), Intersection::None);
    }

    #[test]
    fn meet_in_the_plane_touches_iff_they_overlap() {
        for (p, l, expected) in [
            ([-1.0, 1.0, 0.0], [5.0, 1.0, 0.0], true),    // through
            ([1.0, 1.0, 0.0], [1.5, 1.0, 0.0], true),     // within
            ([-1.0, -1.0, 0.0], [9.0, -1.0, 0.0], false), // beside
            ([-2.0, 0.0, 0.0], [-1.0, 0.0, 0.0], false),  // on an edge's line, before it
            ([-2.0, 0.0, 0.0], [0.0, 0.0, 0.0], false),   // ends at a corner
            ([-2.0, 0.0, 0.0], [0.5, 0.0, 0.0], true),    // along an edge
            ([-1.0, 1.0, 0.0], [1.0, -1.0, 0.0], true),   // through a corner
            ([2.0, 0.0, 0.0], [2.0, -1.0, 0.0], false),   // leaves from an edge
            ([0.0, 0.0, 0.0], [-1.0, -2.0, 0.0], false),  // leaves from a corner
            ([5.0, 0.0, 0.0], [0.0, 5.0, 0.0], false),    // parallel to the long edge
            ([4.0, 0.0, 0.0], [0.0, 4.0, 0.0], true),     // on it
        ] {
            let expected = if expected { Intersection::Touching } else { Intersection::None };
            assert_eq!(to(p, l), expected, "{p:?} to {l:?}");
            assert_eq!(to(l, p), expected, "{l:?} to {p:?}");
        }
    }

    #[test]
    fn meet_a_triangle_without_area_touches_or_misses() {
        let line = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [2.0, 0.0, 0.0]];
        let dot = [[1.0, 1.0, 1.0]; 3];
        let toward = |l| Light::point(l).unwrap();
        assert_eq!(intersect([1.0, -1.0, 0.0], &toward([1.0, 1.0, 0.0]), line), Intersection::Touching);
        assert_eq!(intersect([1.0, -1.0, 0.1], &toward([1.0, 1.0, 0.0]), line), Intersection::None);
        assert_eq!(intersect([5.0, -1.0, 0.0], &toward([5.0, 1.0, 0.0]), line), Intersection::None);
        assert_eq!(intersect([-1.0, 0.0, 0.0], &toward([9.0, 0.0, 0.0]), line), Intersection::Touching);
        assert_eq!(intersect([5.0, 0.0, 0.0], &toward([9.0, 0.0, 0.0]), line), Intersection::None);
        assert_eq!(intersect([4.0, 0.0, 0.0], &toward([9.0, 0.0, 0.0]), line), Intersection::None);
        assert_eq!(intersect([0.0, 0.0, 0.0], &toward([2.0, 2.0, 2.0]), dot), Intersection::Touching);
        assert_eq!(intersect([0.0, 0.0, 0.0], &toward([1.0, 1.0, 1.0]), dot), Intersection::None);
        assert_eq!(intersect([0.0, 0.0, 0.0], &toward([2.0, 2.0, 2.5]), dot), Intersection::None);
    }
}
