use std::f64::consts::PI;

use glam::dvec3;

use super::*;
use crate::random::SplitMix64;
use crate::testing::shapes;

/// A point, a normal of length 1.
fn random_disk(random: &mut SplitMix64) -> Disk {
    let mut unit = || 2.0 * random.unit() - 1.0;
    let center = dvec3(unit(), unit(), unit());
    let normal = dvec3(unit(), unit(), unit()).normalize();
    Disk { center, normal, area: 0.01 + 0.01 * random.unit() }
}

/// The disks of a torus, and some that lie anywhere.
fn two_lots() -> [Vec<Disk>; 2] {
    let torus = shapes::torus(40, 20, 2.0, 0.7);
    let mut random = SplitMix64(11);
    let scattered = (0..900).map(|_| random_disk(&mut random)).collect();
    [disks(&[&torus], Emitters::Vertices).into_iter().map(|(_, disk)| disk).collect(), scattered]
}

fn receivers(count: usize) -> Vec<(DVec3, Option<DVec3>)> {
    let mut random = SplitMix64(5);
    let receiver = |i: usize| {
        let Disk { center, normal, .. } = random_disk(&mut random);
        (3.0 * center, (!i.is_multiple_of(5)).then_some(normal))
    };
    (0..count).map(receiver).collect()
}

fn ambient(mesh: &Mesh, passes: Passes) -> Ambient {
    let mut disks = Disks::of(&[mesh], Emitters::Vertices);
    disks.run(&passes);
    disks.openness(Receivers::of(&[mesh], Per::Vertex).list())
}

/// The sum over all disks one by one, in `f64`.
fn plain_sum(disks: &[Disk], weights: &[f64], p: DVec3, normal: Option<DVec3>) -> Seen {
    let mut seen = Seen::default();
    for (disk, weight) in disks.iter().zip(weights) {
        let (across, area) = (disk.center - p, weight * disk.area);
        let distance = across.length();
        if distance > 0.0 {
            let towards = across / distance;
            let front = area * (-towards.dot(disk.normal)).max(0.0);
            let round = PI * distance * distance;
            let hidden = match normal {
                Some(normal) => front * towards.dot(normal).max(0.0) / (round + area),
                None => 0.25 * front / (round + 0.5 * area),
            };
            seen.hidden += hidden;
            seen.towards += hidden * towards;
        }
    }
    seen
}

#[test]
fn tree_at_theta_0_is_the_plain_sum() {
    for lot in two_lots() {
        let mut tree = Tree::over(&lot);
        let mut random = SplitMix64(3);
        for weighted in [false, true] {
            let weight = |_| if weighted { random.unit() } else { 1.0 };
            let weights: Vec<f64> = lot.iter().map(weight).collect();
            tree.weigh(&weights);
            let (mut worst, mut sabotaged) = (0.0_f64, 0.0_f64);
            for (p, normal) in receivers(100) {
                let plain = plain_sum(&lot, &weights, p, normal);
                let found = tree.sum(p, normal, 0.0);
                worst = worst.max((found.hidden - plain.hidden).abs());
                worst = worst.max((found.towards - plain.towards).length());
                sabotaged = sabotaged.max((tree.sum(p, normal, 0.7).hidden - plain.hidden).abs());
            }
            // Points are rounded by up to 2⁻²⁵ of the extent, at distances of a hundredth of it.
            assert!(worst < 1e-5 && sabotaged > 1e-4, "{worst} {sabotaged}");
        }
    }
}

#[test]
fn order_and_number_of_receivers_change_no_bit() {
    let torus = shapes::torus(40, 20, 2.0, 0.7);
    let disks = Disks::of(&[&torus], Emitters::Vertices);
    let list = Receivers::of(&[&torus], Per::Vertex).list().to_vec();
    let all = disks.seen(&list);
    let alone = |receiver: &Receiver| disks.seen(std::slice::from_ref(receiver))[0];
    assert!(list.iter().map(alone).eq(all.iter().copied()));
    let reversed: Vec<Receiver> = list.iter().rev().copied().collect();
    let turned = disks.seen(&reversed);
    assert!(turned.iter().rev().eq(&all));
    // The sabotage: results stay where the curve put them.
    assert!(turned != all);
}

