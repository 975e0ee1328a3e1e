//! The ray cast against a loop over all faces, and against big integers.

use proptest::prelude::*;
use umbrage::geom::{Facing, Light};
use umbrage::mesh::Mesh;
use umbrage::oracle::{Crossings, Intersection, Oracle, Verdict, intersect};
use umbrage::testing::shapes;
use umbrage::testing::strategy::{light, place, soup};
use umbrage::verify::reference;

fn loop_over_all(mesh: &Mesh, p: [f32; 3], light: &Light) -> Crossings {
    let mut crossings = Crossings::default();
    for face in mesh.triangles() {
        match intersect(p, light, face.map(|v| mesh.positions()[v as usize])) {
            Intersection::None => {}
            Intersection::Touching => crossings.touching += 1,
            Intersection::Crossing(Facing::Front) => crossings.front += 1,
            Intersection::Crossing(_) => crossings.back += 1,
        }
    }
    crossings
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(3000))]

    #[test]
    fn oracle_equals_a_loop_over_all_faces_and_whole_numbers(mesh in soup(40), p in place(), light in light()) {
        let oracle = Oracle::build(&mesh);
        let crossings = oracle.crossings(p, &light);
        prop_assert_eq!(crossings, loop_over_all(&mesh, p, &light));
        prop_assert_eq!(crossings, reference(&mesh, p, &light).crossings);
        prop_assert_eq!(oracle.verdict(p, &light), crossings.verdict());
    }

    #[test]
    fn oracle_from_a_vertex_equals_a_loop_over_all_faces_and_whole_numbers(
        mesh in soup(40),
        vertex in any::<prop::sample::Index>(),
        end in any::<prop::sample::Index>(),
        light in light(),
    ) {
        let positions = mesh.positions();
        prop_assume!(!positions.is_empty());
        let oracle = Oracle::build(&mesh);
        let p = positions[vertex.index(positions.len())];
        for light in [light, Light::point(positions[end.index(positions.len())]).unwrap()] {
            let crossings = oracle.crossings(p, &light);
            prop_assert_eq!(crossings, loop_over_all(&mesh, p, &light));
            prop_assert_eq!(crossings, reference(&mesh, p, &light).crossings);
        }
    }
}

#[test]
fn oracle_a_lost_or_turned_face_is_seen_by_the_reference() {
    let mesh = shapes::icosphere(2);
    let light = Light::point([0.3, 0.2, 5.0]).unwrap();
    let p = [0.1, 0.05, -3.0];
    let truth = reference(&mesh, p, &light).crossings;
    assert_eq!((truth.front, truth.back), (1, 1));
    let (positions, mut triangles, ..) = mesh.into_parts();
    let hit = (0..triangles.len()).find(|&face| {
        let corners = triangles[face].map(|v| positions[v as usize]);
        intersect(p, &light, corners) == Intersection::Crossing(Facing::Front)
    });
    triangles[hit.unwrap()].swap(1, 2);
    let turned = Mesh::new(positions.clone(), triangles.clone()).unwrap();
    assert_ne!(Oracle::build(&turned).crossings(p, &light), truth);
    triangles.remove(hit.unwrap());
    let lost = Mesh::new(positions, triangles).unwrap();
    assert_ne!(Oracle::build(&lost).crossings(p, &light), truth);
}

#[test]
fn oracle_a_sphere_shadows_what_lies_behind_it() {
    let oracle = Oracle::build(&shapes::icosphere(3));
    let sun = Light::directional([0.0, -1.0, 0.0]).unwrap();
    assert_eq!(oracle.verdict([0.1, -7.0, 0.2], &sun), Verdict::Shadowed);
    assert_eq!(oracle.verdict([0.1, 7.0, 0.2], &sun), Verdict::Lit);
    assert_eq!(oracle.verdict([3.0, -7.0, 0.2], &sun), Verdict::Lit);
}

#[test]
fn oracle_first_hit_is_the_nearest_of_all_faces() {
    let mesh = shapes::torus(24, 12, 2.0, 0.7);
    let oracle = Oracle::build(&mesh);
    let eye = [0.3_f32, -6.0, 2.0];
    let mut hits = 0;
    for x in -20_i8..=20 {
        for z in -20_i8..=20 {
            let direction = [f32::from(x) * 0.031, 1.0, f32::from(z) * 0.023 - 0.3];
            let back = Light::directional(direction.map(|d| -d)).unwrap();
            let crossed = mesh.triangles().iter().filter(|face| {
                matches!(
                    intersect(eye, &back, face.map(|v| mesh.positions()[v as usize])),
                    Intersection::Crossing(_)
                )
            });
            let hit = oracle.first_hit(eye, direction);
            assert_eq!(hit.is_some(), crossed.count() > 0);
            if let Some(hit) = hit {
                hits += 1;
                // Seen from a point just beyond the hit, only this face lies in front of the eye.
                let past: [f32; 3] = std::array::from_fn(|i| eye[i] + direction[i] * (hit.t as f32) * 1.0001);
                let before = oracle.crossings(past, &Light::point(eye).unwrap());
                assert!(before.front + before.back <= 1, "{before:?}");
            }
        }
    }
    assert!(hits > 100);
}

#[test]
fn oracle_at_the_ends_of_f32_neither_overflows_nor_errs() {
    let huge = shapes::scaled(&shapes::cube(), 3.4e38);
    let light = Light::point([0.0, 0.0, 3.4e38]).unwrap();
    let oracle = Oracle::build(&huge);
    assert_eq!(oracle.verdict([1e30, 2e30, -3.39e38], &light), Verdict::Lit);
    let tiny = shapes::scaled(&shapes::cube(), 1e-30);
    let oracle = Oracle::build(&tiny);
    let far = Light::point([1.0e30, 2.0e30, 3.0e30]).unwrap();
    assert_eq!(oracle.verdict([-1e-29, -2e-29, -3e-29], &far), Verdict::Shadowed);
    assert_eq!(oracle.verdict([-1e-29, 2e-29, -3e-29], &far), Verdict::Lit);
}
