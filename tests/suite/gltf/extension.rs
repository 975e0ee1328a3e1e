//! Extensions that a document requires: what leaves geometry alone is read with a note, what changes it is
//! refused by name and with a remedy.

use serde_json::json;

use super::{Builder, SQUARE};

#[test]
fn extension_that_leaves_geometry_alone_is_noted() {
    let mut builder = Builder::square();
    // The image is only in the extension, and the material is invalid: neither matters for shadows.
    builder.doc["textures"] = json!([{"extensions": {"KHR_texture_basisu": {"source": 0}}}]);
    builder.doc["materials"] = json!([{"alphaMode": 7}]);
    let note = "required extension that leaves geometry alone, as far as is known, not read";
    for name in [
        "KHR_texture_transform",
        "KHR_materials_pbrSpecularGlossiness",
        "KHR_texture_basisu",
        "KHR_techniques_webgl",
        "EXT_mesh_features",
        "EXT_structural_metadata",
        "KHR_xmp_json_ld",
        "MSFT_lod",
        "VRMC_vrm",
        "ACME_never_heard_of",
    ] {
        builder.doc["extensionsRequired"] = json!([name]);
        let scene = builder.read();
        assert_eq!(scene.meshes[0].face_count(), 2);
        assert_eq!(scene.notes[0], format!("extensionsRequired: {note}: `{name}`"));
    }
    builder.doc["extensionsRequired"] =
        json!(["A_one", "B_two", "KHR_lights_punctual", "KHR_mesh_quantization", 7]);
    builder.doc["extensionsUsed"] = json!(["KHR_materials_unlit"]);
    let scene = builder.read();
    assert_eq!(scene.notes[0], format!("extensionsRequired and 2 more: {note}: of the first, `A_one`"));
    assert_eq!(scene.notes.len(), 2, "{:?}", scene.notes);
}

#[test]
fn extension_that_changes_geometry_is_refused_by_name_if_required_and_noted_if_not() {
    for (name, remedy) in [
        ("CESIUM_RTC", "export with the center as the translation of the root node"),
        ("WEB3D_quantized_attributes", "export with KHR_mesh_quantization or plain floats"),
        ("EXT_mesh_primitive_restart", "export one primitive for each strip"),
    ] {
        let mut builder = Builder::square();
        builder.doc["extensionsUsed"] = json!([name]);
        let note =
            format!("extensionsUsed: extension that changes geometry, but is not required, not read: {name}");
        assert_eq!(builder.read().notes, [note]);
        builder.doc["extensionsRequired"] = json!([name]);
        let message = builder.refusal();
        let wanted = format!("requires the extension {name}, which is not supported; {remedy}");
        assert!(message.ends_with(&wanted), "{message}");
    }
}

#[test]
fn extension_that_stores_data_is_refused_where_the_plain_data_is_missing() {
    let decompress = "write the file without it: `gltf-transform cp IN.glb OUT.glb` does";
    for (name, remedy) in [
        ("MESHOPT_compression", decompress),
        ("ACME_mesh_compression", decompress),
        ("ACME_cubes", "export without this extension"),
    ] {
        let mut builder = Builder::square();
        builder.doc["extensionsRequired"] = json!([name]);
        builder.doc["meshes"][0]["primitives"][0]["extensions"] = json!({name: {}});
        assert_eq!(builder.read().meshes[0].positions(), SQUARE, "the plain data is there");
        for accessor in [0, 1] {
            let mut missing = Builder { doc: builder.doc.clone(), bin: builder.bin.clone() };
            missing.doc["accessors"][accessor].as_object_mut().unwrap().remove("bufferView");
            let message = missing.refusal();
            let wanted = format!(
                "mesh 0, primitive 0 (gltf): has no plain data, and its extension `{name}` is not supported; {remedy}"
            );
            assert!(message.ends_with(&wanted), "{message}");
        }
        let mut builder = Builder::square();
        builder.doc["buffers"] = json!([{"byteLength": 1000, "extensions": {name: {}}}]);
        let message = builder.refusal();
        assert!(
            message
                .contains(&format!("buffer 0 (gltf): has no plain data, and its extension `{name}` is not")),
            "{message}"
        );
    }
    let mut builder = Builder::mesh(&SQUARE, 4, None);
    builder.doc["accessors"][0].as_object_mut().unwrap().remove("bufferView");
    assert_eq!(builder.read().notes[0], "accessor 0: accessor without data read as zeros");
}

#[test]
fn extension_of_visibility_hides_a_node_and_all_below_it() {
    let mut builder = Builder::square();
    let hides = |visible: serde_json::Value| json!({"KHR_node_visibility": {"visible": visible}});
    builder.doc["cameras"] = json!([{"perspective": {"yfov": 1, "znear": 1}}]);
    builder.doc["extensionsUsed"] = json!(["KHR_node_visibility", "KHR_lights_punctual"]);
    builder.doc["extensions"] = json!({"KHR_lights_punctual": {"lights": [{"type": "point"}]}});
    builder.doc["nodes"] = json!([
        {"name": "seen", "mesh": 0, "extensions": hides(json!(true))},
        {"name": "hidden", "mesh": 0, "children": [2, 3], "extensions": hides(json!(false))},
        {"name": "below", "mesh": 0, "extensions": hides(json!(true))},
        {"name": "further", "children": [4]},
        {"mesh": 0, "camera": 0, "extensions": {"KHR_lights_punctual": {"light": 0}}},
        {"name": "odd", "mesh": 0, "extensions": hides(json!(0))},
        {"name": "default", "mesh": 0, "extensions": {"KHR_node_visibility": {}}}
    ]);
    builder.doc["scenes"][0]["nodes"] = json!([0, 1, 5, 6]);
    let scene = builder.read();
    let names: Vec<&str> = scene.instances.iter().map(|instance| instance.name.as_str()).collect();
    assert_eq!(names, ["seen", "odd", "default"]);
    // Lamps are hidden, cameras are not.
    assert_eq!((scene.lamps.len(), scene.cameras.len()), (0, 1));
    let notes = [
        "node 1: hidden node (KHR_node_visibility) left out, with all below it",
        "node 5: node taken for visible: visible is not true or false",
    ];
    assert_eq!(scene.notes, notes);
}
