//! Fans: the faces around a vertex, as far as they hang together through edges at that vertex.
//!
//! A face (v, x, y) is an arc x → y in the link of v, and faces that share an edge at v are arcs that share an
//! end, so the fans are the connected components of the link. A screen goes through all vertices and passes
//! those whose arcs lie end to end in one chain; only the others are settled in full. The arcs of a vertex are
//! met in the edge table, which lists the faces of which it is not the largest vertex, and in one list more
//! for those of which it is: 6 bytes a triangle of a closed mesh, and no table over all corners.

use super::{Components, Topology, has_collapsed};
use crate::mesh::{FaceId, VertexId};

/// What [`Topology::fans`] finds.
pub(crate) struct Fans {
    /// At each vertex with several fans, the lowest-numbered face of each of them; ascending.
    pub(crate) several: Vec<(VertexId, FaceId)>,
    /// How many vertices have a face at all.
    pub(crate) vertices: usize,
    /// Whether the two faces of some edge have the same third vertex: without that, and without edges of
    /// three faces or more, no face is a duplicate.
    pub(crate) folded: bool,
}

impl Topology {
    /// Vertices whose faces form more than one fan, that is, are not all connected through edges at the
    /// vertex; ascending, each with its number of fans. Linear time (k·log k at a vertex of many faces).
    #[must_use]
    pub fn non_manifold_vertices(&self) -> Vec<(VertexId, u32)> {
        let several = self.fans().several;
        several.chunk_by(|a, b| a.0 == b.0).map(|fans| (fans[0].0, fans.len() as u32)).collect()
    }

    /// Which vertices have several fans.
    pub(crate) fn fans(&self) -> Fans {
        let (ends, by_largest) = self.faces_by_largest_vertex();
        let mut suspects = Vec::new();
        let (mut vertices, mut folded) = (0, false);
        let mut entries = self.entries.as_slice();
        let mut start = 0;
        for (vertex, &end) in (0..).zip(&ends) {
            let mut link = Link::default();
            let mut before = (NONE, NONE);
            // Half-edges between this vertex and larger ones come next in the table.
            while let [entry, rest @ ..] = entries {
                let half_edge = entry.half_edge();
                let [tail, head, apex] = turned(self.triangles[half_edge.index() / 3], half_edge.0 % 3);
                if tail.min(head) != vertex {
                    break;
                }
                entries = rest;
                // A face of which this vertex is the smallest comes twice: it counts at the smaller other one.
                let larger = tail.max(head);
                let arc = if tail == vertex { (head, apex) } else { (apex, tail) };
                link.push(arc, apex > larger || apex < vertex);
                folded |= before == (larger, apex);
                before = (larger, apex);
            }
            for &face in &by_largest[start as usize..end as usize] {
                let triangle = self.triangles[face as usize];
                let corner = u32::from(triangle[1] == vertex) + 2 * u32::from(triangle[2] == vertex);
                let [_, from, to] = turned(triangle, corner);
                link.push((from, to), true);
            }
            start = end;
            vertices += usize::from(link.len > 0);
            if !link.is_one_chain() {
                suspects.push(vertex);
            }
        }
        drop((ends, by_largest));
        Fans { several: self.settle(&suspects), vertices, folded }
    }

    /// Counting sort of the faces that have not collapsed: where each vertex's list ends, and the lists.
    fn faces_by_largest_vertex(&self) -> (Vec<u32>, Vec<u32>) {
        let mut ends = vec![0_u32; self.vertex_count];
        let largest = |&[a, b, c]: &[u32; 3]| a.max(b).max(c) as usize;
        let kept = || (0..).zip(&self.triangles).filter(|(_, triangle)| !has_collapsed(**triangle));
        kept().for_each(|(_, triangle)| ends[largest(triangle)] += 1);
        let mut sum = 0;
        for end in &mut ends {
            (sum, *end) = (sum + *end, sum);
        }
        let mut faces = vec![0_u32; sum as usize];
        for (face, triangle) in kept() {
            let place = &mut ends[largest(triangle)];
            faces[*place as usize] = face;
            *place += 1;
        }
        (ends, faces)
    }

