//! The mesh: finite positions, in-range triangles, and the names that help a person find a place in it.

mod id;
mod weld;

use std::ops::Range;
use std::sync::Arc;

pub use id::{EdgeId, FaceId, HalfEdgeId, VertexId};
pub(crate) use weld::weld_points;
pub use weld::{Weld, Welded, weld, weld_in_place};

/// A triangle mesh inside the declared domain.
///
/// Positions are finite `f32` in mesh units, right-handed; a face is front-facing when its corners run
/// counter-clockwise. [`Mesh::new`] is the one door that checks this, so nothing behind it checks again.
///
/// Inside that domain every determinant of three coordinate differences fits an `f64` with room to spare
/// (2⁻⁴⁴⁷ … 2³⁹³), which is what the exact predicates need: they can neither overflow nor underflow.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// What the file calls the mesh; may be empty.
    pub name: String,
    positions: Vec<[f32; 3]>,
    triangles: Arc<Vec<[u32; 3]>>,
    parts: Vec<Part>,
    frames: Vec<Vec<[f32; 3]>>,
}

/// A named run of faces: a group, a primitive, a material.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Part {
    /// What the file calls it.
    pub name: String,
    /// Which faces it holds.
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

/// Why positions and triangles do not make a [`Mesh`].
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MeshError {
    /// A coordinate is NaN or infinite.
    #[error("vertex {vertex} has the coordinate {value}, which is not a finite number")]
    NotFinite {
        /// Which vertex.
        vertex: usize,
        /// The coordinate.
        value: f32,
    },
    /// A triangle names a vertex that does not exist.
    #[error("triangle {triangle} names vertex {index}, but there are {vertex_count} vertices")]
    IndexOutOfRange {
        /// Which triangle.
        triangle: usize,
        /// The index it holds.
        index: u32,
        /// How many vertices there are.
        vertex_count: usize,
    },
    /// More triangles or vertices than 32-bit ids can name, or than instances may add up to.
    #[error("{count} {what} are too many (at most {most})")]
    TooLarge {
        /// "triangles" or "vertices".
        what: &'static str,
        /// How many there are.
        count: usize,
        /// How many are allowed.
        most: usize,
    },
    /// There are more or fewer positions than vertices.
    #[error("there are {count} positions, but the mesh has {vertex_count} vertices")]
    PositionCount {
        /// How many positions there are.
        count: usize,
        /// How many vertices the mesh has.
        vertex_count: usize,
    },
    /// The number of indices is not divisible by 3.
    #[error("there are {count} indices, which is not a multiple of 3")]
    IndexCount {
        /// How many indices there are.
        count: usize,
    },
    /// A frame has another number of positions than the mesh.
    #[error("frame {frame} has {count} positions, but the mesh has {vertex_count}")]
    FrameLength {
        /// Which frame.
        frame: usize,
        /// How many positions it has.
        count: usize,
        /// How many the mesh has.
        vertex_count: usize,
    },
}

/// The most triangles a mesh may have, 715,827,882: three half-edges each, of which the edge table keeps a
/// 31-bit id beside one bit of direction.
pub const MAX_TRIANGLES: usize = (1 << 31) / 3;

impl Mesh {
    /// Checks `positions` and `triangles` and takes them in. Linear time, no copy.
    ///
    /// −0.0 becomes +0.0, so that an exact weld never splits a seam on the sign of zero.
    ///
    /// # Errors
    ///
    /// [`MeshError`] if a coordinate is NaN or infinite, an index is out of range, or there are more
    /// triangles than [`MAX_TRIANGLES`] or vertices than 2³² − 1.
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

    /// Copies vertex and index arrays, three indices per face. Nothing is welded.
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

    /// Moves the vertices; after an error nothing has changed.
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

    /// The same mesh with named runs of faces, in ascending order and without overlap.
    ///
    /// # Panics
    ///
    /// Panics if a part is out of order or names a face that does not exist.
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

    /// The same mesh with further frames of an animation: other positions for the same vertices.
    ///
    /// Welding looks at all of them, so that adjacency does not depend on the frame.
    ///
    /// # Errors
    ///
    /// [`MeshError`] if a frame has another length than the mesh, or a coordinate that is not finite.
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

    /// Where the vertices are.
    #[inline]
    #[must_use]
    pub fn positions(&self) -> &[[f32; 3]] {
        &self.positions
    }

