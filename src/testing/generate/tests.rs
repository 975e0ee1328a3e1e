use super::mesh::{CLOSED, KNOWN};
use super::*;
use crate::geom::{Aabb, Light};
use crate::mesh::Mesh;
use crate::random::SplitMix64;
use crate::topology::Topology;
use crate::verify::points::feature::one_ulp_off;

#[test]
fn generate_zeros_are_the_simplest_choices() {
    let zeros = &mut Bytes::new(&[]);
    let draw: &mut dyn Draw = zeros;
    assert_eq!(mesh(draw).with_name("tetrahedron"), KNOWN[0]());
    assert_eq!([draw.between(-3, 3), i32::from(draw.flag())], [0; 2]);
    assert_eq!([draw.signed(), draw.coordinate().into(), draw.bits().into()], [0.0; 3]);
    for (shape, faces) in Shape::ALL.into_iter().zip([4, 12, 12, 4, 4, 1, 1, 1, 1, 1]) {
        assert_eq!(shape.draw(draw).triangles.len(), faces, "{shape:?}");
    }
    assert_eq!(voxel_solid(draw, [3; 3]).face_count(), 12);
}

#[test]
fn generate_larger_choices_are_not_the_simplest() {
    let mut random = SplitMix64(3);
    let draw: &mut dyn Draw = &mut random;
    let values: Vec<i32> = (0..200).map(|_| draw.between(-2, 4)).collect();
    assert_eq!([-2, -1, 0, 1, 2, 3, 4].map(|n| values.contains(&n)), [true; 7], "{values:?}");
    assert!(values.iter().all(|n| (-2..=4).contains(n)));
    let signed: Vec<f64> = (0..200).map(|_| draw.signed()).collect();
    assert!(signed.iter().all(|x| x.abs() < 1.0));
    assert!(signed.iter().any(|&x| x > 0.75) && signed.iter().any(|&x| x < -0.75));
}

/// Choices given one by one, then zeros.
struct Script<'a>(std::slice::Iter<'a, u32>);

impl Draw for Script<'_> {
    fn below(&mut self, n: u32) -> u32 {
        self.0.next().map_or(0, |&choice| choice.min(n - 1))
    }

    fn unit(&mut self) -> f64 {
        0.0
    }
}

#[test]
fn generate_to_leave_an_item_out_does_not_change_the_others() {
    let list = |choices: &[u32], least| {
        let mut script = Script(choices.iter());
        let draw: &mut dyn Draw = &mut script;
        draw.list(least, 3, |draw| draw.below(100))
    };
    assert_eq!(list(&[1, 10, 1, 20, 1, 30], 0), [10, 20, 30]);
    assert_eq!(list(&[1, 10, 0, 20, 1, 30], 0), [10, 30]);
    assert_eq!(list(&[0, 10, 0, 20, 0, 30], 1), [30]);
    assert_eq!(list(&[0, 10, 0, 20, 0, 30], 0), [0; 0]);
}

#[test]
fn generate_faces_have_three_corners_or_any() {
    let mut random = SplitMix64(5);
    let all = faces(&mut random, 0..=4000, 4);
    let collapsed = all.iter().filter(|[a, b, c]| a == b || b == c || c == a).count();
    assert!(all.iter().flatten().all(|&vertex| vertex < 4));
    // Of four corners in the order of those that are left, three in five are such.
    assert!((100..600).contains(&collapsed), "{collapsed} of {}", all.len());
    let mut seen = all.clone();
    seen.sort_unstable();
    seen.dedup();
    assert!(seen.len() >= 24, "all {} orders of three of four vertices", seen.len());
}

#[test]
fn generate_known_solids_are_closed_and_bending_opens_none() {
    let balanced = |mesh: &Mesh| Topology::of(mesh).edge_counts().balanced;
    for (index, known) in KNOWN.iter().enumerate() {
        let mesh = known();
        assert!(balanced(&mesh) || index >= CLOSED, "{}", mesh.name);
    }
    let mut random = SplitMix64(9);
    for _ in 0..200 {
        assert!(balanced(&bent(&mut random, 0.4)));
    }
    // The sabotage: a face of a bent solid is missing.
    let mut draft = Draft::from(bent(&mut random, 0.4));
    draft.triangles.pop();
    assert!(!balanced(&draft.into()));
}

