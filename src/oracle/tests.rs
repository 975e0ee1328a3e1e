//! Verdicts through the BVH against a loop over all faces, where boxes are flat, huge or tiny, or segments
//! lie in a plane or meet an edge.

use super::*;
use crate::random::SplitMix64;
use crate::testing::shapes;

/// Triangles with corners on a coarse grid, some degenerate to lines or points, with several scales in one
/// mesh.
fn soup(random: &mut SplitMix64, faces: usize, scales: &[f32]) -> Mesh {
    let mut positions = Vec::new();
    for _ in 0..faces {
        let scale = scales[random.below(scales.len())];
        let mut number = |most: usize| (random.below(2 * most + 1) as f32 - most as f32) / 16.0;
        let middle = [(); 3].map(|()| number(12));
        positions.extend([(); 3].map(|()| middle.map(|x| (x + number(4)) * scale)));
    }
    let triangles = (0..faces as u32).map(|face| [3 * face, 3 * face + 1, 3 * face + 2]).collect();
    Mesh::new(positions, triangles).unwrap()
}

fn meshes() -> Vec<Mesh> {
    let mut random = SplitMix64(8);
    let torus = shapes::torus(20, 10, 2.0, 0.75);
    let flat = torus.positions().iter().map(|&[x, y, _]| [x, y, 0.5]).collect();
    let mut meshes = vec![
        shapes::menger_sponge(1),
        shapes::double_sheet(),
        shapes::translated(&shapes::icosphere(2), [1e6, -3.0, 0.0]),
        Mesh::new(flat, torus.triangles().to_vec()).unwrap(),
        soup(&mut random, 300, &[1.0, 1e-3, 1e3]),
        soup(&mut random, 300, &[1.0, 1e-30, 3e17]),
        soup(&mut random, 300, &[3.4e38, 1e38, 1.0]),
    ];
    for scale in [1e-42, 1e-38, 1e-20, 1e17, 2e18, 1e37] {
        meshes.push(shapes::scaled(&torus, scale));
        meshes.push(soup(&mut random, 200, &[scale]));
    }
    meshes
}

/// Number of crossings, single verdicts and batch verdicts that differ from a loop over all faces, and the
/// numbers of lit, shadowed and grazing queries.
fn wrong(fault: impl Fn(&mut WideBvh)) -> (usize, [usize; 3]) {
    let mut random = SplitMix64(9);
    let (mut wrong, mut kinds) = (0, [0; 3]);
    for mesh in meshes() {
        let mut oracle = Oracle::build(&mesh);
        fault(&mut oracle.tree);
        let vertices = mesh.positions();
        let mut vertex = || vertices[random.below(vertices.len())];
        let largest = vertices.iter().flatten().fold(0.0_f32, |most, x| most.max(x.abs()));
        let [l, a, b] = [vertex(), vertex(), vertex()];
        let finite = |x: f64| x.clamp(f64::from(f32::MIN), f64::from(f32::MAX)) as f32;
        let beyond = [0, 1, 2].map(|i| finite(f64::from(l[i]) * 3.0 - f64::from(a[i])));
        let between = [0, 1, 2].map(|i| 0.25 * a[i] + 0.75 * b[i]);
        let mut lights = vec![Light::point(l), Light::point(beyond), Light::point([0.0, 0.0, largest])];
        for direction in [[0.0, -1.0, 0.0], [0.0, 0.0, largest], [1.0, 0.0, -1.0], between] {
            lights.extend((direction != [0.0; 3]).then(|| Light::directional(direction)));
        }
        for light in lights.into_iter().map(Result::unwrap) {
            let mut points = vec![[0.0; 3], between, light.xyz()];
            for _ in 0..40 {
                let v = vertex();
                // Points at a vertex, with y halved, and behind the vertex as far as the light is in front of
                // it.
                let towards = light.xyz().map(f64::from);
                points.extend([
                    v,
                    [v[0], 0.5 * v[1], v[2]],
                    [0, 1, 2].map(|i| finite(2.0 * f64::from(v[i]) - towards[i])),
                ]);
            }
            let mut many = vec![Verdict::Lit; points.len()];
            oracle.verdicts_into(&points, &light, &mut many);
            for (&p, &of_many) in points.iter().zip(&many) {
                let mut truth = Crossings::default();
                for face in mesh.triangles() {
                    match intersect(p, &light, face.map(|vertex| vertices[vertex as usize])) {
                        Intersection::None => {}
                        Intersection::Touching => truth.touching += 1,
                        Intersection::Crossing(Facing::Front) => truth.front += 1,
                        Intersection::Crossing(_) => truth.back += 1,
                    }
                }
                let verdict = truth.verdict();
                kinds[verdict as usize] += 1;
                let found = (oracle.crossings(p, &light), oracle.verdict(p, &light), of_many);
                wrong += usize::from(found != (truth, verdict, verdict));
            }
        }
    }
    (wrong, kinds)
}

