//! Nodes, lights, cameras, and the extensions that a document may require.

use serde_json::json;
use umbrage::scene::{LeftOutCamera, NamedCamera, Scope};
use umbrage::view::Lens;

use super::{Builder, identity};

#[test]
fn gltf_nested_nodes_multiply() {
    let mut builder = Builder::square();
    let quarter_about_z = [0.0, 0.0, 0.707_106_77_f32, 0.707_106_77];
    builder.doc["nodes"] = json!([
        {"children": [1], "translation": [10, 0, 0], "scale": [2, 2, 2]},
        {"children": [2], "rotation": quarter_about_z},
        {"mesh": 0, "name": "leaf", "matrix": [1,0,0,0, 0,1,0,0, 0,0,1,0, 3,0,0,1]}
    ]);
    let scene = builder.read();
    assert_eq!((scene.instances.len(), scene.instances[0].name.as_str()), (1, "leaf"));
    // (1,0,0) → +3 along x → (4,0,0) → a quarter turn → (0,4,0) → twice → (0,8,0) → +10 along x
    let corner = scene.instances[0].world_from_mesh.transform_point3([1.0, 0.0, 0.0].into());
    assert!(corner.abs_diff_eq([10.0, 8.0, 0.0].into(), 1e-5), "{corner}");
}

#[test]
fn gltf_mirrored_node_keeps_its_front() {
    let mut builder = Builder::square();
    builder.doc["nodes"] = json!([{"mesh": 0}, {"mesh": 0, "scale": [-1, 1, 1]}]);
    builder.doc["scenes"][0]["nodes"] = json!([0, 1]);
    let scene = builder.read();
    let mirrored: Vec<bool> = scene.instances.iter().map(|i| i.world_from_mesh.determinant() < 0.0).collect();
    assert_eq!(mirrored, [false, true]);
    assert_eq!(scene.meshes.len(), 1, "a mesh is read once");
    // Both face +z after baking.
    for mesh in scene.bake(Scope::Mesh).unwrap() {
        let [a, b, c] = mesh.triangles()[0].map(|v| glam::Vec3::from(mesh.positions()[v as usize]));
        assert_eq!((b - a).cross(c - a), glam::Vec3::Z);
    }
}

#[test]
fn gltf_default_scene_is_read_else_the_first_else_all_roots_else_all_meshes() {
    let mut builder = Builder::square();
    builder.doc["nodes"] =
        json!([{"mesh": 0, "name": "a"}, {"name": "b", "children": [2]}, {"mesh": 0, "name": "c"}]);
    builder.doc["scenes"] = json!([{"nodes": [0]}, {"nodes": [1]}, {}]);
    let names = |builder: &Builder| -> Vec<String> {
        builder.read().instances.into_iter().map(|instance| instance.name).collect()
    };
    assert_eq!(names(&builder), ["a"]);
    assert_eq!(builder.read().notes, ["scene 0: read, the other scenes left out"]);
    builder.doc["scene"] = 1.into();
    assert_eq!(names(&builder), ["c"]);
    builder.doc["scene"] = 2.into();
    assert!(names(&builder).is_empty());
    assert!(
        builder
            .read()
            .notes
            .contains(&"mesh 0: mesh not read, for it stands nowhere in the scene".to_owned())
    );
    builder.doc.as_object_mut().unwrap().remove("scene");
    assert_eq!(names(&builder), ["a"]);
    builder.doc.as_object_mut().unwrap().remove("scenes");
    assert_eq!(names(&builder), ["a", "c"]);
    builder.doc.as_object_mut().unwrap().remove("nodes");
    assert_eq!(names(&builder), ["mesh 0"]);
}

#[test]
fn gltf_skinned_node_stays_where_its_bind_pose_is() {
    let mut builder = Builder::square();
    builder.doc["nodes"] = json!([{"mesh": 0, "skin": 0, "translation": [5, 0, 0]}]);
    builder.doc["skins"] = json!([{"joints": [0]}]);
    builder.doc["animations"] = json!([{}, {}]);
    let scene = builder.read();
    assert_eq!(scene.instances[0].world_from_mesh.to_cols_array(), identity());
    let notes = [
        "node 0: skinned node read in the bind pose, its own transform ignored",
        "animation 0 and 1 more: animation ignored",
    ];
    assert_eq!(scene.notes, notes);
}