#[test]
fn tree_stays_within_its_bound_of_the_plain_sum() {
    for lot in two_lots() {
        let tree = Tree::over(&lot);
        for theta in [0.02, 0.1, 0.3] {
            let (mut used, mut sabotaged) = (0.0_f64, 0.0_f64);
            for (p, normal) in receivers(60) {
                let plain = plain_sum(&lot, &vec![1.0; lot.len()], p, normal).hidden;
                let share = if normal.is_some() { PI } else { 4.0 * PI };
                let all: f64 =
                    lot.iter().map(|disk| disk.area / (share * disk.center.distance_squared(p))).sum();
                let bound = 4.0 * theta / ((1.0 - theta) * (1.0 - theta)) * all;
                let found = tree.sum(p, normal, theta).hidden;
                used = used.max((found - plain).abs() / bound);
                // The sabotage: both sides of disks hide.
                let mut both = lot.clone();
                both.extend(lot.iter().map(|disk| Disk { normal: -disk.normal, ..*disk }));
                let other = Tree::over(&both).sum(p, normal, theta).hidden;
                sabotaged = sabotaged.max((other - plain).abs() / bound);
            }
            assert!(used <= 1.0, "θ {theta}: {used}");
            assert!(theta > 0.05 || sabotaged > 1.0, "θ {theta}: {sabotaged}");
        }
    }
}

#[test]
fn disk_straight_ahead_hides_what_its_radius_and_distance_say() {
    for [radius, distance] in [[1.0, 2.0], [3.0, 0.25], [0.01, 100.0]] {
        let up = DVec3::Z;
        let disk = Disk { center: distance * up, normal: -up, area: PI * radius * radius };
        let share = radius * radius / (radius * radius + distance * distance);
        let seen = |normal| Tree::over(&[disk]).sum(DVec3::ZERO, normal, 0.5);
        let found = seen(Some(up));
        // Some ten roundings to `f32`.
        let rounding = 10.0 * 2f64.powi(-24) * share;
        assert!((found.hidden - share).abs() < rounding);
        assert!((found.towards - found.hidden * up).length() < rounding);
        // Behind the horizon, from behind, and at the same point it hides nothing.
        assert_eq!(seen(Some(-up)).hidden, 0.0);
        let turned = Tree::over(&[Disk { normal: up, ..disk }]);
        assert_eq!(turned.sum(DVec3::ZERO, Some(up), 0.5).hidden, 0.0);
        assert_eq!(turned.sum(disk.center, Some(up), 0.5), Seen::default());
        // Of all directions, less than half.
        let whole = seen(None).hidden;
        let cap = 0.5 * (1.0 - distance / radius.hypot(distance));
        assert!(whole < 0.5 && (whole / cap - 1.0).abs() < 0.4, "{whole} {cap}");
    }
}

#[test]
fn areas_of_disks_are_the_surface_and_the_tutorial_s_half_of_it() {
    let sphere = shapes::icosphere(3);
    let surface: f64 = face_areas(&[&sphere]).sum();
    for emitters in [Emitters::Vertices, Emitters::Faces] {
        let sum: f64 = disks(&[&sphere], emitters).iter().map(|(_, disk)| disk.area).sum();
        assert!((sum / surface - 1.0).abs() < 1e-12);
    }
    // The sabotage.
    let literal = Literal::of(&[&sphere], LiteralForm::AsPrinted);
    let sum: f64 = literal.disks.iter().map(|disk| disk.area).sum();
    assert!((sum / surface - 0.5).abs() < 0.01);
}

