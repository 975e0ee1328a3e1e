//! Boundary loops and other connected sets of edges. Union-find, in near-linear time.

use super::Topology;
use super::components::{Components, NONE};
use crate::mesh::{EdgeId, VertexId};

impl Topology {
    /// The boundary edges, grouped into loops: the connected components of the boundary. Within a loop edges
    /// ascend; loops come in the order of their first edges.
    #[must_use]
    pub fn boundary_loops(&self) -> Vec<Vec<EdgeId>> {
        let (edges, ends) = self.grouped_boundary();
        let starts = std::iter::once(0).chain(ends.iter().copied());
        starts.zip(&ends).map(|(start, &end)| edges[start as usize..end as usize].to_vec()).collect()
    }

    /// [`Topology::boundary_loops`] in two lists: the edges loop by loop, and the end of each loop.
    pub(crate) fn grouped_boundary(&self) -> (Vec<EdgeId>, Vec<u32>) {
        let boundary = || self.edges().filter(|&edge| self.valence(edge) == 1);
        let count = self.counts.boundary;
        if count == 0 {
            return (Vec::new(), Vec::new());
        }
        let mut vertices = Components::new(self.vertex_count());
        for edge in boundary() {
            let [a, b] = self.vertices(edge);
            vertices.join(a.0, b.0);
        }
        // Number the loops in the order of their first edges, then a counting sort.
        let mut number_of = vec![NONE; self.vertex_count()];
        let mut ends: Vec<u32> = Vec::new();
        for edge in boundary() {
            let number = &mut number_of[vertices.find(self.vertices(edge)[0].0) as usize];
            if *number == NONE {
                *number = ends.len() as u32;
                ends.push(0);
            }
            ends[*number as usize] += 1;
        }
        let mut sum = 0;
        for end in &mut ends {
            (sum, *end) = (sum + *end, sum);
        }
        let mut edges = vec![EdgeId(0); count];
        for edge in boundary() {
            let number = number_of[vertices.find(self.vertices(edge)[0].0) as usize];
            let slot = &mut ends[number as usize];
            edges[*slot as usize] = edge;
            *slot += 1;
        }
        (edges, ends)
    }

    /// Groups `edges` (ascending) into connected components by their shared vertices. k·log k for k edges.
    pub(crate) fn connected(&self, edges: Vec<EdgeId>) -> Vec<Vec<EdgeId>> {
        let mut ends: Vec<(VertexId, u32)> = Vec::with_capacity(2 * edges.len());
        for (index, &edge) in edges.iter().enumerate() {
            ends.extend(self.vertices(edge).map(|vertex| (vertex, index as u32)));
        }
        ends.sort_unstable();
        let mut components = Components::new(edges.len());
        for pair in ends.windows(2).filter(|pair| pair[0].0 == pair[1].0) {
            components.join(pair[0].1, pair[1].1);
        }
        let (number_of, count) = components.number(|_| true);
        let mut groups = vec![Vec::new(); count];
        for (number, edge) in number_of.into_iter().zip(edges) {
            groups[number.expect("every edge is numbered") as usize].push(edge);
        }
        groups
    }
}
