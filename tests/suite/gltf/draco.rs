//! KHR_draco_mesh_compression: streams of the reference encoder (draco3d 1.5.9), and streams that are none.

#[cfg(feature = "draco")]
use std::collections::BTreeSet;

use serde_json::json;

#[cfg(feature = "draco")]
use umbrage::read::read_bytes;

use super::Builder;

/// A tetrahedron of side 4 at the origin, in order and in full precision.
pub(super) const SEQUENTIAL: [u8; 82] = [
    0x44, 0x52, 0x41, 0x43, 0x4f, 0x02, 0x02, 0x01, 0x00, 0x00, 0x00, 0x04, 0x04, 0x01, 0x00, 0x02, 0x01,
    0x00, 0x01, 0x03, 0x01, 0x02, 0x03, 0x02, 0x00, 0x03, 0x01, 0x01, 0x00, 0x09, 0x03, 0x00, 0x00, 0x00,
    0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x80, 0x40, 0x00,
    0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x80, 0x40, 0x00, 0x00,
    0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x80, 0x40,
];

/// The same by its edges, in eleven bits.
const EDGEBREAKER: [u8; 76] = [
    0x44, 0x52, 0x41, 0x43, 0x4f, 0x02, 0x02, 0x01, 0x01, 0x00, 0x00, 0x00, 0x04, 0x04, 0x00, 0x03, 0x00,
    0x00, 0x01, 0x2f, 0x01, 0x01, 0x10, 0x01, 0xff, 0x00, 0x00, 0x01, 0x00, 0x09, 0x03, 0x00, 0x00, 0x02,
    0x01, 0x01, 0x01, 0x00, 0x03, 0x03, 0x01, 0x10, 0x01, 0x30, 0x03, 0x00, 0x50, 0x82, 0x24, 0x91, 0x04,
    0x00, 0x00, 0x00, 0x00, 0xff, 0x07, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00,
    0x00, 0x00, 0x00, 0x00, 0x00, 0x80, 0x40, 0x0b,
];

/// A document whose only data is the stream, said to have this many vertices and corners.
pub(super) fn document(stream: &[u8], vertices: usize, corners: usize) -> Builder {
    let name = "KHR_draco_mesh_compression";
    let mut builder = Builder::mesh(&[], 4, None);
    builder.bin.clear();
    builder.doc["bufferViews"] = json!([]);
    let view = builder.view(stream);
    builder.doc["accessors"] = json!([
        {"componentType": 5126, "type": "VEC3", "count": vertices},
        {"componentType": 5123, "type": "SCALAR", "count": corners}
    ]);
    let extension = json!({name: {"bufferView": view, "attributes": {"POSITION": 0}}});
    builder.doc["meshes"] =
        json!([{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "extensions": extension}]}]);
    builder.doc["extensionsRequired"] = json!([name]);
    builder
}

#[test]
#[cfg(feature = "draco")]
fn draco_streams_of_both_kinds_read_as_the_tetrahedron() {
    for stream in [&SEQUENTIAL[..], &EDGEBREAKER] {
        let scene = document(stream, 4, 12).read();
        assert!(scene.notes.is_empty(), "{:?}", scene.notes);
        let mesh = &scene.meshes[0];
        // Whatever the order of vertices: each face by its positions, from the least of them.
        let from_least = |mut face: [[f32; 3]; 3]| {
            while face[1] < face[0] || face[2] < face[0] {
                face.rotate_left(1);
            }
            face.map(|p| p.map(|x| x as i32))
        };
        let at = |corner: u32| mesh.positions()[corner as usize];
        let faces: BTreeSet<_> = mesh.triangles().iter().map(|corners| from_least(corners.map(at))).collect();
        let [o, x, y, z] = [[0.0; 3], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0], [0.0, 0.0, 4.0]];
        assert_eq!(faces, [[o, y, x], [o, x, z], [x, y, z], [y, o, z]].map(from_least).into());
    }
    // As integers that stand for fractions.
    let mut builder = document(&SEQUENTIAL, 4, 12);
    builder.doc["accessors"][0]["componentType"] = 5121.into();
    builder.doc["accessors"][0]["normalized"] = true.into();
    assert_eq!(builder.read().meshes[0].positions()[1], [4.0 / 255.0, 0.0, 0.0]);
}

#[test]
#[cfg(feature = "draco")]
fn draco_that_says_what_cannot_be_is_refused() {
    let place = "mesh 0, primitive 0, KHR_draco_mesh_compression";
    for (vertices, corners, wanted) in [
        (5, 12, "has 4 vertices and 4 triangles, but its accessors say 5 and 4"),
        (4, 15, "has 4 vertices and 4 triangles, but its accessors say 4 and 5"),
        (4, 9, "does not decode: "),
        (1 << 40, 12, "asks for "),
        (4, usize::MAX, "asks for "),
    ] {
        let message = document(&SEQUENTIAL, vertices, corners).refusal();
        assert!(message.contains(&format!("{place} (gltf): {wanted}")), "{message}");
    }
    let change = |pointer: &str, value: serde_json::Value| {
        let mut builder = document(&SEQUENTIAL, 4, 12);
        let extension =
            &mut builder.doc["meshes"][0]["primitives"][0]["extensions"]["KHR_draco_mesh_compression"];
        *extension.pointer_mut(pointer).unwrap() = value;
        builder.refusal()
    };
    assert!(
        change("/attributes/POSITION", json!(7)).contains(&format!("{place} (gltf): has no attribute 7"))
    );
    assert!(change("/attributes", json!({})).contains("attributes (gltf): POSITION is missing"));
    assert!(change("/bufferView", json!(9)).contains("names buffer view 9, but there are 1"));
}

#[test]
#[cfg(feature = "draco")]
fn draco_streams_cut_or_with_any_byte_changed_never_panic() {
    for stream in [&SEQUENTIAL[..], &EDGEBREAKER] {
        for end in 0..stream.len() - 1 {
            let message = document(&stream[..end], 4, 12).refusal();
            assert!(
                message.contains("KHR_draco_mesh_compression (gltf): does not decode: "),
                "{end}: {message}"
            );
        }
        let (mut read, mut refused) = (0, 0);
        for at in 0..stream.len() {
            for byte in [0, 1, 2, 4, 8, 16, 32, 64, 127, 128, 254, 255] {
                let mut changed = stream.to_vec();
                changed[at] = byte;
                match read_bytes(&document(&changed, 4, 12).gltf(), "a.gltf") {
                    Ok(_) => read += 1,
                    Err(error) => {
                        assert!(!error.to_string().contains('\n'));
                        refused += 1;
                    }
                }
            }
        }
        assert!(read > 50 && refused > 50, "{read} read, {refused} refused");
    }
}

#[test]
#[cfg(not(feature = "draco"))]
fn draco_is_refused_by_name_with_a_remedy() {
    for stream in [&SEQUENTIAL[..], &EDGEBREAKER] {
        let message = document(stream, 4, 12).refusal();
        let wanted = "mesh 0, primitive 0 (gltf): has no plain data, and its extension `KHR_draco_mesh_compression` is not \
                      supported; write the file without it: `gltf-transform cp IN.glb OUT.glb` does";
        assert!(message.ends_with(wanted), "{message}");
    }
}
