//! The choice between z-pass and z-fail, and the bound of the depth complexity, against samples with exact
//! answers.

use glam::{DQuat, DVec3};
use proptest::prelude::*;
use umbrage::Reason;
use umbrage::caster::{Caster, ShellBoxes};
use umbrage::facing::{CasterFaces, classify};
use umbrage::geom::Light;
use umbrage::mesh::{FaceId, Mesh};
use umbrage::oracle::{Intersection, Oracle, intersect};
use umbrage::scene::Scope;
use umbrage::shadow::stencil::{
    Counting, DepthComplexity, ShellMethods, StencilMethod, max_depth_complexity,
};
use umbrage::testing::shapes;
use umbrage::testing::strategy::{light, place, soup};
use umbrage::topology::{Shells, Topology};
use umbrage::view::{Projection, ProjectionKind};

use crate::support::real_meshes;

fn shells(mesh: &Mesh) -> Shells {
    Topology::of(mesh).shells()
}

fn auto(mesh: &Mesh, projection: &Projection, light: &Light) -> ShellMethods {
    ShellMethods::choose(mesh, &shells(mesh), projection, light, None)
}

fn narrow(p: DVec3) -> [f32; 3] {
    p.as_vec3().to_array()
}

fn wide(p: [f32; 3]) -> DVec3 {
    DVec3::from(p.map(f64::from))
}

/// A camera at `eye` that looks along −z, with a square picture and a field of view of 90 degrees.
fn ahead(eye: [f32; 3], near: f32) -> Projection {
    let (right, up, forward) = ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]);
    Projection { eye, right, up, forward, near, kind: Default::default() }
}

fn turned(projection: &Projection, by: DQuat) -> Projection {
    let turn = |row: [f32; 3]| narrow(by * wide(row));
    let [right, up, forward] = [projection.right, projection.up, projection.forward].map(turn);
    Projection { right, up, forward, ..*projection }
}

/// Points of the near rectangle, its corners included; exact for a camera along an axis at small integers.
fn near_places(projection: &Projection, steps: usize) -> Vec<[f32; 3]> {
    let [a, b, _, d] = projection.near_corners();
    let at =
        |i: usize, j: usize| a + (b - a) * (i as f64 / steps as f64) + (d - a) * (j as f64 / steps as f64);
    (0..=steps).flat_map(|i| (0..=steps).map(move |j| (i, j))).map(|(i, j)| narrow(at(i, j))).collect()
}

/// Whether the shadow ray that continues away from the light, from a point of a face, meets the near
/// rectangle: the converse question, in plain `f64`.
fn shadow_meets(projection: &Projection, light: &Light, place: DVec3) -> bool {
    let away = if light.is_directional() { -wide(light.xyz()) } else { place - wide(light.xyz()) };
    let from = projection.clip(place.extend(1.0).to_array());
    let step = projection.clip(away.extend(0.0).to_array());
    let near = f64::from(projection.near);
    let inside = |t: f64| (0..2).all(|i| (from[i] + t * step[i]).abs() <= near);
    if step[3] == 0.0 {
        from[3] == near && inside(0.0)
    } else {
        let t = (near - from[3]) / step[3];
        t >= 0.0 && inside(t)
    }
}

/// Whether a sample proves that z-pass would miscount a shell.
fn harmful(mesh: &Mesh, shells: &Shells, shell: usize, projection: &Projection, light: &Light) -> bool {
    let places = near_places(projection, 8);
    let faces = (0..mesh.face_count()).filter(|&face| shells.of_face[face] == Some(shell as u32));
    faces.map(|face| mesh.corners(FaceId::new(face))).any(|corners| {
        let [a, b, c] = corners.map(wide);
        places.iter().any(|&p| intersect(p, light, corners) != Intersection::None)
            || [a, b, c, (a + b) / 2.0, (b + c) / 2.0, (c + a) / 2.0, (a + b + c) / 3.0]
                .into_iter()
                .any(|place| shadow_meets(projection, light, place))
    })
}