#[test]
fn gltf_lights_stand_in_the_world() {
    let mut builder = Builder::square();
    builder.doc["extensionsUsed"] = json!(["KHR_lights_punctual"]);
    builder.doc["extensionsRequired"] = json!(["KHR_lights_punctual"]);
    builder.doc["extensions"] = json!({"KHR_lights_punctual": {"lights": [
        {"type": "directional", "name": "sun", "intensity": 3, "range": 9, "color": [1, 0.5, 0.25]},
        {"type": "point", "range": 7.5},
        {"type": "spot", "spot": {"innerConeAngle": 0.25, "outerConeAngle": 9}}
    ]}});
    let holds = |light: u32| json!({"KHR_lights_punctual": {"light": light}});
    // A quarter turn about x maps −z to −y and +y to +z.
    let down = [-0.707_106_77_f32, 0.0, 0.0, 0.707_106_77];
    builder.doc["nodes"] = json!([
        {"rotation": down, "translation": [1, 2, 3], "scale": [4, 4, 4], "children": [1, 2, 3]},
        {"extensions": holds(0)},
        {"extensions": holds(1), "name": "lamp", "translation": [0, 0, 1]},
        {"extensions": holds(2)}
    ]);
    let scene = builder.read();
    let [sun, lamp, spot] = &scene.lamps[..] else { panic!("{:?}", scene.lamps) };
    let close =
        |a: [f32; 3], b: [f32; 3]| assert!(glam::Vec3::from(a).abs_diff_eq(b.into(), 1e-6), "{a:?} {b:?}");
    assert!(sun.light().is_directional() && !lamp.light().is_directional() && !spot.light().is_directional());
    close(sun.light().xyz(), [0.0, 1.0, 0.0]); // travels down, so it is up
    assert_eq!((sun.name.as_str(), sun.intensity, sun.color), ("sun", 3.0, [1.0, 0.5, 0.25]));
    close(lamp.light().xyz(), [1.0, 6.0, 3.0]);
    assert_eq!((lamp.name.as_str(), lamp.intensity, lamp.color, lamp.cone), ("lamp", 1.0, [1.0; 3], None));
    close(spot.light().xyz(), [1.0, 2.0, 3.0]);
    assert_eq!((sun.range, lamp.range, spot.range), (None, Some(7.5), None));
    let cone = spot.cone.unwrap();
    close(cone.direction, [0.0, -1.0, 0.0]);
    assert_eq!((cone.inner_rad, cone.outer_rad), (0.25, std::f32::consts::FRAC_PI_2));

    builder.doc["nodes"][0]["scale"] = json!([1, 1, 0]);
    let scene = builder.read();
    assert_eq!(scene.lamps.len(), 1, "only a point light needs no direction");
    assert!(scene.notes.contains(
        &"light 0 and 1 more: light left out: of the first, its node is flattened to no direction".to_owned()
    ));
}

#[test]
fn gltf_light_that_is_none_is_left_out_with_a_note() {
    let light = |light: serde_json::Value, index: usize| {
        let mut builder = Builder::square();
        builder.doc["extensions"] = json!({"KHR_lights_punctual": {"lights": [light]}});
        builder.doc["nodes"][0]["extensions"] = json!({"KHR_lights_punctual": {"light": index}});
        let scene = builder.read();
        assert_eq!(scene.instances.len(), 1);
        (scene.lamps, scene.notes)
    };
    for (bad, why) in [
        (json!({"type": "point", "range": 0}), "its range is 0, but must be more than 0"),
        (json!({"type": "point", "range": -2}), "its range is -2, but must be more than 0"),
        (json!({"type": "point", "intensity": -1}), "its intensity is -1, but must not be below 0"),
        (json!({"type": "point", "intensity": 1e39}), "intensity is 1e+39, which is not a 32-bit number"),
        (json!({"type": "point", "color": [1, 1]}), "color is not a list of 3 numbers"),
        (json!({"type": "point", "color": [1, -1, 1]}), "its color is [1.0, -1.0, 1.0], but must be from 0"),
        (json!({"type": "area"}), "its type is not directional, point or spot"),
        (json!({}), "type is missing"),
        (
            json!({"type": "spot", "spot": {"outerConeAngle": "wide"}}),
            "outerConeAngle is \"wide\", which is not",
        ),
    ] {
        let (lamps, notes) = light(bad, 0);
        assert!(lamps.is_empty() && notes.len() == 1, "{notes:?}");
        assert!(notes[0].starts_with(&format!("light 0: light left out: {why}")), "{notes:?}");
    }
    let (lamps, notes) = light(json!({"type": "point"}), 3);
    assert!(lamps.is_empty());
    assert_eq!(notes, ["node 0: light left out: names light 3, but there are 1"]);
    let (lamps, notes) = light(json!({"type": "spot"}), 0);
    let cone = lamps[0].cone.unwrap();
    assert_eq!((cone.inner_rad, cone.outer_rad), (0.0, std::f32::consts::FRAC_PI_4));
    assert_eq!(notes, ["light 0: spot light without a cone given the default one"]);
}

