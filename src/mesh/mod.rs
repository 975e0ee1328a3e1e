//! Triangle meshes: finite positions, in-range indices, named runs of faces, and welding.

mod id;
mod origin;
mod posed;
mod steps;
mod weld;

use std::ops::Range;
use std::sync::Arc;

pub use id::{EdgeId, FaceId, HalfEdgeId, VertexId};
pub use origin::Origin;
pub(crate) use origin::Origins;
pub(crate) use posed::as_frames as movers_as_frames;
pub(crate) use posed::moved as moved_positions;
pub(crate) use weld::weld_points;
pub use weld::{Weld, Welded, weld, weld_in_place};

/// A triangle mesh whose positions are finite and whose indices are in range.
///
/// Positions are `f32` in mesh units, in right-handed coordinates. A face is seen from the front if its
/// corners run counter-clockwise. Only [`Mesh::new`] and the functions built on it check the input, so later
/// code does not check again.
///
/// Every determinant of three coordinate differences of a mesh fits an `f64` with room to spare
/// (2⁻⁴⁴⁷ … 2³⁹³). The exact predicates rely on this range: they can neither overflow nor underflow.
///
/// Two meshes are equal if they have the same name, positions, faces, parts and frames, wherever in a file
/// their faces stand, and whatever skin moves them.
#[derive(Clone, Debug, Default)]
pub struct Mesh {
    /// Name of the mesh in its file; may be empty.
    pub name: String,
    positions: Vec<[f32; 3]>,
    triangles: Arc<Vec<[u32; 3]>>,
    parts: Vec<Part>,
    frames: Vec<Vec<[f32; 3]>>,
    /// `None` if every face is the polygon of its own number.
    origins: Option<Arc<Origins>>,
    /// `None` if no skin moves the mesh.
    skin: Option<Arc<Vec<u32>>>,
    /// Where the vertices of a posed mesh stand at rest: there they are welded. `None` if it is not posed.
    rest: Option<Arc<Vec<[f32; 3]>>>,
}

impl PartialEq for Mesh {
    fn eq(&self, other: &Self) -> bool {
        let Self { name, positions, triangles, parts, frames, origins: _, skin: _, rest: _ } = self;
        (name, positions, triangles, parts, frames)
            == (&other.name, &other.positions, &other.triangles, &other.parts, &other.frames)
    }
}

/// A named run of faces: a group, a primitive, a material.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Part {
    /// Name of the part in its file; may be empty.
    pub name: String,
    /// The faces of the part.
    pub faces: Range<u32>,
    /// The material of the faces: an index into those of the scene.
    pub material: Option<u32>,
}

impl Part {
    /// A named run of faces without a material.
    #[must_use]
    pub fn new(name: impl Into<String>, faces: Range<u32>) -> Self {
        Self { name: name.into(), faces, material: None }
    }
}

/// Reason why positions and triangles do not make a [`Mesh`].
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MeshError {
    /// A coordinate is NaN or infinite.
    #[error("vertex {vertex} has the coordinate {value}, which is not a finite number")]
    NotFinite {
        /// Index of the vertex.
        vertex: usize,
        /// The coordinate.
        value: f32,
    },
    /// A triangle names a vertex that does not exist.
    #[error("triangle {triangle} names vertex {index}, but there are {vertex_count} vertices")]
    IndexOutOfRange {
        /// Index of the triangle.
        triangle: usize,
        /// The out-of-range index.
        index: u32,
        /// Number of vertices.
        vertex_count: usize,
    },
    /// The number of triangles or vertices exceeds the range of 32-bit ids, or the limit for the sum over all
    /// instances.
    #[error("{count} {what} are too many (at most {most})")]
    TooLarge {
        /// "triangles" or "vertices".
        what: &'static str,
        /// Actual number.
        count: usize,
        /// Largest allowed number.
        most: usize,
    },
    /// The number of positions differs from the number of vertices.
    #[error("there are {count} positions, but the mesh has {vertex_count} vertices")]
    PositionCount {
        /// Number of positions.
        count: usize,
        /// Number of vertices of the mesh.
        vertex_count: usize,
    },
    /// The number of indices is not divisible by 3.
    #[error("there are {count} indices, which is not a multiple of 3")]
    IndexCount {
        /// Number of indices.
        count: usize,
    },
    /// A frame and the mesh differ in their number of positions.
    #[error("frame {frame} has {count} positions, but the mesh has {vertex_count}")]
    FrameLength {
        /// Number of the frame; the mesh itself is frame 0.
        frame: usize,
        /// Number of positions of the frame.
        count: usize,
        /// Number of vertices of the mesh.
        vertex_count: usize,
    },
}

