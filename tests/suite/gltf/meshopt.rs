//! EXT_meshopt_compression and KHR_meshopt_compression: documents compressed by the naive encoder of the fuzz
//! targets, which read as what went in.

use glam::{Mat4, Quat};
use serde_json::{Value, json};
use umbrage::mesh::Mesh;
use umbrage::testing::shapes;

use super::{Builder, SQUARE, f32s, u16s};
use crate::fuzz::body::meshopt::{attributes, sequence, triangles};

impl Builder {
    /// Replaces a view by its compressed form: `stream` stands for `count` elements of `stride` bytes.
    fn compress(&mut self, view: usize, stream: &[u8], mode: &str, count: usize, stride: usize) {
        let (start, name) = (self.bin.len(), "EXT_meshopt_compression");
        self.bin.extend_from_slice(stream);
        let view = &mut self.doc["bufferViews"][view];
        view["buffer"] = 1.into();
        view["extensions"] = json!({name: {
            "buffer": 0, "byteOffset": start, "byteLength": stream.len(), "byteStride": stride, "mode": mode, "count": count
        }});
        self.doc["extensionsRequired"] = json!([name]);
        let fallback = json!({"byteLength": start, "extensions": {name: {"fallback": true}}});
        self.doc["buffers"] = json!([self.embedded(), fallback]);
    }

    fn compressed(&mut self, view: usize) -> &mut Value {
        &mut self.doc["bufferViews"][view]["extensions"]["EXT_meshopt_compression"]
    }
}

/// The mesh with its positions and indices (of `index_bytes` each) compressed.
pub(super) fn document(mesh: &Mesh, index_bytes: usize, mode: &str) -> Builder {
    let mut builder = Builder::mesh(mesh.positions(), 4, None);
    let indices: Vec<u32> = mesh.triangles().iter().flatten().copied().collect();
    let bytes: Vec<u8> =
        indices.iter().flat_map(|index| index.to_le_bytes()[..index_bytes].to_vec()).collect();
    let component = if index_bytes == 2 { 5123 } else { 5125 };
    let accessor = builder.accessor(component, "SCALAR", indices.len(), &bytes);
    builder.doc["meshes"][0]["primitives"][0]["indices"] = accessor.into();
    builder.bin.clear();
    let positions = f32s(mesh.positions().as_flattened());
    builder.compress(0, &attributes(&positions, 12), "ATTRIBUTES", mesh.vertex_count(), 12);
    let stream = if mode == "TRIANGLES" { triangles(&indices) } else { sequence(&indices) };
    builder.compress(1, &stream, mode, indices.len(), index_bytes);
    builder
}

#[test]
fn meshopt_documents_read_as_the_mesh_that_was_compressed() {
    let soup = shapes::soup(&shapes::icosphere(2));
    for mesh in [shapes::cube(), shapes::icosphere(3), shapes::torus(40, 20, 1.0, 0.3), soup] {
        for (index_bytes, mode) in [(2, "TRIANGLES"), (4, "TRIANGLES"), (2, "INDICES"), (4, "INDICES")] {
            let builder = document(&mesh, index_bytes, mode);
            let scene = builder.read();
            assert_eq!(scene.meshes[0].positions(), mesh.positions());
            assert_eq!(scene.meshes[0].triangles(), mesh.triangles(), "{mode}");
            assert!(scene.notes.is_empty(), "{:?}", scene.notes);
            let mut glb = Builder { doc: builder.doc.clone(), bin: builder.bin.clone() };
            glb.doc["buffers"][0] = json!({"byteLength": glb.bin.len()});
            let buffers = glb.doc["buffers"].clone();
            assert_eq!(
                umbrage::read::read_bytes(&glb.glb_with(buffers), "a.glb").unwrap().meshes,
                scene.meshes
            );
        }
    }
}

