//! Scenes whose openness is known in closed form, and what would be wrong without each of the rules.

use std::f64::consts::TAU;

use glam::DVec3;

use super::lattice::{Lattice, shift};
use super::start::Start;
use super::*;
use crate::mesh::{FaceId, Mesh};
use crate::oracle::Oracle;
use crate::oracle::area::SoftOracle;
use crate::testing::shapes;

pub(super) const UP: [f32; 3] = [0.0, 0.0, 1.0];

/// Rays in these tests: their error is about 1.3e-3 where an outline crosses the hemisphere.
pub(super) const RAYS: u32 = 2048;
pub(super) const CLOSE: f64 = 4e-3;

/// A mesh of quads, each cut into two faces.
pub(super) fn quads(corners: &[[[f32; 3]; 4]]) -> Mesh {
    let faces = (0..corners.len() as u32)
        .flat_map(|i| [[4 * i, 4 * i + 1, 4 * i + 2], [4 * i, 4 * i + 2, 4 * i + 3]]);
    Mesh::new(corners.as_flattened().to_vec(), faces.collect()).unwrap()
}

pub(super) fn exactly(rays: u32) -> RayOptions {
    RayOptions { effort: Effort::Rays(rays), ring: Ring::Off, ..RayOptions::default() }
}

fn cast(meshes: &[&Mesh], receivers: &Receivers, options: &RayOptions) -> Ambient {
    Ambient::by_rays(&Oracle::over(meshes), receivers, options, &|_| {}).0
}

pub(super) fn one(point: [f32; 3], normal: [f32; 3], face: Option<FaceId>) -> Receivers {
    let list = vec![Receiver { point, normal: Some(normal), face }];
    Receivers { list, ..Receivers::default() }
}

/// Openness of one receiver.
pub(super) fn open(mesh: &Mesh, point: [f32; 3], normal: [f32; 3]) -> f64 {
    f64::from(cast(&[mesh], &one(point, normal, None), &exactly(RAYS)).openness[0])
}

/// The mean of what rays find that are drawn evenly from the hemisphere, without the cosine.
pub(super) fn open_evenly(mesh: &Mesh, point: [f32; 3], normal: [f32; 3]) -> f64 {
    let oracle = Oracle::build(mesh);
    let start = Start::at(&oracle, &one(point, normal, None), 0);
    let above = |d: &[f32; 3]| (0..3).map(|i| d[i] * normal[i]).sum::<f32>() > 0.0;
    let lattice = Lattice::new(2 * RAYS);
    let directions = lattice.directions(None, shift(1, point)).filter(above);
    let hidden: f64 = directions.map(|d| start.hidden(&oracle, d, Reach::Unlimited)).sum();
    1.0 - hidden / f64::from(RAYS)
}

pub(super) fn is_close(found: f64, expected: f64) {
    assert!((found - expected).abs() < CLOSE, "{found} is not {expected}");
}

/// Form factor of a rectangle x by y, over its height, with one corner above the receiver.
fn corner(x: f64, y: f64) -> f64 {
    let part = |x: f64, y: f64| x / (1.0 + x * x).sqrt() * (y / (1.0 + x * x).sqrt()).atan();
    (part(x, y) + part(y, x)) / TAU
}

#[test]
fn a_long_wall_hides_by_its_height_over_its_distance() {
    for (height, distance) in [(1.0_f32, 1.0_f32), (3.0, 0.5), (0.25, 1.0)] {
        let far = 1e5;
        let wall = quads(&[[
            [distance, -far, 0.0],
            [distance, far, 0.0],
            [distance, far, height],
            [distance, -far, height],
        ]]);
        let expected = 0.5 * (1.0 + 1.0 / (1.0 + f64::from(height / distance).powi(2)).sqrt());
        is_close(open(&wall, [0.0; 3], UP), expected);
        assert!((open_evenly(&wall, [0.0; 3], UP) - expected).abs() > 5.0 * CLOSE);
    }
}

