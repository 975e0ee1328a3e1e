//! Poses of glTF files: against a naive model of what they say, and what is wrong in them.

#[path = "../../../src/animate/tests/naive.rs"]
mod naive;

use serde_json::{Value, json};
use umbrage::animate::{Pose, PoseError};
use umbrage::caster::Caster;
use umbrage::geom::Light;
use umbrage::mesh::{Mesh, Weld, weld};
use umbrage::read::read;
use umbrage::scene::{Scene, Scope};
use umbrage::testing::shapes;
use umbrage::verify::points::{Options, Verifier};

use super::{Builder, f32s, u16s};
use crate::support::{facts, real_meshes};
use naive::{Mode, Model, Path};

/// A model as a document.
fn document(model: &Model) -> Builder {
    let faces: Vec<u16> = (0..model.positions.len() as u16).collect();
    let mut builder = Builder::mesh(&model.positions, 4, Some(&faces));
    let targets: Vec<Value> =
        model.targets.iter().map(|target| json!({"POSITION": builder.positions(target)})).collect();
    if !targets.is_empty() {
        builder.doc["meshes"][0]["primitives"][0]["targets"] = targets.into();
        builder.doc["meshes"][0]["weights"] = json!(model.weights);
    }
    let node = |index: usize| {
        let node = &model.nodes[index];
        let children: Vec<usize> =
            (0..model.nodes.len()).filter(|&child| model.nodes[child].parent == Some(index)).collect();
        let mut json =
            json!({"translation": node.translation, "rotation": node.rotation, "scale": node.scale});
        if !children.is_empty() {
            json["children"] = json!(children);
        }
        json
    };
    builder.doc["nodes"] = (0..model.nodes.len()).map(node).collect();
    builder.doc["nodes"][0]["mesh"] = 0.into();
    if !model.joints.is_empty() {
        builder.doc["nodes"][0]["skin"] = 0.into();
        builder.doc["skins"] = json!([{"joints": model.joints}]);
        if let Some(inverse) = &model.inverse_binds {
            let bytes = f32s(inverse.as_flattened());
            let matrices = builder.accessor(5126, "MAT4", inverse.len(), &bytes);
            builder.doc["skins"][0]["inverseBindMatrices"] = matrices.into();
        }
        for set in 0..model.influences[0].len().div_ceil(4) {
            let of = |vertex: &Vec<(u32, f32)>| -> [(u32, f32); 4] {
                std::array::from_fn(|k| vertex.get(4 * set + k).copied().unwrap_or((0, 0.0)))
            };
            let four: Vec<[(u32, f32); 4]> = model.influences.iter().map(of).collect();
            let joints: Vec<u16> = four.iter().flatten().map(|&(joint, _)| joint as u16).collect();
            let weights: Vec<f32> = four.iter().flatten().map(|&(_, weight)| weight).collect();
            let joints = builder.accessor(5123, "VEC4", four.len(), &u16s(&joints));
            let weights = builder.accessor(5126, "VEC4", four.len(), &f32s(&weights));
            let attributes = &mut builder.doc["meshes"][0]["primitives"][0]["attributes"];
            attributes[format!("JOINTS_{set}")] = joints.into();
            attributes[format!("WEIGHTS_{set}")] = weights.into();
        }
    }
    let (mut samplers, mut channels) = (Vec::new(), Vec::new());
    for keys in &model.clip {
        let parts = if keys.mode == Mode::Cubic { 0..3 } else { 1..2 };
        let values: Vec<f32> = keys.keys.iter().flat_map(|key| key[parts.clone()].concat()).collect();
        let (path, shape, width) = match keys.path {
            Path::Translation => ("translation", "VEC3", 3),
            Path::Rotation => ("rotation", "VEC4", 4),
            Path::Scale => ("scale", "VEC3", 3),
            Path::Weights => ("weights", "SCALAR", 1),
        };
        let mode = match keys.mode {
            Mode::Step => "STEP",
            Mode::Linear => "LINEAR",
            Mode::Cubic => "CUBICSPLINE",
        };
        let input = builder.accessor(5126, "SCALAR", keys.times.len(), &f32s(&keys.times));
        let output = builder.accessor(5126, shape, values.len() / width, &f32s(&values));
        channels.push(json!({"sampler": samplers.len(), "target": {"node": keys.node, "path": path}}));
        samplers.push(json!({"input": input, "output": output, "interpolation": mode}));
    }
    builder.doc["animations"] = json!([{"name": "clip", "samplers": samplers, "channels": channels}]);
    builder
}