/// The first shell that a plan counts with z-pass although a sample forbids it.
fn miscounted(mesh: &Mesh, projection: &Projection, light: &Light, plan: &ShellMethods) -> Option<usize> {
    let shells = shells(mesh);
    (0..shells.count).find(|&shell| {
        plan.choices[shell].what == StencilMethod::ZPass && harmful(mesh, &shells, shell, projection, light)
    })
}

/// Cameras along an axis, where contact is often exact, or in any orientation.
fn camera() -> impl Strategy<Value = Projection> {
    let near = prop_oneof![Just(0.25_f32), Just(0.5), Just(1.0)];
    let grid = prop_oneof![Just(DQuat::IDENTITY), Just(DQuat::from_xyzw(0.5, 0.5, 0.5, 0.5))];
    let free = (-1.0..1.0, -1.0..1.0, -1.0..1.0, 0.1..1.0)
        .prop_map(|(x, y, z, w)| DQuat::from_xyzw(x, y, z, w).normalize());
    let eye = [-2_i8..=2, -2_i8..=2, -2_i8..=2].prop_map(|eye| eye.map(f32::from));
    (eye, near, prop_oneof![grid, free]).prop_map(|(eye, near, turn)| turned(&ahead(eye, near), turn))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1500))]

    #[test]
    fn zpass_is_never_chosen_where_a_sample_forbids_it(mesh in soup(6), projection in camera(), light in light()) {
        let plan = auto(&mesh, &projection, &light);
        prop_assert_eq!(miscounted(&mesh, &projection, &light, &plan), None);
    }
}

/// Small casters around a camera, in general position; `between` puts them near the segment between light and
/// eye.
fn generic(count: u64, between: bool) -> impl Iterator<Item = (Mesh, Projection, Light)> {
    let mut state = 7_u64;
    let mut unit = move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64 * 2.0 - 1.0
    };
    (0..count).map(move |k| {
        let turn = DQuat::from_xyzw(unit(), unit(), unit(), unit()).normalize();
        let projection = turned(&ahead([0.1, 0.2, 0.3], 0.1), turn);
        let place = DVec3::new(20.0 * unit(), 20.0 * unit(), 20.0 * unit());
        let light = if k % 3 == 0 { Light::directional(narrow(-place)) } else { Light::point(narrow(place)) };
        let shape =
            [shapes::icosphere(1), shapes::cube(), shapes::torus(12, 8, 1.0, 0.4), shapes::tetrahedron()];
        let scatter = DVec3::new(unit(), unit(), unit());
        let offset = if between { place * (0.5 + 0.3 * unit()) + 1.5 * scatter } else { 8.0 * scatter };
        (shapes::translated(&shape[k as usize % 4], narrow(offset)), projection, light.unwrap())
    })
}

#[test]
fn zpass_is_chosen_nearly_wherever_samples_allow_it() {
    for (between, share, proven) in [(false, 0.9, 0.95), (true, 0.3, 0.85)] {
        let (mut allowed, mut chosen) = (0, 0);
        for (mesh, projection, light) in generic(500, between) {
            let plan = auto(&mesh, &projection, &light);
            assert_eq!(miscounted(&mesh, &projection, &light, &plan), None, "{projection:?} {light}");
            allowed += usize::from(!harmful(&mesh, &shells(&mesh), 0, &projection, &light));
            chosen += plan.count(StencilMethod::ZPass);
        }
        eprintln!("z-pass: allowed by samples {allowed}, proven {chosen}, of 500");
        assert!(
            allowed as f64 >= share * 500.0 && chosen as f64 >= proven * allowed as f64,
            "{chosen} of {allowed}"
        );
    }
}

