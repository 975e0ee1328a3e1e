//! Nodes, lights, cameras, and the extensions that a document may require.

use serde_json::json;
use umbrage::scene::{NamedCamera, Scope};
use umbrage::view::Lens;

use super::{Builder, SQUARE, identity};

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
    assert_eq!(
        scene.notes[0],
        "node 1 and 1 more: light left out, for its node is flattened to no direction"
    );
    builder.doc["nodes"][1]["extensions"] = holds(3);
    assert!(builder.refusal().contains("node 1, KHR_lights_punctual (gltf): names light 3, but there are 3"));
    builder.doc["nodes"][1]["extensions"] = holds(1);
    builder.doc["extensions"]["KHR_lights_punctual"]["lights"][1]["range"] = 0.into();
    assert!(builder.refusal().contains("light 1 (gltf): has a range that is not above 0"));
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
    assert_eq!(scene.notes[0], "camera 2: camera that is neither perspective nor orthographic left out");
    builder.doc["cameras"][1]["perspective"]["yfov"] = 4.into();
    assert!(builder.refusal().contains("camera 1, perspective (gltf): yfov is 4"));
    builder.doc["cameras"][1]["perspective"]["yfov"] = 0.5.into();
    builder.doc["cameras"][0]["orthographic"]["ymag"] = 0.into();
    assert!(builder.refusal().contains("camera 0, orthographic (gltf): ymag is 0"));
}

#[test]
fn gltf_extensions_that_leave_geometry_alone_are_accepted() {
    let mut builder = Builder::square();
    builder.doc["extensionsRequired"] = json!([
        "KHR_texture_transform",
        "KHR_materials_unlit",
        "KHR_materials_pbrSpecularGlossiness",
        "KHR_texture_basisu",
        "EXT_texture_webp",
        "KHR_lights_punctual",
        "KHR_mesh_quantization"
    ]);
    // The image is only in the extension, and the material is invalid: neither matters for shadows.
    builder.doc["textures"] = json!([{"extensions": {"KHR_texture_basisu": {"source": 0}}}]);
    builder.doc["materials"] = json!([{"alphaMode": 7}]);
    assert_eq!(builder.read().meshes[0].face_count(), 2);
    for name in ["KHR_draco_mesh_compression", "EXT_meshopt_compression", "EXT_mesh_gpu_instancing", "X_new"]
    {
        builder.doc["extensionsRequired"] = json!([name]);
        assert!(
            builder.refusal().contains(&format!("requires the extension {name}, which is not supported"))
        );
    }
}

#[test]
fn gltf_gpu_instances_that_are_not_required_are_noted() {
    let mut builder = Builder::square();
    builder.doc["nodes"][0]["extensions"] = json!({"EXT_mesh_gpu_instancing": {"attributes": {}}});
    let scene = builder.read();
    assert_eq!(scene.instances.len(), 1);
    assert_eq!(scene.notes, ["node 0: node with EXT_mesh_gpu_instancing read as a single instance"]);
}

#[test]
fn gltf_compressed_data_without_plain_data_is_refused_by_name() {
    let mut builder = Builder::square();
    builder.doc["meshes"][0]["primitives"][0]["extensions"] = json!({"KHR_draco_mesh_compression": {}});
    assert_eq!(builder.read().meshes[0].positions(), SQUARE, "the plain data is there");
    builder.doc["accessors"][0].as_object_mut().unwrap().remove("bufferView");
    assert!(builder.refusal().contains("primitive 0 (gltf): is compressed with KHR_draco_mesh_compression"));

    let mut builder = Builder::square();
    builder.doc["buffers"] = json!([{"byteLength": 1000, "extensions": {"EXT_meshopt_compression": {}}}]);
    assert!(builder.refusal().contains("buffer 0 (gltf): is compressed with EXT_meshopt_compression"));
}
