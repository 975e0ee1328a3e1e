//! The scene again, with two of its meshes moving.

use std::f32::consts::{PI, TAU};

use serde_json::{Value, json};

/// Seconds of the clip, after which it begins again.
const SECONDS: f32 = 2.0;
/// Keys of each channel.
const KEYS: usize = 17;

/// A GLB of the scene with a clip: the knot turns around its upright axis, and the sphere jumps.
///
/// # Panics
///
/// Panics if the bytes are no GLB that this crate wrote.
pub(super) fn with_clip(glb: &[u8]) -> Vec<u8> {
    let chunk = |at: usize| {
        let length = u32::from_le_bytes(glb[at..at + 4].try_into().expect("four bytes")) as usize;
        &glb[at + 8..at + 8 + length]
    };
    let document = chunk(12);
    let mut bin = chunk(12 + 8 + document.len()).to_vec();
    let mut document: Value = serde_json::from_slice(document).expect("it was written as JSON");

    let time = |key: usize| SECONDS * key as f32 / (KEYS - 1) as f32;
    let turn = |key: usize| TAU * time(key) / SECONDS;
    // About the upright axis through x = -1.5: around the origin, and then back to where it was.
    let axis = -1.5;
    let times = add(&mut document, &mut bin, "SCALAR", (0..KEYS).map(time).collect());
    let rotation = (0..KEYS).flat_map(|key| [0.0, (0.5 * turn(key)).sin(), 0.0, (0.5 * turn(key)).cos()]);
    let rotation = add(&mut document, &mut bin, "VEC4", rotation.collect());
    let shift = (0..KEYS).flat_map(|key| [axis - axis * turn(key).cos(), 0.0, axis * turn(key).sin()]);
    let shift = add(&mut document, &mut bin, "VEC3", shift.collect());
    let jump = (0..KEYS).flat_map(|key| [0.0, (PI * 2.0 * time(key) / SECONDS).sin().abs(), 0.0]);
    let jump = add(&mut document, &mut bin, "VEC3", jump.collect());

    let nodes = document["nodes"].as_array().expect("the scene has nodes");
    let node = |name: &str| {
        let named = |node: &Value| node["name"].as_str().is_some_and(|of| of.starts_with(name));
        nodes.iter().position(named).expect("the scene has such a node")
    };
    let channel = |sampler: usize, name: &str, path: &str| json!({ "sampler": sampler, "target": { "node": node(name), "path": path } });
    let channels = [
        channel(0, "torus knot", "rotation"),
        channel(1, "torus knot", "translation"),
        channel(2, "sphere", "translation"),
    ];
    let samplers = [rotation, shift, jump].map(|output| json!({ "input": times, "output": output }));
    let clip = json!([{ "name": "turn and jump", "channels": channels, "samplers": samplers }]);
    document["animations"] = clip;
    document["accessors"][times]["min"] = json!([0.0]);
    document["accessors"][times]["max"] = json!([SECONDS]);
    document["buffers"][0]["byteLength"] = bin.len().into();
    joined(&document, &bin)
}

/// Adds an accessor of floats; its number.
fn add(document: &mut Value, bin: &mut Vec<u8>, shape: &str, floats: Vec<f32>) -> usize {
    bin.resize(bin.len().next_multiple_of(4), 0);
    let start = bin.len();
    floats.iter().for_each(|x| bin.extend(x.to_le_bytes()));
    let mut push = |list: &str, entry: Value| {
        let list = document[list].as_array_mut().expect("the scene has such a list");
        list.push(entry);
        list.len() - 1
    };
    let view = json!({ "buffer": 0, "byteOffset": start, "byteLength": bin.len() - start });
    let view = push("bufferViews", view);
    push("accessors", json!({ "bufferView": view, "componentType": 5126, "type": shape, "count": KEYS }))
}

/// A GLB of its two chunks.
fn joined(document: &Value, bin: &[u8]) -> Vec<u8> {
    let mut text = document.to_string().into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    let mut bin = bin.to_vec();
    bin.resize(bin.len().next_multiple_of(4), 0);
    let length = 12 + 8 + text.len() + 8 + bin.len();
    let mut glb = b"glTF\x02\0\0\0".to_vec();
    glb.extend((length as u32).to_le_bytes());
    for (kind, chunk) in [(b"JSON", &text), (b"BIN\0", &bin)] {
        glb.extend((chunk.len() as u32).to_le_bytes());
        glb.extend(kind);
        glb.extend(chunk);
    }
    glb
}