#[test]
fn zpass_faults_are_seen_by_the_samples() {
    let seen = |fault: &dyn Fn(&Mesh, &Projection, &Light) -> ShellMethods| {
        generic(300, true)
            .filter(|(mesh, projection, light)| {
                miscounted(mesh, projection, light, &fault(mesh, projection, light)).is_some()
            })
            .count()
    };
    // Everything is z-pass; the rectangle is a point; the light is on the other side; half of the faces are
    // skipped.
    let shell_of = |mesh: &Mesh| shells(mesh);
    assert!(
        seen(&|mesh, p, l| ShellMethods::choose(mesh, &shell_of(mesh), p, l, Some(StencilMethod::ZPass)))
            > 20
    );
    let mirrored = |light: &Light| {
        let other = light.xyz().map(|x| 0.0 - x);
        if light.is_directional() { Light::directional(light.xyz()) } else { Light::point(other) }.unwrap()
    };
    assert!(seen(&|mesh, p, l| auto(mesh, p, &mirrored(l))) > 10);
    let skipped = |mesh: &Mesh| {
        let (positions, mut triangles, ..) = mesh.clone().into_parts();
        let from = triangles.len() / 2;
        triangles.drain(from..);
        Mesh::new(positions, triangles).unwrap()
    };
    assert!(
        seen(&|mesh, p, l| {
            let half = skipped(mesh);
            let all_clear = auto(&half, p, l).count(StencilMethod::ZFail) == 0;
            ShellMethods::choose(
                mesh,
                &shells(mesh),
                p,
                l,
                if all_clear { Some(StencilMethod::ZPass) } else { Some(StencilMethod::ZFail) },
            )
        }) > 3
    );
}

#[test]
fn zpass_hard_cases_of_light_and_camera() {
    use StencilMethod::{ZFail, ZPass};
    let cube = shapes::cuboid([-1.0; 3], [1.0; 3]);
    let point = |x, y, z| Light::point([x, y, z]).unwrap();
    let sun = |x, y, z| Light::directional([x, y, z]).unwrap();
    let outside = ahead([0.0, 0.0, 8.0], 0.5);
    let far = (2.0_f32).powi(40);
    for (name, projection, light, expected) in [
        ("light at the eye", outside, point(0.0, 0.0, 8.0), ZPass),
        ("light behind the eye", outside, point(0.0, 1.0, 20.0), ZPass),
        ("light in the middle of the near rectangle", outside, point(0.0, 0.0, 7.5), ZPass),
        ("light on the near plane, far to the side", outside, point(90.0, 5.0, 7.5), ZPass),
        ("light between camera and caster", outside, point(0.2, 0.3, 4.0), ZPass),
        ("light beside the caster", outside, point(5.0, 0.0, 0.0), ZPass),
        ("light behind the caster: the eye is in the volume", outside, point(0.0, 0.0, -5.0), ZFail),
        ("light inside the caster", outside, point(0.1, 0.2, 0.3), ZFail),
        ("light on a corner of the caster, on the side of the eye", outside, point(1.0, 1.0, 1.0), ZPass),
        ("light on a corner of the caster, on the far side", outside, point(-1.0, -1.0, -1.0), ZFail),
        ("light far above", outside, point(0.0, far, 0.0), ZPass),
        ("light far behind the caster", outside, point(0.0, 0.0, -far), ZFail),
        ("light far behind the eye", outside, point(0.0, 0.0, far), ZPass),
        ("sun in the back", outside, sun(0.0, 0.0, -1.0), ZPass),
        ("sun in the face, the caster between", outside, sun(0.0, 0.0, 1.0), ZFail),
        ("sun in the face, the caster beside", ahead([5.0, 0.0, 8.0], 0.5), sun(0.0, 0.0, 1.0), ZPass),
        ("sun from above", outside, sun(0.0, -1.0, 0.0), ZPass),
        ("eye inside the caster", ahead([0.0; 3], 0.5), sun(0.0, -1.0, 0.0), ZFail),
        ("near plane cuts the caster", ahead([0.0, 0.0, 1.25], 0.5), sun(0.0, 0.0, -1.0), ZFail),
        ("near plane touches the caster", ahead([0.0, 0.0, 1.5], 0.5), sun(0.0, 0.0, -1.0), ZFail),
        ("near plane touches from the side", ahead([1.5, 0.0, 0.0], 0.5), sun(0.0, -1.0, 0.0), ZFail),
        (
            "near rectangle cut by a side of the volume",
            ahead([0.9, -4.0, 0.5], 0.5),
            sun(0.0, -1.0, 0.0),
            ZFail,
        ),
        (
            "near rectangle touched by a side of the volume",
            ahead([1.5, -4.0, 0.5], 0.5),
            sun(0.0, -1.0, 0.0),
            ZFail,
        ),
        ("near rectangle beside the volume", ahead([1.6, -4.0, 0.5], 0.5), sun(0.0, -1.0, 0.0), ZPass),
        (
            "near rectangle in the volume far from the caster",
            ahead([0.0, -1e6, 0.0], 0.5),
            sun(0.0, -1.0, 0.0),
            ZFail,
        ),
        (
            "the caster is behind the eye, and so is the light",
            ahead([0.0, 0.0, -4.0], 0.5),
            point(0.0, 0.0, 9.0),
            ZFail,
        ),
        (
            "the caster is behind the eye, the light before it",
            ahead([0.0, 0.0, -4.0], 0.5),
            point(0.0, 0.0, -9.0),
            ZPass,
        ),
    ] {
        let plan = auto(&cube, &projection, &light);
        assert_eq!(plan.choices[0].what, expected, "{name}");
        let reason = if expected == ZPass { Reason::NothingBetween } else { Reason::MayLieBetween };
        assert_eq!(plan.choices[0].why, reason);
        assert_eq!(miscounted(&cube, &projection, &light, &plan), None, "{name}");
    }
}