#[test]
fn the_floor_of_a_box_pit_and_a_point_under_a_disk_have_their_form_factors() {
    let pit = |depth: f32| {
        quads(&[
            [[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]],
            [[-1.0, -1.0, 0.0], [-1.0, 1.0, 0.0], [-1.0, 1.0, depth], [-1.0, -1.0, depth]],
            [[1.0, 1.0, 0.0], [1.0, -1.0, 0.0], [1.0, -1.0, depth], [1.0, 1.0, depth]],
            [[1.0, -1.0, 0.0], [-1.0, -1.0, 0.0], [-1.0, -1.0, depth], [1.0, -1.0, depth]],
            [[-1.0, 1.0, 0.0], [1.0, 1.0, 0.0], [1.0, 1.0, depth], [-1.0, 1.0, depth]],
        ])
    };
    assert!((4.0 * corner(0.5, 0.5) - 0.239_456_470_461).abs() < 1e-12);
    for depth in [0.5_f32, 2.0] {
        let x = 1.0 / f64::from(depth);
        is_close(open(&pit(depth), [0.0; 3], UP), 4.0 * corner(x, x));
        assert!((open_evenly(&pit(depth), [0.0; 3], UP) - 4.0 * corner(x, x)).abs() > 5.0 * CLOSE);
    }
    let sides = 200_u32;
    let mut rim: Vec<[f32; 3]> = (0..sides)
        .map(|i| TAU * f64::from(i) / f64::from(sides))
        .map(|turn| [turn.cos() as f32, turn.sin() as f32, 2.0])
        .collect();
    rim.push([0.0, 0.0, 2.0]);
    let disk = Mesh::new(rim, (0..sides).map(|i| [i, (i + 1) % sides, sides]).collect()).unwrap();
    is_close(open(&disk, [0.0; 3], UP), 1.0 - 1.0 / 5.0);
}

#[test]
fn inside_a_closed_shell_nothing_is_open_however_thin_it_is_and_with_an_offset_it_leaks() {
    let thin = shapes::cuboid([-1.0, -1.0, 0.0], [1.0, 1.0, 5e-4]);
    for solid in [shapes::torus(16, 8, 2.0, 0.7), shapes::menger_sponge(1), thin.clone()] {
        let turned = shapes::inside_out(&solid);
        for per in [Per::Vertex, Per::Corner, Per::Face] {
            let receivers = Receivers::of(&[&turned], per);
            let found = cast(&[&turned], &receivers, &exactly(32));
            assert!(found.openness.iter().all(|&open| open == 0.0), "{} {per:?}", solid.name);
            assert!(found.inside.is_empty());
        }
    }
    let turned = shapes::inside_out(&thin);
    let mut moved = Receivers::of(&[&turned], Per::Corner);
    for receiver in &mut moved.list {
        let normal = receiver.normal.unwrap();
        receiver.point = [0, 1, 2].map(|i| receiver.point[i] + 1e-3 * normal[i]);
    }
    assert!(cast(&[&turned], &moved, &exactly(32)).openness.iter().any(|&open| open > 0.1));
}

#[test]
fn on_a_convex_solid_everything_is_open() {
    for solid in [
        shapes::cube(),
        shapes::tetrahedron(),
        shapes::icosphere(2),
        shapes::cuboid([0.1, 0.7, -3.0], [0.3, 0.9, -2.999]),
        shapes::scaled(&shapes::octahedron(), 1e-30),
    ] {
        for per in [Per::Vertex, Per::Corner, Per::Face] {
            let receivers = Receivers::of(&[&solid], per);
            let found = cast(&[&solid], &receivers, &exactly(64));
            assert!(found.openness.iter().all(|&open| open == 1.0), "{} {per:?}", solid.name);
            assert_eq!(found.standard_error, Some(0.0));
        }
    }
}

