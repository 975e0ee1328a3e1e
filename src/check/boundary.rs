//! Near-miss seams: boundary edges that a small weld would close.

use crate::mesh::{EdgeId, Mesh, VertexId, weld_points};
use crate::topology::Topology;

/// The number of boundary edges that a weld within one distance would close.
///
/// ```
/// use umbrage::check::CrackReport;
/// use umbrage::testing::shapes;
/// use umbrage::topology::Topology;
/// let seam = shapes::seam(2); // two units in the last place wide
/// let report = CrackReport::of(&seam, &Topology::of(&seam));
/// let widest = report.near_miss.last().expect("there is a boundary");
/// assert_eq!((widest.edges, report.counts.near_miss_edges), (8, 8));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct NearMiss {
    /// The distance, as a fraction of the diagonal of the mesh.
    pub relative: f64,
    /// The distance, in mesh units.
    pub distance: f64,
    /// The number of boundary edges that would pair one to one with another.
    pub edges: usize,
}

/// The tolerances tried, as fractions of the diagonal of the mesh: from about the spacing of `f32` at that
/// size to a visible gap.
const TOLERANCES: [f64; 4] = [1e-7, 1e-6, 1e-5, 1e-4];

/// The boundary: its edges, its vertices, and each edge's ends as indices among them.
pub(super) struct Boundary<'a> {
    pub(super) edges: &'a [EdgeId],
    pub(super) vertices: Vec<VertexId>,
    pub(super) points: Vec<[f32; 3]>,
    pub(super) ends: Vec<[u32; 2]>,
}

impl<'a> Boundary<'a> {
    pub(super) fn new(mesh: &Mesh, topology: &Topology, edges: &'a [EdgeId]) -> Self {
        let mut vertices: Vec<VertexId> = edges.iter().flat_map(|&edge| topology.vertices(edge)).collect();
        vertices.sort_unstable();
        vertices.dedup();
        let index = |vertex| vertices.binary_search(&vertex).expect("the ends are all there") as u32;
        let ends = edges.iter().map(|&edge| topology.vertices(edge).map(index)).collect();
        let points = vertices.iter().map(|vertex| mesh.positions()[vertex.index()]).collect();
        Self { edges, vertices, points, ends }
    }

    /// The number of edges that pair one to one at each tolerance, and those that do at the largest,
    /// ascending.
    ///
    /// Vertices of the boundary are welded as by [`Weld::Within`](crate::mesh::Weld::Within). An edge whose
    /// ends become one vertex has collapsed and pairs with nothing; three or more edges that coincide do not
    /// pair one to one.
    pub(super) fn near_miss(&self, diagonal: f64) -> (Vec<NearMiss>, Vec<EdgeId>) {
        let mut pairs = Vec::new();
        let found = TOLERANCES.map(|relative| {
            let distance = relative * diagonal;
            pairs = self.pairs_within(distance);
            NearMiss { relative, distance, edges: pairs.len() }
        });
        (found.to_vec(), pairs)
    }

    fn pairs_within(&self, distance: f64) -> Vec<EdgeId> {
        let welded = weld_points(&self.points, distance);
        let mut keyed: Vec<([u32; 2], EdgeId)> = Vec::with_capacity(self.edges.len());
        for (ends, &edge) in self.ends.iter().zip(self.edges) {
            let [a, b] = ends.map(|end| welded[end as usize]);
            if a != b {
                keyed.push(([a.min(b), a.max(b)], edge));
            }
        }
        keyed.sort_unstable();
        let two = keyed.chunk_by(|a, b| a.0 == b.0).filter(|group| group.len() == 2);
        let mut pairs: Vec<EdgeId> = two.flatten().map(|&(_, edge)| edge).collect();
        pairs.sort_unstable();
        pairs
    }
}