#[test]
fn zpass_does_not_depend_on_the_size_of_the_scene_until_numbers_leave_f32() {
    let cube = shapes::cuboid([-1.0; 3], [1.0; 3]);
    for k in [-100, -60, 0, 60, 100] {
        let scale = 2.0_f32.powi(k);
        let mesh = shapes::scaled(&cube, scale);
        let projection = ahead([0.0, 0.0, 8.0 * scale], 0.5 * scale);
        let method = |light: [f32; 3]| {
            auto(&mesh, &projection, &Light::point(light.map(|x| x * scale)).unwrap()).choices[0].what
        };
        assert_eq!(method([0.0, 9.0, 2.0]), StencilMethod::ZPass, "2^{k}");
        assert_eq!(method([0.0, 0.0, -9.0]), StencilMethod::ZFail, "2^{k}");
    }
    // Nothing is claimed if a shader's numbers may overflow, or if the projection is invalid.
    let huge = shapes::cuboid([-3e38; 3], [3e38, 3e38, -1e38]);
    let light = Light::directional([0.0, 0.0, -1.0]).unwrap();
    assert_eq!(auto(&huge, &ahead([0.0; 3], 1.0), &light).choices[0].what, StencilMethod::ZFail);
    for broken in [
        Projection { near: 0.0, ..ahead([0.0, 0.0, 8.0], 1.0) },
        Projection { near: f32::NAN, ..ahead([0.0, 0.0, 8.0], 1.0) },
        Projection { right: [f32::NAN; 3], ..ahead([0.0, 0.0, 8.0], 1.0) },
        Projection { forward: [0.0; 3], ..ahead([0.0, 0.0, 8.0], 1.0) },
    ] {
        assert_eq!(auto(&cube, &broken, &light).choices[0].what, StencilMethod::ZFail, "{broken:?}");
    }
}

#[test]
fn zpass_is_decided_for_each_shell_by_itself() {
    let aside = shapes::translated(&shapes::cube(), [40.0, 0.0, 0.0]);
    let mesh = Mesh::concat(&[shapes::cube(), aside, shapes::translated(&shapes::cube(), [0.0, 0.0, -9.0])])
        .unwrap();
    let (projection, light) = (ahead([0.0, 0.0, 8.0], 0.1), Light::point([0.0, 0.0, -5.0]).unwrap());
    let plan = auto(&mesh, &projection, &light);
    let methods: Vec<&str> = plan.choices.iter().map(|choice| choice.what.name()).collect();
    assert_eq!(methods, ["zfail", "zpass", "zpass"]);
    assert_eq!(
        plan.summary(),
        "zpass for 2 shells: no face of the shell can lie between the light and the near rectangle of the camera; \
         zfail for 1 shell: a face of the shell may lie between the light and the near rectangle of the camera"
    );
    let boxes = ShellBoxes::new(&mesh, &shells(&mesh));
    assert_eq!(boxes.choose(&mesh, &projection, &light), plan);
    for (asked, words) in [
        (Some(StencilMethod::ZPass), "zpass for 3 shells: z-pass was asked for; nothing is proven"),
        (Some(StencilMethod::ZFail), "zfail for 3 shells: z-fail was asked for"),
    ] {
        assert_eq!(ShellMethods::choose(&mesh, &shells(&mesh), &projection, &light, asked).summary(), words);
    }
    let empty = Mesh::new(vec![[0.0; 3]], vec![[0, 0, 0]]).unwrap();
    assert_eq!(auto(&empty, &projection, &light).summary(), "nothing casts");
}

