//! Readers: the meaning of each format; and no file makes a reader panic or run away.

mod foreign;
mod md2;
mod obj;
mod off;
mod origin;
mod outlines;
mod ply;
mod polygon;
mod polygon_large;
mod reports;
mod slips;
mod stl;

use std::path::Path;

use umbrage::mesh::Mesh;
use umbrage::read::{read, read_bytes};
use umbrage::scene::Scene;

use crate::support::{facts, real_meshes};

/// Reads `bytes` as the file `name`.
fn scene(bytes: impl AsRef<[u8]>, name: &str) -> Scene {
    read_bytes(bytes.as_ref(), name).unwrap_or_else(|error| panic!("{error}"))
}

/// The one mesh of the file.
fn mesh(bytes: impl AsRef<[u8]>, name: &str) -> Mesh {
    let mut scene = scene(bytes, name);
    assert_eq!((scene.meshes.len(), scene.instances.len()), (1, 1));
    scene.meshes.remove(0)
}

/// The full error message for a bad file.
fn error(bytes: impl AsRef<[u8]>, name: &str) -> String {
    match read_bytes(bytes.as_ref(), name) {
        Ok(scene) => panic!("{name} was read: {scene:?}"),
        Err(error) => error.to_string(),
    }
}

/// Asserts the message of each bad file, without the advice to export again.
fn expect_errors(name: &str, table: &[(&[u8], &str)]) {
    for (bytes, problem) in table {
        let message = error(bytes, name);
        let message = message.strip_suffix("; export the file again").unwrap_or(&message);
        assert_eq!(message, format!("{name}{problem}"), "{:?}", String::from_utf8_lossy(bytes));
    }
}

/// The names and faces of a mesh's parts.
fn parts(mesh: &Mesh) -> Vec<(&str, std::ops::Range<u32>)> {
    mesh.parts().iter().map(|part| (part.name.as_str(), part.faces.clone())).collect()
}

/// A small sound file of each format, with a bit of every feature.
fn samples() -> Vec<(&'static str, Vec<u8>)> {
    vec![
        ("a.obj", obj::SAMPLE.to_vec()),
        ("text.stl", stl::SAMPLE.to_vec()),
        (
            "binary.stl",
            stl::binary(&[[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], [[0.5; 3], [2.0; 3], [3.0; 3]]]),
        ),
        ("text.ply", ply::SAMPLE.to_vec()),
        ("little.ply", ply::binary(false)),
        ("big.ply", ply::binary(true)),
        ("text.off", off::SAMPLE.to_vec()),
        ("binary.off", off::binary()),
        ("a.md2", md2::sample()),
    ]
}

/// Reads a damaged file: no panic, and no more vertices or faces than bytes.
fn survives(bytes: &[u8], name: &str) -> bool {
    match read_bytes(bytes, name) {
        Ok(scene) => {
            for mesh in &scene.meshes {
                assert!(mesh.vertex_count() <= bytes.len() && mesh.face_count() <= bytes.len(), "{name}");
            }
            true
        }
        Err(error) => {
            let message = error.to_string();
            assert!(
                message.starts_with(name) && !message.contains('\n') && message.len() < 400,
                "{message:?}"
            );
            false
        }
    }
}

#[test]
fn samples_are_sound() {
    for (name, bytes) in samples() {
        assert!(scene(&bytes, name).meshes[0].face_count() > 0, "{name}");
    }
}

#[test]
fn truncation_at_every_byte_never_panics_and_binary_files_notice_it() {
    for (name, bytes) in samples() {
        for len in 0..bytes.len() {
            let read = survives(&bytes[..len], name);
            assert!(
                !read || ["a.obj", "text.stl", "text.ply", "text.off"].contains(&name),
                "{name} cut to {len} bytes was read"
            );
        }
    }
}

#[test]
fn flipping_every_byte_never_panics() {
    for (name, bytes) in samples() {
        let mut refused = 0;
        for at in 0..bytes.len() {
            for value in [
                0,
                1,
                b' ',
                b'\n',
                b'\r',
                b'-',
                b'0',
                b'9',
                b'e',
                b'\\',
                0x7f,
                0x80,
                0xfe,
                0xff,
                bytes[at] ^ 1,
            ] {
                let mut garbled = bytes.clone();
                garbled[at] = value;
                refused += usize::from(!survives(&garbled, name));
            }
        }
        assert!(refused > 0, "no damage to {name} was ever noticed");
    }
}

