//! Malformed documents: refused with one line that names the location, and never a panic.

use serde_json::{Value, json};
use umbrage::read::read_bytes;
use umbrage::scene::Scope;

use super::{Builder, SQUARE, f32s, refusal, u16s};

#[test]
fn gltf_node_cycles_and_second_parents_are_refused() {
    let mut builder = Builder::square();
    // (nodes, roots, message)
    let cases = [
        (json!([{"children": [0]}]), json!([0]), "node 0 (gltf): is its own ancestor"),
        (
            json!([{"mesh": 0}, {"children": [2]}, {"children": [1, 3]}, {}]),
            json!([0, 1]),
            "is its own ancestor",
        ),
        (json!([{"children": [1]}, {"children": [0]}]), json!([0, 1]), "is its own ancestor"),
        (
            json!([{"children": [2]}, {"children": [2]}, {}]),
            json!([0, 1]),
            "node 2 (gltf): has two parents in the scene, node 0 and node 1",
        ),
        (
            json!([{"children": [1, 2]}, {"children": [2]}, {}]),
            json!([0]),
            "node 2 (gltf): has two parents in the scene, node 0 and node 1",
        ),
        (json!([{"children": [1]}]), json!([0]), "node 0 (gltf): names node 1, but there are 1"),
        (json!([{"children": "all"}]), json!([0]), "node 0 (gltf): children is not a list"),
        (json!([{"mesh": 1}]), json!([0]), "node 0 (gltf): names mesh 1, but there are 1"),
        (json!([{"mesh": 4294967296_u64}]), json!([0]), "names mesh 4294967296, but there are 1"),
        (json!([{"mesh": -1}]), json!([0]), "mesh is -1, which is not a count"),
        (json!([{"matrix": [1, 2]}]), json!([0]), "node 0 (gltf): matrix is not a list of 16 numbers"),
        (json!([{"rotation": [0, 0, 0, 0]}]), json!([0]), "node 0 (gltf): has a rotation of length zero"),
        (json!([{"scale": [1e39, 1, 1]}]), json!([0]), "stands beyond the range of 32-bit floats"),
        (json!([{"matrix": [1,0,0,1, 0,1,0,0, 0,0,1,0, 0,0,0,1]}]), json!([0]), "last row is not 0, 0, 0, 1"),
    ];
    for (nodes, roots, wanted) in cases {
        builder.doc["nodes"] = nodes;
        builder.doc["scenes"][0]["nodes"] = roots;
        let message = builder.refusal();
        assert!(message.contains(wanted), "{message} / {wanted}");
    }
}

#[test]
fn gltf_deep_chain_of_nodes_does_not_overflow_the_stack() {
    let mut builder = Builder::square();
    let depth = 200_000;
    let mut nodes: Vec<Value> = (1..depth).map(|child| json!({"children": [child]})).collect();
    nodes.push(json!({"mesh": 0}));
    builder.doc["nodes"] = nodes.into();
    assert_eq!(builder.read().instances.len(), 1);
}

#[test]
fn gltf_accessors_of_the_wrong_type_are_named() {
    // (accessor, field, value, message)
    let cases = [
        (
            0,
            "type",
            json!("VEC2"),
            "primitive 0, accessor 0 (gltf): is of type VEC2, but a position is a VEC3",
        ),
        (0, "componentType", json!(5125), "accessor 0 (gltf): holds 32-bit integers"),
        (0, "componentType", json!(5130), "accessor 0 (gltf): has the component type 5130"),
        (1, "componentType", json!(5126), "accessor 1 (gltf): holds numbers that are not unsigned integers"),
        (1, "type", json!("VEC2"), "accessor 1 (gltf): is of type VEC2, but an index is a SCALAR"),
        (
            0,
            "count",
            json!(5),
            "5 elements of 12 bytes, 12 apart from byte 0, do not fit buffer view 0, which has 48",
        ),
        (0, "count", json!(u64::MAX), "do not fit buffer view 0"),
        (0, "count", json!(-4), "count is -4, which is not a count"),
        (0, "count", json!(3), "primitive 0 (gltf): index 5 names vertex 3, but there are 3"),
        (0, "byteOffset", json!(u64::MAX), "do not fit buffer view 0"),
        (0, "bufferView", json!(9), "accessor 0 (gltf): names buffer view 9, but there are 2"),
    ];
    for (accessor, field, value, wanted) in cases {
        let mut builder = Builder::square();
        builder.doc["accessors"][accessor][field] = value;
        let message = builder.refusal();
        assert!(message.contains(wanted), "{message} / {wanted}");
    }
    for (field, value) in
        [("byteOffset", u64::MAX), ("byteOffset", 100), ("byteLength", 61), ("byteLength", u64::MAX)]
    {
        let mut builder = Builder::square();
        builder.doc["bufferViews"][0][field] = value.into();
        let message = builder.refusal();
        assert!(
            message.contains("buffer view 0 (gltf): is ") && message.contains("but buffer 0 has 60"),
            "{message}"
        );
    }
}

