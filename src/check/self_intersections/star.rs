//! Proof that a closed surface does not meet itself, in linear time: it is star-shaped.
//!
//! Let a point lie strictly behind every face. Seen from it, every face is turned the same way; since the
//! surface is closed, the number of faces in a direction is then the same for all directions but those of
//! edges. If it is one, every ray meets the surface once: two faces that met beyond what they share would lie
//! in one direction, and so would the faces around. All convex solids are star-shaped, and so are cones,
//! spheres and gears, whatever the valence of their vertices and however their caps are cut into triangles.
//!
//! The proof of a convex polytope of Kurt Mehlhorn et al., *Checking Geometric Programs or Verification of
//! Geometric Structures*, 1999, section 2.3, without the convexity.

use crate::geom::Aabb;
use crate::geom::predicate::{Sign, orient3d};
use crate::mesh::{FaceId, Mesh};

/// Faces through which a ray is tried.
const RAYS: usize = 8;

/// Whether these faces, all those of one watertight shell, are proven to meet nowhere but in what they share.
pub(crate) fn is_star(mesh: &Mesh, faces: &[FaceId]) -> bool {
    let Some(&first) = faces.first() else { return false };
    let inside = centers(mesh, faces).into_iter().find_map(|center| {
        let side = |face| {
            let [a, b, c] = mesh.corners(face);
            orient3d(a, b, c, center)
        };
        let sign = side(first);
        (!sign.is_zero() && faces.iter().all(|&face| side(face) == sign)).then_some((center, sign))
    });
    let Some((center, sign)) = inside else { return false };
    let towards = |&face: &FaceId| within(mesh.corners(face));
    let step = faces.len().div_ceil(RAYS);
    faces.iter().step_by(step).map(towards).find_map(|aim| faces_along(mesh, faces, center, aim, sign))
        == Some(1)
}

/// Points that may lie behind every face: the mean of all corners, and the center of the box.
fn centers(mesh: &Mesh, faces: &[FaceId]) -> [[f32; 3]; 2] {
    let (mut sum, mut bounds) = ([0.0_f64; 3], Aabb::EMPTY);
    for &face in faces {
        let corners = mesh.corners(face);
        bounds = bounds.join(&Aabb::around(corners));
        for corner in corners {
            for axis in 0..3 {
                sum[axis] += f64::from(corner[axis]);
            }
        }
    }
    let corners = 3.0 * faces.len() as f64;
    [sum.map(|sum| (sum / corners) as f32), bounds.center()]
}

/// A point within a face, on none of the lines through a corner and the middle of the face, which hit the
/// edges of a regular solid behind.
fn within(corners: [[f32; 3]; 3]) -> [f32; 3] {
    let [a, b, c] = corners.map(|p| p.map(f64::from));
    std::array::from_fn(|axis| (0.5 * a[axis] + 0.3 * b[axis] + 0.2 * c[axis]) as f32)
}

/// The number of faces that a ray from `center` through `aim` meets, given that `center` is on the side
/// `sign` of each; `None` if the line through both touches an edge.
fn faces_along(mesh: &Mesh, faces: &[FaceId], center: [f32; 3], aim: [f32; 3], sign: Sign) -> Option<usize> {
    if center == aim {
        return None;
    }
    let mut count = 0;
    for &face in faces {
        let [a, b, c] = mesh.corners(face);
        let signs = [(a, b), (b, c), (c, a)].map(|(u, v)| orient3d(center, aim, u, v));
        match (signs.contains(&Sign::Positive), signs.contains(&Sign::Negative)) {
            (true, true) => {} // the line passes beside the face
            _ if signs.contains(&Sign::Zero) => return None,
            // Ahead, not behind: with aim − center = αA + βB + γC, the signs are that of −γ·det(A, B, C).
            _ => count += usize::from(signs[0] == -sign),
        }
    }
    Some(count)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::shapes;

    fn faces(mesh: &Mesh) -> Vec<FaceId> {
        (0..mesh.face_count()).map(FaceId::new).collect()
    }

    fn star(mesh: &Mesh) -> bool {
        is_star(mesh, &faces(mesh))
    }

    #[test]
    fn star_shaped_solids_are_proven_and_no_others() {
        let sphere = shapes::translated(&shapes::icosphere(3), [0.25, -8.0, 3.0]);
        for solid in [shapes::cube(), shapes::tetrahedron(), shapes::octahedron(), sphere] {
            assert!(star(&solid) && star(&shapes::inside_out(&solid)), "{}", solid.name);
        }
        for other in [shapes::torus(12, 8, 3.0, 1.0), shapes::figure_eight_prism(), shapes::hollow_cube()] {
            assert!(!star(&other), "{}", other.name);
        }
        assert!(!is_star(&shapes::cube(), &[]));
    }

    #[test]
    fn star_of_two_turns_is_refused() {
        // Two copies of a sphere: every face is turned away from the center, but each ray meets two.
        let sphere = shapes::icosphere(2);
        let larger = shapes::scaled(&sphere, 1.5);
        assert!(star(&sphere) && star(&larger));
        assert!(!star(&Mesh::concat(&[sphere.clone(), larger]).unwrap()));
        // Fault injected: a ray backwards would be counted, too.
        let rays = |sign| faces_along(&sphere, &faces(&sphere), [0.0; 3], [0.31, 0.52, 0.2], sign);
        assert_eq!([rays(Sign::Positive), rays(Sign::Negative)], [Some(1), Some(1)]);
        let half: Vec<FaceId> = faces(&sphere)
            .into_iter()
            .filter(|&face| sphere.corners(face).iter().all(|p| p[0] <= 0.2))
            .collect();
        let sides = [Sign::Positive, Sign::Negative]
            .map(|s| faces_along(&sphere, &half, [0.0; 3], [0.9, 0.1, 0.2], s));
        assert!(sides == [Some(0), Some(1)] || sides == [Some(1), Some(0)], "{sides:?}");
    }
}
