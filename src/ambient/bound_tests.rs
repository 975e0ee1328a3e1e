//! More scenes with a closed form, and the bound that form factors give.

use std::f64::consts::TAU;

use glam::DVec3;

use super::Reach;
use super::closed_tests::{CLOSE, RAYS, UP, is_close, one, open, open_evenly, quads};
use super::lattice::Lattice;
use super::start::Start;
use crate::mesh::Mesh;
use crate::oracle::Oracle;

#[test]
fn a_plane_through_the_receiver_leaves_half_of_one_and_the_cosine_of_its_tilt() {
    // Normals (0.6, 0, 0.8) and (0.28, 0, 0.96).
    for ([along, down], cosine) in [([4e3_f32, 3e3_f32], 0.8), ([2.4e3, 0.7e3], 0.96)] {
        let far = 4e5;
        let plane =
            quads(&[[[-along, -far, down], [along, -far, -down], [along, far, -down], [-along, far, down]]]);
        is_close(open(&plane, [0.0; 3], UP), 0.5 * (1.0 + cosine));
        assert!((open_evenly(&plane, [0.0; 3], UP) - 0.5 * (1.0 + cosine)).abs() > 5.0 * CLOSE);
        // The sabotage: without the rule of the fan the plane hides nothing.
        let oracle = Oracle::build(&plane);
        let start = Start::at(&oracle, &one([0.0; 3], UP, None), 0).without_fan();
        let lattice = Lattice::new(RAYS);
        let hidden = |direction| start.hidden(&oracle, direction, Reach::Unlimited);
        assert!(lattice.directions(Some(UP), [0.0; 2]).all(|direction| hidden(direction) == 0.0));
    }
}

#[test]
fn the_floor_of_a_round_pit_sees_the_square_of_its_radius_over_that_of_its_rim() {
    let sides = 200_u32;
    for depth in [0.5_f32, 2.0] {
        let ring = |z: f32| {
            (0..sides).map(move |i| {
                let turn = TAU * f64::from(i) / f64::from(sides);
                [turn.cos() as f32, turn.sin() as f32, z]
            })
        };
        let wall = |i: u32| {
            let next = (i + 1) % sides;
            [[i, i + sides, next], [next, i + sides, next + sides]]
        };
        let pit =
            Mesh::new(ring(0.0).chain(ring(depth)).collect(), (0..sides).flat_map(wall).collect()).unwrap();
        let expected = 1.0 / (1.0 + f64::from(depth).powi(2));
        is_close(open(&pit, [0.0; 3], UP), expected);
        assert!((open_evenly(&pit, [0.0; 3], UP) - expected).abs() > 5.0 * CLOSE);
    }
}

/// Lambert's form factor of a triangle above the horizon, seen from the origin.
fn lambert(corners: [[f32; 3]; 3]) -> f64 {
    let corners = corners.map(|corner| DVec3::from(corner.map(f64::from)));
    let side = |i: usize| {
        let (a, b) = (corners[i], corners[(i + 1) % 3]);
        let across = a.cross(b);
        across.z / across.length() * across.length().atan2(a.dot(b))
    };
    ((0..3).map(side).sum::<f64>() / TAU).abs()
}

#[test]
fn faces_hide_no_more_than_the_sum_of_their_form_factors() {
    let near = [[-1.0, -1.0, 1.0], [1.0, -1.0, 1.0], [0.0, 1.0, 1.0]];
    let aside = [[2.0, -1.0, 0.5], [2.5, 1.0, 0.25], [2.0, 0.5, 2.0]];
    let across = [[-1.0, 0.5, 1.5], [1.5, 0.25, 1.5], [0.5, 0.75, 2.5]];
    let twice = near.map(|corner: [f32; 3]| corner.map(|x| 2.0 * x));
    let of = |faces: &[[[f32; 3]; 3]]| {
        let triangles = (0..faces.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]);
        Mesh::new(faces.as_flattened().to_vec(), triangles.collect()).unwrap()
    };
    // A face alone, and two beside each other, hide just that; without the cosine they do not.
    for faces in [&[near][..], &[near, aside]] {
        let bound = 1.0 - faces.iter().copied().map(lambert).sum::<f64>();
        is_close(open(&of(faces), [0.0; 3], UP), bound);
        assert!((open_evenly(&of(faces), [0.0; 3], UP) - bound).abs() > 5.0 * CLOSE);
    }
    // Behind each other they hide less, and one more face never opens anything.
    let all = [near, aside, across, twice];
    let mut last = 1.0;
    for count in 1..=all.len() {
        let found = open(&of(&all[..count]), [0.0; 3], UP);
        let bound = 1.0 - all[..count].iter().copied().map(lambert).sum::<f64>();
        assert!(found <= last && found > bound - CLOSE, "{count}: {found} {bound}");
        assert!(count < 4 || found > bound + 5.0 * CLOSE, "{found} {bound}");
        last = found;
    }
}
