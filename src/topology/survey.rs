//! What the one-rings of the vertices say about a mesh: fans, repeated faces, connected components.
//!
//! A counting sort brings the corners of all faces together by vertex, each as an edge of the vertex's link;
//! every link is then decided by itself.

use super::components::NONE;
use super::counting_sort::{Blocks, SLACK, starts_of};
use super::vertex_link::{self, LinkBuilder, LinkEdge};
use super::{Topology, has_collapsed};
use crate::mesh::{FaceId, VertexId};

/// What the one-rings of all vertices say.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Survey {
    /// At each vertex with several fans, the lowest-numbered face of each fan; ascending.
    pub(crate) fans: Vec<(VertexId, FaceId)>,
    /// The number of vertices that have a face.
    pub(crate) vertices: usize,
    /// Whether two faces have the same three vertices.
    pub(crate) repeats: bool,
    /// The number of sets of vertices connected by edges; vertices without a face do not count.
    pub(crate) components: usize,
}

impl Topology {
    /// The survey, made on the first call, which takes about as long as the build.
    ///
    /// Memory while it runs: 28 bytes per triangle of a closed mesh; 34 and half a megabyte if the order of
    /// the faces is random; at most 120 for any mesh.
    pub(crate) fn survey(&self) -> &Survey {
        self.survey.get_or_init(|| {
            let blocks = Blocks::for_order_of(self.vertex_count, &self.triangles, BLOCK_BITS);
            survey_by(self.vertex_count, &self.triangles, blocks)
        })
    }

    /// Vertices whose faces form more than one fan, that is, are not all connected through edges at the
    /// vertex; ascending, each with its number of fans.
    #[must_use]
    pub fn non_manifold_vertices(&self) -> Vec<(VertexId, u32)> {
        let fans = self.survey().fans.chunk_by(|a, b| a.0 == b.0);
        fans.map(|fans| (fans[0].0, fans.len() as u32)).collect()
    }
}

/// Vertices per block, as a power of two. A block of 2¹³ vertices has about 50,000 corners, 400 kB.
const BLOCK_BITS: u32 = 13;

/// The corners of a face: each vertex, and the edge of its link.
#[inline(always)]
fn corners([a, b, c]: [u32; 3]) -> [(u32, LinkEdge); 3] {
    [(a, LinkEdge { from: b, to: c }), (b, LinkEdge { from: c, to: a }), (c, LinkEdge { from: a, to: b })]
}

/// The survey of triangles whose indices are below `vertex_count`.
pub(super) fn survey_by(vertex_count: usize, triangles: &[[u32; 3]], blocks: Blocks) -> Survey {
    let mut ends = vec![0_u32; blocks.count(vertex_count)];
    for &triangle in triangles.iter().filter(|&&triangle| !has_collapsed(triangle)) {
        for vertex in triangle {
            ends[blocks.of(vertex)] += 1;
        }
    }
    let (sum, most) = starts_of(&mut ends);
    let mut edges = vec![LinkEdge::default(); sum as usize + SLACK];
    let mut links = LinkBuilder::new(vertex_count);
    if blocks.bits == 0 {
        scatter::<false>(triangles, blocks, &mut ends, &mut edges, &mut []);
        vertex_link::add(&mut links, 0, &ends, &edges);
    } else {
        let mut lows = vec![0_u16; edges.len()];
        scatter::<true>(triangles, blocks, &mut ends, &mut edges, &mut lows);
        let mut sorted = vec![LinkEdge::default(); most as usize + SLACK];
        let mut own_ends = vec![0_u32; 1 << blocks.bits];
        let mut start = 0;
        for (block, &end) in (0..).zip(&ends) {
            let first: u32 = block << blocks.bits;
            let range = start as usize..end as usize;
            start = end;
            let own_ends = &mut own_ends[..(vertex_count - first as usize).min(1 << blocks.bits)];
            sort_block(&lows[range.clone()], &edges[range], own_ends, &mut sorted);
            vertex_link::add(&mut links, first, own_ends, &sorted);
        }
    }
    drop(edges);
    let LinkBuilder { fans, vertices, repeats, components, .. } = links;
    let components = components.count();
    Survey { fans: with_faces(vertex_count, triangles, &fans), vertices, repeats, components }
}

/// Writes each corner to the next free slot of its vertex, or of its vertex's block.
fn scatter<const BY_BLOCK: bool>(
    triangles: &[[u32; 3]],
    blocks: Blocks,
    slots: &mut [u32],
    edges: &mut [LinkEdge],
    lows: &mut [u16],
) {
    // Same length as `edges`, so one bounds check covers both.
    let lows = if BY_BLOCK { &mut lows[..edges.len()] } else { &mut [] };
    for &triangle in triangles.iter().filter(|&&triangle| !has_collapsed(triangle)) {
        for (vertex, edge) in corners(triangle) {
            let slot = &mut slots[if BY_BLOCK { blocks.of(vertex) } else { vertex as usize }];
            edges[*slot as usize] = edge;
            if BY_BLOCK {
                lows[*slot as usize] = blocks.low(vertex);
            }
            *slot += 1;
        }
    }
}

