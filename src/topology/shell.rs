//! What hangs together: shells and boundary loops. All by union-find, in near-linear time.

use super::{Topology, has_collapsed};
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

    /// Joins two sets; gives the leader of both.
    #[inline]
    pub fn join(&mut self, a: u32, b: u32) -> u32 {
        let (a, b) = (self.find(a), self.find(b));
        let leader = a.min(b);
        self.parent[a.max(b) as usize] = leader;
        leader
    }

    /// `false` if two members are in one set as far as can be seen at once.
    #[inline]
    pub(super) fn may_differ(&self, [a, b]: [u32; 2]) -> bool {
        self.parent[a as usize] != self.parent[b as usize]
    }

    /// Adds a set of one member; gives that.
    pub(super) fn push(&mut self) -> u32 {
        let member = self.parent.len() as u32;
        self.parent.push(member);
        member
    }

    /// How many sets there are.
    pub(super) fn count(&self) -> usize {
        (0..).zip(&self.parent).filter(|&(member, &parent)| member == parent).count()
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

impl Shells {
    /// The faces of each shell; collapsed ones are left out. A counting sort.
    pub(crate) fn faces_by_shell(&self) -> FacesByShell {
        let mut ends = vec![0; self.count];
        self.of_face.iter().flatten().for_each(|&shell| ends[shell as usize] += 1);
        let mut sum = 0;
        for end in &mut ends {
            (sum, *end) = (sum + *end, sum);
        }
        let mut faces = vec![FaceId::new(0); sum];
        for (face, shell) in self.of_face.iter().enumerate() {
            if let Some(shell) = shell {
                let place = &mut ends[*shell as usize];
                faces[*place] = FaceId::new(face);
                *place += 1;
            }
        }
        FacesByShell { faces, ends }
    }
}

/// The faces of each shell, ascending: one list, and where it ends for each shell.
#[derive(Clone, Debug)]
pub(crate) struct FacesByShell {
    pub(crate) faces: Vec<FaceId>,
    pub(crate) ends: Vec<usize>,
}

impl FacesByShell {
    pub(crate) fn iter(&self) -> impl Iterator<Item = &[FaceId]> {
        let starts = std::iter::once(0).chain(self.ends.iter().copied());
        starts.zip(&self.ends).map(|(start, &end)| &self.faces[start..end])
    }
}

impl Topology {
    /// Which faces hang together through edges. Memory: 8 bytes a face, 12 at its peak; the first to ask a table that
    /// was not built with its survey takes what [`Topology::build_surveyed`] does.
    #[must_use]
    pub fn shells(&self) -> Shells {
        let survey = self.survey();
        if survey.components <= 1 && survey.fans.several.is_empty() {
            // Without a vertex of several fans, what hangs together through vertices does so through edges.
            let of_face =
                self.triangles.iter().map(|&corners| (!has_collapsed(corners)).then_some(0)).collect();
            return Shells { of_face, count: survey.components };
        }
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

    /// The boundary edges, grouped into loops: the connected components of the boundary. Within a loop edges
    /// ascend; loops come in the order of their first edges.
    #[must_use]
    pub fn boundary_loops(&self) -> Vec<Vec<EdgeId>> {
        let (edges, ends) = self.grouped_boundary();
        let starts = std::iter::once(0).chain(ends.iter().copied());
        starts.zip(&ends).map(|(start, &end)| edges[start as usize..end as usize].to_vec()).collect()
    }

    /// The same in two lists: the edges loop by loop, and where each loop ends.
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
        // Number the loops as they are met, then a counting sort.
        const NONE: u32 = u32::MAX;
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
            let place = &mut ends[number as usize];
            edges[*place as usize] = edge;
            *place += 1;
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