/// Largest number of triangles of a mesh: 715,827,882. A triangle has three half-edges, and the edge table
/// stores a half-edge as a 31-bit id with one bit of direction.
pub const MAX_TRIANGLES: usize = (1 << 31) / 3;

impl Mesh {
    /// Checks `positions` and `triangles` and takes ownership of them. Linear time, no copy.
    ///
    /// The coordinate −0.0 becomes +0.0, so that an exact weld never splits a seam at the sign of zero.
    ///
    /// # Errors
    ///
    /// [`MeshError`] if a coordinate is NaN or infinite, if an index is out of range, or if there are more
    /// triangles than [`MAX_TRIANGLES`] or more vertices than 2³² − 2.
    ///
    /// ```
    /// use umbrage::mesh::Mesh;
    /// let mesh = Mesh::new(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]])?;
    /// assert_eq!(mesh.face_count(), 1);
    /// assert!(Mesh::new(vec![[f32::NAN; 3]], vec![]).is_err());
    /// # Ok::<(), umbrage::mesh::MeshError>(())
    /// ```
    pub fn new(mut positions: Vec<[f32; 3]>, triangles: Vec<[u32; 3]>) -> Result<Self, MeshError> {
        if triangles.len() > MAX_TRIANGLES {
            let (what, count) = ("triangles", triangles.len());
            return Err(MeshError::TooLarge { what, count, most: MAX_TRIANGLES });
        }
        if positions.len() >= u32::MAX as usize {
            let (what, count) = ("vertices", positions.len());
            return Err(MeshError::TooLarge { what, count, most: u32::MAX as usize - 1 });
        }
        admit(&mut positions)?;
        let vertex_count = positions.len();
        for (triangle, corners) in triangles.iter().enumerate() {
            if let Some(&index) = corners.iter().find(|&&index| index as usize >= vertex_count) {
                return Err(MeshError::IndexOutOfRange { triangle, index, vertex_count });
            }
        }
        Ok(Self { positions, triangles: Arc::new(triangles), ..Self::default() })
    }

    /// A mesh copied from vertex and index arrays, with three indices per face. Nothing is welded.
    ///
    /// # Errors
    ///
    /// As [`Mesh::new`], and [`MeshError::IndexCount`] if the number of indices is not divisible by 3.
    ///
    /// ```
    /// use umbrage::mesh::Mesh;
    /// let positions = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    /// assert_eq!(Mesh::from_indexed(&positions, &[0, 1, 2])?.face_count(), 1);
    /// assert!(Mesh::from_indexed(&positions, &[0, 1]).is_err());
    /// # Ok::<(), umbrage::mesh::MeshError>(())
    /// ```
    pub fn from_indexed(positions: &[[f32; 3]], indices: &[u32]) -> Result<Self, MeshError> {
        let (triangles, rest) = indices.as_chunks::<3>();
        if !rest.is_empty() {
            return Err(MeshError::IndexCount { count: indices.len() });
        }
        Self::new(positions.to_vec(), triangles.to_vec())
    }

    /// Replaces the vertex positions. On error the mesh is unchanged.
    pub(crate) fn set_positions(&mut self, mut positions: Vec<[f32; 3]>) -> Result<(), MeshError> {
        let (count, vertex_count) = (positions.len(), self.vertex_count());
        if count != vertex_count {
            return Err(MeshError::PositionCount { count, vertex_count });
        }
        admit(&mut positions)?;
        self.positions = positions;
        Ok(())
    }

    /// The same mesh under another name.
    #[must_use]
    pub fn with_name(mut self, name: impl Into<String>) -> Self {
        self.name = name.into();
        self
    }

