use super::super::change::ChangeKind;
use super::super::test_support::{bits, without};
use super::*;
use crate::check::CrackReport;
use crate::testing::shapes;

fn counts(mesh: &Mesh) -> crate::check::Counts {
    let topology = Topology::of(mesh);
    let mut report = CrackReport::of(mesh, &topology);
    report.add_self_intersections(mesh, &topology, 1);
    report.counts
}

/// The mesh without the faces around a vertex.
fn without_fan(mesh: &Mesh, vertex: u32) -> Mesh {
    let keep = (0..mesh.face_count() as u32).filter(|&f| !mesh.triangles()[f as usize].contains(&vertex));
    let kept = super::super::rewrite::keep_faces(mesh.clone(), &keep.collect::<Vec<_>>());
    super::super::drop_unreferenced(kept).0
}

/// All triangulations of the stretch of a loop from corner `i` to corner `j`.
pub(super) fn all_triangulations(i: usize, j: usize) -> Vec<Vec<[usize; 3]>> {
    if j - i < 2 {
        return vec![Vec::new()];
    }
    let with = |k: usize| {
        let right = all_triangulations(k, j);
        let both = all_triangulations(i, k).into_iter().flat_map(move |left| {
            right.clone().into_iter().map(move |right| [left.clone(), right, vec![[i, k, j]]].concat())
        });
        both.collect::<Vec<_>>()
    };
    (i + 1..j).flat_map(with).collect()
}

#[test]
fn filled_holes_leave_everything_else_and_close() {
    let sphere = shapes::icosphere(2);
    for (mesh, edges) in [
        (without(&shapes::cube(), 3), 3),
        (shapes::open_cube(), 4),
        (without_fan(&sphere, 40), 6),
        (without_fan(&shapes::torus(9, 7, 2.0, 0.5), 5), 6),
        (shapes::inside_out(&shapes::open_cube()), 4),
    ] {
        let (filled, step) = fill(mesh.clone(), Fill::default()).unwrap();
        assert_eq!((step.count, step.left), (1, 0), "{}", mesh.name);
        assert_eq!(bits(&filled), bits(&mesh));
        assert_eq!(filled.triangles()[..mesh.face_count()], mesh.triangles()[..]);
        assert_eq!(filled.face_count(), mesh.face_count() + edges - 2);
        let found = counts(&filled);
        assert!(found.watertight && found.self_intersections == Some(0) && found.zero_area_faces == 0);
        let patch = step.changes[0].patch.unwrap();
        assert_eq!((patch.edges, patch.meets, patch.left), (edges, Some(false), None));
        assert_eq!(step.changes[0].new, Some(mesh.face_count() as u32));
        // Fault injected: the first face of the patch turned over.
        let (positions, mut triangles, ..) = filled.into_parts();
        triangles[mesh.face_count()].swap(0, 1);
        assert!(!counts(&Mesh::new(positions, triangles).unwrap()).watertight);
    }
}

#[test]
fn filled_flat_hole_of_any_outline_is_exact() {
    // A box of unit cubes without the faces on top of an L of them: a concave hole in a plane.
    let solid = shapes::voxels([4, 4, 2], |[x, y, z]| z == 0 || x == 0 || y == 0);
    let top = solid.bounds().unwrap()[1][2];
    let keep: Vec<u32> = (0..solid.face_count() as u32)
        .filter(|&f| solid.corners(crate::mesh::FaceId(f)).iter().any(|p| p[2] != top))
        .collect();
    let open = super::super::rewrite::keep_faces(solid.clone(), &keep);
    let open = super::super::drop_unreferenced(open).0;
    let (filled, step) = fill(open, Fill::default()).unwrap();
    let found = counts(&filled);
    assert!(found.watertight && found.self_intersections == Some(0) && found.zero_area_faces == 0);
    assert_eq!(found.signed_volume, counts(&solid).signed_volume);
    let patch = step.changes[0].patch.unwrap();
    assert_eq!((step.count, patch.off_plane, patch.area), (1, 0.0, Some(7.0)));
}

