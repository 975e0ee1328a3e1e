//! glTF and GLB: every feature on a document made here, every defect refused with one line, real files by
//! their facts.

mod animation;
mod buffer;
mod defect;
mod draco;
mod extension;
mod geometry;
mod instancing;
mod meshopt;
mod occlusion;
mod real;
mod reports;
mod scene;
mod skin;
mod slip;

use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use serde_json::{Value, json};
use umbrage::read::read_bytes;
use umbrage::scene::Scene;

/// A document under construction: accessors and meshes are added by methods, everything else is set in `doc`.
struct Builder {
    doc: Value,
    bin: Vec<u8>,
}

const SQUARE: [[f32; 3]; 4] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0]];

impl Builder {
    fn new() -> Self {
        let doc = json!({
            "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
            "meshes": [], "accessors": [], "bufferViews": [], "buffers": []
        });
        Self { doc, bin: Vec::new() }
    }

    /// One mesh of one primitive, without and with the index accessor of `indices`.
    fn mesh(positions: &[[f32; 3]], mode: u32, indices: Option<&[u16]>) -> Self {
        let mut builder = Self::new();
        let position = builder.positions(positions);
        let mut primitive = json!({"attributes": {"POSITION": position}, "mode": mode});
        if let Some(indices) = indices {
            primitive["indices"] = builder.accessor(5123, "SCALAR", indices.len(), &u16s(indices)).into();
        }
        builder.doc["meshes"] = json!([{"primitives": [primitive]}]);
        builder
    }

    fn square() -> Self {
        Self::mesh(&SQUARE, 4, Some(&[0, 1, 2, 2, 1, 3]))
    }

    fn view(&mut self, bytes: &[u8]) -> usize {
        let views = self.doc["bufferViews"].as_array_mut().unwrap();
        views.push(json!({"buffer": 0, "byteOffset": self.bin.len(), "byteLength": bytes.len()}));
        self.bin.extend_from_slice(bytes);
        self.bin.resize(self.bin.len().next_multiple_of(4), 0);
        views.len() - 1
    }

    fn accessor(&mut self, component: u32, shape: &str, count: usize, bytes: &[u8]) -> usize {
        let view = self.view(bytes);
        let accessors = self.doc["accessors"].as_array_mut().unwrap();
        accessors
            .push(json!({"bufferView": view, "componentType": component, "type": shape, "count": count}));
        accessors.len() - 1
    }

    fn positions(&mut self, positions: &[[f32; 3]]) -> usize {
        self.accessor(5126, "VEC3", positions.len(), &f32s(positions.as_flattened()))
    }

    /// The document as .gltf with the buffer embedded.
    fn gltf(&self) -> Vec<u8> {
        let mut doc = self.doc.clone();
        if doc["buffers"] == json!([]) {
            doc["buffers"] = json!([self.embedded()]);
        }
        serde_json::to_vec(&doc).unwrap()
    }

    /// The buffer within its URI.
    fn embedded(&self) -> Value {
        let uri = format!("data:application/octet-stream;base64,{}", BASE64_STANDARD.encode(&self.bin));
        json!({"byteLength": self.bin.len(), "uri": uri})
    }

    /// The document as .gltf with the buffer in the file `uri`.
    fn gltf_beside(&self, uri: &str) -> Vec<u8> {
        let mut doc = self.doc.clone();
        doc["buffers"] = json!([{"byteLength": self.bin.len(), "uri": uri}]);
        serde_json::to_vec(&doc).unwrap()
    }

    fn glb(&self) -> Vec<u8> {
        self.glb_with(json!([{"byteLength": self.bin.len()}]))
    }

    /// The document as GLB with these buffers, of which the first is the binary chunk.
    fn glb_with(&self, buffers: Value) -> Vec<u8> {
        let mut doc = self.doc.clone();
        doc["buffers"] = buffers;
        let mut json = serde_json::to_vec(&doc).unwrap();
        json.resize(json.len().next_multiple_of(4), b' ');
        let mut glb = b"glTF\x02\0\0\0".to_vec();
        glb.extend((12 + 8 + json.len() as u32 + 8 + self.bin.len() as u32).to_le_bytes());
        for (kind, chunk) in [(b"JSON", &json), (b"BIN\0", &self.bin)] {
            glb.extend((chunk.len() as u32).to_le_bytes());
            glb.extend(kind);
            glb.extend(chunk);
        }
        glb
    }

    fn read(&self) -> Scene {
        read_bytes(&self.gltf(), "a.gltf").unwrap_or_else(|error| panic!("{error}"))
    }

    /// The error message for this document, which must be refused.
    fn refusal(&self) -> String {
        refusal(&self.gltf())
    }
}

fn refusal(bytes: &[u8]) -> String {
    let message = read_bytes(bytes, "a.gltf").expect_err("must be refused").to_string();
    assert!(!message.contains('\n') && message.contains("; "), "one line with a remedy: {message}");
    message
}

fn f32s(values: &[f32]) -> Vec<u8> {
    values.iter().flat_map(|x| x.to_le_bytes()).collect()
}

fn u16s(values: &[u16]) -> Vec<u8> {
    values.iter().flat_map(|x| x.to_le_bytes()).collect()
}

fn identity() -> [f32; 16] {
    glam::Mat4::IDENTITY.to_cols_array()
}
