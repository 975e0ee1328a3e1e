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

/// Not on the boundary; no index reaches this value.
const NONE: u32 = u32::MAX;

/// The boundary: its edges, its vertices, and each edge's ends as indices among them.
pub(super) struct Boundary<'a> {
    pub(super) edges: &'a [EdgeId],
    pub(super) vertices: Vec<VertexId>,
    pub(super) points: Vec<[f32; 3]>,
    pub(super) ends: Vec<[u32; 2]>,
}

impl<'a> Boundary<'a> {
    pub(super) fn new(mesh: &Mesh, topology: &Topology, edges: &'a [EdgeId]) -> Self {
        // A table of all vertices: a boundary may have as many, and sorting it would take longer.
        let mut index_of = vec![NONE; topology.vertex_count()];
        for vertex in edges.iter().flat_map(|&edge| topology.vertices(edge)) {
            index_of[vertex.index()] = 0;
        }
        let mut vertices: Vec<VertexId> = Vec::new();
        for (vertex, index) in (0..).map(VertexId).zip(&mut index_of).filter(|(_, index)| **index != NONE) {
            *index = vertices.len() as u32; // at most as many as vertices
            vertices.push(vertex);
        }
        let index = |vertex: VertexId| index_of[vertex.index()];
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
        let mut widest = None;
        let mut found: Vec<NearMiss> = Vec::with_capacity(TOLERANCES.len());
        // From the largest on: where no two vertices are within a distance, none are within a smaller one.
        let mut apart = false;
        for relative in TOLERANCES.into_iter().rev() {
            let distance = relative * diagonal;
            let pairs = (!apart).then(|| self.pairs_within(distance)).flatten();
            apart = pairs.is_none();
            let pairs = pairs.unwrap_or_default();
            found.push(NearMiss { relative, distance, edges: pairs.len() });
            widest.get_or_insert(pairs);
        }
        found.reverse();
        (found, widest.unwrap_or_default())
    }

    /// The edges that pair one to one, ascending; `None` if no two vertices are within the distance.
    fn pairs_within(&self, distance: f64) -> Option<Vec<EdgeId>> {
        let welded = weld_points(&self.points, distance);
        // Kept vertices are numbered in order.
        if welded.iter().zip(0..).all(|(&welded, index)| welded == index) {
            return None;
        }
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
        Some(pairs)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{Weld, weld};
    use crate::random::SplitMix64;
    use crate::testing::shapes;

    /// At each tolerance by itself: the edges that pair one to one, counted by comparing each with each.
    fn naive(boundary: &Boundary<'_>, diagonal: f64) -> Vec<usize> {
        let pairs_at = |relative: f64| {
            let welded = weld_points(&boundary.points, relative * diagonal);
            let keys: Vec<[u32; 2]> = (boundary.ends.iter())
                .map(|ends| ends.map(|end| welded[end as usize]))
                .map(|[a, b]| [a.min(b), a.max(b)])
                .collect();
            let same = |key: &[u32; 2]| keys.iter().filter(|other| *other == key).count();
            keys.iter().filter(|key| key[0] != key[1] && same(key) == 2).count()
        };
        TOLERANCES.map(pairs_at).to_vec()
    }

    #[test]
    fn near_misses_are_those_of_each_tolerance_by_itself() {
        let mut some = 0;
        for seed in 0..40 {
            // Triangles of a torus, each apart, with corners that err by up to a power of ten of its size.
            let soup = shapes::soup(&shapes::torus(8, 5, 2.0, 0.7));
            let mut random = SplitMix64(seed);
            let error = 10_f32.powi(-3 - (seed % 6) as i32);
            let mut moved = |x: f32| x + error * (random.below(2001) as f32 / 1000.0 - 1.0);
            let positions = soup.positions().iter().map(|p| p.map(&mut moved)).collect();
            let mesh = weld(&Mesh::new(positions, soup.triangles().to_vec()).unwrap(), Weld::Exact).mesh;
            let topology = Topology::of(&mesh);
            let (edges, _) = topology.grouped_boundary();
            let boundary = Boundary::new(&mesh, &topology, &edges);
            let (found, widest) = boundary.near_miss(6.0);
            let counts: Vec<usize> = found.iter().map(|miss| miss.edges).collect();
            assert_eq!(counts, naive(&boundary, 6.0), "{seed}");
            assert_eq!(widest.len(), counts[3]);
            some += usize::from(counts[3] > 0);
            // Fault injected: at another size of the mesh the counts are others.
            assert!(counts[3] == 0 || counts != naive(&boundary, 6e-9));
        }
        assert!((10..40).contains(&some), "{some}");
    }

    #[test]
    fn boundary_vertices_are_those_of_its_edges_ascending() {
        let mesh = shapes::open_cube();
        let topology = Topology::of(&mesh);
        let (edges, _) = topology.grouped_boundary();
        let boundary = Boundary::new(&mesh, &topology, &edges);
        let mut vertices: Vec<VertexId> = edges.iter().flat_map(|&edge| topology.vertices(edge)).collect();
        vertices.sort_unstable();
        vertices.dedup();
        assert_eq!(boundary.vertices, vertices);
        for (&edge, ends) in edges.iter().zip(&boundary.ends) {
            assert_eq!(ends.map(|end| vertices[end as usize]), topology.vertices(edge));
        }
    }
}