#[test]
fn fill_refuses_what_would_meet_the_mesh_unless_it_is_asked_to() {
    // A sheet would be covered by its own patch; a lone triangle by its reverse.
    let triangle = Mesh::new(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]]).unwrap();
    let pierced = {
        let open = shapes::open_cube();
        let spike = [[0.1, 0.0, -0.5], [0.2, 0.0, -0.5], [0.15, 0.1, 3.0]];
        let spike = Mesh::new(spike.to_vec(), vec![[0, 1, 2], [0, 2, 1]]).unwrap();
        Mesh::concat(&[open, spike]).unwrap()
    };
    for mesh in [shapes::sheet(3), triangle, pierced] {
        let (same, step) = fill(mesh.clone(), Fill::default()).unwrap();
        assert_eq!((step.count, step.left, same.face_count()), (0, 1, mesh.face_count()));
        let patch = step.changes[0].patch.unwrap();
        assert_eq!((patch.meets, patch.left), (Some(true), Some(Left::NoPatch)));
        let (filled, step) = fill(mesh, Fill { anyway: true, ..Fill::default() }).unwrap();
        assert_eq!((step.count, step.changes[0].patch.unwrap().meets), (1, Some(true)));
        assert_eq!(counts(&filled).boundary_edges, 0);
    }
}

#[test]
fn fill_leaves_long_holes_and_borders_that_do_not_close() {
    let (mesh, step) = fill(shapes::open_cube(), Fill::up_to(3)).unwrap();
    assert_eq!((mesh.face_count(), step.count, step.left), (10, 0, 1));
    assert_eq!(step.changes[0].patch.unwrap().left, Some(Left::TooLong));
    assert_eq!(step.changes[0].kind, ChangeKind::HoleLeft);
    let (_, step) = fill(shapes::mobius(9), Fill::default()).unwrap();
    assert!(step.changes.iter().any(|change| change.patch.unwrap().left == Some(Left::NoLoop)));
}

#[test]
fn fill_of_touching_holes_closes_each() {
    // Two faces of an octahedron that share one vertex only.
    let octahedron = shapes::octahedron();
    let pair = (1..8).find(|&other| {
        let first = octahedron.triangles()[0];
        octahedron.triangles()[other].iter().filter(|&vertex| first.contains(vertex)).count() == 1
    });
    let mesh = without(&without(&octahedron, pair.unwrap()), 0);
    let (filled, step) = fill(mesh, Fill::default()).unwrap();
    assert_eq!(step.count, 2);
    assert!(counts(&filled).watertight && counts(&filled).signed_volume > 0.0);
}

#[test]
fn fill_avoids_a_diagonal_that_is_an_edge_already() {
    // An octahedron without the two faces at one edge: of the two diagonals of the hole one is the edge on
    // the other side... of a square base, where all four sides have another face.
    let positions =
        vec![[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [2.0, 2.0, 0.0], [0.0, 2.0, 0.0], [1.0, 1.0, -2.0]];
    // The ring 0, 1, 2, 3 on top is open; below it, the edge 0 - 2 is in use by two faces.
    let triangles = vec![[1, 0, 4], [2, 1, 4], [3, 2, 4], [0, 3, 4]];
    let bowl = Mesh::new(positions, triangles).unwrap();
    let topology = Topology::of(&bowl);
    let both = |used: [u32; 2]| {
        let with = |i: usize, j: usize| [i as u32, j as u32] == used;
        let points: Vec<[f32; 3]> = bowl.positions()[..4].to_vec();
        least_area::least_area(&points, with)
    };
    assert!(both([0, 2]).iter().all(|t| t.contains(&1) && t.contains(&3)));
    assert!(both([1, 3]).iter().all(|t| t.contains(&0) && t.contains(&2)));
    assert_eq!(topology.edge_counts().boundary, 4);
}

#[test]
fn fill_finds_the_patch_that_meets_nothing_or_proves_that_there_is_none() {
    // A bowl with a bent rim, and a spike through every patch but those that pass above it.
    let rim = |k: usize| {
        let turn = std::f32::consts::TAU * k as f32 / 8.0;
        [turn.cos(), turn.sin(), if k.is_multiple_of(2) { 1.0 } else { 0.0 }]
    };
    let bowl = |spike: f32| {
        let mut positions: Vec<[f32; 3]> = (0..8).map(rim).collect();
        positions.push([0.0, 0.0, -2.0]);
        let mut triangles: Vec<[u32; 3]> = (0..8).map(|k| [(k + 1) % 8, k, 8]).collect();
        positions.extend([[0.01, 0.0, spike], [-0.01, 0.02, -1.0], [-0.01, -0.02, -1.0]]);
        triangles.extend([[9, 10, 11], [9, 11, 10]]);
        Mesh::new(positions, triangles).unwrap()
    };
    let closed = |spike: f32| {
        let (mesh, step) = fill(bowl(spike), Fill::default()).unwrap();
        (step.count, step.changes[0].patch.unwrap().left, counts(&mesh).self_intersections)
    };
    assert_eq!(closed(0.8), (1, None, Some(0)));
    assert_eq!(closed(1.5), (0, Some(Left::NoPatch), Some(0)));
}