fn baked(scene: Scene) -> Mesh {
    scene.bake(Scope::Mesh).unwrap().remove(0)
}

#[test]
fn animation_poses_agree_with_the_naive_model() {
    for model in Model::all() {
        let scene = document(&model).read();
        assert_eq!(scene.rig.clips()[0].problem(), None, "{}", model.name);
        for time in Model::times() {
            let posed = baked(scene.pose(&Pose::at(time)).unwrap());
            for (got, wanted) in posed.positions().iter().zip(model.posed(time)) {
                // As for the rig alone; a matrix of an instance is rounded to `f32` as well, and multiplied
                // there: 7 more roundings an axis.
                let size = wanted.iter().fold(8.0, |most: f64, x| most.max(x.abs()));
                let allowed = (7.0 + 3.0 * 7.0) * size * f64::from(f32::EPSILON) / 2.0;
                for axis in 0..3 {
                    let off = (f64::from(got[axis]) - wanted[axis]).abs();
                    assert!(off <= allowed, "{} at {time}: {got:?} is not {wanted:?}", model.name);
                }
            }
        }
    }
}

/// What the pose of a document says.
fn refused(builder: &Builder) -> String {
    let error = builder.read().pose(&Pose::at(0.5)).map(|_| ()).unwrap_err();
    assert!(!error.remedy().is_empty());
    error.to_string()
}

/// A note of the posed document that begins like this.
fn noted(builder: &Builder, text: &str) {
    let posed = builder.read().pose(&Pose::at(0.5)).unwrap_or_else(|error| panic!("{text}: {error}"));
    assert!(posed.notes.iter().any(|note| note.contains(text)), "{text}: {:?}", posed.notes);
}

fn skinned() -> Model {
    Model::all().into_iter().find(|model| model.name == "simple skin").unwrap()
}

#[test]
fn animation_that_is_not_asked_for_changes_nothing_and_refuses_nothing() {
    let model = skinned();
    let mut plain = document(&model);
    let posable = plain.read();
    plain.doc.as_object_mut().unwrap().remove("animations");
    assert_eq!(plain.read().meshes, posable.meshes);
    // Whatever is wrong in a clip or skin, the file is read as before.
    for broken in [json!(7), json!([7]), json!([{"samplers": 3}]), json!([{"channels": [{}]}])] {
        let mut builder = document(&model);
        builder.doc["animations"] = broken;
        assert_eq!(builder.read().meshes, posable.meshes);
        assert!(builder.read().pose(&Pose::at(0.0)).is_err());
    }
    let rest = Builder::square().read();
    assert!(rest.rig.is_empty() && !rest.moves() && posable.moves());
    let posed = rest.pose(&Pose::at(3.0)).unwrap();
    assert_eq!(posed.meshes, rest.meshes);
    assert!(posed.notes.iter().any(|note| note.contains("nothing in it moves")));
}

#[test]
fn animation_notes_of_the_bind_pose_are_not_those_of_a_pose() {
    let scene = document(&skinned()).read();
    let at_rest = ["animation 0: animation ignored", "node 0: skinned node read in the bind pose"];
    for text in at_rest {
        assert!(scene.notes.iter().any(|note| note.contains(text)), "{:?}", scene.notes);
    }
    let posed = scene.pose(&Pose::at(0.5)).unwrap();
    assert!(at_rest.iter().all(|text| !posed.notes.iter().any(|note| note.contains(text))));
    assert!(posed.notes.iter().any(|note| note.contains("weights that do not add up to 1")));
}

