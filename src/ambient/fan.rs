//! The faces at a receiver, which no ray from it can cross.
//!
//! A ray that starts in the plane of a face meets it there and nowhere else, so the exact ray cast never
//! counts a face through the receiver p. What these faces hide is decided by the limit of a receiver
//! p + t·n, t → 0. Cut at p, a face becomes up to three triangles (p, a, b). By scale, one of them hides the
//! direction ω if and only if, on the sphere around p, the arc from the normal n to ω crosses the arc from a
//! to b. No condition on the mesh is needed: it may be open or non-manifold, or have duplicate faces.

use glam::DVec3;

use crate::geom::Light;
use crate::geom::predicate::filter::EPSILON;
use crate::geom::predicate::{Homogeneous, Sign, directions_turn};

/// What the faces through a receiver hide from it.
#[derive(Clone, Debug, Default)]
pub(crate) struct Fan {
    normal: Option<Homogeneous>,
    wings: Vec<Wing>,
}

/// A triangle with the receiver as a corner: the directions of the two others, and the side that the normal is
/// on.
#[derive(Clone, Copy, Debug)]
struct Wing {
    a: Homogeneous,
    b: Homogeneous,
    side: Sign,
}

impl Fan {
    /// The faces `around` that contain the point `p`, seen from the side of `normal`.
    pub(crate) fn new(p: [f32; 3], normal: [f32; 3], around: &[[[f32; 3]; 3]]) -> Self {
        let (Ok(here), Some(towards)) = (Light::point(p), towards(normal)) else { return Self::default() };
        let mut wings = Vec::new();
        for &[a, b, c] in around {
            for [a, b] in [[a, b], [b, c], [c, a]] {
                if surely_below(p, normal, a) && surely_below(p, normal, b) {
                    continue; // beyond the horizon
                }
                let [from, to] = [a, b].map(|corner| Homogeneous::extruded(corner, &here));
                let side = directions_turn([from, to, towards]);
                // Zero where p is one of the two corners or between them, or the normal lies in the plane.
                if !side.is_zero() {
                    wings.push(Wing { a: from, b: to, side });
                }
            }
        }
        Self { normal: Some(towards), wings }
    }

    /// Whether the faces hide this direction.
    pub(crate) fn hides(&self, direction: [f32; 3]) -> bool {
        let (Some(normal), Some(ray)) = (self.normal, towards(direction)) else { return false };
        self.wings.iter().any(|&Wing { a, b, side }| {
            directions_turn([a, b, ray]) == -side
                && directions_turn([normal, a, ray]) == side
                && directions_turn([ray, b, normal]) == side
        })
    }
}

/// A direction as a point at infinity; `None` if it is zero.
fn towards(direction: [f32; 3]) -> Option<Homogeneous> {
    Light::directional(direction.map(|x| -x)).ok().map(|light| Homogeneous::light(&light))
}

/// Whether a corner is certainly not above the horizon. The sum of three products of differences that are
/// rounded once errs by less than 8ε of their magnitudes.
fn surely_below(p: [f32; 3], normal: [f32; 3], corner: [f32; 3]) -> bool {
    let [p, normal, corner] = [p, normal, corner].map(|x| DVec3::from(x.map(f64::from)));
    let products = normal * (corner - p);
    products.element_sum() <= -8.0 * EPSILON * products.abs().element_sum()
}