#[test]
fn a_sphere_over_a_plane_hides_by_the_cosine_and_the_square_of_its_distance() {
    let (x, z) = (1.5_f32, 1.25_f32);
    let sphere = shapes::translated(&shapes::icosphere(3), [x, 0.0, z]);
    let (x, z) = (f64::from(x), f64::from(z));
    let expected = 1.0 - z / (x * x + z * z).powf(1.5);
    is_close(open(&sphere, [0.0; 3], UP), expected);
    assert!((open_evenly(&sphere, [0.0; 3], UP) - expected).abs() > 3.0 * CLOSE);
}

/// Two sides that rise from the y-axis with the slope 3 : 4, far longer than wide is what is asked about.
fn groove() -> Mesh {
    let (far, wide, high) = (4e4, 4e3, 3e3);
    quads(&[
        [[0.0, -far, 0.0], [wide, -far, high], [wide, 0.0, high], [0.0, 0.0, 0.0]],
        [[0.0, 0.0, 0.0], [wide, 0.0, high], [wide, far, high], [0.0, far, 0.0]],
        [[0.0, -far, 0.0], [0.0, 0.0, 0.0], [-wide, 0.0, high], [-wide, -far, high]],
        [[0.0, 0.0, 0.0], [0.0, far, 0.0], [-wide, far, high], [-wide, 0.0, high]],
    ])
}

#[test]
fn a_vertex_on_the_line_of_a_groove_sees_the_cosine_of_its_slope_by_the_rule_of_the_fan() {
    let groove = groove();
    let all = Receivers::of(&[&groove], Per::Vertex);
    let at = all.list.iter().position(|receiver| receiver.point == [0.0; 3]).unwrap();
    let receiver = all.list[at];
    assert!((receiver.normal.unwrap()[2] - 1.0).abs() < 1e-6);
    let found = cast(&[&groove], &all, &exactly(RAYS));
    is_close(f64::from(found.openness[at]), 0.8);
    let oracle = Oracle::build(&groove);
    let start = Start::at(&oracle, &all, at).without_fan();
    let lattice = Lattice::new(RAYS);
    let mut directions = lattice.directions(receiver.normal, [0.0; 2]);
    assert!(directions.all(|direction| start.hidden(&oracle, direction, Reach::Unlimited) == 0.0));
}

#[test]
fn a_face_of_a_groove_sees_the_squared_cosine_and_not_itself() {
    let groove = groove();
    let (point, normal) = ([4.0, -0.5, 3.0], [-0.6, 0.0, 0.8]);
    let corners = |face: u32| groove.corners(FaceId(face));
    let own = (0..2).find(|&face| crate::geom::predicate::on_triangle(corners(face), point)).unwrap();
    let found = cast(&[&groove], &one(point, normal, Some(FaceId(own))), &exactly(RAYS));
    is_close(f64::from(found.openness[0]), 0.64);
    // Rounded behind its own face, it is black unless that face is left out.
    let behind = [4.0, -0.5, 3_f32.next_down()];
    let found = cast(&[&groove], &one(behind, normal, Some(FaceId(own))), &exactly(RAYS));
    is_close(f64::from(found.openness[0]), 0.64);
    assert_eq!(cast(&[&groove], &one(behind, normal, None), &exactly(64)).openness[0], 0.0);
}

#[test]
fn a_box_on_the_ground_sees_half_the_sky_beside_its_foot() {
    // The ground contains the receiver without having it as a corner.
    let ground = quads(&[[[-9.0, -9.0, 0.0], [9.0, -9.0, 0.0], [9.0, 9.0, 0.0], [-9.0, 9.0, 0.0]]]);
    let block = shapes::cuboid([-1.0, -1.0, 0.0], [1.0, 1.0, 2.0]);
    let slab = shapes::cuboid([-9.0, -9.0, -1.0], [9.0, 9.0, 0.0]);
    for below in [&ground, &slab] {
        let meshes = [&block, below];
        let receivers = Receivers::of(&meshes, Per::Corner);
        let found = cast(&meshes, &receivers, &exactly(256));
        for (index, (receiver, &open)) in (0..).zip(receivers.list.iter().zip(&found.openness)) {
            let normal = receiver.normal.unwrap();
            if receiver.point[0].abs() == 1.0 && receiver.point[2] == 0.0 {
                if normal[2] == 0.0 {
                    assert!((open - 0.5).abs() < 0.02, "{open}");
                }
                // Its bottom lies in the solid of the slab, if there is one.
                assert_eq!(found.inside.contains(&index), below.face_count() == 12 && normal[2] < 0.0);
            }
        }
    }
}

