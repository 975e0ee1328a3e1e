//! Counts and normals of receivers on shapes whose normals are known.

use super::*;
use crate::testing::shapes;

fn normals(of: &Receivers) -> Vec<Option<[f32; 3]>> {
    let mut normals: Vec<_> = of.list.iter().map(|receiver| receiver.normal).collect();
    normals.sort_by(|a, b| a.partial_cmp(b).unwrap());
    normals
}

/// Every corner has the position of its receiver.
fn fits(meshes: &[&Mesh], of: &Receivers) {
    let corners =
        meshes.iter().flat_map(|mesh| (0..mesh.face_count()).map(|face| mesh.corners(FaceId::new(face))));
    assert_eq!(of.corners.len(), corners.clone().count());
    for (corners, receivers) in corners.zip(&of.corners) {
        for (corner, &receiver) in corners.iter().zip(receivers) {
            assert_eq!(of.list[receiver as usize].point, *corner);
        }
    }
}

#[test]
fn smooth_meshes_have_a_receiver_per_vertex_and_hard_edges_one_per_side() {
    for (mesh, per, count) in [
        (shapes::icosphere(2), Per::Corner, 162),
        (shapes::torus(24, 12, 2.0, 0.5), Per::Corner, 288),
        (shapes::cube(), Per::Corner, 24),
        (shapes::tetrahedron(), Per::Corner, 12),
        (shapes::tetrahedron(), Per::Vertex, 4),
        (shapes::menger_sponge(1), Per::Vertex, 64),
        (shapes::sheet(3), Per::Corner, 16),
    ] {
        for mesh in [shapes::soup(&mesh), shapes::shuffled(&mesh, 3), mesh] {
            let found = Receivers::of(&[&mesh], per);
            assert_eq!(found.list.len(), count, "{}", mesh.name);
            fits(&[&mesh], &found);
        }
    }
}

#[test]
fn normals_of_a_sphere_point_outwards_and_those_of_a_cube_along_the_axes() {
    for Receiver { point, normal, .. } in Receivers::of(&[&shapes::icosphere(3)], Per::Corner).list {
        let normal = normal.unwrap();
        let cosine: f32 = (0..3).map(|i| point[i] * normal[i]).sum();
        assert!(cosine > 0.999, "{normal:?} at {point:?}");
    }
    let cube = Receivers::of(&[&shapes::cube()], Per::Corner);
    assert!(cube.list.iter().all(|receiver| {
        let normal = receiver.normal.unwrap();
        let axis = (0..3).find(|&i| normal[i] != 0.0).unwrap();
        normal[axis] == receiver.point[axis] && normal.iter().map(|x| x.abs()).sum::<f32>() == 1.0
    }));
    // Over all faces, weighted by angles: the diagonal, although one side has one triangle there and another
    // has two. Weighted by number or by area it would not be.
    for Receiver { point, normal, .. } in Receivers::of(&[&shapes::cube()], Per::Vertex).list {
        let off = (0..3).map(|i| (normal.unwrap()[i] - point[i] / 3_f32.sqrt()).abs()).fold(0.0, f32::max);
        assert!(off < 1e-6, "{normal:?} at {point:?}");
    }
}

#[test]
fn two_sides_of_a_sheet_have_two_normals_per_corner_and_none_per_vertex() {
    // The sides are cut along different diagonals, so that no sum is exactly zero.
    let p = [[0.1, 0.2], [1.3, 0.1], [1.1, 1.7], [-0.1, 1.8_f32]];
    let flat = p.map(|[x, y]| [x, y, 0.0]);
    let tilted = p.map(|[x, y]| [x, y, x - 2.0 * y]);
    for corners in [flat, tilted] {
        let faces = vec![[0, 1, 2], [0, 2, 3], [1, 0, 3], [1, 3, 2]];
        let mesh = Mesh::new(corners.to_vec(), faces).unwrap();
        let all = Receivers::of(&[&mesh], Per::Vertex);
        assert_eq!(all.list.len(), 4);
        assert!(corners != flat || all.list.iter().all(|receiver| receiver.normal.is_none()));
        let sides = Receivers::of(&[&mesh], Per::Corner);
        assert!(sides.list.len() >= 8 && sides.list.iter().all(|receiver| receiver.normal.is_some()));
        fits(&[&mesh], &sides);
    }
    let double = Receivers::of(&[&shapes::double_sheet()], Per::Vertex);
    assert_eq!(normals(&double), [None; 4]);
    let double = Receivers::of(&[&shapes::double_sheet()], Per::Corner);
    let [down, up] = [-1.0, 1.0].map(|z| Some([0.0, 0.0, z]));
    assert_eq!(normals(&double), [down, down, down, down, up, up, up, up]);
}