#[test]
fn animation_defects_are_refused_with_their_place() {
    let model = skinned();
    for (change, wanted) in [
        (&["/skins/0/joints/1", "1000"][..], "skin 0: names node 1000, but there are 3"),
        (&["/skins/0/joints", "[]"], "skin 0: has no joints"),
        (&["/skins/0/joints", "[1]"], "skin 0: a vertex is moved by joint 1, but there are 1"),
        (&["/skins/0/inverseBindMatrices", "0"], "accessor 0: is of type VEC3"),
        (
            &["/animations/0/samplers/0/interpolation", "\"SLERP\""],
            "animation 0, sampler 0: its interpolation",
        ),
        (&["/animations/0/channels/0/sampler", "9"], "animation 0, channel 0: names sampler 9"),
        (&["/animations/0/samplers/0/output", "99"], "animation 0, sampler 0: names accessor 99"),
        (&["/animations/0/samplers/0/interpolation", "\"CUBICSPLINE\""], "values for"),
    ] {
        let mut builder = document(&model);
        *builder.doc.pointer_mut(change[0]).unwrap() = serde_json::from_str(change[1]).unwrap();
        let said = refused(&builder);
        assert!(said.contains(wanted), "{change:?}: {said}");
    }
    // Fewer inverse bind matrices than joints.
    let mut builder = document(&model);
    let matrix = builder.accessor(5126, "MAT4", 1, &f32s(&model.inverse_binds.as_ref().unwrap()[0]));
    builder.doc["skins"][0]["inverseBindMatrices"] = matrix.into();
    assert!(refused(&builder).contains("skin 0: has 1 inverse bind matrices for 2 joints"));
    // Joints outside of the scene.
    let mut builder = document(&model);
    builder.doc["nodes"][0].as_object_mut().unwrap().remove("children");
    assert!(refused(&builder).contains("skin 0: its joint 0 is node 1, which is not in the scene; add"));
    // Times that do not increase, that are none, and keys that are none.
    for (times, wanted) in [
        (&[0.0, 2.0, 1.0][..], "its time 2 is 1, which is before the time 2"),
        (&[0.0, f32::NAN, 1.0], "which is not a finite number"),
        (&[], "has no keys"),
        (&[0.0], "has"),
    ] {
        let mut builder = document(&model);
        let input = builder.accessor(5126, "SCALAR", times.len(), &f32s(times));
        builder.doc["animations"][0]["samplers"][0]["input"] = input.into();
        let said = refused(&builder);
        assert!(said.contains(wanted), "{times:?}: {said}");
    }
    // A rotation of length zero.
    let mut builder = document(&model);
    let keys = model.clip[0].times.len();
    let output = builder.accessor(5126, "VEC4", keys, &f32s(&vec![0.0; 4 * keys]));
    builder.doc["animations"][0]["samplers"][0]["output"] = output.into();
    assert!(refused(&builder).contains("animation 0, sampler 0: its key 0 is a rotation of length zero"));
}

#[test]
fn animation_slips_whose_intention_is_plain_are_noted() {
    let model = skinned();
    for (pointer, value, text) in [
        ("/animations/0/channels/0/target/node", json!(77), "channel of a node that does not exist left out"),
        ("/animations/0/channels/0/target/path", json!("color"), "path that glTF does not know left out"),
        ("/animations/0/channels/0/target/path", json!("pointer"), "KHR_animation_pointer left out"),
        ("/animations/0/channels/0/target/path", json!("weights"), "without a target left out"),
        ("/animations/0/channels/0/target/node", json!(1), "second channel of a node and path left out"),
        ("/animations/0/channels/0/target", json!({"path": "scale"}), "channel without a node left out"),
    ] {
        let mut builder = document(&model);
        *builder.doc.pointer_mut(pointer).unwrap() = value;
        noted(&builder, text);
    }
    let mut builder = document(&model);
    builder.doc["nodes"].as_array_mut().unwrap().push(json!({"name": "apart"}));
    builder.doc["animations"][0]["channels"][0]["target"]["node"] = 3.into();
    noted(&builder, "channel of a node outside of the scene left out");
    // A clip of length 0, a spline of one key.
    for (mode, values) in [("LINEAR", 1), ("CUBICSPLINE", 3)] {
        let mut builder = document(&model);
        let input = builder.accessor(5126, "SCALAR", 1, &f32s(&[0.25]));
        let turn = [0.0, 0.0, 1.0, 0.0].repeat(values);
        let output = builder.accessor(5126, "VEC4", values, &f32s(&turn));
        builder.doc["animations"][0]["samplers"] =
            json!([{"input": input, "output": output, "interpolation": mode}]);
        builder.doc["animations"][0]["channels"] =
            json!([{"sampler": 0, "target": {"node": 1, "path": "rotation"}}]);
        let scene = builder.read();
        assert_eq!(scene.rig.clips()[0].span(), [0.25, 0.25]);
        let at = |time| baked(scene.pose(&Pose::at(time)).unwrap());
        assert_eq!(at(0.25), at(9.0));
        noted(&builder, "is outside of clip clip (0.25 to 0.25 s): the nearest key is held");
    }
    // Weights without a sum.
    let mut builder = document(&model);
    let none = builder.accessor(5126, "VEC4", 24, &f32s(&[0.0; 96]));
    builder.doc["meshes"][0]["primitives"][0]["attributes"]["WEIGHTS_0"] = none.into();
    noted(&builder, "vertex that no joint has a weight for left where it is at rest");
}

