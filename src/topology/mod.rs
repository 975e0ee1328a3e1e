//! Adjacency: half-edges and edges of a triangle list, whatever its defects.
//!
//! Topology never sees a position. Half-edge `h` is corner `h` of the triangle list, so its face is `h / 3`,
//! its tail is the index stored there and `next` is arithmetic. What is stored is one table from each
//! undirected edge to its half-edges. An edge of a bad mesh may have one half-edge, three or eighteen, so the
//! table is a list of lists (offsets and entries) and [`Topology::twin`] is an `Option`.
//!
//! Terms follow the field: Kevin Weiler, *Edge-Based Data Structures for Solid Modeling in Curved-Surface
//! Environments*, 1985; Swen Campagna, Leif Kobbelt, Hans-Peter Seidel, *Directed Edges*, 1998 (implicit
//! half-edges in a triangle list).

mod adjacency;
mod boundary;
mod build;
mod components;
mod counting_sort;
mod edge_list;
#[cfg(feature = "gpu")]
mod gpu;
mod shells;
mod sorting_network;
mod survey;
mod validate;
mod vertex_link;

pub use build::TopologyBuilder;
pub(crate) use components::Components;
pub use edge_list::ListedEdge;
#[cfg(feature = "gpu")]
pub use gpu::{GpuTopology, GpuTopologyBuilder};
pub(crate) use shells::FacesByShell;
pub use shells::Shells;

use std::sync::{Arc, OnceLock};

use bytemuck::{Pod, Zeroable};

use crate::mesh::{EdgeId, FaceId, HalfEdgeId, Mesh, VertexId};
use survey::Survey;

/// Half-edges and edges of a triangle list.
///
/// Edges are numbered in the order of their vertices `(a, b)`, `a < b`, whatever the order of the faces.
/// A face with two equal corners has *collapsed*: it keeps its id and its half-edge ids, but has no edges.
#[derive(Clone, Debug)]
pub struct Topology {
    vertex_count: usize,
    triangles: Arc<Vec<[u32; 3]>>,
    /// Index of each edge's first entry; one more than there are edges.
    offsets: Vec<u32>,
    /// Half-edges by edge, ascending within an edge, as [`Entry`]s.
    entries: Vec<u32>,
    collapsed_faces: usize,
    counts: EdgeCounts,
    /// Computed on first use.
    survey: OnceLock<Survey>,
}

/// Equal if built of the same faces, from which everything else follows.
impl PartialEq for Topology {
    fn eq(&self, other: &Self) -> bool {
        self.vertex_count == other.vertex_count
            && self.triangles == other.triangles
            && (&self.offsets, &self.entries) == (&other.offsets, &other.entries)
    }
}

impl Eq for Topology {}

/// A half-edge in the edge table: its id, and whether it runs from the edge's higher-numbered vertex to its
/// lower one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
#[repr(transparent)]
pub(crate) struct Entry(u32);

impl Entry {
    #[inline]
    pub(crate) fn face(self) -> usize {
        self.0 as usize / 6
    }

    /// 1 if it runs against the edge, else 0.
    #[inline]
    pub(crate) fn against(self) -> u32 {
        self.0 & 1
    }

    #[inline]
    fn half_edge(self) -> HalfEdgeId {
        HalfEdgeId(self.0 >> 1)
    }

    /// +1 along the edge (lower- to higher-numbered vertex), −1 against it.
    #[inline]
    pub(crate) fn direction(self) -> i32 {
        1 - 2 * (self.0 & 1) as i32
    }
}

/// Counts of how the edges of a mesh are used by its faces.
///
/// ```
/// use umbrage::testing::shapes;
/// use umbrage::topology::Topology;
/// let counts = Topology::of(&shapes::open_cube()).edge_counts();
/// assert!(!counts.watertight());
/// assert_eq!((counts.boundary, counts.non_manifold, counts.misoriented), (4, 0, 0));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct EdgeCounts {
    /// Edges with exactly one face.
    pub boundary: usize,
    /// Edges with three faces or more.
    pub non_manifold: usize,
    /// Edges with exactly two faces that run along the edge in the same direction.
    pub misoriented: usize,
    /// The most faces that any edge has.
    pub max_faces: usize,
    /// At every edge the two directions are used equally often: the mesh is a cycle in the sense of homology.
    pub balanced: bool,
    /// Every edge is used an even number of times.
    pub even: bool,
}

/// The counts of no edges.
impl Default for EdgeCounts {
    fn default() -> Self {
        Self::NONE
    }
}

impl EdgeCounts {
    const NONE: Self =
        Self { boundary: 0, non_manifold: 0, misoriented: 0, max_faces: 0, balanced: true, even: true };

