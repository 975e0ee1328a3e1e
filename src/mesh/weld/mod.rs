//! Vertices at one place become one vertex, so that faces which touch in space are neighbors in topology.

mod bucketed;
mod exact;
mod id_table;
mod streaming;
#[cfg(test)]
mod tests;
mod within;

use std::sync::Arc;

use super::{Mesh, VertexId};

/// Which vertices are the same.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Weld {
    /// Bit-equal positions, in every frame.
    #[default]
    Exact,
    /// Only equal indices: the file's own topology.
    None,
    /// Positions at most this far apart (mesh units, in every frame). Going through the vertices in order,
    /// each joins the lowest-numbered kept vertex within reach, or is kept itself: nothing moves farther than
    /// the distance, and there are no chains.
    Within(f32),
}

impl Weld {
    /// The distance, if there is one.
    fn distance(self) -> Option<f32> {
        match self {
            Self::Within(distance) if distance > 0.0 => Some(distance),
            _ => None,
        }
    }

    fn is_exact(self) -> bool {
        self != Self::None && self.distance().is_none()
    }
}

/// A welded mesh: no two vertices are the same, and every vertex belongs to a face.
#[derive(Clone, Debug)]
pub struct Welded {
    /// Positions of the kept vertices, faces in the order of the original with welded indices. What is asked about
    /// the original may be answered from it, so ask before it is taken away.
    pub mesh: Mesh,
    /// For each vertex of the original the vertex it became, or [`UNUSED`]. `None` if the original was a soup whose
    /// corners were its vertices in order, as then the faces tell.
    vertex_of: Option<Vec<u32>>,
}

impl Welded {
    /// What a vertex of the original became; `None` if no face uses it.
    ///
    /// # Panics
    ///
    /// Panics if the original has no such vertex, or if another mesh was put in the place of [`Welded::mesh`] and has
    /// fewer faces.
    #[must_use]
    pub fn vertex_of(&self, original: VertexId) -> Option<VertexId> {
        let vertex = self.vertices()[original.index()];
        (vertex != UNUSED).then_some(VertexId(vertex))
    }

    /// How many vertices of the original no face uses.
    #[must_use]
    pub fn unreferenced(&self) -> usize {
        self.vertices().iter().filter(|&&vertex| vertex == UNUSED).count()
    }

    fn vertices(&self) -> &[u32] {
        self.vertex_of.as_deref().unwrap_or(self.mesh.triangles.as_flattened())
    }
}

/// Merges vertices. Expected linear time; kept vertices stay in their order.
///
/// Vertices that no face references are left out.
///
/// Memory: at its peak 24 bytes a face of a closed mesh, the result included, 60 of its soup, and at most 150 where no
/// vertex is shared; 400 with a distance.
///
/// ```
/// use umbrage::mesh::{Weld, weld};
/// use umbrage::testing::shapes;
/// let soup = shapes::soup(&shapes::cube());
/// assert_eq!((soup.vertex_count(), weld(&soup, Weld::Exact).mesh.vertex_count()), (36, 8));
/// ```
#[must_use]
pub fn weld(mesh: &Mesh, how: Weld) -> Welded {
    let used = Used::by(mesh);
    let mut triangles = Vec::new();
    let (kept, vertex_of) = if how.is_exact() && used.are_corners {
        triangles = vec![[0; 3]; mesh.face_count()];
        (exact::merge(mesh, &used, triangles.as_flattened_mut()), None)
    } else {
        let (kept, vertex_of) = merged(mesh, &used, how);
        // (Spelt out: `map` of an array is not always inlined.)
        let welded_of = |vertex: u32| vertex_of[vertex as usize];
        let corners = mesh.triangles().iter();
        triangles.extend(corners.map(|&[a, b, c]| [welded_of(a), welded_of(b), welded_of(c)]));
        (kept, Some(vertex_of))
    };
    let welded = Mesh {
        name: mesh.name.clone(),
        frames: mesh.frames.iter().map(|frame| pick(frame, &kept.origins)).collect(),
        positions: kept.positions,
        triangles: triangles.into(),
        parts: mesh.parts.clone(),
    };
    Welded { mesh: welded, vertex_of }
}

/// The same in the memory of the mesh itself, for those who do not need the original any more.
///
/// Memory: at its peak 20 bytes a face of a closed mesh beside the mesh, 48 of its soup, and at most 140 where no
/// vertex is shared; 400 with a distance.
///
/// ```
/// use umbrage::mesh::{Weld, weld_in_place};
/// use umbrage::testing::shapes;
/// assert_eq!(weld_in_place(shapes::soup(&shapes::cube()), Weld::Exact).mesh.vertex_count(), 8);
/// ```
#[must_use]
pub fn weld_in_place(mut mesh: Mesh, how: Weld) -> Welded {
    let used = Used::by(&mesh);
    let vertices = mesh.vertex_count();
    let (kept, vertex_of) = if how.is_exact() && used.are_corners {
        let mut triangles = Arc::unwrap_or_clone(std::mem::take(&mut mesh.triangles));
        let kept = exact::merge(&mesh, &used, triangles.as_flattened_mut());
        mesh.triangles = triangles.into();
        (kept, None)
    } else {
        let (kept, vertex_of) = merged(&mesh, &used, how);
        for corner in Arc::make_mut(&mut mesh.triangles).as_flattened_mut() {
            *corner = vertex_of[*corner as usize];
        }
        (kept, Some(vertex_of))
    };
    // Otherwise every vertex has kept its number.
    if kept.positions.len() < vertices {
        mesh.positions = kept.positions;
        for frame in &mut mesh.frames {
            *frame = pick(frame, &kept.origins);
        }
    }
    Welded { mesh, vertex_of }
}

