//! Boxes that are apart from faces, and from the sides of shadow volumes, by exact signs.

use super::fault::{Fault, Faults};
use crate::geom::predicate::{Homogeneous, Sign, on_triangle, orient3d_homogeneous, side_of_point};
use crate::geom::{Aabb, Facing, Light};
use crate::oracle::{Intersection, intersect};

/// A box with its corners.
#[derive(Clone, Copy, Debug)]
pub(super) struct Corners {
    bounds: Aabb,
    at: [[f32; 3]; 8],
    is_strict: bool,
}

impl Corners {
    pub(super) fn of(bounds: Aabb, faults: Faults) -> Self {
        let corner = |i: usize| {
            [0, 1, 2].map(|axis| if i >> axis & 1 == 0 { bounds.low[axis] } else { bounds.high[axis] })
        };
        Self { bounds, at: [0, 1, 2, 3, 4, 5, 6, 7].map(corner), is_strict: !faults.has(Fault::NotStrict) }
    }

    /// Whether the box surely has no point in common with a face.
    pub(super) fn is_off_face(&self, face: [[f32; 3]; 3]) -> bool {
        !Aabb::around(face).overlaps(&self.bounds) || self.is_on_one_side(|p| side_of_point(face, p))
    }

    /// The same, where touching counts as meeting whatever fault there is.
    pub(super) fn is_off_face_strictly(&self, face: [[f32; 3]; 3]) -> bool {
        Self { is_strict: true, ..*self }.is_off_face(face)
    }

    /// Whether the box surely has no point in common with an edge, nor with any point beyond it that the
    /// light sees through the edge.
    pub(super) fn is_off_side(&self, [a, b]: [[f32; 3]; 2], light: &Light) -> bool {
        let [light, a, b] = [Homogeneous::light(light), Homogeneous::point(a), Homogeneous::point(b)];
        self.is_on_one_side(|p| orient3d_homogeneous([light, a, b, Homogeneous::point(p)]))
    }

    fn is_on_one_side(&self, side: impl Fn([f32; 3]) -> Sign) -> bool {
        let mut sides = [false; 2];
        for &corner in &self.at {
            match side(corner) {
                Sign::Positive => sides[0] = true,
                Sign::Negative => sides[1] = true,
                Sign::Zero if self.is_strict => return false,
                Sign::Zero => {}
            }
            if sides == [true; 2] {
                return false;
            }
        }
        true
    }
}

/// Directions in which no edge of a generated or modeled mesh is likely to lie.
const SCATTERED: [[f32; 3]; 3] = [[0.817, 0.334, 0.471], [-0.293, 0.881, -0.372], [0.141, -0.427, 0.893]];

/// The winding number of some closed faces around a point; `None` if the point lies on one of them, or if the
/// rays in several directions all run through an edge.
pub(super) fn winding(faces: impl Iterator<Item = [[f32; 3]; 3]> + Clone, p: [f32; 3]) -> Option<i32> {
    'directions: for travel in SCATTERED {
        let light = Light::directional(travel).ok()?;
        let mut sum = 0;
        for face in faces.clone() {
            match intersect(p, &light, face) {
                Intersection::Crossing(Facing::Front) => sum += 1,
                Intersection::Crossing(_) => sum -= 1,
                Intersection::Touching => continue 'directions,
                Intersection::None => {
                    if side_of_point(face, p).is_zero() && on_triangle(face, p) {
                        return None;
                    }
                }
            }
        }
        return Some(sum);
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{FaceId, Mesh};
    use crate::testing::shapes;

    #[test]
    fn winding_is_that_of_the_shells_around_a_point() {
        let around = |mesh: &Mesh, p: [f32; 3]| {
            winding((0..mesh.face_count()).map(|face| mesh.corners(FaceId::new(face))), p)
        };
        let nested = shapes::nested_cubes(3);
        let high = nested.bounds().unwrap()[1];
        assert_eq!(around(&nested, high), None);
        assert_eq!(around(&nested, high.map(|x| x + 1.0)), Some(0));
        assert_eq!(around(&shapes::cube(), [0.1, 0.2, -0.3]).map(i32::abs), Some(1));
        assert_eq!(around(&shapes::cube(), [1.0, 0.2, -0.3]), None);
        assert_eq!(around(&shapes::torus(20, 10, 2.0, 0.7), [0.0; 3]), Some(0));
    }

    #[test]
    fn box_that_touches_is_not_apart() {
        let light = Light::point([0.0, 0.0, 9.0]).unwrap();
        let face = [[0.0, 0.0, 2.0], [4.0, 0.0, 2.0], [0.0, 4.0, 2.0]];
        for (low, apart) in [(2.5, true), (2.0, false), (1.0, false), (0.5, true)] {
            let bounds = Aabb { low: [0.5, 0.5, low], high: [1.0, 1.0, low + 1.0] };
            assert_eq!(Corners::of(bounds, Faults::default()).is_off_face(face), apart, "{low}");
        }
        for (low, apart) in [(0.1, true), (0.0, false), (-0.5, false)] {
            let bounds = Aabb { low: [low, 0.5, 0.0], high: [low + 1.0, 1.0, 1.0] };
            let edge = [[0.0, 0.0, 2.0], [0.0, 4.0, 2.0]];
            assert_eq!(Corners::of(bounds, Faults::default()).is_off_side(edge, &light), apart, "{low}");
        }
    }
}
