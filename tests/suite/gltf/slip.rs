//! Slips around plain geometry: read, with a note that names the slip.

use std::fs;

use serde_json::{Value, json};
use umbrage::read::{read, read_bytes};
use umbrage::scene::Scene;

use super::{Builder, SQUARE, refusal};

/// The names of the nodes that stand in the scene, and the notes.
fn standing(builder: &Builder) -> (Vec<String>, Vec<String>) {
    let scene = builder.read();
    (scene.instances.into_iter().map(|instance| instance.name).collect(), scene.notes)
}

fn place_of(scene: &Scene) -> [f32; 3] {
    scene.instances[0].world_from_mesh.w_axis.truncate().into()
}

#[test]
fn slip_roots_and_parents_outside_the_scene_are_noted() {
    let mut builder = Builder::square();
    // (nodes, roots, what stands, notes)
    let leaf = |name: &str| json!({"mesh": 0, "name": name});
    let cases = [
        (
            json!([leaf("a"), {"children": [0], "translation": [9, 9, 9]}]),
            json!([0]),
            vec!["a"],
            "node 0: root with a parent outside the scene: node 1 is not in the scene, and does not move it",
        ),
        (
            json!([{"children": [1, 2]}, leaf("a"), {"children": [3]}, leaf("b")]),
            json!([0, 1, 2, 3]),
            vec!["a", "b"],
            "scene and 2 more: root that has a parent in the scene: of the first, node 1 is a child of node 0, and stands \
             once, below it",
        ),
        (
            json!([{"children": [3]}, {"children": [3]}, {"children": [3]}, leaf("a")]),
            json!([0]),
            vec!["a"],
            "node 3 and 1 more: node with a second parent outside the scene: of the first, node 1 is not in the scene, and \
             does not move it",
        ),
        (
            json!([{"children": [2]}, {"children": [2]}, leaf("a")]),
            json!([2]),
            vec!["a"],
            "node 2 and 1 more: root with a parent outside the scene: of the first, node 0 is not in the scene, and does \
             not move it",
        ),
        (json!([leaf("a")]), json!([0, 0]), vec!["a"], "scene 0: root listed twice stands once"),
        (
            json!([{"children": [1, 1]}, leaf("a")]),
            json!([0]),
            vec!["a"],
            "node 0: child listed twice stands once",
        ),
        // Outside the scene, nothing needs to be right.
        (
            json!([leaf("a"), {"children": [2]}, {"children": [1, 0, 7, "x"]}, {"children": 3}, {"matrix": 1}]),
            json!([0]),
            vec!["a"],
            "node 0: root with a parent outside the scene: node 2 is not in the scene, and does not move it",
        ),
    ];
    for (nodes, roots, names, note) in cases {
        builder.doc["nodes"] = nodes;
        builder.doc["scenes"][0]["nodes"] = roots;
        assert_eq!(
            standing(&builder),
            (names.iter().map(|&name| name.to_owned()).collect(), vec![note.to_owned()])
        );
    }
}

#[test]
fn slip_root_that_is_a_child_in_the_scene_stands_where_its_parent_puts_it() {
    let mut builder = Builder::square();
    let translation = |x: f32, mut node: Value| {
        node["translation"] = json!([x, 0, 0]);
        node
    };
    builder.doc["nodes"] =
        json!([translation(1.0, json!({"mesh": 0})), translation(10.0, json!({"children": [0]}))]);
    // Whatever the order of the list, and once its parent is outside, where it says itself.
    for (roots, x) in [(json!([0, 1]), 11.0), (json!([1, 0]), 11.0), (json!([1]), 11.0), (json!([0]), 1.0)] {
        builder.doc["scenes"][0]["nodes"] = roots;
        assert_eq!(place_of(&builder.read()), [x, 0.0, 0.0]);
    }
    builder.doc.as_object_mut().unwrap().remove("scenes");
    builder.doc.as_object_mut().unwrap().remove("scene");
    assert_eq!(place_of(&builder.read()), [11.0, 0.0, 0.0]);
}