/// A mesh that is turned about two axes, so that no side lies along one and every coordinate is rounded.
fn tilted(mesh: &Mesh) -> Mesh {
    let turn = glam::DMat3::from_rotation_x(0.7) * glam::DMat3::from_rotation_z(0.4);
    let turned = |p: &[f32; 3]| (turn * DVec3::from(p.map(f64::from))).to_array().map(|x| x as f32);
    Mesh::new(mesh.positions().iter().map(turned).collect(), mesh.triangles().to_vec()).unwrap()
}

/// By the analytic form, per corner.
fn analytic(mesh: &Mesh) -> Vec<f64> {
    let receivers = Receivers::of(&[mesh], Per::Corner);
    exact_part(&SoftOracle::build(mesh), &receivers, 0..receivers.list.len()).openness
}

#[test]
fn at_hard_edges_a_receiver_is_on_its_own_side_of_walls_that_contain_its_normal() {
    // A closed room of two parts, convex and not, and its outside.
    let room = shapes::voxels([2, 2, 1], |[x, y, _]| x + y < 2);
    for solid in [
        room.clone(),
        tilted(&room),
        tilted(&shapes::cube()),
        tilted(&shapes::cuboid([0.0; 3], [1.0, 2.0, 1e-3])),
    ] {
        let inside = shapes::inside_out(&solid);
        let found = cast(&[&inside], &Receivers::of(&[&inside], Per::Corner), &exactly(64));
        assert!(found.openness.iter().all(|&open| open == 0.0), "{found:?}");
        assert!(analytic(&inside).iter().all(|&open| open < 1e-6), "{:?}", analytic(&inside));
        let outside = cast(&[&solid], &Receivers::of(&[&solid], Per::Corner), &exactly(64));
        let convex = solid.face_count() == 12;
        assert!(outside.openness.iter().all(|&open| open == 1.0 || (!convex && open > 0.2)), "{outside:?}");
    }
    // Both sides of a sheet that is folded by a right angle, where each face has a reversed copy. At the end
    // of the fold, halfway between the edges of its face, a receiver sees five eighths of the circle.
    let fold = quads(&[
        [[0.0, 0.0, 0.0], [9.0, 0.0, 0.0], [9.0, 9.0, 0.0], [0.0, 9.0, 0.0]],
        [[0.0, 0.0, 0.0], [0.0, 9.0, 0.0], [0.0, 9.0, 9.0], [0.0, 0.0, 9.0]],
    ]);
    let both = Mesh::concat(&[fold.clone(), shapes::inside_out(&fold)]).unwrap();
    for mesh in [both.clone(), tilted(&both)] {
        let receivers = Receivers::of(&[&mesh], Per::Corner);
        let found = cast(&[&mesh], &receivers, &exactly(256));
        assert!(analytic(&mesh).iter().zip(&found.openness).all(|(a, &b)| (a - f64::from(b)).abs() < 0.02));
        for (face, corners) in receivers.corners().iter().enumerate() {
            for (corner, &receiver) in mesh.triangles()[face].iter().zip(corners) {
                let [x, _, z] = both.positions()[*corner as usize];
                let (is_at_fold, open) = (x == 0.0 && z == 0.0, found.openness[receiver as usize]);
                let fits = match face {
                    4.. => open == 1.0,
                    _ if is_at_fold => (open - 0.625).abs() < 0.02,
                    _ => open > 0.9 && open < 0.99,
                };
                assert!(fits, "{open} at corner {corner} of face {face}");
            }
        }
    }
}

