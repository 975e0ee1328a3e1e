//! The step that closes holes.

mod clear;
mod ears;
mod least_angle;
mod least_area;
mod loops;
mod meet;
mod shape;
mod triangulate;

use super::change::{Left, Patch, Step};
use super::rewrite::with_faces;
use crate::mesh::{Mesh, MeshError};
use crate::topology::Topology;
use clear::Clear;
use loops::loops;
use meet::{Conflict, conflicts};
use triangulate::{Method, Triangulator};

/// Which holes are closed.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Fill {
    /// Holes of more edges are left; `None` closes those of any number.
    pub most_edges: Option<usize>,
    /// Holes that are longer around, in mesh units, are left; `None` closes those of any length.
    pub most_length: Option<f64>,
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
/// diagonals. Where such a patch would meet other faces, one that bends little is tried, one by the shortest
/// diagonals, and at last every one: a hole of at most 400 edges is closed, or it is proven that each patch
/// between its vertices meets other faces ([`Left::NoPatch`]). Diagonals that are edges already, and faces
/// without area, are avoided wherever possible.
///
/// Guarantee: all faces and positions stay, bit for bit, and no vertex is new. New faces come at the end. At
/// each edge of a patch there are two faces, in opposite directions. A patch that would meet other faces
/// where it should not is refused, unless [`Fill::anyway`]. What is left is listed with the reason.
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
        let mut patch = shape::of(&ring.iter().map(|&vertex| at(vertex)).collect::<Vec<_>>());
        let too_long = which.most_edges.is_some_and(|most| ring.len() > most);
        let too_far = which.most_length.is_some_and(|most| patch.length > most);
        patch.left = match (too_long, too_far) {
            (true, _) => Some(Left::TooLong),
            (false, true) => Some(Left::TooFarAround),
            (false, false) => None,
        };
        holes.push(Hole { ring, faces: Vec::new(), first: None, patch });
    }
    close(&mesh, &mut triangulator, &mut holes)?;
    for hole in &mut holes {
        if which.anyway && matches!(hole.patch.left, Some(Left::Meets | Left::NoPatch | Left::NotDecided)) {
            hole.patch.left = None;
        }
        let faces = hole.faces.iter().map(|corners| corners.map(at));
        hole.patch.area = (!hole.faces.is_empty()).then(|| shape::area(faces));
    }
    drop(topology);
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
    /// Those of the first method, unless one after it meets no other face.
    faces: Vec<[u32; 3]>,
    /// What stood against the first method.
    first: Option<Conflict>,
    patch: Patch,
}

/// Finds a patch for each hole that is not left already, or says why there is none: one method after the
/// other, each for all holes that are still open.
fn close(mesh: &Mesh, triangulator: &mut Triangulator<'_>, holes: &mut [Hole]) -> Result<(), MeshError> {
    let mut open: Vec<usize> = (0..holes.len()).filter(|&hole| holes[hole].patch.left.is_none()).collect();
    // With the patches that were found so far.
    let mut base = mesh.clone();
    for method in Method::ALL {
        let cut = |&hole: &usize| Some((hole, triangulator.cut(&holes[hole].ring, method)?));
        let tried: Vec<(usize, Vec<[u32; 3]>)> = open.iter().filter_map(cut).collect();
        if tried.is_empty() {
            continue;
        }
        let faces: Vec<[u32; 3]> = tried.iter().flat_map(|(_, faces)| faces.iter().copied()).collect();
        let mut end = base.face_count();
        let ends: Vec<usize> = tried
            .iter()
            .map(|(_, faces)| {
                end += faces.len();
                end
            })
            .collect();
        let conflicts = conflicts(&with_patches(base.clone(), &faces)?, base.face_count(), &ends);
        let mut found: Vec<[u32; 3]> = Vec::new();
        for ((hole, faces), conflict) in tried.into_iter().zip(conflicts) {
            let hole = &mut holes[hole];
            let first = *hole.first.get_or_insert(conflict);
            let fits = conflict.meets == Some(false) && !conflict.edge_in_use;
            if fits {
                found.extend_from_slice(&faces);
            }
            if fits || hole.faces.is_empty() {
                hole.faces = faces;
            }
            hole.patch.meets = if fits { Some(false) } else { first.meets };
            hole.patch.left = match first.meets {
                _ if fits => None,
                _ if first.edge_in_use => Some(Left::EdgeInUse),
                None => Some(Left::NotDecided),
                Some(_) => Some(Left::Meets),
            };
        }
        open.retain(|&hole| holes[hole].patch.left.is_some());
        if open.is_empty() {
            break;
        }
        base = with_patches(base, &found)?;
    }
    close_clear(base, triangulator, holes, &open)
}

/// The last method, for the holes that none before closed: whatever patch meets nothing.
fn close_clear(
    base: Mesh,
    triangulator: &mut Triangulator<'_>,
    holes: &mut [Hole],
    open: &[usize],
) -> Result<(), MeshError> {
    let mut with = base.clone();
    let mut tried: Vec<(usize, Vec<[u32; 3]>)> = Vec::new();
    for &hole in open {
        match triangulator.clear(&with, &holes[hole].ring) {
            Clear::Found(faces) => {
                let ring = &holes[hole].ring;
                let faces: Vec<[u32; 3]> = faces.iter().map(|face| face.map(|corner| ring[corner])).collect();
                with = with_patches(with, &faces)?;
                tried.push((hole, faces));
            }
            Clear::Impossible => holes[hole].patch.left = Some(Left::NoPatch),
            Clear::NotFound => {}
        }
    }
    // What was found is judged as all patches are.
    let ends: Vec<usize> = tried
        .iter()
        .scan(base.face_count(), |end, (_, faces)| {
            *end += faces.len();
            Some(*end)
        })
        .collect();
    for ((hole, faces), conflict) in tried.into_iter().zip(conflicts(&with, base.face_count(), &ends)) {
        if conflict.meets == Some(false) && !conflict.edge_in_use {
            let hole = &mut holes[hole];
            (hole.faces, hole.patch.left, hole.patch.meets) = (faces, None, Some(false));
        }
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