    /// The same mesh with named runs of faces. The runs are in ascending order and do not overlap.
    ///
    /// ```
    /// use umbrage::mesh::{FaceId, Part};
    /// use umbrage::testing::shapes;
    /// let bottom = Part::new("bottom", 0..2);
    /// let cube = shapes::cube().with_parts(vec![bottom]);
    /// assert_eq!(cube.part_name(FaceId(1)), Some("bottom"));
    /// assert_eq!(cube.part_name(FaceId(2)), None);
    /// ```
    ///
    /// # Panics
    ///
    /// Panics if a part is out of order, or if its range ends past the last face.
    #[must_use]
    pub fn with_parts(mut self, parts: Vec<Part>) -> Self {
        let mut end = 0;
        for part in &parts {
            assert!(
                part.faces.start >= end && part.faces.end >= part.faces.start,
                "part out of order: {part:?}"
            );
            end = part.faces.end;
        }
        assert!(
            end as usize <= self.triangles.len(),
            "a part ends at face {end} of {}",
            self.triangles.len()
        );
        self.parts = parts;
        self
    }

    /// The same mesh, whose faces were cut from these polygons of its file.
    pub(crate) fn with_origins(mut self, origins: Origins) -> Self {
        self.origins = (!origins.are_plain(self.face_count())).then(|| Arc::new(origins));
        self
    }

    /// The same mesh, whose faces are those of `other` in the same order.
    pub(crate) fn with_origins_of(mut self, other: Option<Arc<Origins>>) -> Self {
        self.origins = other;
        self
    }

    pub(crate) fn origins(&self) -> Option<&Arc<Origins>> {
        self.origins.as_ref()
    }

    /// Drops the frames after the first `count` of [`Mesh::frames`].
    pub(crate) fn truncate_frames(&mut self, count: usize) {
        self.frames.truncate(count);
    }

    /// The same mesh with a number for each vertex: two vertices have the same one if every pose of the skin
    /// moves them alike. A list of another length is left out.
    pub(crate) fn with_skin(mut self, skin: Option<Arc<Vec<u32>>>) -> Self {
        self.skin = skin.filter(|skin| skin.len() == self.vertex_count());
        self
    }

    pub(crate) fn skin(&self) -> Option<&Arc<Vec<u32>>> {
        self.skin.as_ref()
    }

    /// The same mesh in a pose: its vertices are still welded by where they stand at rest, which is here
    /// unless said otherwise.
    pub(crate) fn posed(mut self, positions: Vec<[f32; 3]>) -> Result<Self, MeshError> {
        let rest = self.rest.take().unwrap_or_else(|| Arc::new(self.positions.clone()));
        self.set_positions(positions)?;
        self.rest = Some(rest);
        Ok(self)
    }

    /// The same mesh, welded by these positions. A list of another length is left out.
    pub(crate) fn with_rest(mut self, rest: Option<Arc<Vec<[f32; 3]>>>) -> Self {
        self.rest = rest.filter(|rest| rest.len() == self.vertex_count());
        self
    }

    pub(crate) fn rest(&self) -> Option<&Arc<Vec<[f32; 3]>>> {
        self.rest.as_ref()
    }

    /// The polygon of the file that `face` is, or was cut from. Logarithmic in the changes of the number of
    /// corners from polygon to polygon.
    ///
    /// It stays with the face through [`weld`](fn@weld), [`Scene::bake`](crate::scene::Scene::bake) and
    /// [`Scene::retain`](crate::scene::Scene::retain). A mesh that was not read has polygons that are its
    /// faces.
    ///
    /// ```
    /// # #[cfg(feature = "files")] {
    /// use umbrage::mesh::FaceId;
    /// use umbrage::read::read_bytes;
    /// let file = b"v 0 0 0\nv 4 0 0\nv 4 4 0\nv 0 4 0\nf 1 2 3 4\nf 1 3 2\n";
    /// let mesh = read_bytes(file, "a.obj")?.meshes.remove(0);
    /// let origin = mesh.origin(FaceId(2)); // the quad is two faces
    /// assert_eq!((origin.polygon, origin.line), (1, Some(6)));
    /// # }
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn origin(&self, face: FaceId) -> Origin {
        match &self.origins {
            Some(origins) => origins.of(face.0),
            None => Origin { polygon: face.0, line: None },
        }
    }

