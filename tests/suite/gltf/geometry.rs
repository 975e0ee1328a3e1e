//! Primitives and accessors: vertices, triangles, parts and frames that result from them.

use serde_json::json;

use super::{Builder, SQUARE, f32s, identity, u16s};

#[test]
fn gltf_triangle_list_indexed_and_not() {
    let scene = Builder::square().read();
    assert_eq!(scene.meshes[0].positions(), SQUARE);
    assert_eq!(scene.meshes[0].triangles(), [[0, 1, 2], [2, 1, 3]]);
    assert_eq!((scene.meshes[0].name.as_str(), scene.instances[0].name.as_str()), ("mesh 0", "node 0"));
    assert_eq!(scene.instances[0].world_from_mesh.to_cols_array(), identity());

    let scene = Builder::mesh(&SQUARE, 4, None).read();
    assert_eq!(scene.meshes[0].triangles(), [[0, 1, 2]]);
    assert_eq!(scene.notes, ["mesh 0, primitive 0: last triangle incomplete and left out"]);
}

#[test]
fn gltf_index_types_agree() {
    let wanted = Builder::square().read().meshes[0].clone();
    let list: [u8; 6] = [0, 1, 2, 2, 1, 3];
    let wide: Vec<u8> = list.iter().flat_map(|&index| u32::from(index).to_le_bytes()).collect();
    for (component, bytes) in [(5121, list.to_vec()), (5125, wide)] {
        let mut builder = Builder::mesh(&SQUARE, 4, None);
        let accessor = builder.accessor(component, "SCALAR", 6, &bytes);
        builder.doc["meshes"][0]["primitives"][0]["indices"] = accessor.into();
        assert_eq!(builder.read().meshes[0], wanted, "component type {component}");
    }
}

#[test]
fn gltf_strip_turns_every_other_triangle() {
    let scene = Builder::mesh(&SQUARE, 5, None).read();
    assert_eq!(scene.meshes[0].triangles(), [[0, 1, 2], [1, 3, 2]]);
    assert!(scene.notes.is_empty());

    let scene = Builder::mesh(&SQUARE, 5, Some(&[0, 1, 2, 2, 3, 1, 0])).read();
    assert_eq!(scene.meshes[0].triangles(), [[0, 1, 2], [2, 1, 3], [3, 1, 0]]);
    let note = "mesh 0, primitive 0 and 1 more: stitching triangle of a strip left out";
    assert_eq!(scene.notes, [note]);
    // Any two of the three indices may be equal.
    for stitch in [[0, 0, 1], [0, 1, 1], [0, 1, 0]] {
        assert_eq!(Builder::mesh(&SQUARE, 5, Some(&stitch)).read().meshes[0].face_count(), 0);
    }
    for short in [&[][..], &[0], &[0, 1]] {
        assert_eq!(Builder::mesh(&SQUARE, 5, Some(short)).read().meshes[0].face_count(), 0);
    }
}

#[test]
fn gltf_fan_turns_about_its_first_vertex() {
    let scene = Builder::mesh(&SQUARE, 6, Some(&[1, 3, 2, 0])).read();
    assert_eq!(scene.meshes[0].triangles(), [[3, 2, 1], [2, 0, 1]]);
    assert_eq!(Builder::mesh(&SQUARE, 6, None).read().meshes[0].face_count(), 2);
    for short in [&[][..], &[0], &[0, 1]] {
        assert_eq!(Builder::mesh(&SQUARE, 6, Some(short)).read().meshes[0].face_count(), 0);
    }
}

#[test]
fn gltf_points_and_lines_are_left_out_and_noted() {
    for mode in 0..4 {
        let scene = Builder::mesh(&SQUARE, mode, None).read();
        assert_eq!((scene.meshes[0].vertex_count(), scene.meshes[0].face_count()), (0, 0));
        assert_eq!(scene.notes, ["mesh 0, primitive 0: primitive of points or lines left out"]);
    }
    assert!(Builder::mesh(&SQUARE, 7, None).refusal().contains("mesh 0, primitive 0 (gltf): has the mode 7"));
}

#[test]
fn gltf_primitives_become_parts_with_vertices_of_their_own() {
    let mut builder = Builder::square();
    let primitive = builder.doc["meshes"][0]["primitives"][0].clone();
    builder.doc["meshes"][0] = json!({"name": "car", "primitives": [primitive, primitive, primitive]});
    builder.doc["meshes"][0]["primitives"][1]["mode"] = 1.into();
    builder.doc["meshes"][0]["primitives"][2]["material"] = 0.into();
    builder.doc["materials"] = json!([{"name": "Wheel"}]);
    let scene = builder.read();
    let mesh = &scene.meshes[0];
    assert_eq!((mesh.name.as_str(), mesh.vertex_count(), mesh.face_count()), ("car", 8, 4));
    assert_eq!(mesh.triangles()[2..], [[4, 5, 6], [6, 5, 7]]);
    let parts: Vec<_> = mesh.parts().iter().map(|part| (part.name.as_str(), part.faces.clone())).collect();
    assert_eq!(parts, [("primitive 0", 0..2), ("primitive 2 (Wheel)", 2..4)]);
}