    /// Counts an edge with `faces` faces, whose directions add up to `sum`.
    #[inline]
    fn add(&mut self, faces: usize, sum: i32) {
        self.boundary += usize::from(faces == 1);
        self.non_manifold += usize::from(faces > 2);
        self.misoriented += usize::from(faces == 2 && sum != 0);
        self.max_faces = self.max_faces.max(faces);
        self.balanced &= sum == 0;
        self.even &= faces.is_multiple_of(2);
    }

    /// Whether every edge has exactly two faces, in opposite directions.
    #[must_use]
    pub fn watertight(&self) -> bool {
        self.boundary == 0 && self.non_manifold == 0 && self.misoriented == 0
    }
}

impl Topology {
    /// The edge table of `triangles` over `vertex_count` vertices.
    ///
    /// Algorithm: a counting sort of the half-edges by their lower-numbered vertex, then a small sort of each
    /// vertex's half-edges by the other one. No hashing. Linear time, except that a vertex whose k half-edges
    /// are not all in pairs takes k·log k.
    ///
    /// Memory: 26 bytes per triangle of a closed mesh at the peak, of which 18 are the result. If the order
    /// of the faces is random: 32, and half a megabyte. At most 120 for any mesh with at most three vertices
    /// per face. An allocator that cannot shrink a list in place takes 6 more for a moment.
    ///
    /// Memory traffic: the triangles are read twice (24 bytes per triangle), the sorted half-edges written
    /// and read (48), the table written (18): 90 bytes, and 60 more for the first digit of the sort if the
    /// order of the faces is random. Of these, 26 bytes or 32 are on pages touched for the first time, unless
    /// they are reused: see [`TopologyBuilder`].
    ///
    /// [`Topology::shells`], [`Topology::non_manifold_vertices`] and the crack report also need the one-ring
    /// of each vertex; the first of them to be called computes it.
    ///
    /// # Panics
    ///
    /// Panics if an index is not below `vertex_count`, or if there are more triangles than
    /// [`MAX_TRIANGLES`](crate::mesh::MAX_TRIANGLES).
    ///
    /// ```
    /// use umbrage::testing::shapes;
    /// use umbrage::topology::Topology;
    /// let cube = shapes::cube();
    /// let topology = Topology::of(&cube);
    /// assert_eq!(topology.edge_count(), 18);
    /// assert!(topology.edge_counts().watertight());
    /// ```
    #[must_use]
    pub fn build(vertex_count: usize, triangles: impl Into<Arc<Vec<[u32; 3]>>>) -> Self {
        build::build(vertex_count, triangles.into())
    }

    /// The edge table of a mesh, whose triangles it shares: [`Topology::build`] without a copy.
    ///
    /// ```
    /// use umbrage::testing::shapes;
    /// use umbrage::topology::Topology;
    /// assert_eq!(Topology::of(&shapes::cube()).edge_count(), 18);
    /// ```
    #[must_use]
    pub fn of(mesh: &Mesh) -> Self {
        Self::build(mesh.vertex_count(), mesh.shared_triangles())
    }

    /// Whether it was built from the triangles of `mesh`. Constant time if they are shared.
    pub(crate) fn is_of(&self, mesh: &Mesh) -> bool {
        Arc::ptr_eq(&self.triangles, &mesh.shared_triangles()) || self.triangles() == mesh.triangles()
    }

    /// The number of vertices, used or not.
    #[inline]
    #[must_use]
    pub fn vertex_count(&self) -> usize {
        self.vertex_count
    }

    /// The faces as given, collapsed ones included; shared with the mesh if built by [`Topology::of`].
    #[inline]
    #[must_use]
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// The number of faces, collapsed ones included.
    #[inline]
    #[must_use]
    pub fn face_count(&self) -> usize {
        self.triangles.len()
    }

    /// The number of edges.
    #[inline]
    #[must_use]
    pub fn edge_count(&self) -> usize {
        self.offsets.len() - 1
    }

    /// The number of faces with two equal corners, which have no edges.
    #[must_use]
    pub fn collapsed_face_count(&self) -> usize {
        self.collapsed_faces
    }

    /// Whether `face` has two equal corners.
    #[inline]
    #[must_use]
    pub fn is_collapsed(&self, face: FaceId) -> bool {
        has_collapsed(self.triangles[face.index()])
    }

    /// All edges, ascending.
    pub fn edges(&self) -> impl ExactSizeIterator<Item = EdgeId> + use<> {
        (0..self.edge_count() as u32).map(EdgeId) // at most 3 × MAX_TRIANGLES, which fits
    }

    /// All faces, ascending, collapsed ones included.
    pub fn faces(&self) -> impl ExactSizeIterator<Item = FaceId> + use<> {
        (0..self.face_count() as u32).map(FaceId)
    }

