//! Points under an even sky whose open share is known in closed form, and the faults that each would catch.

use std::f64::consts::PI;

use glam::DVec3;

use super::closed_tests::{quads, triangles};
use super::fault::{Fault, Faults};
use super::sky::Open;
use super::*;
use crate::mesh::FaceId;
use crate::testing::shapes;

const UP: [f32; 3] = [0.0, 0.0, 1.0];

/// No receiver is at a hard edge.
const SMOOTH: HardEdges<'static> = HardEdges { off: &|_| None, is_own: &|_, _| false };

fn at(point: [f32; 3], normal: [f32; 3]) -> UnderSky {
    UnderSky { point, normal: Some(normal), face: None }
}

fn open(mesh: &Mesh, receiver: UnderSky, fault: Option<Fault>) -> Open {
    let mut soft = SoftOracle::build(mesh);
    soft.faults = Faults(fault);
    soft.open_sky(&[receiver], SMOOTH, true)[0]
}

/// The share is right to `within` and within its bound; returns it.
fn holds(mesh: &Mesh, receiver: UnderSky, share: f64, within: f64) -> f64 {
    let found = open(mesh, receiver, None);
    let off = (found.share - share).abs();
    assert!(off <= within && off <= found.bound + within, "{found:?} is not {share}");
    found.share
}

/// With the fault the share is wrong by far.
fn catches(mesh: &Mesh, receiver: UnderSky, share: f64, fault: Fault) {
    let wrong = open(mesh, receiver, Some(fault));
    assert!((wrong.share - share).abs() > 0.03, "{fault:?} is not caught: {wrong:?}");
}

/// The form factor of a rectangle x by y, over its height, with one corner above the receiver.
fn corner(x: f64, y: f64) -> f64 {
    let part = |x: f64, y: f64| x / (1.0 + x * x).sqrt() * (y / (1.0 + x * x).sqrt()).atan();
    (part(x, y) + part(y, x)) / (2.0 * PI)
}

/// A cuboid without its top, seen from inside or outside.
fn pit(low: [f32; 3], high: [f32; 3]) -> Mesh {
    let closed = shapes::cuboid(low, high);
    let is_top = |face: &[u32; 3]| face.iter().all(|&x| closed.positions()[x as usize][2] == high[2]);
    let faces = closed.triangles().iter().copied().filter(|face| !is_top(face)).collect();
    Mesh::new(closed.positions().to_vec(), faces).unwrap()
}

/// The normals of all faces at a vertex, each by its angle there.
fn normal_at(mesh: &Mesh, vertex: u32) -> [f32; 3] {
    let mut sum = DVec3::ZERO;
    for face in mesh.triangles() {
        let Some(k) = face.iter().position(|&x| x == vertex) else { continue };
        let [p, a, b] = [0, 1, 2].map(|i| wide(mesh.positions()[face[(k + i) % 3] as usize]));
        sum += (a - p).cross(b - p).normalize() * (a - p).angle_between(b - p);
    }
    sum.normalize().to_array().map(|x| x as f32)
}

fn vertices(mesh: &Mesh) -> impl Iterator<Item = UnderSky> + '_ {
    let ids = 0..mesh.vertex_count() as u32;
    ids.map(|vertex| at(mesh.positions()[vertex as usize], normal_at(mesh, vertex)))
}

#[test]
fn long_wall_leaves_what_its_height_says() {
    let long = 2f32.powi(21);
    for [distance, height] in [[1.0_f32, 1.0], [2.0, 3.0], [0.5, 16.0]] {
        let wall = quads(&[[
            [distance, -long, 0.0],
            [distance, long, 0.0],
            [distance, long, height],
            [distance, -long, height],
        ]]);
        let slope = f64::from(height / distance);
        let share = 0.5 * (1.0 + 1.0 / (1.0 + slope * slope).sqrt());
        let found = holds(&wall, at([0.0; 3], UP), share, 1e-12);
        // The sabotage: all directions alike leave 1 − φ/π, φ the angle to the top.
        assert!((1.0 - slope.atan() / PI - found).abs() > 0.005);
        catches(&wall, at([0.0; 3], UP), share, Fault::NoClosing);
    }
}

