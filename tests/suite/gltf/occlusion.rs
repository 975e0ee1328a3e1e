//! Occlusion added to glTF files: the file is the same but for the values, which are those asked for.

mod back;
mod refused;
mod values;

use serde_json::{Value, json};
use umbrage::scene::Scope;
use umbrage::write::{Form, GltfFile, Occlusion, OcclusionOptions, Written};

use super::{Builder, f32s, u16s};
use back::Back;

const FORMS: [Form; 3] = [Form::Texture, Form::Color, Form::Attribute];

/// Half a step of eight bits.
const HALF_STEP: f64 = 0.5 / 255.0;

/// A value of its own for each corner of each face, and the indices of them.
fn different(faces: usize) -> (Vec<[u32; 3]>, Vec<f32>) {
    let count = 3 * faces as u32;
    let corners = (0..faces as u32).map(|face| [3 * face, 3 * face + 1, 3 * face + 2]).collect();
    // 0 and 1 are among them; neighbors differ by more than the steps of eight bits.
    let value = |corner: u32| (corner * 7 % count) as f32 / (count - 1).max(1) as f32;
    (corners, (0..count).map(value).collect())
}

fn faces_of(bytes: &[u8]) -> usize {
    let scene = umbrage::read::read_bytes(bytes, "a.gltf").unwrap_or_else(|error| panic!("{error}"));
    scene.bake(Scope::Mesh).unwrap().iter().map(|mesh| mesh.face_count()).sum()
}

fn add(bytes: &[u8], corners: &[[u32; 3]], openness: &[f32], options: &OcclusionOptions) -> Written {
    let occlusion = Occlusion { corners, openness, bent: None };
    let file = GltfFile::from_bytes(bytes.to_vec()).unwrap();
    file.check(None, options).unwrap_or_else(|error| panic!("{error}"));
    file.with_occlusion(None, &occlusion, options).unwrap_or_else(|error| panic!("{error}"))
}

/// The positions of the corners of all faces in the world, by our own reader.
fn world(bytes: &[u8]) -> Vec<(String, Vec<[[u32; 3]; 3]>)> {
    let scene = umbrage::read::read_bytes(bytes, "a.glb").unwrap_or_else(|error| panic!("{error}"));
    let corners = |mesh: &umbrage::mesh::Mesh| {
        let bits = |vertex: u32| mesh.positions()[vertex as usize].map(f32::to_bits);
        (mesh.name.clone(), mesh.triangles().iter().map(|face| face.map(bits)).collect())
    };
    scene.bake(Scope::Mesh).unwrap().iter().map(corners).collect()
}

/// A document with much in it: four primitives (a strip, a fan, one without indices, one with morph targets,
/// joints and colors) in one mesh that two nodes show, the second mirrored; a square in a mesh of its own;
/// materials, a camera, an animation, extras.
fn rich() -> Builder {
    let mut builder = Builder::new();
    let grid: Vec<[f32; 3]> =
        (0..8).map(|i| [(i / 2) as f32, (i % 2) as f32, (i * i % 5) as f32 * 0.25]).collect();
    let grid = builder.positions(&grid);
    let strip = builder.accessor(5123, "SCALAR", 8, &u16s(&[0, 1, 2, 3, 4, 5, 6, 7]));
    let list = builder.accessor(5123, "SCALAR", 9, &u16s(&[0, 2, 1, 2, 3, 1, 4, 5, 6]));
    let bytes: Vec<u8> = (0..24).map(|x| x * 10).collect();
    let joints = builder.accessor(5121, "VEC3", 8, &bytes);
    let color = builder.accessor(5121, "VEC3", 8, &bytes);
    builder.doc["accessors"][color]["normalized"] = true.into();
    let uv: Vec<f32> = (0..16).map(|x| x as f32 / 16.0).collect();
    let uv = builder.accessor(5126, "VEC2", 8, &f32s(&uv));
    let moved: Vec<[f32; 3]> = (0..8).map(|i| [0.0, i as f32, 0.5]).collect();
    let moved = builder.positions(&moved);
    builder.doc["meshes"] = json!([
        {"name": "all", "extras": {"kept": [1.5, "x"]}, "primitives": [
            {"attributes": {"POSITION": grid}, "indices": strip, "mode": 5, "material": 0},
            {"attributes": {"POSITION": grid}, "indices": strip, "mode": 6},
            {"attributes": {"POSITION": grid}, "mode": 5},
            {"attributes": {"POSITION": grid}, "mode": 0},
            {"attributes": {"POSITION": grid, "JOINTS_0": joints, "COLOR_0": color, "TEXCOORD_0": uv, "_ID": joints},
             "indices": list, "material": 1, "targets": [{"POSITION": moved, "NORMAL": moved}, {"POSITION": moved}]}
        ]},
        {"name": "alone", "primitives": [{"attributes": {"POSITION": grid}, "indices": list, "material": 1}]}
    ]);
    builder.doc["materials"] = json!([
        {"name": "plain"},
        {"name": "textured", "normalTexture": {"index": 0, "texCoord": 1}, "emissiveFactor": [0.1, 0.2, 0.3]}
    ]);
    builder.doc["textures"] = json!([{"source": 0}]);
    builder.doc["images"] = json!([{"uri": "data:image/png;base64,AAAA", "name": "embedded"}]);
    builder.doc["cameras"] = json!([{"type": "perspective", "perspective": {"yfov": 0.7, "znear": 0.1}}]);
    builder.doc["animations"] = json!([{"name": "none", "channels": [], "samplers": []}]);
    builder.doc["scenes"] = json!([{"nodes": [0, 1, 2, 3]}]);
    builder.doc["nodes"] = json!([
        {"name": "left", "mesh": 0, "extras": {"a": 0.1}},
        {"name": "right", "mesh": 0, "scale": [-1.0, 1, 2], "translation": [9, 0.30000000000000004, 0]},
        {"name": "single", "mesh": 1, "rotation": [0, 0.6, 0, 0.8]},
        {"name": "eye", "camera": 0}
    ]);
    builder
}

