use proptest::prelude::*;
use proptest::strategy::ValueTree;
use proptest::test_runner::{Config, RngAlgorithm, TestError, TestRng, TestRunner};

use super::*;
use crate::check::CrackReport;
use crate::geom::predicate::{Sign, side_of_point};
use crate::mesh::Mesh;
use crate::oracle::{Oracle, Verdict};
use crate::topology::Topology;

fn topology(mesh: &Mesh) -> Topology {
    Topology::of(mesh)
}

fn balanced(mesh: &Mesh) -> bool {
    topology(mesh).edge_counts().balanced
}

/// The smallest value that `fails`, after shrinking.
fn smallest<S: Strategy>(strategy: S, fails: impl Fn(&S::Value) -> bool) -> S::Value {
    let config = Config { cases: 10_000, failure_persistence: None, ..Config::default() };
    // Always the same random numbers: how small the result is depends on them.
    let random = TestRng::deterministic_rng(RngAlgorithm::ChaCha);
    let found = TestRunner::new_with_rng(config, random).run(&strategy, |value| {
        prop_assert!(!fails(&value));
        Ok(())
    });
    match found {
        Err(TestError::Fail(_, value)) => value,
        other => panic!("nothing was found: {other:?}"),
    }
}

proptest! {
    #[test]
    fn strategy_closed_meshes_are_balanced(mesh in prop_oneof![closed(), cad(), at_scale(closed())]) {
        prop_assert!(mesh.face_count() > 0 && balanced(&mesh));
    }

    #[test]
    fn strategy_one_piece_of_damage_is_seen_in_the_topology(solid in damaged(voxel_solid(2), 1)) {
        let [damage] = solid.damage[..] else { panic!("{:?}", solid.damage) };
        let counts = CrackReport::of(&solid.mesh, &topology(&solid.mesh)).counts;
        let seen = match damage {
            Damage::DoubledTurned(_) => counts.duplicate_opposite_winding == 1,
            Damage::Doubled(_) => counts.duplicate_same_winding == 1,
            Damage::Collapsed(_) => counts.collapsed_faces == 1,
            Damage::Dropped(_) | Damage::Turned(_) | Damage::Unwelded(_) => true,
            // The whole edge and its halves; the whole one has more faces where four met.
            Damage::Split(_) => counts.boundary_edges >= 2,
            Damage::Torn(..) | Damage::Moved(..) | Damage::Added(_) => false,
        };
        prop_assert!(!counts.balanced && seen, "{:?}", counts);
    }

    #[test]
    fn strategy_hollow_solids_have_a_cavity(mesh in hollow()) {
        let counts = CrackReport::of(&mesh, &topology(&mesh)).counts;
        prop_assert!(counts.shells >= 2 && (56.0..=63.0).contains(&counts.signed_volume));
    }
}

#[test]
fn strategy_meshes_shrink_to_few_faces() {
    assert_eq!(smallest(soup(40), |mesh| mesh.face_count() > 0).face_count(), 1);
    assert_eq!(smallest(voxel_solid(3), |_| true).face_count(), 12);
    let solid = smallest(damaged(closed(), 5), |solid| !balanced(&solid.mesh));
    assert_eq!((solid.mesh.face_count(), solid.damage.len()), (11, 1), "{:?}", solid.damage);
}

#[test]
fn strategy_cases_shrink_in_mesh_light_and_points_alike() {
    let oracle = |case: &Case| Oracle::build(&case.mesh);
    let case = smallest(case(soup(40), 8), |case| {
        case.points.iter().any(|&p| oracle(case).verdict(p, &case.light) == Verdict::Shadowed)
    });
    // Picks go by the number of faces, so some may have to stay; but as nothing more than a point.
    let solid = case.mesh.triangles().iter().filter(|[a, b, c]| a != b && b != c && c != a).count();
    assert!(solid <= 3 && case.points.len() == 1, "{case:?}");
}

#[test]
fn strategy_picks_are_where_they_are_hardest() {
    let mut runner = TestRunner::deterministic();
    let cases = case(cad(), 4);
    // Lights on a vertex, in the plane of a face, directional, along an axis, far away; points on a vertex,
    // in the plane of a face, and behind a silhouette edge.
    let mut seen = [0; 8];
    for _ in 0..300 {
        let Case { mesh, light, points } =
            cases.new_tree(&mut runner).expect("nothing is rejected").current();
        let [x, y, z] = light.xyz();
        let on_vertex = |p: [f32; 3]| mesh.positions().contains(&p);
        let corners = |face: &[u32; 3]| face.map(|vertex| mesh.positions()[vertex as usize]);
        let in_plane = |p| mesh.triangles().iter().any(|face| side_of_point(corners(face), p) == Sign::Zero);
        let grazing = |&&p: &&[f32; 3]| Oracle::build(&mesh).verdict(p, &light) == Verdict::Grazing;
        for (count, found) in seen.iter_mut().zip([
            usize::from(!light.is_directional() && on_vertex([x, y, z])),
            usize::from(!light.is_directional() && in_plane([x, y, z])),
            usize::from(light.is_directional()),
            usize::from(light.is_directional() && [x, y, z].iter().filter(|x| **x != 0.0).count() == 1),
            usize::from([x, y, z].iter().any(|x| x.abs() > 1e6)),
            points.iter().filter(|&&p| on_vertex(p)).count(),
            points.iter().filter(|&&p| in_plane(p)).count(),
            points.iter().filter(grazing).count(),
        ]) {
            *count += found;
        }
    }
    assert!(seen.iter().all(|&count| count >= 10), "{seen:?}");
}