#[test]
fn middle_of_a_pit_sees_its_opening() {
    let pits = [([2.0, 2.0], 2.0, 0.239_456_470_461), ([1.0, 1.0], 4.0, 0.0), ([6.0, 6.0], 0.5, 0.0)];
    for ([a, b], depth, known) in pits {
        let (x, y, h) = (f64::from(a) / 2.0, f64::from(b) / 2.0, f64::from(depth));
        let share = 4.0 * corner(x / h, y / h);
        assert!(known == 0.0 || (share - known).abs() < 1e-12);
        let mesh = pit([-a / 2.0, -b / 2.0, 0.0], [a / 2.0, b / 2.0, depth]);
        holds(&mesh, at([0.0; 3], UP), share, 1e-13);
        // The length of a normal does not count.
        holds(&mesh, at([0.0; 3], [0.0, 0.0, 0.3]), share, 1e-13);
    }
    // The sabotage: all directions alike.
    let mesh = pit([-1.0, -1.0, 0.0], [1.0, 1.0, 2.0]);
    let alike = open(&mesh, UnderSky { point: [0.0; 3], normal: None, face: None }, None).share;
    assert!((alike - 0.239_456_470_461).abs() > 0.01, "{alike}");
}

#[test]
fn without_a_normal_every_direction_counts_alike() {
    // The sixth side of a cube, from its middle and from the middle of another side.
    let mesh = pit([-1.0; 3], [1.0; 3]);
    let middle = UnderSky { point: [0.0; 3], normal: None, face: None };
    holds(&mesh, middle, 1.0 / 6.0, 1e-14);
    catches(&mesh, middle, 1.0 / 6.0, Fault::NoClosing);
    // A square at height h, side 2a, takes up 4·asin(a²/(a² + h²)).
    let lid = quads(&[[[-3.0, -3.0, 1.0], [3.0, -3.0, 1.0], [3.0, 3.0, 1.0], [-3.0, 3.0, 1.0]]]);
    holds(&lid, middle, 1.0 - (9.0_f64 / 10.0).asin() / PI, 1e-14);
    let empty = Mesh::new(Vec::new(), Vec::new()).unwrap();
    holds(&empty, middle, 1.0, 1e-15);
    holds(&empty, at([1.0, 2.0, 3.0], [0.3, -0.2, 0.7]), 1.0, 1e-15);
}

#[test]
fn closed_shells_are_dark_inside_and_convex_solids_bright_outside() {
    for mesh in
        [shapes::cuboid([-3.0, -1.0, 0.0], [1.0, 2.0, 7.0]), shapes::icosphere(1), shapes::octahedron()]
    {
        for receiver in vertices(&mesh) {
            holds(&mesh, receiver, 1.0, 1e-15);
            let inwards = at(receiver.point, receiver.normal.unwrap().map(|x| -x));
            holds(&mesh, inwards, 0.0, 1e-15);
            catches(&mesh, inwards, 0.0, Fault::NoFan);
        }
        let inside = at([0.01, 0.02, 0.03], [0.2, -0.5, 0.1]);
        holds(&mesh, inside, 0.0, 1e-15);
    }
}

#[test]
fn middle_of_a_face_is_not_hidden_by_it_nor_by_its_copy() {
    let sphere = shapes::icosphere(2);
    let mut faces = sphere.triangles().to_vec();
    faces.push([faces[7][1], faces[7][2], faces[7][0]]);
    let mesh = Mesh::new(sphere.positions().to_vec(), faces).unwrap();
    let mut behind = 0;
    for face in (0..mesh.face_count()).map(FaceId::new) {
        let [a, b, c] = mesh.corners(face).map(wide);
        let middle = [(a + b + c) / 3.0, (b - a).cross(c - a).normalize()];
        let [point, normal] = middle.map(|x| x.to_array().map(|x| x as f32));
        holds(&mesh, UnderSky { point, normal: Some(normal), face: Some(face) }, 1.0, 1e-12);
        // The sabotage: many rounded middles lie behind their own face.
        let without = open(&mesh, at(point, normal), None).share;
        assert!(without.min(1.0 - without) < 1e-6);
        behind += u32::from(without < 0.5);
    }
    assert!(behind > 30, "{behind}");
}