#[test]
fn bent_normals_point_away_from_a_wall() {
    let wall = quads(&[[[1.0, -9.0, 0.0], [1.0, 9.0, 0.0], [1.0, 9.0, 9.0], [1.0, -9.0, 9.0]]]);
    let receivers = one([0.0; 3], UP, None);
    let bent = |mesh: &Mesh| {
        let options = RayOptions { bent: true, ..exactly(RAYS) };
        DVec3::from(cast(&[mesh], &receivers, &options).bent.unwrap()[0].map(f64::from))
    };
    let away = bent(&wall);
    assert!(away.x < -0.3 && away.z > 0.5 && (away.length() - 1.0).abs() < 1e-6, "{away}");
    // An open hemisphere bends nothing; in a closed shell there is no direction.
    let far = shapes::translated(&shapes::cube(), [0.0, 0.0, -9.0]);
    assert!((bent(&far) - DVec3::Z).length() < CLOSE);
    assert_eq!(bent(&shapes::inside_out(&shapes::cube())), DVec3::ZERO);
}

#[test]
fn reach_ends_what_hides_and_fading_weighs_it_by_its_distance() {
    // A ceiling at height 1: the cosine of the least angle that escapes is 1 / D.
    let ceiling = quads(&[[[-1e4, -1e4, 1.0], [1e4, -1e4, 1.0], [1e4, 1e4, 1.0], [-1e4, 1e4, 1.0]]]);
    let found = |reach| {
        let options = RayOptions { reach, ..exactly(RAYS) };
        f64::from(cast(&[&ceiling], &one([0.0; 3], UP, None), &options).openness[0])
    };
    is_close(found(Reach::Unlimited), 0.0);
    is_close(found(Reach::Within(2.0)), 0.25);
    assert_eq!(found(Reach::Within(0.5)), 1.0);
    // 1 − ∫ 2c (1 − 1 / (c·D)) dc from 1/D to 1 = 1 − (1 − 1/D)².
    is_close(found(Reach::Fading(2.0)), 0.75);
    is_close(found(Reach::Fading(10.0)), 1.0 - 0.81);
    for nothing in [Reach::Within(0.0), Reach::Fading(-1.0), Reach::Within(f32::NAN)] {
        assert_eq!(found(nothing), 1.0);
    }
    assert!(found(Reach::Within(f32::MAX)) < CLOSE && found(Reach::Within(f32::INFINITY)) < CLOSE);
}

#[test]
fn both_sides_of_a_sheet_see_the_whole_sphere() {
    // A half-space of it is hidden by a wide wall.
    let wall = quads(&[[[-1e4, -1e4, 1.0], [1e4, -1e4, 1.0], [1e4, 1e4, 1.0], [-1e4, 1e4, 1.0]]]);
    let receivers = Receivers {
        list: vec![Receiver { point: [0.0; 3], normal: None, face: None }],
        ..Receivers::default()
    };
    let options = RayOptions { bent: true, ..exactly(RAYS) };
    let found = cast(&[&wall], &receivers, &options);
    is_close(f64::from(found.openness[0]), 0.5);
    assert!((found.bent.unwrap()[0][2] + 1.0).abs() < 1e-3);
}

#[test]
fn another_caster_never_opens_anything() {
    let (torus, cube) =
        (shapes::torus(16, 8, 2.0, 0.7), shapes::translated(&shapes::cube(), [0.3, 0.1, 1.5]));
    let receivers = Receivers::of(&[&torus], Per::Corner);
    let [alone, both] =
        [&[&torus][..], &[&torus, &cube]].map(|meshes| cast(meshes, &receivers, &exactly(64)).openness);
    assert!(alone.iter().zip(&both).all(|(alone, both)| both <= alone));
    assert!(alone != both);
}

