//! A mesh as the bytes of a file, in each format that the crate reads.

use std::fmt::Write as _;

use umbrage::mesh::Mesh;
use umbrage::write::{Layer, Model, Target, to_bytes};

/// A file in memory.
pub(crate) struct File {
    /// The extension of the file.
    pub(crate) name: &'static str,
    pub(crate) kind: &'static str,
    pub(crate) bytes: Vec<u8>,
    /// Number of vertices that a reader finds in the file: the mesh's vertices, or three per face.
    pub(crate) vertices: usize,
}

pub(crate) fn obj(mesh: &Mesh) -> File {
    written(mesh, Target::Obj, "a.obj", "OBJ")
}

pub(crate) fn ply(mesh: &Mesh) -> File {
    written(mesh, Target::Ply, "a.ply", "PLY, binary")
}

pub(crate) fn glb(mesh: &Mesh) -> File {
    written(mesh, Target::Glb, "a.glb", "GLB")
}

fn written(mesh: &Mesh, target: Target, name: &'static str, kind: &'static str) -> File {
    let model = Model { layers: vec![Layer::from(mesh)] };
    let bytes = to_bytes(&model, target).expect("it fits the format");
    File { name, kind, bytes, vertices: mesh.vertex_count() }
}

pub(crate) fn ply_text(mesh: &Mesh) -> File {
    let mut text = format!(
        "ply\nformat ascii 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\n\
         element face {}\nproperty list uchar int vertex_indices\nend_header\n",
        mesh.vertex_count(),
        mesh.face_count()
    );
    // Writing to a String cannot fail.
    for [x, y, z] in mesh.positions() {
        let _ = writeln!(text, "{x} {y} {z}");
    }
    for [a, b, c] in mesh.triangles() {
        let _ = writeln!(text, "3 {a} {b} {c}");
    }
    File { name: "a.ply", kind: "PLY, text", bytes: text.into_bytes(), vertices: mesh.vertex_count() }
}

pub(crate) fn off(mesh: &Mesh) -> File {
    let mut text = format!("OFF\n{} {} 0\n", mesh.vertex_count(), mesh.face_count());
    for [x, y, z] in mesh.positions() {
        let _ = writeln!(text, "{x} {y} {z}");
    }
    for [a, b, c] in mesh.triangles() {
        let _ = writeln!(text, "3 {a} {b} {c}");
    }
    File { name: "a.off", kind: "OFF, text", bytes: text.into_bytes(), vertices: mesh.vertex_count() }
}

pub(crate) fn stl(mesh: &Mesh) -> File {
    let mut bytes = vec![0; 80];
    bytes.extend((mesh.face_count() as u32).to_le_bytes());
    for corners in mesh.triangles() {
        bytes.extend([0; 12]); // the normal, which no reader uses
        for vertex in corners {
            bytes.extend(mesh.positions()[*vertex as usize].iter().flat_map(|x| x.to_le_bytes()));
        }
        bytes.extend([0; 2]);
    }
    File { name: "a.stl", kind: "STL, binary", bytes, vertices: 3 * mesh.face_count() }
}

pub(crate) fn stl_text(mesh: &Mesh) -> File {
    let mut text = String::from("solid a\n");
    for corners in mesh.triangles() {
        text += "facet normal 0 0 0\nouter loop\n";
        for vertex in corners {
            let [x, y, z] = mesh.positions()[*vertex as usize];
            let _ = writeln!(text, "vertex {x:e} {y:e} {z:e}");
        }
        text += "endloop\nendfacet\n";
    }
    text += "endsolid a\n";
    File { name: "a.stl", kind: "STL, text", bytes: text.into_bytes(), vertices: 3 * mesh.face_count() }
}