#[test]
fn gltf_count_without_data_is_bounded_by_the_file() {
    let mut builder = Builder::mesh(&SQUARE, 4, None);
    builder.doc["accessors"][0].as_object_mut().unwrap().remove("bufferView");
    assert_eq!(builder.read().meshes[0].positions(), [[0.0; 3]; 4], "no data stands for zeros");
    for count in [1_u64 << 32, u64::MAX, 5_000_000] {
        builder.doc["accessors"][0]["count"] = count.into();
        assert!(builder.refusal().contains("accessor 0 (gltf): asks for "), "{count}");
    }
}

#[test]
fn gltf_shared_accessors_do_not_multiply_beyond_the_file() {
    let mut builder = Builder::mesh(&vec![[0.0; 3]; 10_000], 4, None);
    let primitive = builder.doc["meshes"][0]["primitives"][0].clone();
    builder.doc["meshes"][0]["primitives"] = vec![primitive.clone(); 100].into();
    assert_eq!(builder.read().meshes[0].vertex_count(), 1_000_000);
    builder.doc["meshes"][0]["primitives"] = vec![primitive; 1000].into();
    assert!(
        builder.refusal().contains("more may be decoded from a file of this size; export every primitive")
    );
    // Frames count too.
    let mut builder = Builder::mesh(&vec![[0.0; 3]; 10_000], 4, None);
    builder.doc["meshes"][0]["primitives"][0]["targets"] = vec![json!({}); 1000].into();
    assert!(builder.refusal().contains("mesh 0 (gltf): asks for 10000000 elements"));
}

#[test]
fn gltf_position_that_is_not_finite_names_primitive_and_accessor() {
    for value in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        let mut positions = SQUARE;
        positions[2][1] = value;
        let message = Builder::mesh(&positions, 4, None).refusal();
        let wanted = format!(
            "a.gltf, mesh 0, primitive 0, accessor 0 (gltf): element 2 has the coordinate {value}, which is not a finite number; \
             export the file again"
        );
        assert_eq!(message, wanted);
    }
    let mut builder = Builder::square();
    let far = builder.positions(&[[f32::MAX; 3]; 4]);
    builder.doc["accessors"][0]["bufferView"] = builder.doc["accessors"][far]["bufferView"].clone();
    builder.doc["meshes"][0]["primitives"][0]["targets"] = json!([{"POSITION": far}]);
    assert!(builder.refusal().contains("mesh 0 (gltf): vertex 0 has the coordinate inf"));
}