#[test]
fn faces_without_area_give_no_normal_and_take_the_value_of_a_neighbor() {
    let mesh = shapes::collinear_face();
    let found = Receivers::of(&[&mesh], Per::Corner);
    fits(&[&mesh], &found);
    // A lone needle has receivers, without a normal.
    let needle = Mesh::new(vec![[0.0; 3], [1.0; 3], [2.0; 3]], vec![[0, 1, 2], [0, 0, 1]]).unwrap();
    let found = Receivers::of(&[&needle], Per::Corner);
    assert_eq!(normals(&found), [None; 3]);
    // Beside a face with an area it adds none.
    let mut positions = needle.positions().to_vec();
    positions.push([0.0, 0.0, 5.0]);
    let with_face = Mesh::new(positions, vec![[0, 1, 2], [0, 1, 3]]).unwrap();
    let found = Receivers::of(&[&with_face], Per::Corner);
    assert_eq!((found.list.len(), found.corners[0][..2] == found.corners[1][..2]), (4, true));
    assert_eq!(found.list.iter().filter(|receiver| receiver.normal.is_none()).count(), 1);
}

#[test]
fn positions_are_joined_across_meshes_and_faces_are_numbered_in_sequence() {
    let (left, right) = (shapes::sheet(1), shapes::translated(&shapes::sheet(1), [1.0, 0.0, 0.0]));
    let both = [&left, &right];
    let found = Receivers::of(&both, Per::Corner);
    assert_eq!(found.list.len(), 6);
    fits(&both, &found);
    let faces = Receivers::of(&both, Per::Face);
    assert_eq!(faces.list[3].face, Some(FaceId(3)));
    assert_eq!(faces.corners, [[0; 3], [1; 3], [2; 3], [3; 3]]);
    let third = 1.0 + 1.0 / 3.0;
    assert!(faces.list.iter().any(|receiver| (receiver.point[0] - third).abs() < 1e-6));
    assert!(Receivers::of(&[], Per::Corner).list.is_empty());
}

#[test]
fn given_normals_split_a_vertex_and_equal_ones_join_a_seam() {
    // A seam: the file has both vertices of the shared edge twice.
    let (left, right) = (shapes::sheet(1), shapes::translated(&shapes::sheet(1), [1.0, 0.0, 0.0]));
    let tilted = |index: usize| if index == 0 { [0.0, 0.0, 3.0] } else { [0.0, 1.0, 1.0] };
    let (split, bad) = Receivers::with_normals(&[&left, &right], |mesh, _| Some([tilted(mesh); 3]));
    assert_eq!((split.list.len(), bad), (8, 0));
    let (joined, _) = Receivers::with_normals(&[&left, &right], |_, _| Some([tilted(0); 3]));
    assert_eq!(joined.list.len(), 6);
    let (some, bad) = Receivers::with_normals(&[&left, &right], |mesh, _| {
        (mesh == 1).then_some([tilted(0), [0.0; 3], [f32::INFINITY, 0.0, 0.0]])
    });
    assert_eq!((some.list.len(), bad), (6, 4));
    assert!(some.list.iter().all(|receiver| receiver.normal == Some([0.0, 0.0, 1.0])));
}

#[test]
fn receivers_of_a_scaled_mesh_have_the_same_normals_bit_by_bit() {
    let torus = shapes::torus(17, 9, 2.0, 0.7);
    for scale in [2_f32.powi(-60), 2_f32.powi(70)] {
        let [here, there] =
            [&torus, &shapes::scaled(&torus, scale)].map(|mesh| Receivers::of(&[mesh], Per::Corner).list);
        assert!(here.iter().zip(&there).all(|(a, b)| a.normal == b.normal));
    }
}

#[test]
fn an_edge_of_many_faces_takes_no_quadratic_time() {
    let count = 20_000_u32;
    let mut positions = vec![[0.0, 0.0, 0.0], [0.0, 0.0, 1.0]];
    positions.extend((0..count).map(|i| [1.0, i as f32, 0.0]));
    let faces = (0..count).map(|i| if i % 2 == 0 { [0, 1, i + 2] } else { [1, 0, i + 2] }).collect();
    let book = Mesh::new(positions, faces).unwrap();
    assert!(Receivers::of(&[&book], Per::Corner).list.len() > 3 * 20_000 / 2);
}