#[test]
fn scaling_by_a_power_of_two_changes_no_bit() {
    let mesh = shapes::torus_knot(2, 3, 16, 5, 0.4);
    let found = |scale: f32| {
        let mesh = shapes::scaled(&mesh, scale);
        let receivers = Receivers::of(&[&mesh], Per::Corner);
        [Reach::Unlimited, Reach::Within(0.5 * scale), Reach::Fading(2.0 * scale)].map(|reach| {
            let options = RayOptions { reach, bent: true, ring: Ring::On, ..exactly(16) };
            cast(&[&mesh], &receivers, &options)
        })
    };
    let one = found(1.0);
    assert_eq!((found(2_f32.powi(-40)), found(2_f32.powi(30))), (one.clone(), one.clone()));
    assert_ne!(found(3.0), one); // other positions, other directions
}

#[test]
#[cfg(feature = "parallel")]
fn any_number_of_threads_gives_the_same_bits() {
    let mesh = shapes::torus_knot(2, 3, 24, 5, 0.4);
    let receivers = Receivers::of(&[&mesh], Per::Corner);
    let options = RayOptions { bent: true, ring: Ring::On, ..exactly(16) };
    let [few, many] = [1, 5].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let done = std::sync::atomic::AtomicU64::new(0);
        let found = pool.install(|| {
            let progress = |more| _ = done.fetch_add(more, std::sync::atomic::Ordering::Relaxed);
            Ambient::by_rays(&Oracle::build(&mesh), &receivers, &options, &progress)
        });
        assert_eq!(done.into_inner(), receivers.list().len() as u64);
        found
    });
    assert_eq!(few, many);
    let other_seed = RayOptions { seed: 2, ..options };
    assert_ne!(cast(&[&mesh], &receivers, &other_seed), few.0);
}

#[test]
fn overlapping_solids_bury_what_lies_in_the_other_and_rooms_bury_nothing() {
    let (a, b) = (shapes::cube(), shapes::cuboid([0.0; 3], [3.0; 3]));
    let meshes = [&a, &b];
    let receivers = Receivers::of(&meshes, Per::Corner);
    let found = cast(&meshes, &receivers, &exactly(64));
    let points: Vec<_> = found.inside.iter().map(|&index| receivers.list[index as usize].point).collect();
    assert_eq!(points, [[[1.0; 3]; 3], [[0.0; 3]; 3]].concat());
    assert!(found.inside.iter().all(|&index| found.openness[index as usize] == 0.0));
    // In a room whose faces look inwards, or between thick walls, a short reach leaves all open.
    let room = shapes::inside_out(&shapes::cuboid([-5.0; 3], [5.0; 3]));
    let outer = shapes::cuboid([-6.0; 3], [6.0; 3]);
    for walls in [vec![&a, &room], vec![&a, &room, &outer]] {
        let receivers = Receivers::of(&walls, Per::Corner);
        let options = RayOptions { reach: Reach::Within(1.0), ..exactly(16) };
        let found = cast(&walls, &receivers, &options);
        assert!(found.inside.is_empty() && found.openness[..24].iter().all(|&open| open == 1.0));
        let unlimited = cast(&walls, &receivers, &exactly(16));
        assert!(unlimited.openness[..24].iter().all(|&open| open == 0.0));
    }
    // An open box is no solid.
    let open = shapes::scaled(&shapes::open_cube(), 4.0);
    let meshes = [&a, &open];
    assert!(cast(&meshes, &Receivers::of(&meshes, Per::Corner), &exactly(16)).inside.is_empty());
}