#[test]
fn generate_every_kind_of_damage_is_done_as_it_says() {
    let mut random = SplitMix64(11);
    let mut kinds = std::collections::BTreeSet::new();
    for _ in 0..400 {
        let before = Draft::from(KNOWN[2]());
        let mut after = before.clone();
        let done = damage(&mut random, Damage::KINDS, &mut after).expect("a cube has faces");
        let name = format!("{done:?}");
        kinds.insert(name.split('(').next().map(str::to_owned));
        let grown = |faces: usize, vertices: usize| {
            (after.triangles.len(), after.positions.len()) == (12 + faces, 8 + vertices)
        };
        let face = |face: u32| before.triangles[face as usize];
        let moved =
            |p: [f32; 3], q: [f32; 3]| (0..3).map(|i| (p[i] - q[i]).abs() / f32::EPSILON).fold(0.0, f32::max);
        let as_said = match done {
            Damage::Dropped(_) => after.triangles.len() == 11,
            Damage::Turned(of) => {
                let [a, b, c] = face(of);
                after.triangles[of as usize] == [a, c, b] && grown(0, 0)
            }
            Damage::Doubled(of) => after.triangles.last() == Some(&face(of)) && grown(1, 0),
            Damage::DoubledTurned(of) => {
                let [a, b, c] = face(of);
                after.triangles.last() == Some(&[a, c, b]) && grown(1, 0)
            }
            Damage::Split(_) => grown(1, 1),
            Damage::Collapsed(of) => after.triangles[of as usize][1..] == [face(of)[1]; 2] && grown(0, 0),
            Damage::Unwelded(of) => after.positions[8] == before.positions[face(of)[0] as usize],
            Damage::Torn(of, p) => {
                after.positions[8] == p && moved(p, before.positions[face(of)[0] as usize]) <= 2.0
            }
            Damage::Moved(vertex, p) => after.positions[vertex as usize] == p && grown(0, 0),
            Damage::Added(corners) => after.triangles.last() == Some(&corners) && grown(1, 0),
        };
        assert!(as_said, "{done:?}");
    }
    assert_eq!(kinds.len() as u32, Damage::KINDS, "{kinds:?}");
}

#[test]
fn generate_any_mesh_light_and_point_of_any_bytes_are_small_and_sound() {
    let mut random = SplitMix64(13);
    let (mut largest, mut seen) = (0, [0; 3]);
    for _ in 0..2000 {
        let data: Vec<u8> = (0..SplitMix64::below(&mut random, 400)).map(|_| random.next() as u8).collect();
        let bytes = &mut Bytes::new(&data);
        let mesh = mesh(bytes);
        let light = light(bytes, &mesh);
        let p = point(bytes, &mesh, &light);
        largest = largest.max(mesh.face_count());
        assert!(mesh.face_count() > 0 && p.iter().all(|x| x.is_finite()));
        let on_vertex = |p: [f32; 3]| usize::from(mesh.positions().contains(&p));
        seen[0] += usize::from(light.is_directional());
        seen[1] += usize::from(!light.is_directional()) * on_vertex(light.xyz());
        seen[2] += on_vertex(p);
    }
    assert!((40..=100).contains(&largest) && seen.iter().all(|&n| n > 100), "{largest} {seen:?}");
}

#[test]
fn generate_lights_and_points_of_a_mesh_without_faces_are_there() {
    let (empty, light) = (Mesh::default(), Light::point([1.0, 2.0, 3.0]).unwrap());
    let mut random = SplitMix64(17);
    for _ in 0..500 {
        let _ = super::light(&mut random, &empty);
        assert!(point(&mut random, &empty, &light).iter().all(|x| x.is_finite()));
    }
}

#[test]
fn generate_light_one_ulp_off_is_off_by_one_ulp() {
    let mut random = SplitMix64(1);
    for p in [[1.0, -2.5, 0.0], [f32::MAX, f32::MIN, f32::MIN_POSITIVE]] {
        for _ in 0..200 {
            let off = one_ulp_off(&mut random, p);
            let near = |i: usize| [p[i].next_down(), p[i], p[i].next_up()].contains(&off[i]);
            assert!(off != p && (0..3).all(near) && off.iter().all(|x| x.is_finite()), "{p:?} {off:?}");
        }
    }
}

#[test]
fn generate_light_far_is_at_least_a_billion_diagonals_away() {
    let mesh = crate::testing::shapes::cube();
    let (mut random, [low, high]) = (SplitMix64(1), mesh.bounds().unwrap());
    let bounds = Aabb { low, high };
    for _ in 0..1000 {
        let light = LightKind::FAR.draw(&mut random, &mesh).xyz();
        let away = (0..3).map(|i| f64::from(light[i] - bounds.center()[i]).powi(2)).sum::<f64>().sqrt();
        let exponent = (away / bounds.diagonal()).log2();
        assert!((29.999..40.001).contains(&exponent), "2^{exponent}");
    }
}

#[test]
fn generate_mixed_scales_always_mixes() {
    let mut random = SplitMix64(1);
    for _ in 0..500 {
        let mut positions = vec![[1.0_f32; 3]; 3 + random.below(5)];
        Scale::Mixed.apply(&mut random, &mut positions);
        let first = positions[0][0];
        assert!(positions.iter().flatten().any(|&x| x != first), "{positions:?}");
    }
}
