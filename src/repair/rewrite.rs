//! Other faces for a mesh, with all that belongs to faces.

use crate::mesh::{FaceId, Mesh, MeshError, Origins, Part};

/// The mesh with other faces. The first of them come from old faces, which `from` names in ascending order,
/// so that a face may be dropped, or become several; the others are new, and belong to no part. Parts and
/// polygons of the file stay with their faces.
pub(super) fn with_faces(mesh: Mesh, triangles: Vec<[u32; 3]>, from: &[u32]) -> Result<Mesh, MeshError> {
    let origins = origins(&mesh, from, triangles.len() - from.len());
    let at = |face: u32| from.partition_point(|&old| old < face) as u32;
    let parts = mesh.parts().iter().map(|part| {
        let faces = at(part.faces.start)..at(part.faces.end);
        Part { name: part.name.clone(), faces, material: part.material }
    });
    let parts = parts.collect();
    let (name, skin) = (mesh.name.clone(), mesh.skin().cloned());
    let (positions, _, _, frames) = mesh.into_parts();
    let mesh = Mesh::new(positions, triangles)?.with_name(name).with_parts(parts);
    Ok(mesh.with_frames(frames)?.with_origins(origins).with_skin(skin))
}

/// The mesh with those of its faces that `from` names, ascending.
pub(super) fn keep_faces(mesh: Mesh, from: &[u32]) -> Mesh {
    let triangles = from.iter().map(|&face| mesh.triangles()[face as usize]).collect();
    with_faces(mesh, triangles, from).expect("some faces of a mesh, with its vertices")
}

/// The polygons of the old faces; of each new face, one after the last of the file.
fn origins(mesh: &Mesh, from: &[u32], new: usize) -> Origins {
    let mut origins = Origins::default();
    let mut first = 0;
    for run in from.chunk_by(|&a, &b| b == a + 1) {
        origins.append(mesh, run[0]..run[run.len() - 1] + 1, first);
        first += run.len() as u32; // faces fit 32 bits
    }
    if new > 0 {
        let last = mesh.face_count().checked_sub(1).map(|last| mesh.origin(FaceId::new(last)).polygon);
        let next = last.map_or(0, |last| last.saturating_add(1));
        origins.append(&Mesh::default(), next..next.saturating_add(new as u32), first);
    }
    origins
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::shapes;

    #[test]
    fn rewritten_faces_keep_their_parts_and_polygons() {
        let parts = vec![Part::new("low", 0..4), Part::new("high", 6..12)];
        let cube = shapes::cube().with_parts(parts);
        let from = [0, 3, 5, 7, 7, 11];
        let mut triangles: Vec<[u32; 3]> = from.iter().map(|&face| cube.triangles()[face as usize]).collect();
        triangles.push([0, 1, 2]);
        let rewritten = with_faces(cube, triangles, &from).unwrap();
        let ranges: Vec<_> = rewritten.parts().iter().map(|part| part.faces.clone()).collect();
        assert_eq!(ranges, [0..2, 3..6]);
        let polygons = (0..7).map(|face| rewritten.origin(FaceId(face)).polygon);
        // The last one is new: after the twelve of the cube.
        assert_eq!(polygons.collect::<Vec<_>>(), [0, 3, 5, 7, 7, 11, 12]);
        assert_eq!(keep_faces(rewritten, &[1, 2, 5]).parts()[1].faces, 2..3);
    }
}