/// The largest number of faces that any of many rays from the light crosses: rays through points of every
/// face.
fn most_seen(mesh: &Mesh, light: &Light) -> u32 {
    let oracle = Oracle::build(mesh);
    let mut most = 0;
    for face in 0..mesh.face_count() {
        let [a, b, c] = mesh.corners(FaceId::new(face)).map(wide);
        for [s, t, u] in [[0.4, 0.35, 0.25], [0.9, 0.06, 0.04], [0.05, 0.92, 0.03], [0.02, 0.05, 0.93]] {
            let through = a * s + b * t + c * u;
            let away = if light.is_directional() { -wide(light.xyz()) } else { through - wide(light.xyz()) };
            let beyond = through + away * (100.0 / away.length().max(1e-9));
            let crossings = oracle.crossings(narrow(beyond), light);
            most = most.max(crossings.front + crossings.back);
        }
    }
    most
}

fn layers(mesh: &Mesh, light: &Light, limit: u32) -> DepthComplexity {
    max_depth_complexity(mesh, &CasterFaces::All.signs(&classify(mesh, light)), light, limit)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(600))]

    #[test]
    fn layers_no_ray_crosses_more_than_the_bound(mesh in soup(60), light in light(), limit in 1_u32..20) {
        let bound = layers(&mesh, &light, limit);
        let seen = most_seen(&mesh, &light);
        prop_assert!(seen <= bound.at_most(), "{} crossed, {:?}", seen, bound);
        prop_assert_eq!(bound.is_below(), bound.at_most() < limit);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    #[test]
    fn layers_a_light_anywhere_around_a_surface_is_bounded(at in place(), torus in any::<bool>(), limit in 3_u32..80) {
        let mesh = if torus { shapes::torus(40, 20, 2.0, 0.75) } else { shapes::icosphere(3) };
        let light = Light::point(at).unwrap();
        let bound = layers(&mesh, &light, limit);
        prop_assert!(most_seen(&mesh, &light) <= bound.at_most());
        prop_assert!(limit < 60 || bound.is_below(), "{:?}", bound);
    }
}

#[test]
fn layers_nested_cubes_reach_the_limit_when_they_do() {
    let far = 2.0_f32.powi(40);
    for light in [
        Light::point([1000.0, 2000.0, 1500.0]).unwrap(),
        Light::directional([-0.3, -1.0, -0.2]).unwrap(),
        Light::point([0.3 * far, far, 0.2 * far]).unwrap(),
    ] {
        for (count, below) in [(100, true), (128, false), (256, false), (300, false)] {
            let mesh = shapes::nested_cubes(count);
            let bound = layers(&mesh, &light, 256);
            // A ray through the center crosses both sides of every cube.
            assert_eq!(most_seen(&mesh, &light).max(2 * count), 2 * count);
            assert!(bound.at_most() >= 2 * count, "{count}: {bound:?}");
            assert_eq!(bound.is_below(), below, "{count}: {bound:?}");
            // With front faces alone, half of them.
            let front =
                max_depth_complexity(&mesh, &CasterFaces::Front.signs(&classify(&mesh, &light)), &light, 256);
            assert!(front.at_most() >= count);
            assert_eq!(front.is_below(), count < 256, "{count}: {front:?}");
        }
        // With the light in the center, a ray crosses every cube once.
        let inside = Light::point([0.1, 0.2, 0.3]).unwrap();
        assert!(layers(&shapes::nested_cubes(60), &inside, 256).is_below());
        assert!(!layers(&shapes::nested_cubes(256), &inside, 256).is_below());
    }
}

