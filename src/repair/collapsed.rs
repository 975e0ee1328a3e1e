//! The step that drops collapsed faces.

use super::change::{ChangeKind, Step};
use super::index_map::IndexMap;
use super::rewrite::keep_faces;
use crate::mesh::Mesh;
use crate::topology::has_collapsed;

/// Drops faces with two equal corners. One with three different corners on a line stays: it passes its edges
/// on to its neighbors, and dropping it would open a crack.
///
/// Guarantee: no position changes, and the signed boundary chain (at each edge, the faces along it minus the
/// faces against it) stays, since both edges that such a face has run along each other in opposite
/// directions.
///
/// ```
/// use umbrage::mesh::Weld;
/// use umbrage::{repair, testing::shapes};
/// let (capsule, _) = repair::weld(shapes::uv_capsule(16, 8, 1.0, 2.0), Weld::Exact);
/// let (mesh, step) = repair::drop_collapsed(capsule);
/// assert_eq!(step.count, 2 * 16); // those at the poles
/// assert_eq!(repair::drop_collapsed(mesh).1.count, 0);
/// ```
#[must_use]
pub fn drop_collapsed(mesh: Mesh) -> (Mesh, Step) {
    let mut step = Step::new("collapsed");
    if !mesh.triangles().iter().any(|&corners| has_collapsed(corners)) {
        return (mesh, step);
    }
    let mut from = Vec::with_capacity(mesh.face_count());
    for (face, &corners) in (0..).zip(mesh.triangles()) {
        if has_collapsed(corners) {
            let at = mesh.positions()[corners[0] as usize];
            step.add(ChangeKind::CollapsedDropped, Some(face), None, at);
        } else {
            from.push(face);
        }
    }
    step.faces = Some(IndexMap::backward(&from, mesh.face_count()));
    (keep_faces(mesh, &from), step)
}

#[cfg(test)]
mod tests {
    use super::super::test_support::{bits, boundary_chain};
    use super::*;
    use crate::testing::shapes;

    #[test]
    fn collapsed_faces_go_and_the_boundary_chain_stays() {
        let spoiled = |mut triangles: Vec<[u32; 3]>, positions: Vec<[f32; 3]>| {
            triangles.splice(2..2, [[0, 0, 1], [3, 2, 3]]);
            triangles.push([5, 1, 1]);
            Mesh::new(positions, triangles).unwrap()
        };
        for shape in [shapes::open_cube(), shapes::octahedron(), shapes::collinear_face()] {
            let (positions, triangles, ..) = shape.clone().into_parts();
            let (mesh, step) = drop_collapsed(spoiled(triangles, positions));
            assert_eq!(mesh.triangles(), shape.triangles());
            assert_eq!(bits(&mesh), bits(&shape));
            let dropped: Vec<_> = step.changes.iter().map(|change| change.old.unwrap()).collect();
            assert_eq!(dropped, [2, 3, shape.face_count() as u32 + 2]);
            assert_eq!(boundary_chain(&mesh), boundary_chain(&shape));
            // Fault injected: one more face is dropped.
            assert_ne!(boundary_chain(&keep_faces(mesh, &[0, 1, 3])), boundary_chain(&shape));
        }
    }
}