#[test]
fn animation_times_beyond_the_ends_are_held_and_those_that_are_none_refused() {
    let scene = document(&skinned()).read();
    let [start, end] = scene.rig.clips()[0].span();
    let at = |time: f64| baked(scene.pose(&Pose::at(time)).unwrap());
    assert_eq!((at(-5.0), at(1e300)), (at(start), at(end)));
    for time in [f64::NAN, f64::INFINITY] {
        assert!(matches!(scene.pose(&Pose::at(time)), Err(PoseError::NoTime { what: "time", .. })));
    }
    for fps in [0.0, -1.0, f64::NAN] {
        assert!(matches!(scene.pose(&Pose::frame(3).fps(fps)), Err(PoseError::NoTime { .. })));
    }
    let none = scene.pose(&Pose::at(0.0).of(1)).unwrap_err();
    assert_eq!(none, PoseError::NoClip { clip: 1, count: 1 });
    let mut changed = scene.clone();
    changed.instances.push(changed.instances[0].clone());
    assert!(matches!(changed.pose(&Pose::at(0.0)), Err(PoseError::Instances { count: 2, posed: 1 })));
}

/// Two strips of faces that meet in a seam of vertices given twice. The joints of the second strip are those
/// of the first, or not.
fn seam(second: u16) -> Scene {
    let x = [0.0, 1.0, 1.0, 0.0, 1.0, 2.0, 2.0, 1.0];
    let y = [0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 1.0, 1.0];
    let positions: Vec<[f32; 3]> = (0..8).map(|v| [x[v], y[v], 0.0]).collect();
    let mut builder = Builder::mesh(&positions, 4, Some(&[0, 1, 2, 0, 2, 3, 4, 5, 6, 4, 6, 7]));
    let joints: Vec<u16> = (0..8).flat_map(|v| [if v < 4 { 0 } else { second }, 0, 0, 0]).collect();
    let joints = builder.accessor(5123, "VEC4", 8, &u16s(&joints));
    let weights = builder.accessor(5126, "VEC4", 8, &f32s(&[1.0, 0.0, 0.0, 0.0].repeat(8)));
    let attributes = &mut builder.doc["meshes"][0]["primitives"][0]["attributes"];
    (attributes["JOINTS_0"], attributes["WEIGHTS_0"]) = (joints.into(), weights.into());
    builder.doc["nodes"] = json!([{"mesh": 0, "skin": 0, "children": [1, 2]}, {}, {}]);
    builder.doc["skins"] = json!([{"joints": [1, 2]}]);
    let input = builder.accessor(5126, "SCALAR", 3, &f32s(&[0.0, 1.0, 2.0]));
    // At time 1 the second joint scales everything to a point.
    let output = builder.accessor(5126, "VEC3", 3, &f32s(&[1.0, 1.0, 1.0, 0.0, 0.0, 0.0, 1.0, 1.0, 3.0]));
    builder.doc["animations"] = json!([{
        "samplers": [{"input": input, "output": output}],
        "channels": [{"sampler": 0, "target": {"node": 2, "path": "scale"}}],
    }]);
    builder.read()
}

