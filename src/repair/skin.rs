//! Vertices that a skin moves differently, kept apart.

use hashbrown::HashSet;

use super::change::{ChangeKind, Step};
use crate::mesh::{Mesh, VertexId, Weld, Welded, movers_as_frames, weld_in_place};

/// Makes vertices one by the rule `how`, but only those with the same number in the skin of the mesh.
///
/// The numbers become frames, in which vertices of different numbers are farther apart than any weld
/// distance: the corners of a cube of the side 2 · `f32::MAX`, three bits of the number a frame. So every
/// weld that compares frames keeps them apart.
pub(super) fn weld(mut mesh: Mesh, how: Weld) -> Welded {
    let Some(skin) = mesh.skin().cloned() else { return weld_in_place(mesh, how) };
    let (name, origins) = (mesh.name.clone(), mesh.origins().cloned());
    let (positions, triangles, parts, mut frames) = mesh.into_parts();
    let own = frames.len();
    frames.extend(movers_as_frames(&skin));
    mesh = Mesh::new(positions, triangles).expect("it was a mesh").with_name(name).with_parts(parts);
    mesh = mesh.with_origins_of(origins).with_frames(frames).expect("finite, and as many as vertices");
    let mut welded = weld_in_place(mesh, how);
    let mut kept = vec![0; welded.mesh.vertex_count()];
    for (vertex, &number) in (0..).zip(&*skin) {
        if let Some(new) = welded.vertex_of(VertexId(vertex)) {
            kept[new.index()] = number;
        }
    }
    welded.mesh.truncate_frames(own);
    welded.mesh = welded.mesh.with_skin(Some(kept.into()));
    welded
}

/// Lists the vertices of a welded mesh that have the positions of one before them in every frame, and that
/// only the skin keeps apart.
pub(super) fn list_kept_apart(mesh: &Mesh, step: &mut Step) {
    if mesh.skin().is_none() {
        return;
    }
    let mut seen = HashSet::new();
    for vertex in 0..mesh.vertex_count() {
        if !seen.insert(in_every_frame(mesh, vertex)) {
            let (id, at) = (Some(vertex as u32), mesh.positions()[vertex]); // ids have 32 bits
            step.add(ChangeKind::KeptApart, id, id, at);
        }
    }
}

/// The positions of a vertex in all frames, as bits.
pub(super) fn in_every_frame(mesh: &Mesh, vertex: usize) -> Vec<u32> {
    let frames = mesh.frames().iter().map(|frame| frame[vertex]);
    frames.chain([mesh.positions()[vertex]]).flatten().map(f32::to_bits).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::repair;
    use crate::testing::shapes;

    /// A soup whose vertices have skin numbers by their height: both halves have some at the middle.
    fn skinned(seam: bool) -> Mesh {
        let soup = shapes::soup(&shapes::torus(8, 6, 2.0, 0.5));
        // By the middle of the face, so that the border of the halves has both numbers.
        let number = |face: u32| {
            let low = soup.corners(crate::mesh::FaceId(face)).iter().map(|corner| corner[0]).sum::<f32>();
            if seam && low > 0.0 { 9 } else { 4 }
        };
        let skin = (0..soup.face_count() as u32).flat_map(|face| [number(face); 3]).collect::<Vec<_>>();
        soup.clone().with_skin(Some(skin.into()))
    }

    #[test]
    fn skin_keeps_vertices_of_one_position_apart_in_every_weld() {
        for how in [Weld::Exact, Weld::Within(1e-3), Weld::Within(1e9), Weld::Within(f32::MAX)] {
            let (mesh, step) = repair::weld(skinned(true), how);
            let numbers = mesh.skin().unwrap();
            assert_eq!(numbers.len(), mesh.vertex_count());
            assert!(numbers.contains(&4) && numbers.contains(&9), "{how:?}");
            // Each corner still has its number.
            let corners = |mesh: &Mesh| -> Vec<u32> {
                mesh.triangles().as_flattened().iter().map(|&v| mesh.skin().unwrap()[v as usize]).collect()
            };
            assert_eq!(corners(&mesh), corners(&skinned(true)), "{how:?}");
            assert!(mesh.frames().is_empty());
            if how == Weld::Exact {
                // Two rings of the tube, of 6 vertices each, are there twice.
                assert_eq!((mesh.vertex_count(), step.left), (48 + 12, 12));
            }
            // Fault injected: without the skin, they are one.
            let without = repair::weld(skinned(true).with_skin(None), how).0;
            assert!(without.vertex_count() < mesh.vertex_count(), "{how:?}");
        }
        let (mesh, step) = repair::weld(skinned(false), Weld::Exact);
        assert_eq!((mesh.vertex_count(), step.left), (48, 0));
    }
}