#[test]
fn a_wanted_error_is_met_and_more_rays_are_asked_for_where_it_is_smaller() {
    let mesh = shapes::torus_knot(2, 3, 20, 5, 0.5);
    let receivers = Receivers::of(&[&mesh], Per::Corner);
    let oracle = Oracle::build(&mesh);
    let truth = cast(&[&mesh], &receivers, &RayOptions { seed: 9, ..exactly(256) });
    let mut last = 0;
    for wanted in [0.2, 0.06] {
        let options = RayOptions { effort: Effort::Error(wanted), ..RayOptions::default() };
        let (found, cast) = Ambient::by_rays(&oracle, &receivers, &options, &|_| {});
        let squares = found.openness.iter().zip(&truth.openness).map(|(a, b)| f64::from(a - b).powi(2));
        let error = (squares.sum::<f64>() / truth.openness.len() as f64).sqrt();
        assert!(error < 1.5 * wanted, "{error} for {wanted}");
        assert!(found.standard_error.is_some_and(|stated| stated < 1.3 * wanted && stated > 0.3 * error));
        assert!(cast.rays > last && !cast.ring);
        last = cast.rays;
    }
    for (effort, rays) in [(Effort::Rays(0), 1), (Effort::Error(10.0), 1)] {
        let options = RayOptions { effort, ..exactly(1) };
        assert_eq!(Ambient::by_rays(&oracle, &receivers, &options, &|_| {}).1.rays, rays);
    }
}

#[test]
fn the_mean_over_a_ring_helps_on_a_fine_mesh() {
    // A fine floor under a sphere, whose openness is known.
    let floor = shapes::scaled(&shapes::sheet(48), 1.0 / 6.0);
    let sphere = shapes::translated(&shapes::icosphere(2), [4.0, 4.0, 1.5]);
    let meshes = [&floor, &sphere];
    let receivers = Receivers::of(&[&floor], Per::Corner);
    let error = |ring: Ring, rays: u32| {
        let options = RayOptions { ring, ..exactly(rays) };
        let (found, cast) = Ambient::by_rays(&Oracle::over(&meshes), &receivers, &options, &|_| {});
        let squares = receivers.list.iter().zip(&found.openness).map(|(receiver, &open)| {
            let flat = f64::from((receiver.point[0] - 4.0).hypot(receiver.point[1] - 4.0));
            let truth = 1.0 - 1.5 / (flat * flat + 1.5 * 1.5).powf(1.5);
            (f64::from(open) - truth).powi(2)
        });
        ((squares.sum::<f64>() / receivers.list.len() as f64).sqrt(), cast.ring)
    };
    let [(plain, _), (shared, is_shared)] = [error(Ring::Off, 6), error(Ring::Auto, 6)];
    assert!(is_shared && shared < 0.6 * plain, "{shared} {plain}");
    assert!(ring::helps(64) && !ring::helps(65));
}

#[test]
fn the_mean_over_a_ring_keeps_edges_of_the_openness() {
    // Coarse, and with deep holes: neighbors see very different parts of the sky.
    let mesh = shapes::menger_sponge(1);
    let receivers = Receivers::of(&[&mesh], Per::Corner);
    let soft = SoftOracle::build(&mesh);
    let truth = exact_part(&soft, &receivers, 0..receivers.list.len()).openness;
    let error = |values: &mut dyn Iterator<Item = f32>| {
        truth.iter().zip(values).map(|(truth, value)| (truth - f64::from(value)).abs()).sum::<f64>()
    };
    let values = |ring: Ring| {
        let options = RayOptions { ring, effort: Effort::Rays(64), ..RayOptions::default() };
        Ambient::by_rays(soft.oracle(), &receivers, &options, &|_| {}).0.openness
    };
    let plain = values(Ring::Off);
    let [alone, shared] = [plain.clone(), values(Ring::Auto)].map(|found| error(&mut found.into_iter()));
    assert!(shared < 1.1 * alone, "{}: {shared} {alone}", mesh.name);
    // The sabotage: neighbors share whatever their values are.
    let samples: Vec<rays::Sample> =
        plain.iter().map(|&openness| rays::Sample { openness, ..rays::Sample::default() }).collect();
    let all = ring::Pairs::of(&receivers).smooth(&receivers.list, &samples, f64::INFINITY);
    let blurred = error(&mut all.iter().map(|sample| sample.openness));
    assert!(blurred > 2.0 * alone, "{}: {blurred} {alone}", mesh.name);
}