#[test]
fn garbage_under_every_extension_never_panics() {
    // A fixed sequence (Knuth's 64-bit linear congruential generator), so that a failure can be reproduced.
    let mut state = 1_u64;
    let mut byte = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 56) as u8
    };
    for len in 1..300 {
        let mut bytes: Vec<u8> = (0..len).map(|_| byte()).collect();
        bytes[0] |= 0x80; // never a brace: no file is glTF
        for (name, sample) in samples() {
            survives(&bytes, name);
            let head = sample.len().min(len / 2);
            survives(&[&sample[..head], &bytes[..]].concat(), name);
        }
    }
}

#[test]
fn the_content_tells_the_format_before_the_extension_does() {
    for (name, bytes) in samples().into_iter().filter(|(name, _)| *name != "a.obj") {
        let format = scene(&bytes, name).format;
        assert!(format.is_some());
        assert_eq!(scene(&bytes, "misnamed.obj").format, format, "{name}");
    }
}

#[test]
fn an_unreadable_place_is_named_with_a_remedy() {
    let folder = tempfile::tempdir().unwrap();
    let in_folder = |name: &str| folder.path().join(name);
    let message =
        |path: &Path| read(path).unwrap_err().to_string().replace(&*folder.path().to_string_lossy(), "F");

    let missing = message(&in_folder("missing.obj"));
    assert!(missing.starts_with("F/missing.obj: cannot be opened: "), "{missing}");
    assert!(missing.ends_with("; check the path"), "{missing}");
    assert_eq!(message(folder.path()), "F: is a directory; name a mesh file");
    for name in ["empty.obj", "empty.stl", "empty.ply", "empty.md2"] {
        std::fs::write(in_folder(name), b"").unwrap();
        assert_eq!(message(&in_folder(name)), format!("F/{name}: the file is empty; export the file again"));
    }
}

#[test]
fn a_file_reads_as_its_bytes_do() {
    let folder = tempfile::tempdir().unwrap();
    for (name, bytes) in samples() {
        let path = folder.path().join(name);
        std::fs::write(&path, &bytes).unwrap();
        assert_eq!(read(&path).unwrap().meshes, scene(&bytes, name).meshes, "{name}");
    }
}

#[test]
fn real_meshes_have_the_measured_counts() {
    let Some(folder) = real_meshes() else { return };
    let mut checked = 0;
    for row in facts(&folder) {
        let columns = [
            "name",
            "format",
            "vertices",
            "triangles",
            "unreferenced_vertices",
            "ngon_faces",
            "md2_frames",
            "bbox",
        ];
        let [name, format, vertices, triangles, unreferenced, n_gons, frames, size] =
            columns.map(|column| row[column].as_str());
        if !["obj", "stl", "ply", "md2"].contains(&format) {
            continue;
        }
        let scene = read(folder.join(name)).unwrap_or_else(|error| panic!("{error}"));
        let mesh = &scene.meshes[0];
        assert_eq!(mesh.vertex_count().to_string(), vertices, "vertices of {name}");
        assert_eq!(mesh.face_count().to_string(), triangles, "triangles of {name}");
        let mut used = vec![false; mesh.vertex_count()];
        mesh.triangles().as_flattened().iter().for_each(|&vertex| used[vertex as usize] = true);
        let unused = used.iter().filter(|used| !**used).count();
        assert_eq!(unused.to_string(), unreferenced, "unreferenced vertices of {name}");
        let note = scene.notes.iter().find_map(|note| note.strip_suffix(" n-gons cut into triangles"));
        assert_eq!(note.unwrap_or("0"), n_gons, "n-gons of {name}");
        let [low, high] = mesh.bounds().unwrap();
        for (axis, size) in size.split(" x ").enumerate() {
            // The facts have six digits.
            let (size, found): (f32, f32) = (size.parse().unwrap(), high[axis] - low[axis]);
            assert!((size - found).abs() <= 1e-5 * size, "axis {axis} of {name}: {found}, not {size}");
        }
        if !frames.is_empty() {
            assert_eq!((1 + mesh.frames().len()).to_string(), frames, "frames of {name}");
        }
        checked += 1;
    }
    assert!(checked > 0, "facts.csv names no file of these formats");
}