    /// The faces, three vertex indices each, counter-clockwise from the front.
    #[inline]
    #[must_use]
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// The faces, to be shared with what is built over them: a clone of a pointer.
    #[must_use]
    pub fn shared_triangles(&self) -> Arc<Vec<[u32; 3]>> {
        Arc::clone(&self.triangles)
    }

    /// Named runs of faces; may be empty.
    #[must_use]
    pub fn parts(&self) -> &[Part] {
        &self.parts
    }

    /// Positions in the further frames of an animation; the first frame is [`Mesh::positions`].
    #[must_use]
    pub fn frames(&self) -> &[Vec<[f32; 3]>] {
        &self.frames
    }

    /// How many vertices there are, referenced or not.
    #[inline]
    #[must_use]
    pub fn vertex_count(&self) -> usize {
        self.positions.len()
    }

    /// How many faces there are, collapsed ones included.
    #[inline]
    #[must_use]
    pub fn face_count(&self) -> usize {
        self.triangles.len()
    }

    /// The three corners of a face.
    ///
    /// # Panics
    ///
    /// Panics if there is no such face.
    #[inline]
    #[must_use]
    pub fn corners(&self, face: FaceId) -> [[f32; 3]; 3] {
        // Spelt out: `map` is not always inlined, and this is the innermost line of most loops.
        let [a, b, c] = self.triangles[face.index()];
        [self.positions[a as usize], self.positions[b as usize], self.positions[c as usize]]
    }

    /// What the file calls the run of faces that holds `face`, if it has a name. Logarithmic in the parts.
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

    /// The smallest axis-aligned box around the *referenced* vertices: `[lowest, highest]`, or `None` if no
    /// face exists.
    #[must_use]
    pub fn bounds(&self) -> Option<[[f32; 3]; 2]> {
        let mut corners = self.triangles.iter().flatten().map(|&vertex| self.positions[vertex as usize]);
        let first = corners.next()?;
        Some(corners.fold([first; 2], |[low, high], p| {
            [std::array::from_fn(|i| low[i].min(p[i])), std::array::from_fn(|i| high[i].max(p[i]))]
        }))
    }

    /// The largest magnitude of a coordinate of any *referenced* vertex; 0 without faces.
    #[cfg(feature = "gpu")]
    pub(crate) fn largest_coordinate(&self) -> f32 {
        self.bounds().iter().flatten().flatten().fold(0.0, |most, x| most.max(x.abs()))
    }

    /// Positions, triangles, parts and frames, to be changed and brought back through [`Mesh::new`].
    #[must_use]
    #[expect(clippy::type_complexity, reason = "the four fields, named in the line above")]
    pub fn into_parts(self) -> (Vec<[f32; 3]>, Vec<[u32; 3]>, Vec<Part>, Vec<Vec<[f32; 3]>>) {
        (self.positions, Arc::unwrap_or_clone(self.triangles), self.parts, self.frames)
    }

    /// Several meshes as one: vertices and faces in order, no vertex shared between two of them.
    ///
    /// Each mesh's parts are kept, named `mesh / part`; a mesh without parts becomes one part.
    ///
    /// # Errors
    ///
    /// [`MeshError::TooLarge`] if the sum does not fit 32-bit ids.
    pub fn concat(meshes: &[Mesh]) -> Result<Mesh, MeshError> {
        let mut positions = Vec::with_capacity(meshes.iter().map(Mesh::vertex_count).sum());
        let mut triangles = Vec::with_capacity(meshes.iter().map(Mesh::face_count).sum());
        let mut parts = Vec::new();
        for mesh in meshes {
            // Checked by `Mesh::new` below: an offset that does not fit makes the count too large.
            let (vertices, faces) = (positions.len() as u32, triangles.len() as u32);
            positions.extend_from_slice(&mesh.positions);
            triangles.extend(mesh.triangles.iter().map(|t| t.map(|vertex| vertex.wrapping_add(vertices))));
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
        Ok(Mesh::new(positions, triangles)?.with_parts(parts))
    }
}

/// Refuses what is not finite and turns −0.0 into +0.0.
fn admit(positions: &mut [[f32; 3]]) -> Result<(), MeshError> {
    for (vertex, position) in positions.iter_mut().enumerate() {
        for value in position {
            if !value.is_finite() {
                return Err(MeshError::NotFinite { vertex, value: *value });
            }
            *value += 0.0; // −0.0 + 0.0 is +0.0; every other value is unchanged
        }
    }
    Ok(())
}
