//! What hangs together: shells, fans around a vertex, boundary loops. All by union-find, in near-linear time.

use super::Topology;
use crate::mesh::{EdgeId, FaceId, VertexId};

/// A partition of `0..n` into sets, each led by its smallest member.
///
/// Robert E. Tarjan, *Efficiency of a Good But Not Linear Set Union Algorithm*, 1975; with path halving
/// (Tarjan and van Leeuwen, 1984). The smallest member leads, so the outcome does not depend on the order.
#[derive(Clone, Debug)]
pub struct Components {
    parent: Vec<u32>,
}

impl Components {
    /// `n` sets of one member each.
    ///
    /// # Panics
    ///
    /// Panics if `n` does not fit in 32 bits.
    #[must_use]
    pub fn new(n: usize) -> Self {
        let n = u32::try_from(n).expect("members are 32-bit ids");
        Self { parent: (0..n).collect() }
    }

    /// The leader of `member`'s set.
    #[inline]
    pub fn find(&mut self, mut member: u32) -> u32 {
        loop {
            let parent = self.parent[member as usize];
            if parent == member {
                return member;
            }
            let grandparent = self.parent[parent as usize];
            self.parent[member as usize] = grandparent;
            member = grandparent;
        }
    }

    /// Joins two sets.
    #[inline]
    pub fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.find(a), self.find(b));
        if a != b {
            self.parent[a.max(b) as usize] = a.min(b);
        }
    }

    /// The number of each member's set, counted in the order of the leaders among `members`; and how many
    /// sets those are. Members that are not wanted get `None`.
    pub(crate) fn number(mut self, wanted: impl Fn(u32) -> bool) -> (Vec<Option<u32>>, usize) {
        let mut number_of = vec![None; self.parent.len()];
        let mut count = 0;
        for member in 0..self.parent.len() as u32 {
            if !wanted(member) {
                continue;
            }
            let leader = self.find(member) as usize;
            if number_of[leader].is_none() {
                number_of[leader] = Some(count);
                count += 1;
            }
            number_of[member as usize] = number_of[leader];
        }
        (number_of, count as usize)
    }
}

/// The shells of a mesh: faces connected through edges (not through single vertices).
#[derive(Clone, Debug)]
pub struct Shells {
    /// For each face the number of its shell; `None` for a collapsed face.
    pub of_face: Vec<Option<u32>>,
    /// How many shells there are; numbered in the order of their first faces.
    pub count: usize,
}

impl Topology {
    /// Which faces hang together through edges.
    #[must_use]
    pub fn shells(&self) -> Shells {
        let mut faces = Components::new(self.face_count());
        for edge in self.edges() {
            let mut uses = self.half_edges(edge);
            let Some(first) = uses.next() else { continue };
            for other in uses {
                faces.join(self.face(first).0, self.face(other).0);
            }
        }
        let (of_face, count) = faces.number(|face| !self.is_collapsed(FaceId(face)));
        Shells { of_face, count }
    }

    /// Vertices whose faces form more than one fan, that is, are not all connected through edges at the
    /// vertex; ascending, each with its number of fans.
    #[must_use]
    pub fn non_manifold_vertices(&self) -> Vec<(VertexId, u32)> {
        // Corners at a vertex are joined where their faces share an edge at that vertex.
        let mut corners = Components::new(3 * self.face_count());
        for edge in self.edges() {
            let [a, _] = self.vertices(edge);
            let mut uses = self.half_edges(edge).map(|half_edge| {
                let next = self.next(half_edge);
                if self.tail(half_edge) == a { (half_edge, next) } else { (next, half_edge) }
            });
            let Some((first_a, first_b)) = uses.next() else { continue };
            for (other_a, other_b) in uses {
                corners.join(first_a.0, other_a.0);
                corners.join(first_b.0, other_b.0);
            }
        }
        let mut fans = vec![0_u32; self.vertex_count()];
        for (face, &triangle) in self.triangles().iter().enumerate() {
            if !super::has_collapsed(triangle) {
                for (corner, &vertex) in triangle.iter().enumerate() {
                    let corner = (3 * face + corner) as u32;
                    fans[vertex as usize] += u32::from(corners.find(corner) == corner);
                }
            }
        }
        let bad = fans.into_iter().enumerate().filter(|&(_, fans)| fans > 1);
        bad.map(|(vertex, fans)| (VertexId::new(vertex), fans)).collect()
    }

    /// The boundary edges, grouped into loops: the connected components of the boundary. Within a loop edges
    /// ascend; loops come in the order of their first edges.
    #[must_use]
    pub fn boundary_loops(&self) -> Vec<Vec<EdgeId>> {
        self.connected(self.edges().filter(|&edge| self.valence(edge) == 1).collect())
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