#[test]
fn occlusion_leaves_faces_names_and_the_rest_of_the_file_as_they_are() {
    let builder = rich();
    let before = builder.glb();
    let (corners, openness) = different(faces_of(&before));
    for form in FORMS {
        let written = add(&before, &corners, &openness, &OcclusionOptions::new(form));
        assert_eq!(world(&written.bytes), world(&before), "{form:?}");
        let (old, new) = (Back::of(&before), Back::of(&written.bytes));
        for key in ["asset", "scene", "scenes", "cameras", "animations"] {
            assert_eq!(new.doc[key], old.doc[key], "{form:?} {key}");
        }
        // Lists only grow, but for the mesh of a node and the material of a primitive.
        for key in ["accessors", "bufferViews", "images", "textures", "samplers"] {
            let list = |back: &Back| back.doc[key].as_array().cloned().unwrap_or_default();
            assert!(list(&new).starts_with(&list(&old)), "{form:?} {key}");
        }
        assert!(new.bin.starts_with(&old.bin));
        for (node, was) in
            new.doc["nodes"].as_array().unwrap().iter().zip(old.doc["nodes"].as_array().unwrap())
        {
            let rest = |node: &Value| {
                let mut node = node.clone();
                node.as_object_mut().unwrap().remove("mesh");
                node
            };
            assert_eq!(rest(node), rest(was));
        }
        // Every attribute of every corner is what it was.
        for (node, was) in new.shown().into_iter().zip(old.shown()) {
            assert_eq!(new.doc["meshes"][node]["name"], old.doc["meshes"][was]["name"]);
            assert_eq!(new.doc["meshes"][node]["extras"], old.doc["meshes"][was]["extras"]);
            for primitive in [0, 1, 2, 4].into_iter().take(if was == 0 { 4 } else { 1 }) {
                for list in ["attributes", "targets/0", "targets/1"] {
                    for name in old.names(was, primitive, list) {
                        if form == Form::Color && name == "COLOR_0" {
                            continue;
                        }
                        let path = format!("{list}/{name}");
                        let corners = new.corners(node, primitive, &path);
                        assert_eq!(
                            corners,
                            old.corners(was, primitive, &path),
                            "{form:?} {primitive} {path}"
                        );
                    }
                }
            }
        }
        assert!(written.notes.iter().all(|note| !note.contains("without a face")), "{:?}", written.notes);
    }
}

#[test]
fn occlusion_comparison_of_attributes_notices_a_vertex_that_was_not_copied() {
    let before = rich().glb();
    let (corners, openness) = different(faces_of(&before));
    let written = add(&before, &corners, &openness, &OcclusionOptions::new(Form::Attribute));
    let (old, mut new) = (Back::of(&before), Back::of(&written.bytes));
    let mesh = new.shown()[2];
    let copied = new.doc["meshes"][mesh]["primitives"][0]["attributes"]["POSITION"].clone();
    assert_ne!(copied, old.doc["meshes"][1]["primitives"][0]["attributes"]["POSITION"]);
    let view =
        new.doc["accessors"][copied.as_u64().unwrap() as usize]["bufferView"].as_u64().unwrap() as usize;
    let view = &new.doc["bufferViews"][view];
    let end = (view["byteOffset"].as_u64().unwrap() + view["byteLength"].as_u64().unwrap()) as usize;
    new.bin[end - 2] ^= 1; // the last copy
    assert_ne!(new.corners(mesh, 0, "attributes/POSITION"), old.corners(1, 0, "attributes/POSITION"));
}
