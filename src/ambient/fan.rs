//! The faces at a receiver, which no ray from it can cross.
//!
//! A ray that starts in the plane of a face meets it there and nowhere else, so the exact ray cast never
//! counts a face through the receiver p. What these faces hide is decided by the limit of a receiver
//! p + t·d, t → 0, where d is the normal, or another direction off the surface. Cut at p, a face becomes up
//! to three triangles (p, a, b). By scale, one of them hides the direction ω if and only if, on the sphere
//! around p, the arc from d to ω crosses the arc from a to b. No condition on the mesh is needed: it may be
//! open or non-manifold, or have duplicate faces.

use glam::DVec3;

use crate::geom::Light;
use crate::geom::predicate::filter::EPSILON;
use crate::geom::predicate::{Homogeneous, Sign, directions_turn};

/// What the faces through a receiver hide from it.
#[derive(Clone, Debug, Default)]
pub(super) struct Fan {
    wings: Vec<Wing>,
}

/// A triangle with the receiver as a corner: the directions of the two others, the direction that the
/// receiver is moved in, and the side of the triangle that this brings it to.
#[derive(Clone, Copy, Debug)]
struct Wing {
    off: Homogeneous,
    a: Homogeneous,
    b: Homogeneous,
    side: Sign,
}

impl Fan {
    /// Adds a face that contains the receiver `p`, which is moved along `off`, for rays around `normal`.
    pub(super) fn add(&mut self, p: [f32; 3], normal: [f32; 3], off: [f32; 3], [a, b, c]: [[f32; 3]; 3]) {
        let (Ok(here), Some(towards)) = (Light::point(p), towards(off)) else { return };
        let is_above = (0..3).map(|i| f64::from(normal[i]) * f64::from(off[i])).sum::<f64>() > 0.0;
        for [a, b] in [[a, b], [b, c], [c, a]] {
            if is_above && surely_below(p, normal, a) && surely_below(p, normal, b) {
                continue; // beyond the horizon
            }
            let [a, b] = [a, b].map(|corner| Homogeneous::extruded(corner, &here));
            let side = directions_turn([a, b, towards]);
            // Zero where p is one of the two corners or between them, or is moved within the plane.
            if !side.is_zero() {
                self.wings.push(Wing { off: towards, a, b, side });
            }
        }
    }

    /// Whether the faces hide this direction.
    pub(super) fn hides(&self, direction: [f32; 3]) -> bool {
        towards(direction).is_some_and(|ray| self.wings.iter().any(|wing| wing.hides(ray)))
    }
}

impl Wing {
    /// The ends of each arc lie on different sides of the other; and with both of these signs, not of the arc
    /// opposite to it.
    fn hides(&self, ray: Homogeneous) -> bool {
        let &Self { off, a, b, side } = self;
        directions_turn([a, b, ray]) == -side
            && directions_turn([off, a, ray]) == side
            && directions_turn([ray, b, off]) == side
    }
}

/// A direction as a point at infinity; `None` if it is zero.
fn towards(direction: [f32; 3]) -> Option<Homogeneous> {
    Light::directional(direction.map(|x| -x)).ok().map(|light| Homogeneous::light(&light))
}

/// Whether a corner is certainly not above the horizon. The sum of three products of differences that are
/// rounded once errs by less than 8ε of their magnitudes.
fn surely_below(p: [f32; 3], normal: [f32; 3], corner: [f32; 3]) -> bool {
    let from_p = [0, 1, 2].map(|i| f64::from(corner[i]) - f64::from(p[i]));
    let products = DVec3::from(from_p) * DVec3::from(normal.map(f64::from));
    products.element_sum() <= -8.0 * EPSILON * products.abs().element_sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::oracle::{Intersection, intersect};
    use crate::random::SplitMix64;

    /// Directions whose answer differs from that of a ray which starts a millionth of the triangle's size off
    /// the receiver, those that are hidden, and all.
    fn differing(hides: impl Fn(&Fan, [f32; 3]) -> bool) -> [usize; 3] {
        let mut random = SplitMix64(3);
        let mut counts = [0; 3];
        for _ in 0..4000 {
            let mut vector = |most: usize| -> [f32; 3] {
                [(); 3].map(|()| random.below(2 * most + 1) as f32 - most as f32)
            };
            let (p, most) = (vector(50), 1 << 20);
            let plus = |a: [f32; 3], b: [f32; 3]| [0, 1, 2].map(|i| a[i] + b[i]);
            let (normal, mut a, mut b) = (vector(1), vector(most), vector(most));
            if normal == [0.0; 3] {
                continue;
            }
            let c = [0, 1, 2].map(|i| p[i] - 0.5 * (a[i] + b[i]));
            (a, b) = (plus(p, a), plus(p, b));
            // With the receiver as a corner, on an edge, or within.
            for triangle in [[p, a, b], [a, p, b], [a, plus(p, [0, 1, 2].map(|i| p[i] - a[i])), b], [a, b, c]]
            {
                if triangle[2] != b && crate::geom::predicate::side_of_point(triangle, p) != Sign::Zero {
                    continue; // rounded off its plane
                }
                let mut fan = Fan::default();
                fan.add(p, normal, normal, triangle);
                let direction = vector(9);
                let along: f32 = (0..3).map(|i| direction[i] * normal[i]).sum();
                let Ok(light) = Light::directional(direction.map(|x| -x)) else { continue };
                if along <= 0.0 {
                    continue;
                }
                let crosses =
                    matches!(intersect(plus(p, normal), &light, triangle), Intersection::Crossing(_));
                counts[0] += usize::from(hides(&fan, direction) != crosses);
                counts[1] += usize::from(crosses);
                counts[2] += 1;
            }
        }
        counts
    }

    #[test]
    fn a_fan_hides_what_faces_hide_from_a_receiver_just_off_them_and_fewer_signs_do_not() {
        let [wrong, hidden, all] = differing(Fan::hides);
        assert!(wrong == 0 && hidden > 300 && all > 3000, "{wrong} of {hidden} hidden, {all} in all");
        let side_alone = |fan: &Fan, direction| {
            let ray = towards(direction).unwrap();
            fan.wings.iter().any(|wing| directions_turn([wing.a, wing.b, ray]) == -wing.side)
        };
        assert!(differing(side_alone)[0] > 100);
        let one_less = |fan: &Fan, direction| {
            let ray = towards(direction).unwrap();
            fan.wings.iter().any(|wing| {
                directions_turn([wing.a, wing.b, ray]) == -wing.side
                    && directions_turn([wing.off, wing.a, ray]) == wing.side
            })
        };
        assert!(differing(one_less)[0] > 100);
        assert!(differing(|_, _| false)[0] > 300);
    }
}
