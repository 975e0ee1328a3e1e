//! Occlusion of meshes in formats that have one value a vertex.

use super::split::{NONE, Split, with_equal_values};
use super::{Layer, Occlusion};
use crate::mesh::Mesh;
use crate::write::Elements;

/// Layers with openness as their [`Layer::quality`]; a vertex with several values is split.
///
/// # Panics
///
/// Panics if `corners` are not those of all faces of `meshes` in sequence, or name a value that is not there.
#[must_use]
pub fn with_occlusion(meshes: &[Mesh], occlusion: &Occlusion<'_>) -> Vec<Layer> {
    let faces: usize = meshes.iter().map(Mesh::face_count).sum();
    assert_eq!(faces, occlusion.corners.len(), "three values a face");
    let values = with_equal_values(occlusion);
    let mut rest = occlusion.corners;
    let layer = |mesh: &Mesh| {
        let (corners, others) = rest.split_at(mesh.face_count());
        rest = others;
        let corners: Vec<[u32; 3]> =
            corners.iter().map(|face| face.map(|receiver| values[receiver as usize])).collect();
        let split = Split::new(mesh.vertex_count(), mesh.triangles(), &corners);
        let mut layer = Layer::from(mesh);
        let copies: Vec<[f32; 3]> = split.copies.iter().map(|&v| layer.positions[v as usize]).collect();
        layer.positions.extend(copies);
        let open = |&receiver: &u32| match receiver {
            NONE => 1.0,
            _ => occlusion.openness[receiver as usize],
        };
        layer.quality = Some(split.receivers.iter().map(open).collect());
        layer.elements = Elements::Triangles(split.triangles);
        layer
    };
    meshes.iter().map(layer).collect()
}