#[test]
fn slip_zero_bytes_behind_the_json_are_passed_over() {
    for builder in [Builder::square(), Builder::mesh(&SQUARE, 5, None)] {
        let plain = builder.read();
        for zeros in [1, 2, 3, 7, 64] {
            let glb = glb(&builder, zeros);
            let text = [builder.gltf(), vec![0; zeros]].concat();
            for (bytes, name) in [(glb, "a.glb"), (text, "a.gltf")] {
                let scene = read_bytes(&bytes, name).unwrap_or_else(|error| panic!("{error}"));
                assert_eq!(scene.meshes, plain.meshes);
                assert_eq!(
                    scene.notes,
                    ["document: padded with zero bytes behind the JSON"],
                    "{name}, {zeros}"
                );
            }
        }
    }
    // Among spaces too, but only behind it.
    let text = [Builder::square().gltf(), b" \0 \n\0 ".to_vec()].concat();
    assert_eq!(read_bytes(&text, "a.gltf").unwrap().notes.len(), 1);
    let bytes = [b"{\0".to_vec(), Builder::square().gltf()[1..].to_vec()].concat();
    assert!(refusal(&bytes).contains("is not JSON"));
}

/// The document as GLB, with this many zero bytes behind the JSON and none before the binary chunk.
fn glb(builder: &Builder, zeros: usize) -> Vec<u8> {
    let mut doc = builder.doc.clone();
    doc["buffers"] = json!([{"byteLength": builder.bin.len()}]);
    let mut json = serde_json::to_vec(&doc).unwrap();
    json.resize(json.len() + zeros, 0);
    container(&[(b"JSON", &json), (b"BIN\0", &builder.bin)])
}

fn container(chunks: &[(&[u8; 4], &[u8])]) -> Vec<u8> {
    let mut glb = b"glTF\x02\0\0\0\0\0\0\0".to_vec();
    for (kind, chunk) in chunks {
        glb.extend((chunk.len() as u32).to_le_bytes());
        glb.extend(*kind);
        glb.extend(*chunk);
    }
    let length = glb.len() as u32;
    state(&mut glb, length);
    glb
}

/// Sets the length in the header.
fn state(glb: &mut [u8], length: u32) {
    glb[8..12].copy_from_slice(&length.to_le_bytes());
}

#[test]
fn slip_length_of_a_container_that_falls_short_is_noted_with_true_numbers() {
    let mut builder = Builder::square();
    builder.doc["extras"] = "x".repeat(40).into();
    let plain = builder.read();
    let whole = glb(&builder, 0);
    let bin = builder.bin.len();
    let all = whole.len();
    for length in [0, 1, 12, 20, all - bin - 9, all - bin, all - 1] {
        let mut short = whole.clone();
        state(&mut short, length as u32);
        let scene = read_bytes(&short, "a.glb").unwrap_or_else(|error| panic!("{length}: {error}"));
        assert_eq!(scene.meshes, plain.meshes);
        let note = format!(
            "container: chunks read beyond the length in the header: it says {length} bytes, but the chunks end at byte {all}"
        );
        assert_eq!(scene.notes, [note]);
    }
    // The binary chunk says more than there is, which is all that is needed; or there is more behind it.
    let mut long = whole.clone();
    long[all - bin - 8..][..4].copy_from_slice(&(bin as u32 + 5).to_le_bytes());
    let scene = read_bytes(&long, "a.glb").unwrap();
    assert_eq!(scene.meshes, plain.meshes);
    let note = format!(
        "container: binary chunk read to the end of the file: it says {} bytes, but {bin} are left",
        bin + 5
    );
    assert_eq!(scene.notes, [note]);
    for behind in [1, 7, 9] {
        let mut more = [whole.clone(), vec![b'x'; behind]].concat();
        for stated in [all, all + behind.min(7)] {
            state(&mut more, stated as u32);
            let scene = read_bytes(&more, "a.glb").unwrap_or_else(|error| panic!("{error}"));
            let note =
                format!("container: bytes behind the last chunk passed over: {behind} from byte {all}");
            assert_eq!(scene.notes, [note]);
        }
    }
    // What is not there is not read, and the numbers are those of the file.
    let mut cut = whole[..all - 4].to_vec();
    let message = refusal(&cut);
    assert!(
        message.contains(&format!("the file needs {all} bytes from here, but {} are left", all - 4)),
        "{message}"
    );
    state(&mut cut, all as u32 - 4);
    let message = refusal(&cut);
    let wanted = format!(
        "is 12 bytes from byte 48, but buffer 0 has {} bytes, not the {bin} of its byteLength",
        bin - 4
    );
    assert!(
        message.contains(&wanted) && message.ends_with("the buffer may be cut off; copy or export it again"),
        "{message}"
    );
}