#[test]
fn gltf_cameras_are_all_read() {
    let mut builder = Builder::square();
    builder.doc["cameras"] = json!([
        {"type": "orthographic", "name": "plan", "orthographic": {"xmag": 1, "ymag": 3, "zfar": 1, "znear": 0}},
        {"type": "perspective", "perspective": {"yfov": 0.5, "znear": 0.1}},
        {"type": "panorama"}
    ]);
    builder.doc["nodes"] = json!([
        {"camera": 1, "name": "front", "translation": [1, 2, 3], "rotation": [0, 1, 0, 0], "children": [1, 2]},
        {"camera": 0},
        {"camera": 2}
    ]);
    let scene = builder.read();
    let [front, plan] = &scene.cameras[..] else { panic!("{:?}", scene.cameras) };
    assert_eq!((front.name.as_str(), plan.name.as_str()), ("front", "plan"));
    let place = (glam::Vec3::new(1.0, 2.0, 3.0), glam::Vec3::Z, glam::Vec3::Y);
    for NamedCamera { camera, .. } in [front, plan] {
        assert_eq!((camera.eye, camera.forward, camera.up), place);
    }
    assert_eq!(front.camera.lens, Lens::Perspective { fov_y_rad: 0.5 });
    assert_eq!(plan.camera.lens, Lens::Orthographic { height: 6.0 });
    assert_eq!((front.camera.near, plan.camera.near), (Some(0.1), None));
    let notes = [
        "camera 0, orthographic: far plane of the camera not applied",
        "camera 2: camera left out: it is neither perspective nor orthographic",
    ];
    assert_eq!(scene.notes[..2], notes);
    let left_out = LeftOutCamera {
        name: "node 2".to_owned(),
        number: 3,
        problem: "it is neither perspective nor orthographic".to_owned(),
    };
    assert_eq!(scene.left_out_cameras, [left_out]);
}

#[test]
fn gltf_camera_that_is_none_is_left_out_with_a_note() {
    let camera = |camera: serde_json::Value| {
        let mut builder = Builder::square();
        builder.doc["cameras"] = json!([{"perspective": {"yfov": 1, "znear": 2}, "name": "good"}, camera]);
        builder.doc["nodes"] =
            json!([{"mesh": 0, "children": [1, 2]}, {"camera": 1, "name": "bad"}, {"camera": 0}]);
        builder.read()
    };
    for (bad, why) in [
        (json!({"perspective": {"yfov": 3.2}}), "its yfov is 3.2, but must be more than 0 and less than pi"),
        (json!({"perspective": {"yfov": 0}}), "its yfov is 0, but must be more than 0 and less than pi"),
        (json!({"perspective": {"yfov": "wide"}}), "yfov is \"wide\", which is not a 32-bit number"),
        (json!({"perspective": {}}), "yfov is missing"),
        (json!({"perspective": 1}), "is not an object"),
        (json!({"orthographic": {"ymag": 0}}), "its ymag is 0.0, but must be more than 0"),
        (json!({"orthographic": {"ymag": 3e38}}), "its ymag is 3e38, but must be more than 0"),
        (json!({"type": "perspective"}), "it is neither perspective nor orthographic"),
        (json!([]), "is not an object"),
    ] {
        let scene = camera(bad);
        let names: Vec<&str> = scene.cameras.iter().map(|camera| camera.name.as_str()).collect();
        assert_eq!(
            (names, scene.instances.len(), scene.notes.len()),
            (vec!["good"], 1, 1),
            "{:?}",
            scene.notes
        );
        assert!(scene.notes[0].contains(&format!(": camera left out: {why}")), "{:?}", scene.notes);
        let [left_out] = &scene.left_out_cameras[..] else { panic!() };
        assert_eq!((left_out.name.as_str(), left_out.number), ("bad", 1));
        assert!(left_out.problem.starts_with(why), "{}", left_out.problem);
    }
    // A near plane that is none leaves a camera that can be used.
    for (odd, why) in [
        (json!({"perspective": {"yfov": 1}}), "znear is missing"),
        (json!({"perspective": {"yfov": 1, "znear": 0}}), "znear is 0, but must be more than 0"),
        (json!({"perspective": {"yfov": 1, "znear": "x"}}), "znear is \"x\", which is not a 32-bit number"),
        (json!({"orthographic": {"ymag": 1, "znear": -1}}), "znear is -1, but must be more than 0"),
    ] {
        let scene = camera(odd);
        let nears: Vec<_> = scene.cameras.iter().map(|camera| camera.camera.near).collect();
        assert_eq!(nears, [None, Some(2.0)]);
        assert!(
            scene.notes[0].ends_with(&format!(": near plane of the camera left open: {why}")),
            "{:?}",
            scene.notes
        );
    }
    let mut builder = Builder::square();
    builder.doc["nodes"][0]["camera"] = 5.into();
    let scene = builder.read();
    assert_eq!(scene.notes, ["node 0: camera left out: names camera 5, but there are 0"]);
    assert_eq!(scene.left_out_cameras[0].name, "node 0");
}