#[test]
fn grooves_show_the_fan_s_rule() {
    // Sides rise with slope 4 : 3 from the line along y.
    let long = 2f32.powi(21);
    let side = |x: f32| [[0.0; 3], [0.0, x * long, 0.0], [x * 3.0, 0.0, 4.0], [0.0, -x * long, 0.0]];
    let groove = quads(&[side(1.0), side(-1.0)]);
    let share = holds(&groove, at([0.0; 3], UP), 0.6, 1e-14);
    catches(&groove, at([0.0; 3], UP), share, Fault::NoFan);
    // A half-space whose inward normal is tilted by δ: (1 + cos δ)/2.
    let flat = shapes::sheet(2);
    let middle = flat.positions().iter().position(|x| {
        flat.triangles().iter().flatten().filter(|&&v| flat.positions()[v as usize] == *x).count() == 6
    });
    let point = flat.positions()[middle.unwrap()];
    let face = flat.corners(FaceId(0)).map(wide);
    let up = (face[1] - face[0]).cross(face[2] - face[0]).normalize();
    let aside = up.any_orthonormal_vector();
    for (along, across) in [(4.0, 3.0), (5.0, 12.0), (1.0, 0.0), (-3.0, 4.0)] {
        let normal = (along * up + across * aside).to_array().map(|x| x as f32);
        // From below, the sheet hides what is above it.
        let cos = (along / f64::hypot(along, across)).abs();
        holds(&flat, at(point, normal), 0.5 * (1.0 + cos), 1e-13);
    }
    // On the inside of one side, across from the other one: cos²ψ at any distance from the line, but for what
    // passes over the far end of the other side.
    let top = [3.0 * long, 4.0 * long];
    let across =
        quads(&[[[0.0, -long, 0.0], [top[0], -long, top[1]], [top[0], long, top[1]], [0.0, long, 0.0]]]);
    for distance in [1.0_f32, 7.0, 0.25] {
        let receiver = at([-3.0 * distance, 0.0, 4.0 * distance], [0.8, 0.0, 0.6]);
        holds(&across, receiver, 0.36, f64::from(4.0 * distance / long));
    }
}

#[test]
fn point_on_an_edge_or_within_a_face_is_hidden_by_what_is_below() {
    let face = [[-1.0, -1.0, 0.0], [3.0, -1.0, 0.0], [-1.0, 3.0, 0.0]];
    let (mesh, tilted) = (triangles(&[face]), [3.0, 0.0, 4.0]);
    holds(&mesh, at([0.0; 3], tilted), 0.9, 1e-13);
    catches(&mesh, at([0.0; 3], tilted), 0.9, Fault::NoFan);
    // On the edge x = −1 the part below is hidden if the normal leans to the face.
    holds(&mesh, at([-1.0, 1.0, 0.0], tilted), 0.9, 1e-13);
    holds(&mesh, at([-1.0, 1.0, 0.0], [-3.0, 0.0, 4.0]), 1.0, 1e-13);
    // With faces across the edge that end at the point, as without the edge.
    let junction = triangles(&[
        face,
        [[-1.0, 1.0, 0.0], [-1.0, 3.0, 0.0], [-4.0, 1.0, 0.0]],
        [[-1.0, 1.0, 0.0], [-4.0, 1.0, 0.0], [-1.0, -1.0, 0.0]],
    ]);
    holds(&junction, at([-1.0, 1.0, 0.0], [-3.0, 0.0, 4.0]), 0.9, 1e-13);
    holds(&junction, at([-1.0, 1.0, 0.0], [1.0, 2.0, 2.0]), 0.5 * (1.0 + 2.0 / 3.0), 1e-13);
}

#[test]
fn sphere_over_a_plane_lies_between_those_around_and_inside_it() {
    let sphere = shapes::icosphere(3);
    let least = (0..sphere.face_count()).map(|face| {
        let [a, b, c] = sphere.corners(FaceId::new(face)).map(wide);
        (b - a).cross(c - a).normalize().dot(a)
    });
    let inner = least.fold(1.0, f64::min);
    for center in [[0.0, 0.0, 1.5], [2.0, 1.0, 1.25], [0.5, -3.0, 4.0]] {
        let mesh = shapes::translated(&sphere, center);
        let [x, y, z] = center.map(f64::from);
        let share = |radius: f64| 1.0 - radius * radius * z / (x * x + y * y + z * z).powf(1.5);
        let found = open(&mesh, at([0.0; 3], UP), None).share;
        // The translation has rounded corners.
        assert!(share(1.0) - 1e-6 <= found && found <= share(inner) + 1e-6, "{found}");
        assert!(share(inner) - share(1.0) < 0.02 && share(1.0) < 0.98);
    }
}

#[test]
fn another_caster_never_opens_the_sky_and_scale_changes_no_bit() {
    let base = shapes::torus(12, 8, 2.0, 0.7);
    let ball = shapes::translated(&shapes::icosphere(1), [0.5, 0.25, 1.75]);
    let both = Mesh::concat(&[base.clone(), ball]).unwrap();
    let receivers: Vec<UnderSky> = vertices(&base).step_by(5).collect();
    let shares =
        |mesh: &Mesh, receivers: &[UnderSky]| SoftOracle::build(mesh).open_sky(receivers, SMOOTH, false);
    let (alone, under) = (shares(&base, &receivers), shares(&both, &receivers));
    assert!(alone.iter().zip(&under).all(|(alone, under)| under.share <= alone.share + 1e-12));
    assert!(alone.iter().zip(&under).any(|(alone, under)| under.share < alone.share - 0.1));
    for power in [-40, -1, 3, 60] {
        let factor = 2f32.powi(power);
        let scaled =
            |receiver: &UnderSky| UnderSky { point: receiver.point.map(|x| x * factor), ..*receiver };
        let receivers: Vec<UnderSky> = receivers.iter().map(scaled).collect();
        assert_eq!(shares(&shapes::scaled(&both, factor), &receivers), under);
    }
    // The sabotage: a factor that is no power of two rounds.
    let receivers: Vec<UnderSky> =
        receivers.iter().map(|r| UnderSky { point: r.point.map(|x| x * 1.1), ..*r }).collect();
    assert_ne!(shares(&shapes::scaled(&both, 1.1), &receivers), under);
}