#[test]
fn oracle_verdicts_are_those_of_a_loop_over_all_faces_and_boxes_rounded_inwards_are_caught() {
    let (wrong_ones, kinds) = wrong(|_| {});
    assert!(wrong_ones == 0 && kinds.iter().all(|&count| count > 1000), "{wrong_ones} wrong, {kinds:?}");
    assert!(wrong(WideBvh::round_inwards).0 > 0);
}

/// Faces that are missed although a segment through their corner begins within `slack` of the point asked,
/// far from the origin.
fn missed_candidates(slack: impl Fn(f32) -> f32) -> usize {
    let far = [5000.25_f32, 0.125, -3000.5];
    let mesh = shapes::translated(&shapes::sheet(6), far);
    let oracle = Oracle::build(&mesh);
    let mut random = SplitMix64(9);
    let mut missed = 0;
    for face in (0..mesh.face_count()).cycle().take(4000).map(FaceId::new) {
        let corner = mesh.corners(face)[random.below(3)];
        let mut next = || random.below(4001) as f32 / 1000.0 - 2.0;
        let at = [0, 1, 2].map(|i| corner[i] + next());
        // On the line through light and corner, on the other side of the corner; in `f64`.
        let past = f64::from(0.1 + next().abs());
        let p = [0, 1, 2].map(|i| {
            let (corner, at) = (f64::from(corner[i]), f64::from(at[i]));
            (corner + past * (corner - at)) as f32
        });
        let largest = p.iter().fold(0.0_f32, |most, x| most.max(x.abs()));
        let mut found = false;
        oracle
            .for_each_candidate(p, slack(largest), &Light::point(at).unwrap(), |met, _| found |= met == face);
        missed += usize::from(!found);
    }
    missed
}

#[test]
fn candidates_of_a_point_that_is_rounded_are_all_found_and_without_slack_some_are_not() {
    assert_eq!(missed_candidates(|largest| largest * (2.0 * f32::EPSILON)), 0);
    assert!(missed_candidates(|_| 0.0) > 0);
}

/// Segments that start at a corner of a triangle, for which a short cut differs from the whole test.
fn wrong_from_corners(short: impl Fn([f32; 3], &Light, &[[f32; 3]; 3]) -> Intersection) -> [usize; 2] {
    let mut random = SplitMix64(11);
    let (mut wrong, mut all) = (0, 0);
    for mesh in meshes() {
        for _ in 0..200 {
            let triangle = mesh.corners(FaceId::new(random.below(mesh.face_count())));
            let other = mesh.corners(FaceId::new(random.below(mesh.face_count())));
            let p = triangle[random.below(3)];
            let halved = |a: [f32; 3], b: [f32; 3]| [0, 1, 2].map(|i| 0.5 * a[i] - 0.5 * b[i]);
            let along = halved(triangle[1], triangle[2]);
            let mut lights = vec![Light::point(other[0]), Light::point(triangle[random.below(3)])];
            for direction in [along, halved(other[0], p), [0.0, 0.0, -1.0]] {
                lights.extend((direction != [0.0; 3]).then(|| Light::directional(direction)));
            }
            for light in lights.into_iter().map(Result::unwrap) {
                wrong += usize::from(short(p, &light, &triangle) != intersect(p, &light, triangle));
                all += 1;
            }
        }
    }
    [wrong, all]
}

#[test]
fn oracle_short_cut_from_corners_is_right_and_without_the_sign_of_the_light_it_is_not() {
    let [wrong, all] = wrong_from_corners(intersect_exactly);
    assert!(wrong == 0 && all > 10_000, "{wrong} of {all}");
    let [unsigned, _] = wrong_from_corners(|_, _, _| Intersection::None);
    assert!(unsigned > 100, "{unsigned}");
}
