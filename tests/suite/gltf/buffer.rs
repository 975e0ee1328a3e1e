//! The binary container; buffers embedded, in a file next to the document, and at forbidden locations.

use std::fs;

use serde_json::json;
use umbrage::read::{read, read_bytes};
use umbrage::scene::Scope;

use super::{Builder, SQUARE, f32s, refusal, u16s};

#[test]
fn glb_reads_as_the_same_scene() {
    let builder = Builder::square();
    let scene = read_bytes(&builder.glb(), "a.glb").unwrap();
    assert_eq!(scene.meshes, builder.read().meshes);
    assert_eq!(scene.format, Some(umbrage::read::Format::Glb));
    // Chunks of unknown types are skipped.
    let mut glb = builder.glb();
    glb.extend(b"\x04\0\0\0WHAT1234");
    let length = (glb.len() as u32).to_le_bytes();
    glb[8..12].copy_from_slice(&length);
    assert_eq!(read_bytes(&glb, "a.glb").unwrap().meshes, scene.meshes);
}

#[test]
fn glb_cut_at_any_byte_is_refused() {
    let glb = Builder::square().glb();
    for end in 4..glb.len() {
        assert!(refusal(&glb[..end]).contains("cut off"), "{end} bytes");
    }
}

#[test]
fn glb_and_gltf_with_a_flipped_byte_never_panic() {
    let mut builder = Builder::square();
    let indices = builder.view(&u16s(&[1]));
    let values = builder.view(&f32s(&[5.0, 6.0, 7.0]));
    builder.doc["accessors"][0]["sparse"] = json!({
        "count": 1, "indices": {"bufferView": indices, "componentType": 5123}, "values": {"bufferView": values}
    });
    let (mut refused, mut read_anyway) = (0, 0);
    for original in [builder.glb(), builder.gltf()] {
        for at in 0..original.len() {
            for flip in [1_u8, 2, 4, 8, 16, 32, 64, 128, 255] {
                let mut bytes = original.clone();
                bytes[at] ^= flip;
                match read_bytes(&bytes, "a.glb") {
                    Ok(scene) => {
                        read_anyway += 1;
                        scene.bake(Scope::Mesh).ok();
                    }
                    Err(error) => {
                        refused += 1;
                        assert!(!error.to_string().contains('\n'));
                    }
                }
            }
        }
    }
    assert!(refused > 1000 && read_anyway > 100, "{refused} refused, {read_anyway} read");
}

#[test]
fn gltf_cut_at_any_byte_is_refused_with_its_line() {
    let text = serde_json::to_string_pretty(&Builder::square().doc).unwrap();
    for end in 1..text.len() {
        assert!(refusal(&text.as_bytes()[..end]).contains(": is not JSON: "), "{end} bytes");
    }
    assert!(refusal(&text.as_bytes()[..text.len() - 1]).starts_with("a.gltf, line "));
    let deep = format!("{{\"extras\":{}", "[".repeat(100_000));
    assert!(refusal(deep.as_bytes()).contains("recursion limit exceeded"));
}

#[test]
fn gltf_external_buffers_stay_in_the_folder() {
    let outer = tempfile::tempdir().unwrap();
    let folder = outer.path().join("model");
    fs::create_dir_all(folder.join("sub dir")).unwrap();
    let builder = Builder::square();
    for place in ["model/sub dir/a.bin", "model/b.bin", "secret.bin"] {
        fs::write(outer.path().join(place), &builder.bin).unwrap();
    }
    fs::write(folder.join("short.bin"), &builder.bin[..10]).unwrap();
    let read_with = |uri: &str| {
        let path = folder.join("a.gltf");
        fs::write(&path, builder.gltf_beside(uri)).unwrap();
        read(path).map_err(|error| error.to_string())
    };
    for uri in ["sub%20dir/a.bin", "sub dir/a.bin", "b.bin", "./sub%20dir/../b.bin"] {
        assert_eq!(read_with(uri).unwrap().meshes[0].positions(), SQUARE, "{uri}");
    }
    let absolute = folder.join("b.bin").display().to_string();
    for uri in
        ["../secret.bin", "sub dir/../../secret.bin", "%2e%2e/secret.bin", &absolute, "http://host/b.bin"]
    {
        let message = read_with(uri).unwrap_err();
        assert!(message.contains("buffer 0 (gltf): `") && message.contains("leaves the folder"), "{message}");
        assert!(
            message.ends_with("put the buffer into the folder of the file and name it by a relative path")
        );
    }
    assert!(read_with("none.bin").unwrap_err().contains("the file `none.bin` cannot be read"));
    assert!(read_with("sub dir").unwrap_err().contains("is not a regular file"));
    let short = read_with("short.bin").unwrap_err();
    let wanted = "buffer view 0 (gltf): is 48 bytes from byte 0, but buffer 0 has 10 bytes, not the 60 of its byteLength";
    assert!(short.contains(wanted), "{short}");
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink(outer.path().join("secret.bin"), folder.join("link.bin")).unwrap();
        assert!(read_with("link.bin").unwrap_err().contains("a link that leaves the folder"));
        std::os::unix::fs::symlink("b.bin", folder.join("inner.bin")).unwrap();
        assert!(read_with("inner.bin").is_ok());
    }
}

#[test]
fn gltf_buffers_that_are_not_there_are_named() {
    let mut builder = Builder::square();
    let message = refusal(&builder.gltf_beside("b.bin"));
    assert!(
        message.contains("is the file `b.bin`, which cannot be reached when reading from memory"),
        "{message}"
    );
    builder.doc["buffers"] = json!([{"byteLength": 60}]);
    assert!(builder.refusal().contains("buffer 0 (gltf): has neither a uri nor a binary chunk"));
    builder.doc["buffers"] = json!([{"byteLength": 60, "uri": "data:;base64,AAAA"}]);
    assert!(builder.refusal().contains("but buffer 0 has 3 bytes, not the 60 of its byteLength"));
    builder.doc["buffers"] = json!([{"uri": "data:;base64,AAAA"}]);
    assert!(builder.refusal().contains("is 48 bytes from byte 0, but buffer 0 has 3 bytes; "));
}

#[test]
fn gltf_file_that_many_buffers_name_counts_once() {
    let folder = tempfile::tempdir().unwrap();
    let count = 1 << 20;
    fs::write(folder.path().join("a.bin"), vec![0; 12 * count]).unwrap();
    let read_with = |buffers: usize| {
        let mut builder = Builder::new();
        let range = || 0..buffers;
        builder.doc["buffers"] = range().map(|_| json!({"byteLength": 12 * count, "uri": "a.bin"})).collect();
        builder.doc["bufferViews"] =
            range().map(|i| json!({"buffer": i, "byteLength": 12 * count})).collect();
        let accessor = |i| json!({"bufferView": i, "componentType": 5126, "type": "VEC3", "count": count});
        builder.doc["accessors"] = range().map(accessor).collect();
        let primitives: serde_json::Value = range().map(|i| json!({"attributes": {"POSITION": i}})).collect();
        builder.doc["meshes"] = json!([{"primitives": primitives}]);
        let path = folder.path().join("a.gltf");
        fs::write(&path, builder.gltf()).unwrap();
        read(path).map(|scene| scene.meshes[0].vertex_count()).map_err(|error| error.to_string())
    };
    // 4 Mi elements without data, and 12 Mi for the bytes of the single file.
    assert_eq!(read_with(15), Ok(15 * count));
    assert!(read_with(17).unwrap_err().contains("accessor 16 (gltf): asks for 1048576 elements"));
}