#[test]
fn animation_leaves_adjacency_alone_and_a_caster_follows() {
    for (second, vertices) in [(0, 6), (1, 8)] {
        let scene = seam(second);
        let notes = scene.pose(&Pose::at(0.0)).unwrap().notes;
        let parted = |note: &String| note.contains("that the skin moves apart") && note.ends_with("2 of 8");
        assert_eq!(notes.iter().any(parted), second == 1, "{notes:?}");
        for scope in [Scope::Mesh, Scope::Scene, Scope::Primitive] {
            for how in [Weld::Exact, Weld::Within(1e-3), Weld::Within(1e9)] {
                let at = |time: f64| {
                    let mesh = scene.pose(&Pose::at(time)).unwrap().bake(scope).unwrap().remove(0);
                    weld(&mesh, how).mesh
                };
                let first = at(0.0);
                let apart = |within: usize| if second == 0 { within } else { 2 * within };
                match how {
                    Weld::Within(distance) if distance > 1.0 => {
                        assert_eq!(first.vertex_count(), apart(1), "by joints alone");
                    }
                    _ => assert_eq!(first.vertex_count(), vertices),
                }
                let mut caster = Caster::new(first.clone());
                for time in [0.5, 1.0, 1.5, 2.0] {
                    let posed = at(time);
                    assert_eq!(posed.triangles(), first.triangles(), "{how:?} at {time}");
                    caster.repose(posed.positions().to_vec()).unwrap();
                    assert_eq!(caster.mesh().positions(), posed.positions());
                }
            }
        }
        // Fault injected: welded where it stands in the pose, all of the second strip is one vertex.
        let flat = scene.pose(&Pose::at(1.0)).unwrap().meshes.remove(0);
        let bare = Mesh::new(flat.positions().to_vec(), flat.triangles().to_vec()).unwrap();
        assert!(second == 0 || weld(&bare, Weld::Exact).mesh.vertex_count() < 8);
    }
}

#[test]
fn animation_moves_lamps_cameras_and_copies_with_their_nodes() {
    let mut builder = Builder::square();
    builder.doc["nodes"] = json!([
        {"children": [1, 2], "translation": [0, 0, 0]},
        {"mesh": 0, "translation": [1, 0, 0]},
        {"camera": 0, "extensions": {"KHR_lights_punctual": {"light": 0}}, "translation": [0, 5, 0]},
    ]);
    builder.doc["cameras"] = json!([{"type": "perspective", "perspective": {"yfov": 1.0, "znear": 0.1}}]);
    builder.doc["extensions"] = json!({"KHR_lights_punctual": {"lights": [{"type": "spot", "spot": {}}]}});
    let input = builder.accessor(5126, "SCALAR", 2, &f32s(&[0.0, 1.0]));
    let output = builder.accessor(5126, "VEC4", 2, &f32s(&[0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 0.0, 0.0]));
    builder.doc["animations"] = json!([{
        "samplers": [{"input": input, "output": output}],
        "channels": [{"sampler": 0, "target": {"node": 0, "path": "rotation"}}],
    }]);
    let mut scene = builder.read();
    let posed = scene.pose(&Pose::at(1.0)).unwrap(); // half a turn about y
    let near = |a: [f32; 3], b: [f32; 3]| (0..3).all(|axis| (a[axis] - b[axis]).abs() < 1e-6);
    assert!(near(posed.cameras[0].camera.forward.to_array(), [0.0, 0.0, 1.0]));
    assert!(near(posed.lamps[0].cone.unwrap().direction, [0.0, 0.0, 1.0]));
    assert!(near(posed.lamps[0].light().xyz(), [0.0, 5.0, 0.0]));
    assert!(near(baked(posed).positions()[0], [-1.0, 0.0, 0.0]));
    // What is left out before or after the pose leaves the others where they are.
    let again = json!([0, 1, 2, 3]);
    builder.doc["nodes"][0]["children"] = json!([1, 2, 3]);
    builder.doc["nodes"].as_array_mut().unwrap().push(json!({"mesh": 0, "name": "other"}));
    assert!(again.is_array());
    scene = builder.read();
    scene.retain(|part| part.instance.name != "other").unwrap();
    let mut after = builder.read().pose(&Pose::at(1.0)).unwrap();
    after.retain(|part| part.instance.name != "other").unwrap();
    assert_eq!(baked(scene.pose(&Pose::at(1.0)).unwrap()), baked(after));
}

