//! Triangles in clip coordinates, clipped to a square pyramid.

use glam::DVec4;

/// A clipped triangle: each of the five planes adds a corner at most.
#[derive(Clone, Copy, Debug)]
pub(super) struct Polygon {
    corners: [DVec4; 8],
    len: usize,
}

impl Polygon {
    pub(super) fn corners(&self) -> &[DVec4] {
        &self.corners[..self.len]
    }
}

/// The part of a triangle with |x| ≤ guard·w, |y| ≤ guard·w and w ≥ `least`. Corners are (x, y, w, depth·w).
///
/// A cut of an edge is computed from its ends in one order, whichever face it is of, so that faces that share
/// an edge also share its cuts.
pub(super) fn clip(corners: [DVec4; 3], guard: f64, least: f64) -> Polygon {
    let [a, b, c] = corners;
    let mut polygon = Polygon { corners: [a, b, c, a, a, a, a, a], len: 3 };
    let planes = [
        DVec4::new(0.0, 0.0, 1.0, 0.0),
        DVec4::new(-1.0, 0.0, guard, 0.0),
        DVec4::new(1.0, 0.0, guard, 0.0),
        DVec4::new(0.0, -1.0, guard, 0.0),
        DVec4::new(0.0, 1.0, guard, 0.0),
    ];
    for (index, plane) in planes.into_iter().enumerate() {
        let above = |p: DVec4| plane.dot(p) - if index == 0 { least } else { 0.0 };
        if polygon.corners().iter().any(|&p| above(p) < 0.0) {
            polygon = cut(&polygon, above);
        }
    }
    polygon
}

/// The part of a convex polygon where `above` is not negative (Sutherland and Hodgman, 1974).
fn cut(polygon: &Polygon, above: impl Fn(DVec4) -> f64) -> Polygon {
    let mut result = Polygon { corners: polygon.corners, len: 0 };
    let mut push = |p| {
        // A convex polygon gains one corner per plane. Rounding may bend it; surplus corners are dropped.
        if result.len < result.corners.len() {
            result.corners[result.len] = p;
            result.len += 1;
        }
    };
    let corners = polygon.corners();
    for (index, &from) in corners.iter().enumerate() {
        let to = corners[(index + 1) % corners.len()];
        let (at_from, at_to) = (above(from), above(to));
        if at_from >= 0.0 {
            push(from);
        }
        if (at_from < 0.0) != (at_to < 0.0) {
            let ordered = from.to_array() <= to.to_array();
            let ([p, q], [at_p, at_q]) =
                if ordered { ([from, to], [at_from, at_to]) } else { ([to, from], [at_to, at_from]) };
            push(p + (q - p) * (at_p / (at_p - at_q)));
        }
    }
    result
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn clip_keeps_what_is_inside_and_cuts_shared_edges_alike() {
        let corner = |x: f64, y: f64, w: f64| DVec4::new(x, y, w, 0.25);
        let inside = [corner(0.1, 0.2, 1.0), corner(0.5, -0.2, 2.0), corner(-1.0, 0.3, 3.0)];
        assert_eq!(clip(inside, 1.0, 0.5).corners(), inside);
        assert!(clip(inside.map(|p| p * -1.0), 1.0, 0.5).corners().is_empty());
        // The eight-sided part of a triangle that reaches beyond all planes: within all of them.
        let large = [corner(-9.0, -5.0, 1.0), corner(9.0, -5.0, 1.0), corner(0.1, 4.0, 1.0)];
        let cut = clip(large, 1.0, 0.5);
        assert!(cut.corners().len() > 3, "{cut:?}");
        assert!(cut.corners().iter().all(|p| p.x.abs() <= p.z + 1e-12 && p.y.abs() <= p.z + 1e-12));
        // Two faces with the edge pq: the same cut, bit for bit, though one runs along it backwards.
        let (p, q) = (corner(0.3, 0.7, 0.1), corner(-3.0, 0.1, 2.3));
        let [one, other] = [[p, q, corner(0.0, 0.0, 3.0)], [q, p, corner(1.0, 1.0, 4.0)]];
        let cuts = |corners| clip(corners, 1.0, 0.5).corners().to_vec();
        let shared = cuts(one).iter().filter(|p| cuts(other).contains(p)).count();
        assert_eq!(shared, 2);
    }
}