#[test]
fn unit_of_length_changes_no_bit_but_does_in_the_tutorial() {
    let torus = shapes::torus(24, 12, 2.0, 0.7);
    let folded = Passes { passes: 3, ..Passes::default() };
    let literally = |mesh: &Mesh| {
        let receivers = Receivers::of(&[mesh], Per::Vertex);
        Literal::of(&[mesh], LiteralForm::AsPrinted).openness(receivers.list())
    };
    let known = ambient(&torus, folded);
    for power in [-30, -3, 10, 60] {
        let scaled = shapes::scaled(&torus, 2f32.powi(power));
        assert_eq!(ambient(&scaled, folded), known);
        // The sabotage.
        assert_ne!(literally(&scaled), literally(&torus));
    }
}

#[test]
fn closed_room_is_dark_and_a_convex_solid_bright() {
    let sphere = shapes::icosphere(4);
    let room = shapes::inside_out(&sphere);
    let dark = ambient(&room, Passes::default());
    let mut disks = Disks::of(&[&room], Emitters::Faces);
    disks.run(&Passes::default());
    let receiver = |point| Receiver { point, normal: Some([0.0, 0.6, 0.8]), face: None };
    let points = [[0.0; 3], [0.3, 0.1, -0.4], [-0.5, 0.2, 0.1]].map(receiver);
    for open in dark.openness.iter().chain(&disks.openness(&points).openness) {
        assert!(*open < 0.04, "{open}");
    }
    // The sabotage: exp(−x) of the same sum.
    let sums = disks.seen(&points);
    assert!(sums.iter().all(|seen| (-seen.hidden).exp() > 0.36));
    for passes in 1..4 {
        let bright = ambient(&sphere, Passes { passes, ..Passes::default() });
        assert!(bright.openness.iter().all(|&open| open == 1.0));
    }
}

#[test]
fn second_pass_brightens_and_damping_takes_half_of_the_step() {
    let torus = shapes::torus(24, 12, 2.0, 1.2);
    let run = |passes, damped| ambient(&torus, Passes { passes, damped, ..Passes::default() }).openness;
    let [first, second, third, damped] = [run(1, true), run(2, true), run(3, false), run(3, true)];
    assert_eq!(second, run(2, false));
    let ordered = |low: &[f32], high: &[f32]| low.iter().zip(high).all(|(low, high)| low <= high);
    // Disks that count less brighten; brighter disks count more.
    assert!(ordered(&first, &second) && ordered(&third, &second) && ordered(&first, &third));
    assert!(ordered(&third, &damped) && ordered(&damped, &second) && damped != third && damped != second);
    // The sabotage: weights of 1 in every pass change nothing.
    assert_ne!(first, second);
}

#[test]
fn bent_normal_turns_from_what_hides() {
    let wall = shapes::cuboid([1.0, -20.0, -20.0], [2.0, 20.0, 20.0]);
    let fine = Mesh::concat(&[wall]).unwrap();
    let disks = Disks::of(&[&fine], Emitters::Faces);
    let receiver = Receiver { point: [-9.0, 0.0, 0.0], normal: Some([0.0, 0.0, 1.0]), face: None };
    let found = disks.openness(&[receiver]);
    let [x, _, z] = found.bent.unwrap()[0];
    // The sabotage is a sign: towards the wall.
    assert!(x < -0.05 && z > 0.8 && found.openness[0] < 0.9, "{x} {z}");
}

#[test]
fn no_disks_hide_nothing_and_flat_faces_make_none() {
    let empty = Mesh::new(Vec::new(), Vec::new()).unwrap();
    let flat = shapes::collinear_face();
    let receiver = Receiver { point: [0.5; 3], normal: None, face: None };
    for mesh in [&empty, &flat] {
        for emitters in [Emitters::Vertices, Emitters::Faces] {
            let mut disks = Disks::of(&[mesh], emitters);
            disks.run(&Passes { theta: f64::NAN, passes: 2, damped: true });
            assert!(disks.openness(&[receiver]).openness[0] > 0.0);
            assert!(disks.count() <= mesh.face_count() + mesh.vertex_count());
        }
    }
    let sheet = Disks::of(&[&shapes::double_sheet()], Emitters::Vertices);
    assert!(sheet.count() <= shapes::double_sheet().vertex_count());
}
