//! The pieces that are kept, as casters of their own.

use crate::caster::{Caster, CasterGroup};
use crate::mesh::{FaceId, Mesh};

use super::Pieces;

/// The kept pieces as casters: one for each caster of the group that keeps a piece, in the same order. `kept`
/// is ascending. `None` if all pieces are kept: then the group itself will do.
///
/// The meshes have the vertices that their faces use, and nothing else of the casters.
///
/// ```
/// use umbrage::caster::{Caster, CasterGroup};
/// use umbrage::plan::relevance::{Pieces, casting};
/// use umbrage::testing::shapes;
/// let caster = Caster::new(shapes::hollow_cube());
/// let group = CasterGroup::new(vec![&caster]);
/// let pieces = Pieces::of(&group);
/// let casters = casting(&group, &pieces, &[1]).expect("one is dropped");
/// assert_eq!((casters.len(), casters[0].mesh().face_count()), (1, 12));
/// assert!(casting(&group, &pieces, &[0, 1]).is_none());
/// ```
///
/// # Panics
///
/// Panics if `pieces` belong to another group, or if there is no such piece.
#[must_use]
pub fn casting(casters: &CasterGroup<'_>, pieces: &Pieces, kept: &[u32]) -> Option<Vec<Caster>> {
    if kept.len() == pieces.len() {
        return None;
    }
    let caster_of = |&piece: &u32| pieces.piece(piece as usize).caster;
    let runs = kept.chunk_by(|a, b| caster_of(a) == caster_of(b));
    let caster = |run: &[u32]| {
        let mut faces: Vec<FaceId> =
            run.iter().flat_map(|&piece| pieces.faces(piece as usize)).copied().collect();
        faces.sort_unstable();
        Caster::new(part(casters.casters()[caster_of(&run[0])].mesh(), &faces))
    };
    Some(runs.map(caster).collect())
}

/// Some faces of a mesh.
fn part(mesh: &Mesh, faces: &[FaceId]) -> Mesh {
    let mut number = vec![u32::MAX; mesh.vertex_count()];
    let mut positions = Vec::new();
    let mut triangles = Vec::with_capacity(faces.len());
    for face in faces {
        triangles.push(mesh.triangles()[face.index()].map(|vertex| {
            let number = &mut number[vertex as usize];
            if *number == u32::MAX {
                *number = positions.len() as u32; // no more than vertices
                positions.push(mesh.positions()[vertex as usize]);
            }
            *number
        }));
    }
    Mesh::new(positions, triangles).expect("part of a valid mesh is valid").with_name(mesh.name.clone())
}