#[test]
fn animation_of_real_files_keeps_faces_and_vertices() {
    let Some(folder) = real_meshes() else { return };
    let mut moving = 0;
    for row in facts(&folder) {
        let frames: usize = row["md2_frames"].parse().unwrap_or(0);
        let clips: usize = row["gltf_animations"].parse().unwrap_or(0);
        if frames + clips == 0 {
            continue;
        }
        moving += 1;
        let scene = read(folder.join(&row["name"])).unwrap();
        assert_eq!(scene.rig.clips().len(), clips);
        let rest = Caster::new(weld(&baked(scene.clone()), Weld::Exact).mesh);
        for clip in 0..clips.max(1) {
            let end = scene.rig.clips().get(clip).map_or(frames as f64 / 24.0, |clip| clip.span()[1]);
            let mut first: Option<Mesh> = None;
            for part in [0.0, 0.31, 0.77, 1.0] {
                let pose = Pose { clip: (clips > 0).then_some(clip), ..Pose::at(part * end) };
                let posed = weld(&baked(scene.pose(&pose).unwrap()), Weld::Exact).mesh;
                let first = first.get_or_insert_with(|| posed.clone());
                assert_eq!(posed.triangles(), first.triangles(), "{}", row["name"]);
                let counts = Caster::new(posed).report().counts;
                assert_eq!(counts.boundary_edges, rest.report().counts.boundary_edges, "{}", row["name"]);
            }
        }
    }
    assert!(moving >= 4, "only {moving} files move");
}

#[test]
fn animation_of_a_part_keeps_it_apart_from_what_it_leaves() {
    // Two squares side by side, each a node; the second one moves or does not.
    let mut builder = Builder::square();
    builder.doc["scenes"] = json!([{"nodes": [0, 1]}]);
    builder.doc["nodes"] = json!([{"mesh": 0}, {"mesh": 0, "translation": [1, 0, 0]}]);
    let input = builder.accessor(5126, "SCALAR", 2, &f32s(&[0.0, 1.0]));
    let moved = builder.accessor(5126, "VEC3", 2, &f32s(&[1.0, 0.0, 0.0, 0.0, 0.0, 5.0]));
    let clip =
        |channels: Value| json!({"samplers": [{"input": input, "output": moved}], "channels": channels});
    let target = json!([{"sampler": 0, "target": {"node": 1, "path": "translation"}}]);
    builder.doc["animations"] = json!([clip(target), clip(json!([]))]);
    let scene = builder.read();
    let vertices = |scene: Scene| {
        let mesh = scene.bake(Scope::Scene).unwrap().remove(0);
        weld(&mesh, Weld::Exact).mesh.vertex_count()
    };
    assert_eq!(vertices(scene.clone()), 6, "at rest they share an edge");
    for time in [0.0, 0.5, 1.0] {
        assert_eq!(vertices(scene.pose(&Pose::at(time)).unwrap()), 8, "at {time}");
        assert_eq!(vertices(scene.pose(&Pose::at(time).of(1)).unwrap()), 6, "nothing moves");
    }
}

#[test]
fn animation_of_many_nodes_with_many_targets_does_not_fill_the_memory() {
    let mut builder = Builder::square();
    let count = 3000;
    // Nine million weights in a file of 100 kB.
    builder.doc["meshes"][0]["primitives"][0]["targets"] = vec![json!({}); count].into();
    builder.doc["meshes"][0]["weights"] = vec![json!(1); count].into();
    builder.doc["scenes"] = json!([{"nodes": (0..count).collect::<Vec<_>>()}]);
    builder.doc["nodes"] = vec![json!({"mesh": 0}); count].into();
    let said = refused(&builder);
    assert!(said.contains("asks for 3000 elements, but only"), "{said}");
    // Fewer are posed.
    let few = 30;
    builder.doc["scenes"] = json!([{"nodes": (0..few).collect::<Vec<_>>()}]);
    assert_eq!(builder.read().pose(&Pose::at(0.0)).unwrap().instances.len(), few);
}