#[test]
fn gltf_document_that_is_none_is_refused() {
    let cases = [
        ("{}", "states no glTF version"),
        (
            r#"{"asset":{"version":"1.0"}}"#,
            "is glTF version `1.0`, but only version 2 can be read; export as glTF 2.0",
        ),
        (r#"{"asset":{"version":"2.0"},"nodes":{}}"#, "nodes is not a list"),
        (r#"{"asset":{"version":"2.0"},"nodes":[3]}"#, "node 0 (gltf): is not an object"),
        (r#"{"asset":{"version":"2.0"},"meshes":"x"}"#, "meshes is not a list"),
        (r#"{"asset":{"version":3},"meshes":[]}"#, "is glTF version `3`, but only version 2 can be read"),
    ];
    for (text, wanted) in cases {
        let message = refusal(text.as_bytes());
        assert!(message.contains(wanted), "{message} / {wanted}");
    }
    let empty = read_bytes(br#"{"asset":{"version":"2.0"}}"#, "a.gltf").unwrap();
    assert!(empty.meshes.is_empty() && empty.instances.is_empty());
}

/// A document with every feature that is read.
pub(super) fn rich() -> Builder {
    let mut builder = Builder::square();
    let indices = builder.view(&u16s(&[1, 3]));
    let values = builder.view(&f32s(&[5.0, 6.0, 7.0, 8.0, 9.0, 10.0]));
    builder.doc["accessors"][0]["byteOffset"] = 0.into();
    builder.doc["accessors"][0]["sparse"] = json!({
        "count": 2, "indices": {"bufferView": indices, "byteOffset": 0, "componentType": 5123},
        "values": {"bufferView": values, "byteOffset": 0}
    });
    builder.doc["bufferViews"][0]["byteStride"] = 12.into();
    builder.doc["meshes"][0]["weights"] = json!([0]);
    builder.doc["meshes"][0]["name"] = "car".into();
    builder.doc["meshes"][0]["primitives"][0]["targets"] = json!([{"POSITION": 0}]);
    builder.doc["meshes"][0]["primitives"][0]["material"] = 0.into();
    builder.doc["materials"] = json!([{"name": "Wheel"}]);
    builder.doc["cameras"] = json!([{"perspective": {"yfov": 1}}]);
    builder.doc["skins"] = json!([{"joints": [0]}]);
    builder.doc["animations"] = json!([{}]);
    builder.doc["extensionsUsed"] = json!(["KHR_lights_punctual"]);
    builder.doc["extensionsRequired"] = json!(["KHR_lights_punctual"]);
    let spot = json!({"type": "spot", "color": [1, 1, 1], "intensity": 2, "spot": {"innerConeAngle": 0, "outerConeAngle": 1}});
    builder.doc["extensions"] = json!({"KHR_lights_punctual": {"lights": [spot]}});
    builder.doc["nodes"] = json!([
        {"children": [1, 2], "camera": 0, "translation": [1, 2, 3], "rotation": [0, 0, 0, 1], "scale": [1, 1, 1]},
        {"mesh": 0, "extensions": {"KHR_lights_punctual": {"light": 0}}},
        {"mesh": 0, "skin": 0, "matrix": [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1]}
    ]);
    builder.doc["buffers"] = serde_json::from_slice::<Value>(&builder.gltf()).unwrap()["buffers"].clone();
    builder
}

/// The JSON pointers of all values in `value`, itself included.
pub(super) fn pointers(value: &Value, at: String, all: &mut Vec<String>) {
    match value {
        Value::Array(list) => {
            list.iter().enumerate().for_each(|(index, value)| pointers(value, format!("{at}/{index}"), all));
        }
        Value::Object(map) => {
            map.iter().for_each(|(key, value)| pointers(value, format!("{at}/{key}"), all));
        }
        _ => {}
    }
    all.push(at);
}

#[test]
fn gltf_with_any_value_replaced_or_removed_never_panics() {
    let builder = rich();
    let scene = builder.read();
    assert_eq!((scene.instances.len(), scene.lamps.len(), scene.cameras.len()), (2, 1, 1));
    let mut all = Vec::new();
    pointers(&builder.doc, String::new(), &mut all);
    let hostile = [
        json!(null),
        json!(true),
        json!("x"),
        json!([]),
        json!({}),
        json!([{}]),
        json!(-1),
        json!(0.5),
        json!(1e39),
        json!(1e308),
        json!(0),
        json!(1),
        json!(2),
        json!(3),
        json!(7),
        json!(255),
        json!(5120),
        json!(5125),
        json!(5126),
        json!(1_000_000),
        json!(1_u64 << 32),
        json!(u64::MAX - 1),
        json!(u64::MAX),
    ];
    let (mut refused, mut read_anyway) = (0, 0);
    let mut attempt = |doc: &Value| match read_bytes(&serde_json::to_vec(doc).unwrap(), "a.gltf") {
        Ok(scene) => {
            read_anyway += 1;
            scene.bake(Scope::Mesh).ok();
        }
        Err(error) => {
            refused += 1;
            assert!(!error.to_string().contains('\n'));
        }
    };
    for pointer in &all {
        for value in &hostile {
            let mut doc = builder.doc.clone();
            *doc.pointer_mut(pointer).unwrap() = value.clone();
            attempt(&doc);
        }
        if let Some((parent, key)) = pointer.rsplit_once('/') {
            let mut doc = builder.doc.clone();
            match doc.pointer_mut(parent).unwrap() {
                Value::Array(list) => drop(list.remove(key.parse().unwrap())),
                Value::Object(map) => drop(map.remove(key)),
                _ => unreachable!("only these have children"),
            }
            attempt(&doc);
        }
    }
    assert!(refused > 1000 && read_anyway > 100, "{refused} refused, {read_anyway} read");
}