    /// The half-edges of an edge, ascending.
    #[inline]
    pub fn half_edges(&self, edge: EdgeId) -> impl ExactSizeIterator<Item = HalfEdgeId> + Clone + '_ {
        self.entries(edge).iter().map(|entry| entry.half_edge())
    }

    /// The faces at an edge, each with +1 if it runs from the edge's lower- to its higher-numbered vertex,
    /// else −1.
    #[inline]
    pub fn uses(&self, edge: EdgeId) -> impl ExactSizeIterator<Item = (FaceId, i32)> + Clone + '_ {
        self.entries(edge).iter().map(|entry| (self.face(entry.half_edge()), entry.direction()))
    }

    /// The number of faces at an edge.
    #[inline]
    #[must_use]
    pub fn valence(&self, edge: EdgeId) -> usize {
        (self.offsets[edge.index() + 1] - self.offsets[edge.index()]) as usize
    }

    /// Whether an edge has exactly two faces, which run along it in the same direction.
    #[inline]
    #[must_use]
    pub fn is_misoriented(&self, edge: EdgeId) -> bool {
        matches!(self.entries(edge), [a, b] if a.direction() == b.direction())
    }

    /// The vertices of an edge, the lower-numbered one first.
    #[inline]
    #[must_use]
    pub fn vertices(&self, edge: EdgeId) -> [VertexId; 2] {
        let half_edge = self.entries(edge)[0].half_edge();
        let (tail, head) = (self.tail(half_edge), self.head(half_edge));
        [tail.min(head), tail.max(head)]
    }

    /// The edge of a half-edge, or `None` if its face has collapsed. Logarithmic in the edges.
    #[must_use]
    pub fn edge(&self, half_edge: HalfEdgeId) -> Option<EdgeId> {
        if self.is_collapsed(self.face(half_edge)) {
            return None;
        }
        let (tail, head) = (self.tail(half_edge), self.head(half_edge));
        self.edge_between(tail, head)
    }

    /// The edge between two vertices, if a face has it. Logarithmic in the edges.
    #[must_use]
    pub fn edge_between(&self, a: VertexId, b: VertexId) -> Option<EdgeId> {
        let wanted = [a.min(b), a.max(b)];
        let (mut low, mut high) = (0, self.edge_count());
        while low < high {
            let middle = low + (high - low) / 2;
            match self.vertices(EdgeId::new(middle)).cmp(&wanted) {
                std::cmp::Ordering::Less => low = middle + 1,
                std::cmp::Ordering::Equal => return Some(EdgeId::new(middle)),
                std::cmp::Ordering::Greater => high = middle,
            }
        }
        None
    }

    /// The half-edge of the other face at the edge: present exactly when the edge has two faces in opposite
    /// directions.
    #[must_use]
    pub fn twin(&self, half_edge: HalfEdgeId) -> Option<HalfEdgeId> {
        match *self.entries(self.edge(half_edge)?) {
            [a, b] if a.direction() != b.direction() => {
                Some(if a.half_edge() == half_edge { b.half_edge() } else { a.half_edge() })
            }
            _ => None,
        }
    }

    /// The face of a half-edge.
    #[inline]
    #[must_use]
    pub fn face(&self, half_edge: HalfEdgeId) -> FaceId {
        FaceId(half_edge.0 / 3)
    }

    /// The next half-edge around its face.
    #[inline]
    #[must_use]
    pub fn next(&self, half_edge: HalfEdgeId) -> HalfEdgeId {
        HalfEdgeId(if half_edge.0 % 3 == 2 { half_edge.0 - 2 } else { half_edge.0 + 1 })
    }

    /// The previous half-edge around its face.
    #[inline]
    #[must_use]
    pub fn prev(&self, half_edge: HalfEdgeId) -> HalfEdgeId {
        HalfEdgeId(if half_edge.0.is_multiple_of(3) { half_edge.0 + 2 } else { half_edge.0 - 1 })
    }

    /// The vertex at which a half-edge starts.
    #[inline]
    #[must_use]
    pub fn tail(&self, half_edge: HalfEdgeId) -> VertexId {
        VertexId(self.triangles[half_edge.index() / 3][half_edge.index() % 3])
    }

    /// The vertex at which a half-edge ends.
    #[inline]
    #[must_use]
    pub fn head(&self, half_edge: HalfEdgeId) -> VertexId {
        self.tail(self.next(half_edge))
    }

    /// Counts of how the edges are used. Constant time: they are made with the table.
    #[must_use]
    pub fn edge_counts(&self) -> EdgeCounts {
        self.counts
    }

    /// The edge table: the index of each edge's first entry, one more than there are edges; and the entries
    /// of all edges.
    pub(crate) fn table(&self) -> (&[u32], &[Entry]) {
        (&self.offsets, bytemuck::cast_slice(&self.entries))
    }

    #[inline]
    fn entries(&self, edge: EdgeId) -> &[Entry] {
        let range = self.offsets[edge.index()] as usize..self.offsets[edge.index() + 1] as usize;
        bytemuck::cast_slice(&self.entries[range])
    }
}

#[inline]
pub(crate) fn has_collapsed([a, b, c]: [u32; 3]) -> bool {
    a == b || b == c || c == a
}