#[test]
fn slip_byte_length_of_a_buffer_is_noted_where_the_views_are_there() {
    let mut builder = Builder::square();
    let plain = builder.read();
    let uri = serde_json::from_slice::<Value>(&builder.gltf()).unwrap()["buffers"][0]["uri"].clone();
    for (length, note) in [
        (json!(61), "buffer 0: byteLength of a buffer passed over: it is 61, but there are 60 bytes"),
        (
            json!(59),
            "buffer 0: byteLength of a buffer passed over: it is 59, but buffer view 1 ends at byte 60",
        ),
        (
            json!(0),
            "buffer 0: byteLength of a buffer passed over: it is 0, but buffer view 0 ends at byte 48",
        ),
        (Value::Null, "buffer 0: no byteLength: the buffer read as far as it goes"),
    ] {
        builder.doc["buffers"] = json!([{"uri": uri, "byteLength": length}]);
        if length.is_null() {
            builder.doc["buffers"] = json!([{ "uri": uri }]);
        }
        let scene = builder.read();
        assert_eq!((scene.meshes, scene.notes), (plain.meshes.clone(), vec![note.to_owned()]));
    }
}

#[test]
fn slip_name_of_a_buffer_is_taken_as_it_stands_where_there_is_such_a_file() {
    let folder = tempfile::tempdir().unwrap();
    let builder = Builder::square();
    let read_with = |uri: &str| {
        let path = folder.path().join("a.gltf");
        fs::write(&path, builder.gltf_beside(uri)).unwrap();
        read(path).map_err(|error| error.to_string())
    };
    fs::create_dir(folder.path().join("sub")).unwrap();
    for name in ["50%.bin", "100%25.bin", "%zz%", "a%é.bin", "sub/b.bin", "twice%20.bin"] {
        fs::write(folder.path().join(name), &builder.bin).unwrap();
    }
    for name in ["50%.bin", "100%25.bin", "%zz%", "a%é.bin"] {
        let scene = read_with(name).unwrap();
        assert_eq!(scene.meshes[0].positions(), SQUARE, "{name}");
        let note =
            format!("buffer 0: name of a buffer that is not percent-encoded taken as it stands: `{name}`");
        assert_eq!(scene.notes, [note]);
    }
    if cfg!(unix) {
        let scene = read_with(r"sub\b.bin").unwrap();
        assert!(scene.notes[0].ends_with("taken as it stands: `sub/b.bin`"), "{:?}", scene.notes);
    }
    // What the URI means comes first.
    fs::write(folder.path().join("twice .bin"), [&builder.bin[12..], &[0; 12]].concat()).unwrap();
    assert_ne!(read_with("twice%20.bin").unwrap().meshes[0].positions(), SQUARE);
    let message = read_with("60%.bin").unwrap_err();
    assert!(message.contains("buffer 0 (gltf): the file `60%.bin` cannot be read"), "{message}");
    assert!(message.ends_with("put the buffer into the folder of the file under this name"), "{message}");
}

