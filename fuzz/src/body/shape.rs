//! Small meshes out of bytes: soups full of ties and duplicates, and closed solids that are bent and cut.

use umbrage::geom::Light;
use umbrage::mesh::{Mesh, Weld, weld};
use umbrage::testing::shapes;

use super::bytes::Bytes;

/// A mesh of at most 40 vertices and 80 faces or so.
pub(crate) fn mesh(bytes: &mut Bytes) -> Mesh {
    let (mut positions, mut triangles) = match bytes.below(16) {
        0 => base(&shapes::tetrahedron()),
        1 => base(&shapes::octahedron()),
        2 => base(&shapes::cube()),
        3 => base(&shapes::hollow_cube()),
        4 => base(&shapes::nested_cubes(2)),
        5 => base(&shapes::torus(3, 3, 2.0, 1.0)),
        6 => base(&shapes::figure_eight_prism()),
        7 => base(&shapes::cubes_sharing_edge()),
        8 => base(&shapes::cubes_sharing_vertex()),
        9 => base(&shapes::mobius(5)),
        10 => base(&shapes::book(3)),
        11 => base(&shapes::sheet(2)),
        12 => base(&shapes::inside_out(&shapes::octahedron())),
        _ => ((0..3 + bytes.below(10)).map(|_| bytes.place()).collect(), Vec::new()),
    };
    // Move vertices, add faces, turn faces, remove faces: so many of each.
    let n = positions.len();
    for _ in 0..bytes.below(2 * n) {
        let vertex = bytes.below(n);
        positions[vertex] = bytes.place();
    }
    for _ in 0..bytes.below(24) {
        triangles.push([(); 3].map(|()| bytes.below(n) as u32));
    }
    for _ in 0..bytes.below(4) {
        let face = bytes.below(triangles.len().clamp(1, 256));
        if let Some(corners) = triangles.get_mut(face) {
            corners.swap(1, 2);
        }
    }
    for _ in 0..bytes.below(4) {
        let face = bytes.below(triangles.len().clamp(1, 256));
        if face < triangles.len() {
            triangles.swap_remove(face);
        }
    }
    Mesh::new(positions, triangles).expect("finite positions and indices in range")
}

/// As [`mesh`], with vertices at one place made one.
pub(crate) fn welded(bytes: &mut Bytes) -> Mesh {
    weld(&mesh(bytes), Weld::Exact).mesh
}

/// A light, now and then exactly on a vertex of the mesh.
pub(crate) fn light(bytes: &mut Bytes, mesh: &Mesh) -> Light {
    let xyz = point(bytes, mesh);
    match Light::directional(xyz) {
        Ok(light) if bytes.byte() & 1 == 1 => light,
        _ => Light::point(xyz).expect("finite coordinates"),
    }
}

/// A point: a place, a vertex, or the middle of two vertices.
pub(crate) fn point(bytes: &mut Bytes, mesh: &Mesh) -> [f32; 3] {
    let n = mesh.vertex_count().min(256);
    match bytes.below(4) {
        0 if n > 0 => mesh.positions()[bytes.below(n)],
        1 if n > 0 => {
            let [a, b] = [(); 2].map(|()| mesh.positions()[bytes.below(n)]);
            [0, 1, 2].map(|i| 0.5 * a[i] + 0.5 * b[i])
        }
        _ => bytes.place(),
    }
}

fn base(mesh: &Mesh) -> (Vec<[f32; 3]>, Vec<[u32; 3]>) {
    (mesh.positions().to_vec(), mesh.triangles().to_vec())
}
