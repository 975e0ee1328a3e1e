//! Whether a written file reads back as what was meant.

use std::path::Path;

use umbrage::check::Counts;
use umbrage::mesh::{Mesh, Weld, weld_in_place};
use umbrage::read;
use umbrage::scene::Scope;

use crate::cli::Failure;
use crate::cli::check::{FileReport, report_on};
use crate::cli::load::WeldedMesh;

/// Whether the bytes of a file, read by this program and welded by the rule `how`, are the faces of `meshes`
/// with the same positions, bit for bit, and have the numbers of `after`.
pub(super) fn is_same(
    bytes: &[u8],
    path: &Path,
    how: Weld,
    meshes: &[&Mesh],
    after: &FileReport,
) -> Result<bool, Failure> {
    let Ok(scene) = read::read_bytes(bytes, path) else {
        // What holds nothing may be no file of its format.
        return Ok(false);
    };
    let Ok(read) = scene.bake(Scope::Mesh) else { return Ok(false) };
    let corners = |mesh: &Mesh| -> Vec<[u32; 3]> {
        let at = |&vertex: &u32| mesh.positions()[vertex as usize].map(f32::to_bits);
        mesh.triangles().iter().flatten().map(at).collect()
    };
    // A mesh without faces is not in every format.
    let has_faces = |mesh: &&&Mesh| mesh.face_count() > 0;
    if !meshes.iter().filter(has_faces).map(|mesh| corners(mesh)).eq(read.iter().map(corners)) {
        return Ok(false);
    }
    let welded: Vec<WeldedMesh> = read
        .into_iter()
        .map(|mesh| {
            let vertices = mesh.vertex_count();
            let welded = weld_in_place(mesh, how);
            WeldedMesh { unreferenced: welded.unreferenced(), vertices, mesh: welded.mesh }
        })
        .collect();
    let found = report_on(path, None, &welded, &[]).total().unwrap_or_default();
    Ok(comparable(found) == comparable(after.total().unwrap_or_default()))
}

/// The numbers without the volume, whose rounding depends on the numbers of the vertices, and without what
/// is searched for only where it is asked for.
fn comparable(mut counts: Counts) -> Counts {
    counts.signed_volume = 0.0;
    (counts.self_intersections, counts.self_intersections_complete) = (None, true);
    counts
}
