//! Vertices at one place become one vertex, so that faces which touch in space are neighbours in topology.

mod exact;
mod far;
mod near;
mod table;
#[cfg(test)]
mod tests;
mod within;

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

/// A welded mesh: no two vertices are the same, and every vertex belongs to a face.
#[derive(Clone, Debug)]
pub struct Welded {
    /// Positions of the kept vertices, faces in the order of the original with welded indices.
    pub mesh: Mesh,
    /// For each vertex of the original the vertex it became, or [`UNUSED`].
    vertex_of: Vec<u32>,
}

impl Welded {
    /// What a vertex of the original became; `None` if no face uses it.
    ///
    /// # Panics
    ///
    /// Panics if the original has no such vertex.
    #[must_use]
    pub fn vertex_of(&self, original: VertexId) -> Option<VertexId> {
        let vertex = self.vertex_of[original.index()];
        (vertex != UNUSED).then_some(VertexId(vertex))
    }

    /// How many vertices of the original no face uses.
    #[must_use]
    pub fn unreferenced(&self) -> usize {
        self.vertex_of.iter().filter(|&&vertex| vertex == UNUSED).count()
    }
}

/// Merges vertices. Expected linear time; kept vertices stay in their order.
///
/// Vertices that no face references are left out.
///
/// Memory: at its peak 33 bytes a face of a closed mesh, the result included, and at most 260 where no vertex is
/// shared; 400 with a distance.
///
/// ```
/// use umbrage::mesh::{Weld, solid, weld};
/// let soup = solid::soup(&solid::cube());
/// assert_eq!((soup.vertex_count(), weld(&soup, Weld::Exact).mesh.vertex_count()), (36, 8));
/// ```
#[must_use]
pub fn weld(mesh: &Mesh, how: Weld) -> Welded {
    let Merged { vertex_of, kept } = merged(mesh, how);
    let pick = |from: &[[f32; 3]]| kept.iter().map(|&vertex| from[vertex as usize]).collect::<Vec<_>>();
    // (Spelt out: `map` of an array is not always inlined.)
    let welded_of = |vertex: u32| vertex_of[vertex as usize];
    let triangles =
        mesh.triangles().iter().map(|&[a, b, c]| [welded_of(a), welded_of(b), welded_of(c)]).collect();
    let welded = Mesh {
        name: mesh.name.clone(),
        positions: pick(&mesh.positions),
        triangles,
        parts: mesh.parts.clone(),
        frames: mesh.frames.iter().map(|frame| pick(frame)).collect(),
    };
    Welded { mesh: welded, vertex_of }
}

/// The same in the memory of the mesh itself, for those who do not need the original any more.
///
/// Memory: at its peak 24 bytes a face of a closed mesh beside the mesh, and at most 140 where no vertex is shared;
/// 400 with a distance.
///
/// ```
/// use umbrage::mesh::{Weld, solid, weld_in_place};
/// assert_eq!(weld_in_place(solid::soup(&solid::cube()), Weld::Exact).mesh.vertex_count(), 8);
/// ```
#[must_use]
pub fn weld_in_place(mut mesh: Mesh, how: Weld) -> Welded {
    let Merged { vertex_of, kept } = merged(&mesh, how);
    // Otherwise every vertex has kept its number.
    if kept.len() < mesh.vertex_count() {
        for positions in mesh.frames.iter_mut().chain([&mut mesh.positions]) {
            for (new, &vertex) in kept.iter().enumerate() {
                positions[new] = positions[vertex as usize]; // never from what was overwritten: they ascend
            }
            positions.truncate(kept.len());
            positions.shrink_to_fit();
        }
        for corner in mesh.triangles.as_flattened_mut() {
            *corner = vertex_of[*corner as usize];
        }
    }
    Welded { mesh, vertex_of }
}

/// For each point the number of the kept point that it joins, by the scheme of [`Weld::Within`].
pub(crate) fn weld_points(points: &[[f32; 3]], distance: f64) -> Vec<u32> {
    within::merged(&[points], &Used::all(points.len()), distance).vertex_of
}

/// A mark that no vertex id reaches, see [`Mesh::new`].
const UNUSED: u32 = u32::MAX;

/// Which vertex becomes which.
#[cfg_attr(test, derive(Debug, PartialEq))]
struct Merged {
    /// Each vertex's welded id, or [`UNUSED`].
    vertex_of: Vec<u32>,
    /// Each welded vertex's origin, the first of those that became it; ascending.
    kept: Vec<u32>,
}

fn merged(mesh: &Mesh, how: Weld) -> Merged {
    let used = Used::by(mesh);
    match how {
        Weld::None => Merged::by(&used, |_, _| None),
        Weld::Within(distance) if distance > 0.0 => {
            let frames: Vec<&[[f32; 3]]> =
                std::iter::once(mesh.positions()).chain(mesh.frames.iter().map(Vec::as_slice)).collect();
            within::merged(&frames, &used, f64::from(distance))
        }
        Weld::Exact | Weld::Within(_) => exact::merged(mesh, &used),
    }
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

/// Which vertices a face references.
struct Used {
    len: usize,
    /// `None` for all.
    referenced: Option<Vec<bool>>,
}

impl Used {
    fn all(len: usize) -> Self {
        Self { len, referenced: None }
    }

    fn by(mesh: &Mesh) -> Self {
        let (len, corners) = (mesh.vertex_count(), mesh.triangles().as_flattened());
        // A soup, as readers of triangles without indices make it.
        if corners.len() == len && (0..).zip(corners).all(|(vertex, &corner)| vertex == corner) {
            return Self::all(len);
        }
        let mut referenced = vec![false; len];
        corners.iter().for_each(|&vertex| referenced[vertex as usize] = true);
        Self { len, referenced: referenced.contains(&false).then_some(referenced) }
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