    /// The same mesh with further animation frames: other positions for the same vertices.
    ///
    /// Welding compares vertices in all frames, so the adjacency does not depend on the frame.
    ///
    /// ```
    /// use umbrage::testing::shapes;
    /// let cube = shapes::cube();
    /// let raised = cube.positions().iter().map(|&[x, y, z]| [x, y + 1.0, z]).collect();
    /// assert_eq!(cube.clone().with_frames(vec![raised])?.frames().len(), 1);
    /// assert!(cube.with_frames(vec![vec![[0.0; 3]; 7]]).is_err()); // the cube has 8 vertices
    /// # Ok::<(), umbrage::mesh::MeshError>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`MeshError`] if the length of a frame differs from the vertex count, or if a coordinate is not
    /// finite.
    pub fn with_frames(mut self, mut frames: Vec<Vec<[f32; 3]>>) -> Result<Self, MeshError> {
        for (index, frame) in frames.iter_mut().enumerate() {
            if frame.len() != self.positions.len() {
                let (count, vertex_count) = (frame.len(), self.positions.len());
                return Err(MeshError::FrameLength { frame: index + 1, count, vertex_count });
            }
            admit(frame)?;
        }
        self.frames = frames;
        Ok(self)
    }

    /// Vertex positions.
    #[inline]
    #[must_use]
    pub fn positions(&self) -> &[[f32; 3]] {
        &self.positions
    }

    /// Faces as three vertex indices each, counter-clockwise seen from the front.
    #[inline]
    #[must_use]
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// Shared ownership of the faces: clones a pointer, not the list.
    #[must_use]
    pub fn shared_triangles(&self) -> Arc<Vec<[u32; 3]>> {
        Arc::clone(&self.triangles)
    }

    /// Named runs of faces; may be empty.
    #[must_use]
    pub fn parts(&self) -> &[Part] {
        &self.parts
    }

    /// Positions in the further animation frames. The first frame is [`Mesh::positions`].
    #[must_use]
    pub fn frames(&self) -> &[Vec<[f32; 3]>] {
        &self.frames
    }

    /// Number of vertices, referenced or not.
    #[inline]
    #[must_use]
    pub fn vertex_count(&self) -> usize {
        self.positions.len()
    }

    /// Number of faces, collapsed ones included.
    #[inline]
    #[must_use]
    pub fn face_count(&self) -> usize {
        self.triangles.len()
    }

    /// Positions of the three corners of a face.
    ///
    /// # Panics
    ///
    /// Panics if there is no such face.
    #[inline]
    #[must_use]
    pub fn corners(&self, face: FaceId) -> [[f32; 3]; 3] {
        // Without `map`: closures on arrays are not always inlined, and this is the innermost line of most
        // loops.
        let [a, b, c] = self.triangles[face.index()];
        [self.positions[a as usize], self.positions[b as usize], self.positions[c as usize]]
    }

    /// Name of the part that contains `face`, if that part has a name. Logarithmic in the number of parts.
    #[must_use]
    pub fn part_name(&self, face: FaceId) -> Option<&str> {
        self.part(face).map(|part| part.name.as_str()).filter(|name| !name.is_empty())
    }

    /// The named run of faces that holds `face`. Logarithmic in the parts.
    #[must_use]
    pub fn part(&self, face: FaceId) -> Option<&Part> {
        let after = self.parts.partition_point(|part| part.faces.start <= face.0);
        self.parts[..after].last().filter(|part| part.faces.contains(&face.0))
    }

    /// Smallest axis-aligned box around the *referenced* vertices, as `[lowest, highest]`. `None` if the mesh
    /// has no faces.
    #[must_use]
    pub fn bounds(&self) -> Option<[[f32; 3]; 2]> {
        let mut corners = self.triangles.iter().flatten().map(|&vertex| self.positions[vertex as usize]);
        let first = corners.next()?;
        Some(corners.fold([first; 2], |[low, high], p| {
            [std::array::from_fn(|i| low[i].min(p[i])), std::array::from_fn(|i| high[i].max(p[i]))]
        }))
    }

    /// Largest magnitude of a coordinate of any *referenced* vertex; 0 without faces.
    #[cfg(feature = "gpu")]
    pub(crate) fn largest_coordinate(&self) -> f32 {
        self.bounds().iter().flatten().flatten().fold(0.0, |most, x| most.max(x.abs()))
    }

