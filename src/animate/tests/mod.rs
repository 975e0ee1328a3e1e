//! Poses against a naive model, and each injected fault caught.

mod naive;

use std::sync::Arc;

use glam::{DMat4, DQuat, DVec3};

use super::clip::{Channel, Clip, Property};
use super::deform::Deformed;
use super::fault::{Fault, Faults};
use super::pose::PoseError;
use super::rig::{Node, Rig};
use super::skin::{Influences, Skin, Slips};
use super::track::{Interpolation, Track};
use super::transform::Local;
use naive::{Mode, Model, Path};

/// The rig of a model, and the numbers of its vertices.
fn rig(model: &Model, faults: Faults) -> (Rig, Vec<u32>) {
    let node = |node: &naive::Node| Node {
        parent: node.parent,
        local: Local::Parts {
            translation: DVec3::from(node.translation),
            rotation: DQuat::from_array(node.rotation),
            scale: DVec3::from(node.scale),
        },
        weights: Vec::new(),
        place: String::new(),
    };
    let channel = |keys: &naive::Keys| {
        let parts = if keys.mode == Mode::Cubic { 0..3 } else { 1..2 };
        let values = keys.keys.iter().flat_map(|key| key[parts.clone()].concat()).collect();
        let interpolation = match keys.mode {
            Mode::Step => Interpolation::Step,
            Mode::Linear => Interpolation::Linear,
            Mode::Cubic => Interpolation::CubicSpline,
        };
        let property = match keys.path {
            Path::Translation => Property::Translation,
            Path::Rotation => Property::Rotation,
            Path::Scale => Property::Scale,
            Path::Weights => Property::Weights,
        };
        let track = Track { times: keys.times.clone(), values, width: keys.keys[0][1].len(), interpolation };
        Channel { node: keys.node, property, track: Arc::new(track) }
    };
    let inverse = |inverse: &Vec<[f32; 16]>| {
        inverse.iter().map(|m| DMat4::from_cols_array(&m.map(f64::from))).collect()
    };
    let skin = Skin {
        joints: model.joints.clone(),
        inverse_binds: model.inverse_binds.as_ref().map(inverse),
        ..Skin::default()
    };
    let (influences, _) = Influences::with(model.influences.iter().map(Vec::as_slice), faults);
    let clip = Clip { channels: model.clip.iter().map(channel).collect(), ..Clip::default() };
    let rig = Rig {
        nodes: model.nodes.iter().map(node).collect(),
        skins: vec![skin],
        clips: vec![clip],
        influences: Arc::new(influences),
        ..Rig::default()
    };
    (rig, (0..model.positions.len() as u32).collect())
}

/// The world positions of a model; an error where they are beyond `f32`.
fn posed(model: &Model, time: f64, faults: Faults) -> Result<Vec<[f32; 3]>, PoseError> {
    let (rig, numbers) = rig(model, faults);
    let nodes = rig.at_with(rig.clips.first(), time, faults)?;
    let full = |target: &Vec<[f32; 3]>| -> Vec<[f32; 3]> {
        let pairs = model.positions.iter().zip(target);
        pairs.map(|(p, d)| [p[0] + d[0], p[1] + d[1], p[2] + d[2]]).collect()
    };
    let targets: Vec<Vec<[f32; 3]>> = model.targets.iter().map(full).collect();
    let rest: Vec<f64> = model.weights.iter().copied().map(f64::from).collect();
    let weights = if nodes.weights[0].is_empty() { rest } else { nodes.weights[0].clone() };
    let skin = (!model.joints.is_empty()).then_some((0, numbers.as_slice()));
    let deformed = Deformed { positions: &model.positions, targets: &targets, weights: &weights, skin };
    let own = deformed.with(&rig, &nodes, faults)?;
    if skin.is_some() {
        return Ok(own);
    }
    let place = |p: [f32; 3]| nodes.world_from_node[0].transform_point3(DVec3::from(p.map(f64::from)));
    Ok(own.into_iter().map(|p| place(p).as_vec3().to_array()).collect())
}

/// The largest part of what a position may be off.
fn worst(model: &Model, faults: Faults) -> f64 {
    let mut worst = 0.0_f64;
    for time in Model::times() {
        let Ok(positions) = posed(model, time, faults) else { return f64::INFINITY };
        for (got, wanted) in positions.iter().zip(model.posed(time)) {
            // Rounded once in the space of the mesh and, where a node moves it, once in the world: half a
            // unit in the last place of 24 bits each, the first one scaled by the node (by 2 at most, for
            // each axis). Sums in `f64` are four digits below.
            let size = wanted.iter().fold(1.0, |most: f64, x| most.max(x.abs()));
            let allowed = (1.0 + 2.0 * 3.0) * size.max(8.0) * f64::from(f32::EPSILON) / 2.0;
            for axis in 0..3 {
                worst = worst.max((f64::from(got[axis]) - wanted[axis]).abs() / allowed);
            }
        }
    }
    worst
}

