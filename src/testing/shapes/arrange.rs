//! The same mesh in another order, position or storage.

use super::Mesh;
use crate::mesh::MeshError;
use crate::random::SplitMix64;

/// `mesh` with new vertex numbers, its faces in another order, and each face's corners rotated, all drawn
/// from `seed`. Same shape, same windings, same counts; without parts, as they are mixed.
///
/// Drawn in this order with SplitMix64: a permutation of the vertices, one of the faces (Fisher & Yates,
/// from the last index down), then a rotation for each new face. Any dependence on the order of a file shows
/// here.
#[must_use]
pub fn shuffled(mesh: &Mesh, seed: u64) -> Mesh {
    let mut random = SplitMix64(seed);
    // `from[new]` is the old vertex, `to[old]` the new one.
    let from = random.permutation(mesh.vertex_count());
    let mut to = vec![0; from.len()];
    for (new, &old) in (0..).zip(&from) {
        to[old as usize] = new;
    }
    let mut triangles: Vec<[u32; 3]> = random
        .permutation(mesh.face_count())
        .into_iter()
        .map(|face| mesh.triangles()[face as usize].map(|vertex| to[vertex as usize]))
        .collect();
    for triangle in &mut triangles {
        triangle.rotate_left(random.below(3));
    }
    let pick = |old: &[[f32; 3]]| from.iter().map(|&vertex| old[vertex as usize]).collect();
    let frames = mesh.frames().iter().map(|frame| pick(frame)).collect();
    rebuilt(Mesh::new(pick(mesh.positions()), triangles), frames).with_name(mesh.name.clone())
}

/// `mesh` with three vertices of its own for each face, as an STL file holds it: V 3F, E 3F, χ F.
///
/// Parts and frames are kept. An exact weld brings back the adjacency, if no two vertices shared a position.
///
/// # Panics
///
/// Panics if three times the faces are more than vertex ids.
#[must_use]
pub fn soup(mesh: &Mesh) -> Mesh {
    let spread = |old: &[[f32; 3]]| mesh.triangles().iter().flatten().map(|&v| old[v as usize]).collect();
    let triangles =
        (0..mesh.face_count() as u32).map(|face| [3 * face, 3 * face + 1, 3 * face + 2]).collect();
    let frames = mesh.frames().iter().map(|frame| spread(frame)).collect();
    rebuilt(Mesh::new(spread(mesh.positions()), triangles), frames)
        .with_parts(mesh.parts().to_vec())
        .with_name(mesh.name.clone())
}

/// `mesh` with the winding of every face reversed: `[a, b, c]` becomes `[a, c, b]`. Counts stay, the volume's
/// sign turns.
#[must_use]
pub fn inside_out(mesh: &Mesh) -> Mesh {
    let triangles = mesh.triangles().iter().map(|&[a, b, c]| [a, c, b]).collect();
    rebuilt(Mesh::new(mesh.positions().to_vec(), triangles), mesh.frames().to_vec())
        .with_parts(mesh.parts().to_vec())
        .with_name(format!("{} inside out", mesh.name).trim_start())
}

/// `mesh` moved by `offset`, each coordinate rounded once.
///
/// Vertices that coincide still do. Far away distinct ones may come to coincide, and flat faces to bend, by
/// up to half a unit in the last place of the new coordinate: one source of cracks and collapsed faces in
/// real files.
///
/// # Panics
///
/// Panics if a new coordinate is not finite.
#[must_use]
pub fn translated(mesh: &Mesh, offset: [f32; 3]) -> Mesh {
    moved(mesh, |p| std::array::from_fn(|i| p[i] + offset[i]))
}

/// `mesh` times `factor` about the origin, each coordinate rounded once.
///
/// Exact where `factor` is a power of two and nothing falls below 2⁻¹²⁶. A negative factor turns the mesh
/// inside out.
///
/// # Panics
///
/// Panics if a new coordinate is not finite.
#[must_use]
pub fn scaled(mesh: &Mesh, factor: f32) -> Mesh {
    moved(mesh, |p| p.map(|x| x * factor))
}

/// `mesh` with each position of each frame mapped by `place`.
fn moved(mesh: &Mesh, place: impl Fn([f32; 3]) -> [f32; 3]) -> Mesh {
    let all = |old: &[[f32; 3]]| old.iter().map(|&p| place(p)).collect();
    let frames = mesh.frames().iter().map(|frame| all(frame)).collect();
    rebuilt(Mesh::new(all(mesh.positions()), mesh.triangles().to_vec()), frames)
        .with_parts(mesh.parts().to_vec())
        .with_name(mesh.name.clone())
}

/// Puts the frames of a rearranged mesh back.
fn rebuilt(mesh: Result<Mesh, MeshError>, frames: Vec<Vec<[f32; 3]>>) -> Mesh {
    mesh.and_then(|mesh| mesh.with_frames(frames))
        .unwrap_or_else(|error| panic!("the rearranged mesh leaves the domain: {error}"))
}