#[test]
fn layers_of_256_and_more_are_counted_in_integers_and_255_in_the_stencil() {
    let (right, up, forward) = ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]);
    let kind = ProjectionKind::InfinitePerspective;
    let camera = Projection { eye: [0.2, 0.3, 999.0], right, up, forward, near: 0.1, kind };
    let light = Light::directional([0.0, 0.0, -1.0]).unwrap();
    for (count, wanted) in [
        (255, Counting::Stencil),
        (256, Counting::Integer),
        (257, Counting::Integer),
        (258, Counting::Integer),
    ] {
        // Triangles above each other: no edge where two of one layer would be counted.
        let triangle = |z: u32| [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]].map(|[x, y]| [x, y, z as f32]);
        let faces = (0..count).map(|z| [3 * z, 3 * z + 1, 3 * z + 2]).collect();
        let caster = Caster::new(Mesh::new((0..count).flat_map(triangle).collect(), faces).unwrap());
        // 256 layers wrap to 0 in eight bits, which reads as lit.
        let volumes = caster.stencil_volumes(&light, &camera, None, None);
        assert_eq!(volumes.counting(), wanted, "{count} layers");
    }
}

#[test]
fn layers_a_face_that_is_left_out_is_seen_by_the_rays() {
    // Ten triangles above each other, and forty with no other triangle behind them.
    let at = |x: f32, z: f32| [[x, 0.0, z], [x + 1.0, 0.0, z], [x, 1.0, z]];
    let stack = (0..10).map(|k| at(0.0, k as f32));
    let corners: Vec<[f32; 3]> = stack.chain((1..=40).map(|k| at(2.0 * k as f32, 0.0))).flatten().collect();
    let mesh = Mesh::new(corners, (0..50).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect()).unwrap();
    let light = Light::directional([0.01, 0.02, -1.0]).unwrap();
    let mut signs = CasterFaces::All.signs(&classify(&mesh, &light));
    let seen = most_seen(&mesh, &light);
    assert_eq!(seen, 10);
    assert!(max_depth_complexity(&mesh, &signs, &light, 11).is_below());
    assert!(max_depth_complexity(&mesh, &signs, &light, 10).at_most() >= seen);
    signs[4] = 0;
    assert!(max_depth_complexity(&mesh, &signs, &light, 10).at_most() < seen, "the fault is not seen");
}

#[test]
fn layers_fewer_faces_than_the_limit_need_no_search() {
    let light = Light::point([8.5, 9.5, 7.0]).unwrap();
    assert_eq!(layers(&shapes::cube(), &light, 256), DepthComplexity::Below(12));
    assert_eq!(layers(&Mesh::default(), &light, 1), DepthComplexity::Below(0));
    assert_eq!(layers(&Mesh::default(), &light, 0), DepthComplexity::Below(0));
    assert_eq!(
        layers(&shapes::cube(), &light, 256).to_string(),
        "no ray from the light crosses more than 12 casting faces"
    );
}

#[test]
fn layers_of_real_meshes_fit_eight_bits() {
    let Some(folder) = real_meshes() else { return };
    for name in [
        "igea.glb",
        "menger_sponge3.glb",
        "tray_bottom_1002.stl",
        "teapot.obj",
        "boeing.obj",
        "many-cubes.gltf",
    ] {
        let meshes = umbrage::read::read(folder.join(name)).unwrap().bake(Scope::Scene).unwrap();
        let [low, high] = meshes[0].bounds().unwrap().map(wide);
        let (center, size) = ((low + high) / 2.0, (high - low).length());
        for light in [
            Light::point(narrow(center + size * DVec3::new(0.8, 1.9, 1.1))),
            Light::point(narrow(center)),
            Light::directional([-0.4, -1.0, -0.3]),
        ] {
            let light = light.unwrap();
            let start = std::time::Instant::now();
            let bound = layers(&meshes[0], &light, 256);
            eprintln!("{name}, {light}: {bound:?}, {:?} with signs", start.elapsed());
            assert!(bound.is_below(), "{name}, {light}: {bound:?}");
        }
    }
}