    /// The lowest face of each fan, at those of the `suspects` (ascending) that have several.
    fn settle(&self, suspects: &[u32]) -> Vec<(VertexId, FaceId)> {
        if suspects.is_empty() {
            return Vec::new();
        }
        let mut corners: Vec<(u32, u32)> = Vec::new();
        for (face, &triangle) in (0..).zip(&self.triangles) {
            if !has_collapsed(triangle) {
                let wanted = triangle.into_iter().filter(|vertex| suspects.binary_search(vertex).is_ok());
                corners.extend(wanted.map(|vertex| (vertex, face)));
            }
        }
        corners.sort_unstable();
        let mut several = Vec::new();
        for corners in corners.chunk_by(|a, b| a.0 == b.0) {
            let vertex = corners[0].0;
            // The two edges of each face at the vertex, by their other ends; faces with equal ones are joined.
            let mut ends: Vec<(u32, u32)> = Vec::with_capacity(2 * corners.len());
            for (index, &(_, face)) in (0..).zip(corners) {
                let others = self.triangles[face as usize].into_iter().filter(|&other| other != vertex);
                ends.extend(others.map(|other| (other, index)));
            }
            ends.sort_unstable();
            let mut components = Components::new(corners.len());
            for pair in ends.windows(2).filter(|pair| pair[0].0 == pair[1].0) {
                components.join(pair[0].1, pair[1].1);
            }
            let (number_of, fans) = components.number(|_| true);
            if fans > 1 {
                // Fans are numbered as their first faces are met.
                let mut next = 0;
                for (number, &(_, face)) in number_of.into_iter().zip(corners) {
                    if number == Some(next) {
                        several.push((VertexId(vertex), FaceId(face)));
                        next += 1;
                    }
                }
            }
        }
        several
    }
}

/// The triangle with its corner number `first` (0, 1 or 2) at the front.
#[inline]
fn turned([a, b, c]: [u32; 3], first: u32) -> [u32; 3] {
    match first {
        0 => [a, b, c],
        1 => [b, c, a],
        _ => [c, a, b],
    }
}

/// The arcs of a vertex, as far as they are few.
struct Link {
    from: [u32; Link::MOST],
    to: [u32; Link::MOST],
    /// May exceed [`Link::MOST`]; what comes after is not kept.
    len: usize,
}

/// No vertex has this id, see [`Mesh::new`](crate::mesh::Mesh::new).
const NONE: u32 = u32::MAX;

impl Default for Link {
    #[inline]
    fn default() -> Self {
        Self { from: [NONE; Self::MOST], to: [NONE; Self::MOST], len: 0 }
    }
}

impl Link {
    /// Most vertices have six faces; those with more than this are settled in full.
    const MOST: usize = 16;

    /// Adds an arc if it counts. No branch: whether it does is a coin toss.
    #[inline]
    fn push(&mut self, (from, to): (u32, u32), counts: bool) {
        let place = self.len % Self::MOST;
        self.from[place] = if counts { from } else { self.from[place] };
        self.to[place] = if counts { to } else { self.to[place] };
        self.len += usize::from(counts);
    }

    /// Whether the arcs can be laid end to end in one chain, which then connects them all: nearly every vertex
    /// of nearly every mesh. `false` proves nothing.
    #[inline]
    fn is_one_chain(&self) -> bool {
        match self.len {
            0 | 1 => true,
            2..=8 => self.chain::<8>(),
            9..=Self::MOST => self.chain::<{ Self::MOST }>(),
            _ => false,
        }
    }

    /// The same over the first `N` places. All of them are compared at once, since where the next arc stands
    /// cannot be predicted.
    #[inline]
    fn chain<const N: usize>(&self) -> bool {
        let at = |ends: &[u32], wanted: u32| {
            let mut found = 0_u32;
            for place in 0..N {
                found |= u32::from(ends[place] == wanted) << place;
            }
            found
        };
        let (from, to) = (&self.from[..N], &self.to[..N]);
        let (mut front, mut back, mut left) = (to[0], from[0], (1_u32 << self.len) - 2);
        while left != 0 {
            let next = at(from, front) & left;
            if next != 0 {
                front = to[next.trailing_zeros() as usize % N];
                left &= left ^ (next & next.wrapping_neg());
                continue;
            }
            let before = at(to, back) & left;
            if before == 0 {
                return false;
            }
            back = from[before.trailing_zeros() as usize % N];
            left &= left ^ (before & before.wrapping_neg());
        }
        true
    }
}