fn pick(from: &[[f32; 3]], origins: &[u32]) -> Vec<[f32; 3]> {
    origins.iter().map(|&vertex| from[vertex as usize]).collect()
}

/// For each point the number of the kept point that it joins, by the scheme of [`Weld::Within`].
pub(crate) fn weld_points(points: &[[f32; 3]], distance: f64) -> Vec<u32> {
    within::merged(&[points], &Used::all(points.len()), distance).vertex_of
}

/// A mark that no vertex id reaches, see [`Mesh::new`].
const UNUSED: u32 = u32::MAX;

/// Which vertex becomes which.
struct Merged {
    /// Each vertex's welded id, or [`UNUSED`].
    vertex_of: Vec<u32>,
    /// Each welded vertex's origin, the first of those that became it; ascending.
    kept: Vec<u32>,
}

/// What is left, and each vertex's welded id, or [`UNUSED`].
fn merged(mesh: &Mesh, used: &Used, how: Weld) -> (Kept, Vec<u32>) {
    if how.is_exact() {
        let mut vertex_of = vec![UNUSED; used.len];
        return (exact::merge(mesh, used, &mut vertex_of), vertex_of);
    }
    let Merged { vertex_of, kept: origins } = match how.distance() {
        None => Merged::by(used, |_, _| None),
        Some(distance) => {
            let frames: Vec<&[[f32; 3]]> =
                std::iter::once(mesh.positions()).chain(mesh.frames.iter().map(Vec::as_slice)).collect();
            within::merged(&frames, used, f64::from(distance))
        }
    };
    (Kept { positions: pick(mesh.positions(), &origins), origins }, vertex_of)
}

/// What is left of the vertices, in their order.
#[derive(Default)]
#[cfg_attr(test, derive(Clone, Debug, PartialEq))]
struct Kept {
    positions: Vec<[f32; 3]>,
    /// Where each comes from, the first of those that became it; an exact weld needs to know only if there are further
    /// frames to be picked.
    origins: Vec<u32>,
}

impl Merged {
    /// Goes through the used vertices in order. `find(vertex, new)` tells the welded vertex that `vertex` joins, or
    /// `None` if it is kept as `new`.
    fn by(used: &Used, mut find: impl FnMut(u32, u32) -> Option<u32>) -> Self {
        let mut vertex_of = vec![UNUSED; used.len];
        let mut kept = Vec::new();
        for vertex in used.iter() {
            let new = kept.len() as u32; // below the vertex count, which fits
            vertex_of[vertex as usize] = find(vertex, new).unwrap_or_else(|| {
                kept.push(vertex);
                new
            });
        }
        Self { vertex_of, kept }
    }
}

/// Whether corners are 0, 1, 2, …
fn ascend(corners: &[u32]) -> bool {
    // A block at a time, without leaving it early, so that it becomes vector instructions.
    const BLOCK: usize = 1024;
    let mut first = 0;
    corners.chunks(BLOCK).all(|block| {
        let wrong = (first..).zip(block).fold(0, |wrong, (vertex, &corner)| wrong | (vertex ^ corner));
        first += block.len() as u32; // corners are fewer than 2³²
        wrong == 0
    })
}

/// Which vertices a face references.
struct Used {
    len: usize,
    /// `None` for all.
    referenced: Option<Vec<bool>>,
    /// Whether the vertices are the corners of the faces one by one, as readers of triangles without indices make them.
    are_corners: bool,
}

impl Used {
    fn all(len: usize) -> Self {
        Self { len, referenced: None, are_corners: false }
    }

    fn by(mesh: &Mesh) -> Self {
        let (len, corners) = (mesh.vertex_count(), mesh.triangles().as_flattened());
        if corners.len() == len && ascend(corners) {
            return Self { are_corners: true, ..Self::all(len) };
        }
        let mut referenced = vec![false; len];
        corners.iter().for_each(|&vertex| referenced[vertex as usize] = true);
        Self { len, referenced: referenced.contains(&false).then_some(referenced), are_corners: false }
    }

    #[inline]
    fn has(&self, vertex: u32) -> bool {
        self.referenced.as_ref().is_none_or(|referenced| referenced[vertex as usize])
    }

    fn iter(&self) -> impl Iterator<Item = u32> + '_ {
        (0..self.len as u32).filter(|&vertex| self.has(vertex)) // there are fewer than 2³² − 1
    }

    fn count(&self) -> usize {
        self.referenced.as_ref().map_or(self.len, |used| used.iter().filter(|&&used| used).count())
    }
}
