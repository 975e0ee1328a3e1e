//! The step that closes holes.

mod ears;
mod least_area;
mod loops;
mod meet;
mod shape;
mod triangulate;

use super::change::{Left, Patch, Step};
use super::rewrite::with_faces;
use crate::mesh::{Mesh, MeshError};
use crate::topology::Topology;
use loops::loops;
use meet::conflicts;
use triangulate::Triangulator;

/// Which holes are closed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct Fill {
    /// Holes of more edges are left; `None` closes those of any number.
    pub most_edges: Option<usize>,
    /// Also closes holes whose patch meets other faces.
    pub anyway: bool,
}

impl Fill {
    /// Holes of at most `edges` edges.
    #[must_use]
    pub fn up_to(edges: usize) -> Self {
        Self { most_edges: Some(edges), ..Self::default() }
    }
}

/// Closes holes with faces between their own vertices, wound like the faces around them.
///
/// A border that touches itself is cut into loops there. A flat loop is cut exactly, by the rules for
/// polygons of files; any other so that the area is least (Gheorghe Barequet and Micha Sharir, *Filling Gaps
/// in the Boundary of a Polyhedron*, 1995, section 3), in cubic time; one too long for that by its shortest
/// diagonals. Diagonals that are edges already, and faces without area, are avoided wherever possible.
///
/// Guarantee: all faces and positions stay, bit for bit, and no vertex is new. New faces come at the end. At
/// each edge of a patch there are two faces, in opposite directions. A patch that would meet other faces where
/// it should not is refused, unless [`Fill::anyway`]. What is left is listed with the reason.
///
/// ```
/// use umbrage::repair::{self, Fill};
/// use umbrage::{testing::shapes, topology::Topology};
/// let (mesh, step) = repair::fill(shapes::open_cube(), Fill::default())?;
/// assert!(step.count == 1 && mesh.face_count() == 12 && Topology::of(&mesh).edge_counts().watertight());
/// // A sheet has no inside: its patch would lie on it.
/// assert_eq!(repair::fill(shapes::sheet(3), Fill::default())?.1.left, 1);
/// # Ok::<(), umbrage::mesh::MeshError>(())
/// ```
///
/// # Errors
///
/// [`MeshError::TooLarge`] if there are more faces than [`MAX_TRIANGLES`](crate::mesh::MAX_TRIANGLES).
pub fn fill(mesh: Mesh, which: Fill) -> Result<(Mesh, Step), MeshError> {
    let mut step = Step::new("fill");
    let topology = Topology::of(&mesh);
    if topology.edge_counts().boundary == 0 {
        return Ok((mesh, step));
    }
    let found = loops(&topology);
    let at = |vertex: u32| mesh.positions()[vertex as usize];
    let mut triangulator = Triangulator::new(&mesh, &topology);
    let mut holes: Vec<Hole> = Vec::new();
    for ring in found.loops {
        let patch = shape::of(&ring.iter().map(|&vertex| at(vertex)).collect::<Vec<_>>());
        let too_long = which.most_edges.is_some_and(|most| ring.len() > most);
        let mut hole = Hole { ring, faces: Vec::new(), patch };
        if too_long {
            hole.patch.left = Some(Left::TooLong);
        } else {
            hole.faces = triangulator.cut(&hole.ring);
            hole.patch.area = Some(shape::area(hole.faces.iter().map(|corners| corners.map(at))));
        }
        holes.push(hole);
    }
    drop(topology);
    judge(&mesh, &mut holes, which.anyway)?;
    let mut next = mesh.face_count();
    let mut new = Vec::new();
    for hole in &holes {
        let closed = hole.patch.left.is_none();
        step.add_hole(hole.patch, closed.then_some(next as u32), at(hole.ring[0]));
        if closed {
            new.extend_from_slice(&hole.faces);
            next += hole.faces.len();
        }
    }
    for chain in found.chains {
        let points: Vec<[f32; 3]> = chain.iter().map(|&vertex| at(vertex)).collect();
        let patch = Patch { edges: chain.len() - 1, left: Some(Left::NoLoop), ..shape::of(&points) };
        step.add_hole(patch, None, points[0]);
    }
    Ok((with_patches(mesh, &new)?, step))
}

/// A loop of the border in the winding of its patch, and the faces that would close it.
struct Hole {
    ring: Vec<u32>,
    faces: Vec<[u32; 3]>,
    patch: Patch,
}

/// Says of each patch whether it meets other faces, and refuses those that must not be.
fn judge(mesh: &Mesh, holes: &mut [Hole], anyway: bool) -> Result<(), MeshError> {
    let patches = || holes.iter().filter(|hole| hole.patch.left.is_none());
    let faces: Vec<[u32; 3]> = patches().flat_map(|hole| hole.faces.iter().copied()).collect();
    let ends: Vec<usize> = patches()
        .scan(mesh.face_count(), |end, hole| {
            *end += hole.faces.len();
            Some(*end)
        })
        .collect();
    if faces.is_empty() {
        return Ok(());
    }
    let conflicts = conflicts(&with_patches(mesh.clone(), &faces)?, mesh.face_count(), &ends);
    let closed = holes.iter_mut().filter(|hole| hole.patch.left.is_none());
    for (hole, conflict) in closed.zip(conflicts) {
        hole.patch.meets = conflict.meets;
        hole.patch.left = match conflict.meets {
            _ if conflict.edge_in_use => Some(Left::EdgeInUse),
            Some(false) => None,
            _ if anyway => None,
            Some(true) => Some(Left::Meets),
            None => Some(Left::NotDecided),
        };
    }
    Ok(())
}

fn with_patches(mesh: Mesh, new: &[[u32; 3]]) -> Result<Mesh, MeshError> {
    if new.is_empty() {
        return Ok(mesh);
    }
    let from: Vec<u32> = (0..mesh.face_count() as u32).collect();
    let triangles = [mesh.triangles(), new].concat();
    with_faces(mesh, triangles, &from)
}

#[cfg(test)]
mod tests;