/// A tube of 768 faces that one joint holds and another bends and twists, each vertex between the two by its
/// height.
fn tube() -> Scene {
    let mesh = shapes::torus(32, 12, 2.0, 0.6);
    let faces: Vec<u16> = mesh.triangles().as_flattened().iter().map(|&corner| corner as u16).collect();
    let mut builder = Builder::mesh(mesh.positions(), 4, Some(&faces));
    let weight = |p: &[f32; 3]| (p[0] / 5.2 + 0.5).clamp(0.0, 1.0);
    let weights: Vec<[f32; 4]> =
        mesh.positions().iter().map(|p| [1.0 - weight(p), weight(p), 0.0, 0.0]).collect();
    let joints = builder.accessor(5123, "VEC4", weights.len(), &u16s(&[0, 1, 0, 0].repeat(weights.len())));
    let weights = builder.accessor(5126, "VEC4", weights.len(), &f32s(weights.as_flattened()));
    let attributes = &mut builder.doc["meshes"][0]["primitives"][0]["attributes"];
    (attributes["JOINTS_0"], attributes["WEIGHTS_0"]) = (joints.into(), weights.into());
    builder.doc["nodes"] = json!([{"mesh": 0, "skin": 0, "children": [1]}, {"children": [2]}, {}]);
    builder.doc["skins"] = json!([{"joints": [1, 2]}]);
    let input = builder.accessor(5126, "SCALAR", 3, &f32s(&[0.0, 1.0, 2.0]));
    let turns = [0.0, 0.0, 0.0, 1.0, 0.5, 0.1, -0.5, 0.7, -0.3, 0.6, 0.2, 0.7];
    let output = builder.accessor(5126, "VEC4", 3, &f32s(&turns));
    builder.doc["animations"] = json!([{
        "samplers": [{"input": input, "output": output}],
        "channels": [{"sampler": 0, "target": {"node": 2, "path": "rotation"}}],
    }]);
    builder.read()
}

/// Whether all judges agree about a caster, and what they answered.
fn verified(caster: &Caster, light: &Light, points: usize) -> (bool, u64) {
    let options = Options { points, ..Options::default() };
    let result = Verifier::new(caster).verify(light, &options, &|_| {});
    (result.agrees() && result.total().disagree == 0, result.total().agree)
}

#[test]
fn animation_poses_cast_verified_shadows() {
    let scene = tube();
    let welded = |time: f64| weld(&baked(scene.pose(&Pose::at(time)).unwrap()), Weld::Exact).mesh;
    let mut caster = Caster::new(welded(0.0));
    let edges = caster.topology().edge_count();
    let light = Light::point([1.0, 6.0, 2.0]).unwrap();
    let mut volumes = Vec::new();
    for time in [0.0, 0.3, 0.7, 1.0, 1.6, 2.0] {
        caster.repose(welded(time).positions().to_vec()).unwrap();
        assert_eq!(caster.topology().edge_count(), edges);
        let (agrees, answered) = verified(&caster, &light, 200);
        assert!(agrees && answered > 100, "at {time}");
        volumes.push(caster.report().counts.signed_volume);
    }
    assert!(volumes.windows(2).all(|pair| pair[0] != pair[1]), "each pose is another: {volumes:?}");
    assert!(scene.pose(&Pose::at(0.5)).unwrap().meshes[0].frames().is_empty());
}

#[test]
fn animation_of_real_files_casts_verified_shadows() {
    let Some(folder) = real_meshes() else { return };
    for (name, times) in [
        ("fox_skinned.glb", [0.2, 1.7]),
        ("cesium_milk_truck.glb", [0.4, 1.1]),
        ("morph_stress_test.gltf", [0.5, 1.3]),
        ("sydney.md2", [0.52, 5.0]),
    ] {
        let scene = read(folder.join(name)).unwrap();
        for time in times {
            let mut posed = scene.pose(&Pose::at(time)).unwrap().bake(Scope::Mesh).unwrap();
            let caster = Caster::new(weld(&posed.remove(0), Weld::Exact).mesh);
            let [low, high] = caster.mesh().bounds().unwrap();
            let light =
                Light::point([0, 1, 2].map(|axis| high[axis] + 0.7 * (high[axis] - low[axis]))).unwrap();
            let (agrees, answered) = verified(&caster, &light, 100);
            assert!(agrees && answered > 20, "{name} at {time}");
        }
    }
}