#[test]
fn meshopt_interleaved_and_quantized_positions_decode() {
    // Positions of 16 bits in 20 bytes, with something else in between, in more than one block.
    let positions: Vec<[u16; 3]> = (0..700_u16).map(|i| [i, i.wrapping_mul(i), 65535 - 9 * i]).collect();
    let element = |p: &[u16; 3]| [u16s(&[7, 7]), u16s(p), u16s(&[p[0], 1, 2, 3, 4])].concat();
    let bytes: Vec<u8> = positions.iter().flat_map(element).collect();
    for normalized in [false, true] {
        let mut builder = Builder::mesh(&[], 0, None);
        builder.doc["meshes"][0]["primitives"][0]["mode"] = 4.into();
        let accessor = builder.accessor(5123, "VEC3", positions.len(), &bytes);
        builder.doc["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = accessor.into();
        builder.doc["accessors"][accessor]["normalized"] = normalized.into();
        builder.doc["accessors"][accessor]["byteOffset"] = 4.into();
        builder.doc["bufferViews"][accessor]["byteStride"] = 20.into();
        builder.doc["extensionsUsed"] = json!(["KHR_mesh_quantization"]);
        builder.compress(accessor, &attributes(&bytes, 20), "ATTRIBUTES", positions.len(), 20);
        let wanted: Vec<[f32; 3]> = positions
            .iter()
            .map(|p| p.map(|x| f32::from(x) / if normalized { 65535.0 } else { 1.0 }))
            .collect();
        assert_eq!(builder.read().meshes[0].positions(), wanted);
    }
}

#[test]
fn meshopt_filters_reach_positions_and_instances() {
    // 1.5·2⁴, −3·2⁻², 0: mantissas with exponents in their highest byte.
    let mut builder = Builder::square();
    let elements: Vec<u8> = [[3 | 3 << 24, 0x00ff_fffd | 0xfe << 24, 0], [0, 0, 1], [5, 0, 0], [0, 5, 0]]
        .iter()
        .flat_map(|p: &[u32; 3]| p.iter().flat_map(|x| x.to_le_bytes()))
        .collect();
    builder.compress(0, &attributes(&elements, 12), "ATTRIBUTES", 4, 12);
    builder.compressed(0)["filter"] = "EXPONENTIAL".into();
    builder.doc["bufferViews"][1]["buffer"] = 0.into();
    let wanted = [[24.0, -0.75, 0.0], [0.0, 0.0, 1.0], [5.0, 0.0, 0.0], [0.0, 5.0, 0.0]];
    assert_eq!(builder.read().meshes[0].positions(), wanted);

    // The identity; a quarter turn about z in 16 bits, z left out as the larger of the two.
    let mut builder = Builder::square();
    let elements: Vec<u8> = [[0, 0, 0, 0x7fff], [0x7fff_i16, 0, 0, 0x7ffe]]
        .iter()
        .flatten()
        .flat_map(|x| x.to_le_bytes())
        .collect();
    let accessor = builder.accessor(5122, "VEC4", 2, &elements);
    builder.doc["accessors"][accessor]["normalized"] = true.into();
    builder.doc["nodes"][0]["extensions"] =
        json!({"EXT_mesh_gpu_instancing": {"attributes": {"ROTATION": accessor}}});
    builder.compress(2, &attributes(&elements, 8), "ATTRIBUTES", 2, 8);
    builder.compressed(2)["filter"] = "QUATERNION".into();
    let scene = builder.read();
    let quarter = Mat4::from_quat(Quat::from_rotation_z(std::f32::consts::FRAC_PI_2));
    assert_eq!(scene.instances.len(), 2);
    assert!(scene.instances[0].world_from_mesh.abs_diff_eq(Mat4::IDENTITY, 1e-4));
    assert!(
        scene.instances[1].world_from_mesh.abs_diff_eq(quarter, 1e-4),
        "{}",
        scene.instances[1].world_from_mesh
    );
}

#[test]
fn meshopt_version_one_is_read_under_either_name() {
    let wanted = [[0.0, 0.0, 0.0], [300.0, 0.0, 0.0], [0.0, 300.0, 0.0], [300.0, 300.0, 7.0]];
    for name in ["KHR_meshopt_compression", "EXT_meshopt_compression"] {
        let mut builder = Builder::square();
        builder.doc["accessors"][0]["componentType"] = 5123.into();
        builder.doc["bufferViews"][0]["byteStride"] = 8.into();
        builder.doc["bufferViews"][0]["byteLength"] = 32.into();
        builder.doc["extensionsUsed"] = json!(["KHR_mesh_quantization"]);
        builder.compress(0, &SQUARE_V1, "ATTRIBUTES", 4, 8);
        let extension = builder.compressed(0).clone();
        builder.doc["bufferViews"][0]["extensions"] = json!({name: extension});
        builder.doc["extensionsRequired"] = json!([name]);
        assert_eq!(builder.read().meshes[0].positions(), wanted);
    }
}

/// (0, 0, 0), (300, 0, 0), (0, 300, 0), (300, 300, 7) in 16 bits, by the reference encoder (meshoptimizer 1.3).
const SQUARE_V1: [u8; 39] = [
    0xa1, 0xee, 0xab, 0x00, 0x4b, 0x4b, 0x4b, 0x00, 0x00, 0x4b, 0x00, 0x00, 0x00, 0x00, 0x0e, 0x00, 0x00,
    0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00,
    0x00, 0x00, 0x00, 0x62, 0x00,
];

#[test]
fn meshopt_compressed_data_wins_over_the_plain_unless_it_is_broken() {
    let mut builder = Builder::square();
    let moved = SQUARE.map(|[x, y, z]| [x + 5.0, y, z]);
    let plain = builder.bin.clone();
    builder.compress(0, &attributes(&f32s(moved.as_flattened()), 12), "ATTRIBUTES", 4, 12);
    // The bytes beside it are those before the stream.
    builder.doc["buffers"][1] = Builder { doc: json!({}), bin: plain }.embedded();
    builder.doc["bufferViews"][1]["buffer"] = 1.into();
    let scene = builder.read();
    assert_eq!((scene.meshes[0].positions(), scene.notes.len()), (&moved[..], 0));
    let length = builder.compressed(0)["byteLength"].as_u64().unwrap();
    builder.compressed(0)["byteLength"] = (length - 1).into();
    let scene = builder.read();
    assert_eq!(scene.meshes[0].positions(), SQUARE);
    let note = "buffer view 0, EXT_meshopt_compression: compressed data passed over for the plain data beside it: does not \
                decode: the stream ends too early";
    assert_eq!(scene.notes, [note]);
    builder.doc["buffers"][1] =
        json!({"byteLength": 60, "extensions": {"EXT_meshopt_compression": {"fallback": true}}});
    builder.doc["bufferViews"][1]["buffer"] = 0.into();
    let message = builder.refusal();
    let wanted = "buffer view 0, EXT_meshopt_compression (gltf): does not decode: the stream ends too early";
    assert!(message.contains(wanted), "{message}");
}

#[test]
fn meshopt_data_that_says_what_cannot_be_is_refused() {
    let sphere = shapes::icosphere(2);
    let place = |view: usize| format!("buffer view {view}, EXT_meshopt_compression (gltf): ");
    // (view, field, value, message)
    let cases: [(usize, &str, Value, &str); 16] = [
        (0, "count", json!(u64::MAX), "too few for 18446744073709551615 elements of 12 bytes as ATTRIBUTES"),
        (0, "count", json!(1_u64 << 40), "too few for 1099511627776 elements"),
        (0, "count", json!(1), "does not decode: there are bytes behind the last element"),
        (0, "byteStride", json!(10), "elements of 10 bytes, which the mode ATTRIBUTES does not allow"),
        (0, "byteStride", json!(0), "elements of 0 bytes, which the mode ATTRIBUTES does not allow"),
        (0, "byteStride", json!(260), "elements of 260 bytes, which the mode ATTRIBUTES does not allow"),
        (0, "filter", json!("QUATERNION"), "elements of 12 bytes, which the mode ATTRIBUTES does not allow"),
        (0, "filter", json!("COLOR"), "is filtered as colors, which are no positions, indices or rotations"),
        (0, "filter", json!("WHAT"), "has a mode and filter that are not among: ATTRIBUTES with"),
        (0, "mode", json!("TRIANGLES"), "elements of 12 bytes, which the mode TRIANGLES does not allow"),
        (0, "byteLength", json!(99_999_999), "is 99999999 bytes from byte 0, but buffer 0 has"),
        (
            0,
            "buffer",
            json!(1),
            "buffer 1 (gltf): has no plain data, and no data of `EXT_meshopt_compression` that could be read",
        ),
        (1, "count", json!(u64::MAX / 3 * 3), "too few for"),
        (1, "count", json!(4), "has 4 elements of 2 bytes, which the mode TRIANGLES does not allow"),
        (1, "mode", json!("INDICES"), "does not decode: the first byte is not that of indices"),
        (1, "byteLength", json!(7), "has 7 bytes, too few for 960 elements of 2 bytes as TRIANGLES"),
    ];
    for (view, field, value, wanted) in cases {
        let mut builder = document(&sphere, 2, "TRIANGLES");
        builder.compressed(view)[field] = value;
        let message = builder.refusal();
        assert!(message.contains(&place(view)) || field == "buffer", "{message}");
        assert!(message.contains(wanted), "{message} / {wanted}");
    }
    let mut builder = document(&sphere, 2, "TRIANGLES");
    builder.doc["bufferViews"][0]["byteLength"] = 9999.into();
    let message = builder.refusal();
    let wanted = format!(
        "buffer view 0 (gltf): is 9999 bytes, but its compressed data is {} bytes",
        12 * sphere.vertex_count()
    );
    assert!(message.contains(&wanted), "{message}");
}

#[test]
fn meshopt_blocks_of_nothing_are_bounded_by_the_file() {
    // Version 1: a control byte for four planes of 256 elements, all of them zeros.
    let (stride, blocks) = (256, 4000);
    let count = 32 * blocks;
    let mut stream = vec![0xa1];
    stream.extend(vec![0xaa; blocks * stride / 4]);
    stream.extend(vec![0; stride + stride / 4]);
    let mut builder = Builder::mesh(&[], 4, None);
    let accessor = builder.accessor(5126, "VEC3", count, &[]);
    builder.doc["bufferViews"][accessor]["byteStride"] = 256.into();
    builder.doc["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = accessor.into();
    builder.compress(accessor, &stream, "ATTRIBUTES", count, stride);
    builder.doc["bufferViews"][accessor]["byteLength"] = (count * stride).into();
    assert_eq!(builder.read().meshes[0].vertex_count(), count);
    // Many views of the same bytes: each would decode to 32 MB.
    let view = builder.doc["bufferViews"][accessor].clone();
    let object = builder.doc["accessors"][accessor].clone();
    let primitives: Vec<Value> = (0..40)
        .map(|index| {
            builder.doc["bufferViews"].as_array_mut().unwrap().push(view.clone());
            let mut object = object.clone();
            object["bufferView"] = (accessor + 1 + index).into();
            builder.doc["accessors"].as_array_mut().unwrap().push(object);
            json!({"attributes": {"POSITION": accessor + 1 + index}})
        })
        .collect();
    builder.doc["meshes"][0]["primitives"] = primitives.into();
    assert!(
        builder.refusal().contains("EXT_meshopt_compression (gltf): asks for 2730667 elements, but only ")
    );
}
