//! A mesh as triangles of obvhs.

use obvhs::triangle::Triangle;
use umbrage::mesh::Mesh;

pub(crate) fn obvhs_triangles(mesh: &Mesh) -> Vec<Triangle> {
    let corners = |face: &[u32; 3]| face.map(|vertex| mesh.positions()[vertex as usize].into());
    mesh.triangles().iter().map(corners).map(|[v0, v1, v2]| Triangle { v0, v1, v2 }).collect()
}
