//! Fans: the faces around a vertex, as far as they hang together through edges at that vertex.
//!
//! A face (v, x, y) is an arc x → y in the link of v, and faces that share an edge at v are arcs that share an
//! end, so the fans are the connected components of the link. The arcs of a vertex are met in the edge table,
//! which lists the faces of which it is not the largest vertex, and in one list more for those of which it is:
//! 6 bytes a triangle of a closed mesh, and no table over all corners.

use super::{Components, Topology, has_collapsed};
use crate::mesh::{FaceId, VertexId};

/// A face at a vertex: the other two corners, in the order of the face.
#[derive(Clone, Copy, Debug)]
struct Arc {
    from: u32,
    to: u32,
    face: u32,
}

impl Topology {
    /// Vertices whose faces form more than one fan, that is, are not all connected through edges at the
    /// vertex; ascending, each with its number of fans. Linear time (k·log k at a vertex of many faces).
    #[must_use]
    pub fn non_manifold_vertices(&self) -> Vec<(VertexId, u32)> {
        let fans = self.fans_of_non_manifold_vertices();
        fans.chunk_by(|a, b| a.0 == b.0).map(|fans| (fans[0].0, fans.len() as u32)).collect()
    }

    /// At each vertex with several fans, the lowest-numbered face of each of them; ascending.
    pub(crate) fn fans_of_non_manifold_vertices(&self) -> Vec<(VertexId, FaceId)> {
        let (ends, by_largest) = self.faces_by_largest_vertex();
        let mut found = Vec::new();
        let mut arcs: Vec<Arc> = Vec::new();
        let mut table = self.entries.iter().map(|entry| entry.half_edge()).peekable();
        let mut start = 0;
        for (vertex, &end) in (0..).zip(&ends) {
            arcs.clear();
            // Half-edges between this vertex and larger ones come next in the table.
            while let Some(&half_edge) = table.peek() {
                let (face, corner) = (half_edge.0 / 3, half_edge.index() % 3);
                let triangle = self.triangles[face as usize];
                let (tail, head, apex) =
                    (triangle[corner], triangle[(corner + 1) % 3], triangle[(corner + 2) % 3]);
                if tail.min(head) != vertex {
                    break;
                }
                table.next();
                // A face of which this vertex is the smallest comes twice: take it at the smaller other one.
                if apex > tail.max(head) || apex < vertex {
                    arcs.push(match tail == vertex {
                        true => Arc { from: head, to: apex, face },
                        false => Arc { from: apex, to: tail, face },
                    });
                }
            }
            for &face in &by_largest[start as usize..end as usize] {
                let [a, b, c] = self.triangles[face as usize];
                let (from, to) = match vertex {
                    _ if vertex == a => (b, c),
                    _ if vertex == b => (c, a),
                    _ => (a, b),
                };
                arcs.push(Arc { from, to, face });
            }
            start = end;
            if !is_one_chain(&mut arcs) {
                let fans = fans(&arcs);
                if fans.len() > 1 {
                    found.extend(fans.into_iter().map(|face| (VertexId(vertex), FaceId(face))));
                }
            }
        }
        found
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
}

/// Whether the arcs can be laid end to end in one chain, which then connects them all: nearly every vertex of
/// nearly every mesh. `false` proves nothing. Arcs are reordered.
#[inline]
fn is_one_chain(arcs: &mut [Arc]) -> bool {
    const SHORT: usize = 24; // comparing all with all stays cheap
    if arcs.len() > SHORT {
        return false;
    }
    let Some((first, mut rest)) = arcs.split_first_mut() else { return true };
    let (mut front, mut back) = (first.to, first.from);
    while !rest.is_empty() {
        if let Some(next) = rest.iter().position(|arc| arc.from == front) {
            front = rest[next].to;
            rest.swap(0, next);
        } else if let Some(before) = rest.iter().position(|arc| arc.to == back) {
            back = rest[before].from;
            rest.swap(0, before);
        } else {
            return false;
        }
        rest = &mut rest[1..];
    }
    true
}

/// The lowest face of each component of the link, ascending.
fn fans(arcs: &[Arc]) -> Vec<u32> {
    let mut ends: Vec<(u32, u32)> =
        (0..).zip(arcs).flat_map(|(index, arc)| [(arc.from, index), (arc.to, index)]).collect();
    ends.sort_unstable();
    let mut components = Components::new(arcs.len());
    for pair in ends.windows(2).filter(|pair| pair[0].0 == pair[1].0) {
        components.join(pair[0].1, pair[1].1);
    }
    let mut lowest = vec![u32::MAX; arcs.len()];
    for (index, arc) in (0..).zip(arcs) {
        let lowest = &mut lowest[components.find(index) as usize];
        *lowest = arc.face.min(*lowest);
    }
    lowest.retain(|&face| face != u32::MAX);
    lowest.sort_unstable();
    lowest
}
