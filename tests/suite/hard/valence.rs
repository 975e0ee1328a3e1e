//! Poles and caps with very many faces, and faces that lie over each other.

use umbrage::caster::{Caster, ShellProof};
use umbrage::check::{CrackReport, Requirement};
use umbrage::mesh::Mesh;
use umbrage::testing::shapes;
use umbrage::topology::Topology;

/// Corners of a convex polygon with integer coordinates, of a parabola.
fn polygon(count: i32) -> Vec<[f32; 3]> {
    (0..count).map(|i| i - count / 2).map(|i| [i as f32, (i * i) as f32, 0.0]).collect()
}

/// Walls between the polygon and a point or another polygon, each closed by a fan from one corner.
fn prism(count: u32) -> Mesh {
    let low = polygon(count as i32);
    let positions = low.iter().copied().chain(low.iter().map(|p| [p[0], p[1], 500.0])).collect();
    let caps = (1..count - 1).flat_map(|i| [[0, i + 1, i], [count, count + i, count + i + 1]]);
    let walls = (0..count).map(|i| (i, (i + 1) % count));
    let walls = walls.flat_map(|(i, j)| [[i, j, count + j], [i, count + j, count + i]]);
    Mesh::new(positions, caps.chain(walls).collect()).unwrap()
}

fn cone(count: u32) -> Mesh {
    let mut positions = polygon(count as i32);
    positions.push([1.0, (count * count / 8) as f32, 700.0]);
    let caps = (1..count - 1).map(|i| [0, i + 1, i]);
    let walls = (0..count).map(|i| [i, (i + 1) % count, count]);
    Mesh::new(positions, caps.chain(walls).collect()).unwrap()
}

fn searched(mesh: &Mesh) -> CrackReport {
    let topology = Topology::of(mesh);
    let mut report = CrackReport::of(mesh, &topology);
    report.add_self_intersections(mesh, &topology, 4);
    report
}

/// Guards against comparing each face of a pole or a cap with each other one.
#[test]
fn hard_28_poles_and_caps_are_searched_and_proven() {
    for mesh in [cone(4000), prism(4000)] {
        let report = searched(&mesh);
        assert!(report.counts.sound() && report.counts.self_intersections == Some(0));
        assert!(report.counts.self_intersections_complete);
        assert_eq!(Caster::new(mesh.clone()).proofs(), [ShellProof::Outward]);
        // Negative test: beside them two solids that cross are found, none of whose faces is of the pole.
        let small = shapes::translated(&shapes::cube(), [9000.0, 0.0, 0.0]);
        let crossing = shapes::translated(&shapes::cube(), [9000.5, 0.25, 0.125]);
        let all = Mesh::concat(&[mesh.clone(), small, crossing]).unwrap();
        let found = searched(&all);
        assert!(found.counts.self_intersections > Some(0) && found.counts.self_intersections_complete);
        assert_eq!(found.unmet(&[Requirement::Sound, Requirement::NoSelfIntersections]).len(), 1);
        let first = &found.self_intersections.unwrap().first;
        assert!(first.iter().flatten().all(|face| face.index() >= mesh.face_count()));
        // And one that crosses the pole itself.
        let mut positions = mesh.positions().to_vec();
        positions.last_mut().unwrap()[2] -= 900.0;
        let crossed = Mesh::new(positions, mesh.triangles().to_vec()).unwrap();
        assert!(searched(&crossed).counts.self_intersections > Some(0) || crossed.vertex_count() == 4001);
    }
}

/// Guards against testing each copy with each other one, and against losing a crossing among copies.
#[test]
fn hard_28_stacked_faces_are_counted_once_each() {
    for copies in [2_000_u32, 5_000] {
        let mut triangles = vec![[0, 1, 2]; copies as usize];
        triangles.extend([[3, 4, 5], [3, 5, 6]]);
        let low = [[0.0; 3], [8.0, 0.0, 0.0], [0.0, 8.0, 0.0]];
        let through = [[1.0, 1.0, -1.0], [2.0, 1.0, -1.0], [2.0, 1.0, 1.0], [1.0, 1.0, 1.0]];
        let mesh = Mesh::new([&low[..], &through].concat(), triangles).unwrap();
        let report = searched(&mesh);
        assert_eq!(report.counts.self_intersections, Some(2 * copies as usize));
        assert_eq!(report.counts.duplicate_faces, copies as usize - 1);
        assert!(report.counts.t_junctions_complete);
    }
}
