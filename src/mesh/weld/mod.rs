//! Welding: vertices with the same position become one vertex, so that faces which touch in space become
//! neighbors in the topology.

mod bucketed;
mod exact;
mod id_table;
mod streaming;
#[cfg(test)]
mod tests;
mod within;

use std::sync::Arc;

use super::{Mesh, VertexId, posed};

/// Rule for which vertices are merged.
///
/// ```
/// use umbrage::mesh::{Mesh, Weld, weld};
/// // Two triangles of a unit square: one shared corner is equal, the other is off by 0.001.
/// let low = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
/// let high = [[1.0, 0.001, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
/// let mesh = Mesh::new([low, high].concat(), vec![[0, 1, 2], [3, 4, 5]])?;
/// let vertices = |how| weld(&mesh, how).mesh.vertex_count();
/// assert_eq!([Weld::None, Weld::Exact, Weld::Within(0.01)].map(vertices), [6, 5, 4]);
/// # Ok::<(), umbrage::mesh::MeshError>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Weld {
    /// Merges vertices whose positions are bit-equal in every frame.
    #[default]
    Exact,
    /// Merges nothing: only equal indices are the same vertex, as in the file.
    None,
    /// Merges vertices at most this far apart in every frame (mesh units). The vertices are visited in order.
    /// Each vertex joins the lowest-numbered kept vertex within the distance, or is kept itself. No vertex
    /// moves farther than the distance, and merges do not chain.
    Within(f32),
}

impl Weld {
    /// The weld distance, if positive.
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
///
/// ```
/// use umbrage::mesh::{VertexId, Weld, weld};
/// use umbrage::testing::shapes;
/// let welded = weld(&shapes::soup(&shapes::cube()), Weld::Exact);
/// // The second triangle of a side starts at the same corner as the first.
/// assert_eq!(welded.vertex_of(VertexId(3)), Some(VertexId(0)));
/// assert_eq!((welded.mesh.vertex_count(), welded.unreferenced()), (8, 0));
/// ```
#[derive(Clone, Debug)]
pub struct Welded {
    /// The welded mesh: positions of the kept vertices, and the original faces in order with welded indices.
    /// [`Welded::vertex_of`] and [`Welded::unreferenced`] may read these faces, so call both before moving
    /// the mesh out.
    pub mesh: Mesh,
    /// The welded id of each original vertex, or [`UNUSED`]. `None` if the corners of the original faces were
    /// its vertices in order, because the welded faces then hold the same list.
    vertex_of: Option<Vec<u32>>,
}

impl Welded {
    /// Welded id of a vertex of the original mesh; `None` if no face uses the vertex.
    ///
    /// # Panics
    ///
    /// Panics if the original has no such vertex, or if [`Welded::mesh`] was replaced by a mesh with fewer
    /// faces.
    #[must_use]
    pub fn vertex_of(&self, original: VertexId) -> Option<VertexId> {
        let vertex = self.vertices()[original.index()];
        (vertex != UNUSED).then_some(VertexId(vertex))
    }

    /// Number of vertices of the original that no face uses.
    #[must_use]
    pub fn unreferenced(&self) -> usize {
        self.vertices().iter().filter(|&&vertex| vertex == UNUSED).count()
    }