#[test]
fn faces_that_share_only_the_receiver_hide_what_any_of_them_hides() {
    // Two triangles above each other that share the receiver as a corner, and one below.
    let mesh = triangles(&[
        [[0.0; 3], [1.0, -1.0, 1.0], [1.0, 1.0, 1.0]],
        [[0.0; 3], [1.0, 1.0, 2.0], [1.0, -1.0, 2.0]],
        [[0.0; 3], [-1.0, 1.0, -2.0], [-1.0, -1.0, -2.0]],
    ]);
    let alone = triangles(&[[[0.0; 3], [1.0, -1.0, 2.0], [1.0, 1.0, 2.0]]]);
    let [both, upper] = [&mesh, &alone].map(|mesh| open(mesh, at([0.0; 3], UP), None).share);
    // What is beyond the arc of the upper one: the sector of the horizon less the triangle to the arc.
    let (a, b) = (glam::dvec3(1.0, -1.0, 2.0), glam::dvec3(1.0, 1.0, 2.0));
    let side = |a: DVec3, b: DVec3| a.cross(b).normalize().z * a.angle_between(b) / (2.0 * PI);
    let expected = 1.0 - (0.25 - side(a, b));
    assert!((upper - expected).abs() < 1e-14, "{upper} {expected}");
    // What the lower one hides is hidden by the upper one too, and what is below the horizon does not count.
    assert!((both - upper).abs() < 1e-14, "{both} {upper}");
}

#[test]
fn bent_direction_beside_a_wall_and_of_a_sphere_over_a_floor_is_that_of_the_integral() {
    // Half of the sky: the integral of ω cos θ over it, over π.
    let wall = shapes::cuboid([1.0, -1e7, -1e7], [2.0, 1e7, 1e7]);
    let half = DVec3::new(-2.0 / (3.0 * PI), 0.0, 1.0 / 3.0);
    let found = open(&wall, at([0.0; 3], UP), None);
    assert!((found.bent - half).length() < 1e-6 + found.bound, "{found:?}");
    // The sabotage: directions that all count alike would lean by 45 degrees.
    let alike = DVec3::new(-1.0, 0.0, 1.0).normalize();
    assert!((found.bent.normalize() - alike).length() > 0.1);
    // Aslant, so that all six sides of the cube have a part of it.
    let tilt = glam::DQuat::from_euler(glam::EulerRot::XYZ, 0.4, 0.7, -0.3);
    let turned = |v: DVec3| (tilt * v).to_array().map(|x| x as f32);
    let empty = Mesh::new(Vec::new(), Vec::new()).unwrap();
    let normal = turned(DVec3::Z);
    let open_sky = open(&empty, at([0.0; 3], normal), None);
    let expected = 2.0 / 3.0 * wide(normal).normalize();
    assert!((open_sky.bent - expected).length() < 1e-14, "{open_sky:?}");
    let corners: Vec<[f32; 3]> = [[-1e4, -1e4], [1e4, -1e4], [1e4, 1e4], [-1e4, 1e4]]
        .map(|[y, z]| turned(DVec3::new(1.0, y, z)))
        .to_vec();
    let slanted = Mesh::new(corners, vec![[0, 1, 2], [0, 2, 3]]).unwrap();
    let found = open(&slanted, at([0.0; 3], normal), None);
    assert!((tilt.inverse() * found.bent - half).length() < 1e-3, "{found:?}");
    // Without a normal: a floor hides the lower half of the sphere.
    let floor = quads(&[[[-1e7, -1e7, -1.0], [1e7, -1e7, -1.0], [1e7, 1e7, -1.0], [-1e7, 1e7, -1.0]]]);
    let found = open(&floor, UnderSky { point: [0.0; 3], normal: None, face: None }, None);
    assert!((found.bent - DVec3::new(0.0, 0.0, 0.25)).length() < 1e-6, "{found:?}");
    // The sabotage: nothing in the way has no mean direction.
    let nothing = open(&empty, UnderSky { point: [0.0; 3], normal: None, face: None }, None);
    assert!(nothing.bent.length() < 1e-14 && nothing.share == 1.0, "{nothing:?}");
}