#[test]
fn slip_uris_are_cut_in_messages_and_remedies_fit() {
    let folder = tempfile::tempdir().unwrap();
    let builder = Builder::square();
    let embedded = serde_json::from_slice::<Value>(&builder.gltf()).unwrap()["buffers"][0]["uri"].clone();
    let long = format!("{}{}", embedded.as_str().unwrap(), "A".repeat(5000));
    let path = folder.path().join("a.gltf");
    for (uri, remedy) in [
        (format!("dat{long}"), "put the buffer into the folder of the file and name it by a relative path"),
        (long.replace("data:", ""), "put the buffer into the folder of the file under this name"),
        (long.replace("A", "*"), "export the file again, or with its buffer in a file of its own"),
        (long.replace(";base64", ""), "export the file again, or with its buffer in a file of its own"),
    ] {
        fs::write(&path, builder.gltf_beside(&uri)).unwrap();
        let message = read(&path).unwrap_err().to_string();
        assert!(message.len() < 500 && message.ends_with(remedy), "{message}");
    }
    // Written in capitals, or broken into lines.
    let text = embedded.as_str().unwrap();
    for uri in [text.replacen("data:", "DATA:", 1), text.replace("AA", "A\nA"), format!(" {text}\n")] {
        fs::write(&path, builder.gltf_beside(&uri)).unwrap();
        assert_eq!(read(&path).unwrap().meshes[0].positions(), SQUARE, "{uri}");
    }
}

#[test]
fn slip_in_what_casts_no_shadow_is_noted() {
    let mut builder = Builder::square();
    let wanted = builder.read().meshes;
    let note = |change: &dyn Fn(&mut Value)| {
        let mut changed = Builder { doc: builder.doc.clone(), bin: builder.bin.clone() };
        change(&mut changed.doc);
        let scene = changed.read();
        assert_eq!(scene.meshes, wanted);
        let [note] = &scene.notes[..] else { panic!("{:?}", scene.notes) };
        note.clone()
    };
    type Change<'a> = &'a dyn Fn(&mut Value);
    let cases: [(Change, &str); 9] = [
        (
            &|doc| doc["scene"] = 7.into(),
            "document: default scene that does not exist passed over: names scene 7, but there are 1",
        ),
        (&|doc| doc["asset"]["version"] = json!(2.0), "asset: version that is not a text read as one"),
        (&|doc| doc["asset"] = json!({}), "document: no version stated (asset.version): read as glTF 2.0"),
        (
            &|doc| doc["materials"] = json!({}),
            "document: materials, cameras or lamps left out: materials is not a list",
        ),
        (
            &|doc| doc["cameras"] = json!(3),
            "document: materials, cameras or lamps left out: cameras is not a list",
        ),
        (
            &|doc| doc["meshes"][0]["primitives"][0]["material"] = 4.into(),
            "mesh 0, primitive 0: material that does not exist left out: names material 4, but there are 0",
        ),
        (
            &|doc| doc["bufferViews"][0]["byteStride"] = 0.into(),
            "buffer view 0: stride of 0 bytes taken for none",
        ),
        (
            &|doc| doc["extensionsUsed"] = json!("all"),
            "extensionsUsed: list of extensions that is none passed over",
        ),
        (
            &|doc| doc["nodes"][0]["weights"] = json!([0, 0.5]),
            "node 0: morph weights of the node ignored, its mesh read at rest",
        ),
    ];
    for (change, wanted) in cases {
        assert_eq!(note(change), wanted);
    }
    builder.doc["animations"] = json!(7);
    assert!(builder.read().notes.is_empty());
}

#[test]
fn slip_quantization_that_is_not_declared_is_noted() {
    for (component, size) in [(5120, 1), (5121, 1), (5122, 2), (5123, 2)] {
        let mut builder = Builder::square();
        let bytes: Vec<u8> =
            SQUARE.as_flattened().iter().flat_map(|&x| [x as u8, 0][..size].to_vec()).collect();
        let accessor = builder.accessor(component, "VEC3", 4, &bytes);
        // Named twice, noted once.
        let primitive = builder.doc["meshes"][0]["primitives"][0].clone();
        builder.doc["meshes"][0]["primitives"] = json!([primitive, primitive]);
        for primitive in builder.doc["meshes"][0]["primitives"].as_array_mut().unwrap() {
            primitive["attributes"]["POSITION"] = accessor.into();
        }
        let scene = builder.read();
        assert_eq!(scene.meshes[0].positions()[..4], SQUARE);
        let note =
            format!("accessor {accessor}: small integers read as if the file used KHR_mesh_quantization");
        assert_eq!(scene.notes, [note]);
        builder.doc["extensionsUsed"] = json!(["KHR_mesh_quantization"]);
        assert!(builder.read().notes.is_empty());
    }
}