#[test]
fn pose_agrees_with_the_naive_model_and_each_fault_is_caught() {
    let models = Model::all();
    for model in &models {
        let worst = worst(model, Faults::default());
        assert!(worst <= 1.0, "{}: off by {worst} of what is allowed", model.name);
    }
    for fault in [
        Fault::LongArc,
        Fault::TangentScale,
        Fault::Clamp,
        Fault::StepAhead,
        Fault::InverseBind,
        Fault::Normalize,
        Fault::Parent,
        Fault::Morph,
    ] {
        let caught = models.iter().filter(|model| worst(model, Faults(Some(fault))) > 100.0).count();
        assert!(caught > 0, "{fault:?} is not caught");
    }
}

#[test]
fn slerp_of_nearly_equal_and_of_opposite_rotations_is_at_constant_speed() {
    let about_z = |angle: f64| DQuat::from_rotation_z(angle).to_array().map(|x| x as f32);
    let track = |values: [[f32; 4]; 2]| Track {
        times: vec![0.0, 1.0],
        values: values.concat(),
        width: 4,
        interpolation: Interpolation::Linear,
    };
    for angle in [1e-5, 1e-3, 0.5, 3.0] {
        for sign in [1.0, -1.0] {
            // The same rotation, written with the other sign.
            let end = about_z(angle).map(|x| x * sign);
            let half = track([about_z(0.0), end]).at(0.5, true, Faults::default());
            let turned = 2.0 * half[2].atan2(half[3]);
            let wanted = angle / 2.0;
            assert!((turned - wanted).abs() <= 1e-6 * angle.max(1e-2), "{angle}: {turned}");
        }
    }
    let still = track([about_z(0.7); 2]).at(0.3, true, Faults::default());
    let wanted = DQuat::from_rotation_z(0.7).to_array();
    assert!((0..4).all(|axis| (still[axis] - wanted[axis]).abs() < 1e-7));
    // Half a turn has two shortest arcs: either is right, and it is a rotation.
    let half = track([[0.0, 0.0, 0.0, 1.0], [0.0, 0.0, 1.0, 0.0]]).at(0.5, true, Faults::default());
    assert!((half.iter().map(|x| x * x).sum::<f64>() - 1.0).abs() < 1e-12);
}

#[test]
fn track_of_a_single_key_or_of_equal_times_holds_and_jumps() {
    let track = |times: &[f32], interpolation| Track {
        times: times.to_vec(),
        values: (0..times.len() * if interpolation == Interpolation::CubicSpline { 3 } else { 1 })
            .map(|x| x as f32)
            .collect(),
        width: 1,
        interpolation,
    };
    for (interpolation, value) in
        [(Interpolation::Step, 0.0), (Interpolation::Linear, 0.0), (Interpolation::CubicSpline, 1.0)]
    {
        for time in [-1.0, 0.5, 9.0] {
            assert_eq!(track(&[0.5], interpolation).at(time, false, Faults::default()), [value]);
            let still = track(&[0.5, 0.5], interpolation).at(time, false, Faults::default());
            assert!(still.iter().all(|x| x.is_finite()));
        }
    }
    let jump = track(&[0.0, 1.0, 1.0, 2.0], Interpolation::Linear);
    let at = |time: f64| jump.at(time, false, Faults::default())[0];
    assert_eq!([at(0.5), at(1.0), at(1.5)], [0.5, 2.0, 2.5]);
}

#[test]
fn weights_are_divided_by_their_sum_and_what_is_wrong_is_counted() {
    let lists: [&[(u32, f32)]; 5] =
        [&[(0, 0.5), (1, 0.5)], &[(0, 2.0), (1, 2.0)], &[], &[(0, 1.0), (1, -1.0)], &[(0, -0.5), (1, 1.5)]];
    let (influences, slips) = Influences::new(lists);
    assert_eq!(slips, Slips { sums: 1, weightless: 2, negative: 2 });
    let joints = [DMat4::IDENTITY, DMat4::from_translation(DVec3::X)];
    let x = |number: u32| influences.move_by(number, &joints, [1.0, 0.0, 0.0])[0];
    assert_eq!([0, 1, 2, 3, 4].map(x), [1.5, 1.5, 1.0, 1.0, 2.5]);
    assert_eq!(x(9), 1.0, "a number that is none moves nothing");
}

#[test]
fn clip_knows_its_span_and_its_keys() {
    let track = |times: &[f32]| {
        Arc::new(Track {
            times: times.to_vec(),
            values: vec![0.0; 3 * times.len()],
            width: 3,
            interpolation: Interpolation::Linear,
        })
    };
    let channel = |track| Channel { node: 0, property: Property::Scale, track };
    let channels = vec![channel(track(&[0.5, 2.0])), channel(track(&[0.25, 0.5]))];
    let clip = Clip { channels, ..Clip::default() };
    assert_eq!((clip.span(), clip.key_times()), ([0.25, 2.0], vec![0.25, 0.5, 2.0]));
    assert_eq!((Clip::default().span(), Clip::default().key_times()), ([0.0; 2], vec![]));
}
