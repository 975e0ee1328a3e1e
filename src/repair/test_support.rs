//! What tests of repair compare.

use std::collections::BTreeMap;

use crate::mesh::Mesh;

/// The positions of all corners, as bits.
pub(super) fn corners(mesh: &Mesh) -> Vec<[u32; 3]> {
    mesh.triangles().iter().flatten().map(|&v| mesh.positions()[v as usize].map(f32::to_bits)).collect()
}

/// The positions of all vertices, as bits.
pub(super) fn bits(mesh: &Mesh) -> Vec<[u32; 3]> {
    mesh.positions().iter().map(|p| p.map(f32::to_bits)).collect()
}

/// The mesh with more faces at its end.
pub(super) fn added(mesh: &Mesh, faces: &[[u32; 3]]) -> Mesh {
    let (positions, mut triangles, ..) = mesh.clone().into_parts();
    triangles.extend(faces);
    Mesh::new(positions, triangles).unwrap()
}

/// The mesh without one face.
pub(super) fn without(mesh: &Mesh, face: usize) -> Mesh {
    let (positions, mut triangles, ..) = mesh.clone().into_parts();
    triangles.remove(face);
    Mesh::new(positions, triangles).unwrap()
}

/// At each edge between two positions, the faces along it minus the faces against it; without zeros.
pub(super) fn boundary_chain(mesh: &Mesh) -> BTreeMap<[[u32; 3]; 2], i32> {
    let mut chain = BTreeMap::new();
    let at = |vertex: u32| mesh.positions()[vertex as usize].map(f32::to_bits);
    for &[a, b, c] in mesh.triangles() {
        for (p, q) in [(a, b), (b, c), (c, a)] {
            let (p, q) = (at(p), at(q));
            *chain.entry([p.min(q), p.max(q)]).or_insert(0) += if p < q { 1 } else { -1 };
        }
    }
    chain.retain(|ends, sum| ends[0] != ends[1] && *sum != 0);
    chain
}