    /// The positions, triangles, parts and frames, by value. [`Mesh::new`] turns them into a mesh again.
    #[must_use]
    #[expect(clippy::type_complexity, reason = "the four fields, named in the line above")]
    pub fn into_parts(self) -> (Vec<[f32; 3]>, Vec<[u32; 3]>, Vec<Part>, Vec<Vec<[f32; 3]>>) {
        (self.positions, Arc::unwrap_or_clone(self.triangles), self.parts, self.frames)
    }

    /// Concatenation of several meshes: vertices and faces in order, no vertex shared between two meshes.
    ///
    /// The parts of each mesh are kept and named `mesh / part`. A mesh without parts becomes one part.
    ///
    /// ```
    /// use umbrage::mesh::Mesh;
    /// use umbrage::testing::shapes;
    /// let right = shapes::translated(&shapes::cube(), [5.0, 0.0, 0.0]).with_name("right");
    /// let both = Mesh::concat(&[shapes::cube().with_name("left"), right])?;
    /// assert_eq!((both.vertex_count(), both.face_count()), (16, 24));
    /// assert_eq!((both.parts()[1].name.as_str(), both.parts()[1].faces.clone()), ("right", 12..24));
    /// # Ok::<(), umbrage::mesh::MeshError>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`MeshError::TooLarge`] if the sums do not fit 32-bit ids.
    pub fn concat(meshes: &[Mesh]) -> Result<Mesh, MeshError> {
        let mut positions = Vec::with_capacity(meshes.iter().map(Mesh::vertex_count).sum());
        let mut triangles = Vec::with_capacity(meshes.iter().map(Mesh::face_count).sum());
        let mut parts = Vec::new();
        let mut origins = Origins::default();
        for mesh in meshes {
            // `Mesh::new` below checks the counts: an offset that does not fit makes a count too large.
            let (vertices, faces) = (positions.len() as u32, triangles.len() as u32);
            positions.extend_from_slice(&mesh.positions);
            triangles.extend(mesh.triangles.iter().map(|t| t.map(|vertex| vertex.wrapping_add(vertices))));
            origins.append(mesh, 0..mesh.face_count() as u32, faces);
            if mesh.parts.is_empty() {
                parts.push(Part::new(mesh.name.clone(), faces..triangles.len() as u32));
            }
            for part in &mesh.parts {
                let name = match (mesh.name.as_str(), part.name.as_str()) {
                    ("", name) | (name, "") => name.to_owned(),
                    (mesh, part) => format!("{mesh} / {part}"),
                };
                let faces = faces + part.faces.start..faces + part.faces.end;
                parts.push(Part { name, faces, material: part.material });
            }
        }
        let joined = Mesh::new(positions, triangles)?.with_parts(parts).with_origins(origins);
        if meshes.iter().any(|mesh| mesh.rest.is_some()) {
            let (rest, movers) = posed::concatenated(meshes);
            return Ok(joined.with_rest(Some(rest.into())).with_skin(Some(movers.into())));
        }
        Ok(joined.with_skin(concatenated_skins(meshes)))
    }
}

/// The skins of meshes one after the other: numbers of different meshes differ. `None` if no mesh has one.
fn concatenated_skins(meshes: &[Mesh]) -> Option<Arc<Vec<u32>>> {
    if meshes.iter().all(|mesh| mesh.skin.is_none()) {
        return None;
    }
    let (mut all, mut first) = (Vec::new(), 0);
    for mesh in meshes {
        match &mesh.skin {
            Some(skin) => all.extend(skin.iter().map(|number| number.saturating_add(first))),
            None => all.resize(all.len() + mesh.vertex_count(), first),
        }
        first = all.iter().max().map_or(0, |most| most.saturating_add(1));
    }
    Some(Arc::new(all))
}

/// Rejects coordinates that are not finite, and turns −0.0 into +0.0.
fn admit(positions: &mut [[f32; 3]]) -> Result<(), MeshError> {
    for (vertex, position) in positions.iter_mut().enumerate() {
        for value in position {
            if !value.is_finite() {
                return Err(MeshError::NotFinite { vertex, value: *value });
            }
            *value += 0.0; // −0.0 + 0.0 is +0.0; no other value changes
        }
    }
    Ok(())
}