/// The second digit of the sort: one block by vertex, into `sorted`. The corners of a vertex keep their
/// order.
fn sort_block(lows: &[u16], edges: &[LinkEdge], ends: &mut [u32], sorted: &mut [LinkEdge]) {
    ends.fill(0);
    for &low in lows {
        ends[usize::from(low)] += 1;
    }
    starts_of(ends);
    for (&low, &edge) in lows.iter().zip(edges) {
        let slot = &mut ends[usize::from(low)];
        sorted[*slot as usize] = edge;
        *slot += 1;
    }
}

/// Turns the index of a corner among the corners of its vertex, which are in the order of the faces, into its
/// face.
fn with_faces(vertex_count: usize, triangles: &[[u32; 3]], fans: &[[u32; 2]]) -> Vec<(VertexId, FaceId)> {
    if fans.is_empty() {
        return Vec::new();
    }
    // For each vertex the next of its fans that has no face yet, and the number of its corners met so far.
    let mut next = vec![[NONE, 0]; vertex_count];
    for (index, &[vertex, _]) in (0..fans.len() as u32).zip(fans).rev() {
        next[vertex as usize][0] = index;
    }
    let mut found = vec![(VertexId(0), FaceId(0)); fans.len()];
    for (face, &triangle) in (0..).zip(triangles).filter(|(_, triangle)| !has_collapsed(**triangle)) {
        for vertex in triangle {
            let [fan, corners] = &mut next[vertex as usize];
            if fans.get(*fan as usize) == Some(&[vertex, *corners]) {
                found[*fan as usize] = (VertexId(vertex), FaceId(face));
                *fan += 1;
            }
            *corners += 1;
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use std::collections::HashSet;

    use super::*;
    use crate::mesh::HalfEdgeId;
    use crate::random::SplitMix64;
    use crate::testing::shapes;
    use crate::topology::build::tests::defective;
    use crate::topology::components::Components;

    /// By union-find over corners and over vertices, without links.
    fn naive(topology: &Topology) -> Survey {
        let mut corners = Components::new(3 * topology.face_count());
        let mut vertices = Components::new(topology.vertex_count());
        let at = |half_edge: HalfEdgeId, vertex| {
            let next = topology.next(half_edge);
            if topology.tail(half_edge) == vertex { half_edge.0 } else { next.0 }
        };
        for edge in topology.edges() {
            let ends = topology.vertices(edge);
            vertices.join(ends[0].0, ends[1].0);
            for vertex in ends {
                let first = topology.half_edges(edge).next().unwrap();
                for half_edge in topology.half_edges(edge) {
                    corners.join(at(first, vertex), at(half_edge, vertex));
                }
            }
        }
        let (mut leaders, mut sets, mut repeats) = (Vec::new(), HashSet::new(), false);
        let mut used = vec![false; topology.vertex_count()];
        for face in topology.faces().filter(|&face| !topology.is_collapsed(face)) {
            let mut triangle = topology.triangles()[face.index()];
            for (corner, vertex) in (3 * face.0..).zip(triangle) {
                used[vertex as usize] = true;
                if corners.find(corner) == corner {
                    leaders.push((VertexId(vertex), face));
                }
            }
            triangle.sort_unstable();
            repeats |= !sets.insert(triangle);
        }
        leaders.sort_unstable();
        let fans =
            leaders.chunk_by(|a, b| a.0 == b.0).filter(|fans| fans.len() > 1).flatten().copied().collect();
        let components =
            (0..).zip(&used).filter(|&(vertex, &used)| used && vertices.find(vertex) == vertex).count();
        Survey { fans, vertices: used.iter().filter(|&&used| used).count(), repeats, components }
    }

    fn survey(vertices: usize, triangles: &[[u32; 3]], bits: u32) -> Survey {
        survey_by(vertices, triangles, Blocks { bits })
    }

    #[test]
    fn survey_is_that_of_union_find_over_corners_and_vertices() {
        let mut met = [0; 4];
        for seed in 0..400 {
            let (vertices, mut triangles) = defective(seed);
            if seed % 4 == 0 {
                // Several components: a copy.
                let copy: Vec<_> =
                    triangles.iter().map(|t| t.map(|vertex| vertex + vertices as u32)).collect();
                triangles.extend(copy);
            }
            if seed % 5 == 0 {
                let repeated = triangles.iter().copied().find(|&triangle| !has_collapsed(triangle)).unwrap();
                triangles.insert(seed as usize % triangles.len(), [repeated[1], repeated[0], repeated[2]]);
            }
            let expected = naive(&Topology::build(2 * vertices, triangles.clone()));
            for bits in [0, 1, 4, 16] {
                assert_eq!(survey(2 * vertices, &triangles, bits), expected, "seed {seed}, {bits} bits");
            }
            met[0] += expected.fans.len();
            met[1] += usize::from(expected.repeats);
            met[2] += usize::from(!expected.repeats);
            met[3] += usize::from(expected.components > 1);
            // Fault injected: a face of its own less changes the survey, one repeated does too.
            let lonely = [0, 1, 2].map(|i| 2 * vertices as u32 + i);
            triangles.push(lonely);
            let with = survey(2 * vertices + 3, &triangles, 0);
            assert_eq!(
                with,
                Survey { vertices: with.vertices, components: with.components, ..expected.clone() }
            );
            assert_eq!((with.vertices, with.components), (expected.vertices + 3, expected.components + 1));
            triangles.push(lonely);
            assert!(survey(2 * vertices + 3, &triangles, 0).repeats);
        }
        assert!(met.iter().all(|&met| met > 50), "{met:?}");
    }

    /// Any permutation as a link: closed fans of all sizes around vertex `of` among others, in random order.
    #[test]
    fn survey_decides_links_of_every_number_of_cycles() {
        let mut random = SplitMix64(5);
        let mut met = [0; 2];
        for round in 0..6000 {
            let degree = 1 + random.below(20);
            // Vertex numbers on both sides of the middle one.
            let names = random.permutation(degree + 1);
            let (middle, ends) = names.split_last().unwrap();
            let to = random.permutation(degree);
            // Now and then two edges to one vertex, or a fixed point, which is a face less.
            let mut triangles: Vec<[u32; 3]> = (0..degree)
                .map(|i| [*middle, ends[i], ends[to[i] as usize]])
                .filter(|triangle| !has_collapsed(*triangle))
                .collect();
            if round % 3 == 0 && !triangles.is_empty() {
                let (at, other) = (random.below(triangles.len()), random.below(degree));
                triangles[at][1 + round % 2] = ends[other];
            }
            let order = random.permutation(triangles.len());
            let triangles: Vec<_> = order.iter().map(|&i| triangles[i as usize]).collect();
            let topology = Topology::build(degree + 1, triangles.clone());
            let expected = naive(&topology);
            assert_eq!(*topology.survey(), expected, "{triangles:?}");
            met[usize::from(expected.fans.iter().any(|fan| fan.0.0 == *middle))] += 1;
        }
        assert!(met.iter().all(|&met| met > 500), "{met:?}");
    }

    #[test]
    fn survey_finds_several_closed_fans_whose_every_end_is_met_twice() {
        for (n, degree) in [(3_u32, 6), (8, 16), (9, 18)] {
            let ring = |first: u32| (0..n).map(move |i| [0, first + i, first + (i + 1) % n]);
            let cone: Vec<[u32; 3]> = ring(1).chain(ring(n + 1)).collect();
            assert_eq!(cone.len(), degree);
            let topology = Topology::build(2 * n as usize + 1, cone);
            assert_eq!(topology.non_manifold_vertices(), [(VertexId(0), 2)]);
            assert_eq!(topology.survey().fans, [(VertexId(0), FaceId(0)), (VertexId(0), FaceId(n))]);
            assert_eq!(topology.shells().count, 2);
            let topology = Topology::build(n as usize + 1, ring(1).collect::<Vec<_>>());
            assert_eq!((topology.non_manifold_vertices(), topology.shells().count), (vec![], 1));
        }
    }

    #[test]
    fn survey_of_a_shuffled_mesh_joins_its_components() {
        // In random order one vertex in seven starts a component of its own, and all of them must be joined.
        let torus = shapes::torus(160, 120, 2.0, 0.75);
        let mixed = shapes::shuffled(&torus, 7);
        let count = mixed.vertex_count();
        for bits in [0, 13] {
            let found = survey(count, mixed.triangles(), bits);
            assert_eq!(found, Survey { fans: vec![], vertices: count, repeats: false, components: 1 });
        }
        // Fault injected: only every other face, which leaves the vertices connected in fewer ways or not at
        // all.
        let half: Vec<_> = mixed.triangles().iter().step_by(2).copied().collect();
        let topology = Topology::build(count, half);
        assert_eq!(*topology.survey(), naive(&topology));
        assert!(!topology.survey().fans.is_empty());
    }

    #[test]
    fn survey_takes_a_hundred_thousand_fans_and_faces_in_linear_time() {
        const MANY: u32 = 100_000;
        // As many fans at vertex 0; as many faces at the edge of vertices 0 and 1. Quadratic time would take
        // hours.
        let fans: Vec<_> = (0..MANY).map(|i| [0, 2 * i + 1, 2 * i + 2]).collect();
        let found = survey(2 * MANY as usize + 1, &fans, 0);
        assert_eq!((found.fans.len() as u32, found.components, found.repeats), (MANY, 1, false));
        let book: Vec<_> = (0..MANY).map(|i| [0, 1, i + 2]).collect();
        let found = survey(MANY as usize + 2, &book, 0);
        assert_eq!((found.fans.len(), found.components, found.repeats), (0, 1, false));
        // One closed fan of as many faces.
        let disk: Vec<_> = (0..MANY).map(|i| [0, i + 1, (i + 1) % MANY + 1]).collect();
        assert_eq!(survey(MANY as usize + 1, &disk, 0).fans, []);
    }
}