#[test]
fn gltf_stride_and_offset_pick_interleaved_positions() {
    let mut builder = Builder::square();
    let interleaved: Vec<f32> = SQUARE.iter().flat_map(|p| [9.0, p[0], p[1], p[2], 9.0]).collect();
    let view = builder.view(&f32s(&interleaved));
    builder.doc["bufferViews"][view]["byteStride"] = 20.into();
    builder.doc["accessors"][0]["bufferView"] = view.into();
    builder.doc["accessors"][0]["byteOffset"] = 4.into();
    assert_eq!(builder.read().meshes[0].positions(), SQUARE);
    builder.doc["accessors"][0]["byteOffset"] = 12.into();
    assert!(
        builder
            .refusal()
            .contains("accessor 0 (gltf): 4 elements of 12 bytes, 20 apart from byte 12, do not fit")
    );
    builder.doc["bufferViews"][view]["byteStride"] = 8.into();
    assert!(builder.refusal().contains("has a stride of 8 bytes, but an element has 12"));
}

#[test]
fn gltf_sparse_values_replace_elements() {
    for dense in [true, false] {
        let mut builder = Builder::square();
        let indices = builder.view(&u16s(&[1, 3]));
        let values = builder.view(&f32s(&[5.0, 6.0, 7.0, 8.0, 9.0, 10.0]));
        let sparse = json!({
            "count": 2, "indices": {"bufferView": indices, "componentType": 5123}, "values": {"bufferView": values}
        });
        builder.doc["accessors"][0]["sparse"] = sparse;
        let mut wanted = SQUARE;
        if !dense {
            builder.doc["accessors"][0].as_object_mut().unwrap().remove("bufferView");
            wanted = [[0.0; 3]; 4];
        }
        (wanted[1], wanted[3]) = ([5.0, 6.0, 7.0], [8.0, 9.0, 10.0]);
        assert_eq!(builder.read().meshes[0].positions(), wanted);

        let place = "mesh 0, primitive 0, accessor 0, sparse, indices (gltf)";
        let mut descending = Builder { doc: builder.doc.clone(), bin: builder.bin.clone() };
        let view = descending.view(&u16s(&[3, 3]));
        descending.doc["accessors"][0]["sparse"]["indices"]["bufferView"] = view.into();
        assert!(descending.refusal().contains(&format!("{place}: 3 does not ascend at index 1")));
        let view = descending.view(&u16s(&[1, 4]));
        descending.doc["accessors"][0]["sparse"]["indices"]["bufferView"] = view.into();
        assert!(
            descending.refusal().contains(&format!("{place}: 4 is out of range, for there are 4 elements"))
        );
        builder.doc["accessors"][0]["sparse"]["count"] = 3.into();
        assert!(
            builder.refusal().contains("3 elements of 2 bytes, 2 apart from byte 0, do not fit buffer view")
        );
    }
}

#[test]
fn gltf_quantized_positions_are_read_in_every_type() {
    // (component type, bytes of one element, the position as stored, the position normalized)
    let cases = [
        (5120, vec![127, 0x80, 0], [127.0, -128.0, 0.0], [1.0, -1.0, 0.0]),
        (5121, vec![255, 51, 0], [255.0, 51.0, 0.0], [1.0, 0.2, 0.0]),
        (5122, u16s(&[32767, 0x8000, 0]), [32767.0, -32768.0, 0.0], [1.0, -1.0, 0.0]),
        (5123, u16s(&[65535, 13107, 0]), [65535.0, 13107.0, 0.0], [1.0, 0.2, 0.0]),
    ];
    for (component, bytes, plain, normalized) in cases {
        let mut builder = Builder::mesh(&SQUARE[..1], 4, None);
        let accessor = builder.accessor(component, "VEC3", 1, &bytes);
        builder.doc["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = accessor.into();
        builder.doc["extensionsUsed"] = json!(["KHR_mesh_quantization"]);
        builder.doc["extensionsRequired"] = json!(["KHR_mesh_quantization"]);
        assert_eq!(builder.read().meshes[0].positions(), [plain]);
        builder.doc["accessors"][accessor]["normalized"] = true.into();
        assert_eq!(builder.read().meshes[0].positions(), [normalized]);
    }
}

#[test]
fn gltf_morph_targets_become_frames() {
    let mut builder = Builder::square();
    let up = builder.positions(&[[0.0, 0.0, 1.0]; 4]);
    let primitive = builder.doc["meshes"][0]["primitives"][0].clone();
    let mut morphed = primitive.clone();
    morphed["targets"] = json!([{"NORMAL": up}, {"POSITION": up}]);
    builder.doc["meshes"][0] = json!({"primitives": [primitive, morphed], "weights": [0.5, 0.0]});
    let scene = builder.read();
    let mesh = &scene.meshes[0];
    let raised = SQUARE.map(|p| [p[0], p[1], p[2] + 1.0]);
    assert_eq!(mesh.frames(), [[SQUARE, SQUARE].concat(), [SQUARE, raised].concat()]);
    assert_eq!(mesh.positions(), [SQUARE, SQUARE].concat());
    assert_eq!(scene.notes, ["mesh 0: default morph weights ignored, read at rest"]);

    let few = builder.positions(&SQUARE[..3]);
    builder.doc["meshes"][0]["primitives"][1]["targets"][1]["POSITION"] = few.into();
    assert!(builder.refusal().contains("morph target 1 (gltf): moves 3 vertices, but the primitive has 4"));
}