    fn vertices(&self) -> &[u32] {
        self.vertex_of.as_deref().unwrap_or(self.mesh.triangles.as_flattened())
    }
}

/// Merges vertices by the rule `how`. Expected linear time. Kept vertices stay in their order.
///
/// Vertices that no face references are dropped. Vertices of a posed mesh are compared where they stand at
/// rest, and are one only if every pose moves them alike.
///
/// Peak memory per face, result included: 24 bytes for a closed mesh, 60 for its soup, and at most 150 if no
/// vertex is shared; 400 with [`Weld::Within`].
///
/// ```
/// use umbrage::mesh::{Weld, weld};
/// use umbrage::testing::shapes;
/// let soup = shapes::soup(&shapes::cube());
/// assert_eq!((soup.vertex_count(), weld(&soup, Weld::Exact).mesh.vertex_count()), (36, 8));
/// ```
#[must_use]
pub fn weld(mesh: &Mesh, how: Weld) -> Welded {
    if mesh.rest.is_some() {
        return weld_in_place(mesh.clone(), how);
    }
    let used = Used::by(mesh);
    let mut triangles = Vec::new();
    let (kept, vertex_of) = if how.is_exact() && used.are_corners {
        triangles = vec![[0; 3]; mesh.face_count()];
        (exact::merge(mesh, &used, triangles.as_flattened_mut()), None)
    } else {
        let (kept, vertex_of) = merged(mesh, &used, how);
        // Without `map`: closures on arrays are not always inlined.
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
        origins: mesh.origins.clone(),
        skin: None, // vertices that it moves apart may be one now
        rest: None,
    };
    Welded { mesh: welded, vertex_of }
}

/// Merges vertices like [`weld`], reusing the memory of `mesh`, for callers that no longer need the original.
///
/// Peak memory per face, beyond the mesh itself: 20 bytes for a closed mesh, 48 for its soup, and at most 140
/// if no vertex is shared; 400 with [`Weld::Within`].
///
/// ```
/// use umbrage::mesh::{Weld, weld_in_place};
/// use umbrage::testing::shapes;
/// assert_eq!(weld_in_place(shapes::soup(&shapes::cube()), Weld::Exact).mesh.vertex_count(), 8);
/// ```
#[must_use]
pub fn weld_in_place(mut mesh: Mesh, how: Weld) -> Welded {
    if let Some(rest) = mesh.rest.take() {
        return posed::weld(mesh, &rest, how);
    }
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
    mesh.skin = None; // vertices that it moves apart may be one now
    // If none was merged or dropped, every vertex has kept its number.
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

/// For each point, the number of the kept point that the point joins, by the rule of [`Weld::Within`].
pub(crate) fn weld_points(points: &[[f32; 3]], distance: f64) -> Vec<u32> {
    within::merged(&[points], &Used::all(points.len()), distance).vertex_of
}

/// Marker for an unreferenced vertex; no vertex id reaches this value, see [`Mesh::new`].
const UNUSED: u32 = u32::MAX;

/// Mapping between original and welded vertices.
struct Merged {
    /// Welded id of each vertex, or [`UNUSED`].
    vertex_of: Vec<u32>,
    /// Original vertex of each welded vertex, the first of those merged into it; ascending.
    kept: Vec<u32>,
}

/// The kept vertices, and the welded id of each vertex or [`UNUSED`].
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

/// The kept vertices, in their original order.
#[derive(Default)]
#[cfg_attr(test, derive(Clone, Debug, PartialEq))]
struct Kept {
    positions: Vec<[f32; 3]>,
    /// Original vertex of each kept vertex: the first of those merged into it. An exact weld fills this list
    /// only if there are further frames to pick from.
    origins: Vec<u32>,
}

impl Merged {
    /// Visits the used vertices in order. `find(vertex, new)` returns the welded vertex that `vertex` joins,
    /// or `None` if `vertex` is kept with the id `new`.
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

/// Whether the corners are 0, 1, 2, …
fn ascend(corners: &[u32]) -> bool {
    // Whole blocks, with no early exit within a block, so that the loop is vectorized.
    const BLOCK: usize = 1024;
    let mut first = 0;
    corners.chunks(BLOCK).all(|block| {
        let wrong = (first..).zip(block).fold(0, |wrong, (vertex, &corner)| wrong | (vertex ^ corner));
        first += block.len() as u32; // corners are fewer than 2³²
        wrong == 0
    })
}

/// The set of vertices that faces reference.
struct Used {
    len: usize,
    /// One flag per vertex; `None` if every vertex is referenced.
    referenced: Option<Vec<bool>>,
    /// Whether corner `i` of the triangle list is vertex `i`, as readers of formats without indices make
    /// meshes.
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
