//! The edge table in linear time, without hashing: half-edges by the smaller vertex, then by the larger one.
//!
//! Each half-edge is sent to the smaller of its vertices. There the edges are told apart: at nearly every vertex
//! of nearly every mesh each has two half-edges, one in each direction; that is tested, and they are put in order
//! on the way, without a branch that depends on the order of the faces. All else goes the long way.

use std::sync::OnceLock;

use super::sort::{self, Blocks, NEXT, Receive, Send};
use super::star::{Arcs, Stars};
use super::{EdgeCounts, Entry, Topology};
use crate::mesh::MAX_TRIANGLES;

pub(super) fn build(vertex_count: usize, triangles: Vec<[u32; 3]>) -> Topology {
    assert!(triangles.len() <= MAX_TRIANGLES, "{} triangles; at most {MAX_TRIANGLES} fit", triangles.len());
    let blocks = Blocks::for_order_of(vertex_count, &triangles);
    build_by(vertex_count, triangles, blocks)
}

fn build_by(vertex_count: usize, triangles: Vec<[u32; 3]>, blocks: Blocks) -> Topology {
    let mut table = Table::default();
    let collapsed_faces = sort::by_vertex(vertex_count, &triangles, blocks, HalfEdges, &mut table);
    let (offsets, entries, counts) = table.finish();
    let survey = OnceLock::new();
    let topology = Topology { vertex_count, triangles, offsets, entries, collapsed_faces, counts, survey };
    #[cfg(debug_assertions)]
    topology.validate();
    topology
}

/// The same with all that the stars of the vertices tell.
pub(super) fn build_surveyed(vertex_count: usize, triangles: Vec<[u32; 3]>) -> Topology {
    assert!(triangles.len() <= MAX_TRIANGLES, "{} triangles; at most {MAX_TRIANGLES} fit", triangles.len());
    let blocks = Blocks::for_order_of(vertex_count, &triangles);
    build_surveyed_by(vertex_count, triangles, blocks)
}

fn build_surveyed_by(vertex_count: usize, triangles: Vec<[u32; 3]>, blocks: Blocks) -> Topology {
    let mut stars = Stars::new(vertex_count);
    let collapsed_faces = sort::by_vertex(vertex_count, &triangles, blocks, Arcs, &mut stars);
    let (offsets, entries, counts, survey) = stars.finish();
    let survey = OnceLock::from(survey);
    let topology = Topology { vertex_count, triangles, offsets, entries, collapsed_faces, counts, survey };
    #[cfg(debug_assertions)]
    topology.validate();
    topology
}

/// Half-edges at their smaller vertices: the larger one, and the entry of the edge table.
#[derive(Clone, Copy)]
struct HalfEdges;

impl Send<2> for HalfEdges {
    #[inline(always)]
    fn send(self, face: u32, corner: usize, triangle: &[u32; 3]) -> (u32, [u32; 2]) {
        let (tail, head) = (triangle[corner], triangle[NEXT[corner]]);
        let half_edge = 3 * face + corner as u32;
        (tail.min(head), [tail.max(head), half_edge << 1 | u32::from(tail > head)])
    }
}

/// How much is written beyond the end of the table.
const SLACK: usize = 16;

/// The edge table as far as it is made.
#[derive(Default)]
struct Table {
    /// With room for what is written beyond the end.
    offsets: Vec<u32>,
    edges: usize,
    /// The same.
    entries: Vec<u32>,
    entry_count: usize,
    counts: EdgeCounts,
    keys: Vec<u64>,
}

impl Table {
    /// Adds the edges from a vertex to larger ones if each has two half-edges, one in each direction; else leaves
    /// everything as it is. Of the items only the first `count` count.
    #[inline]
    fn pairs<const N: usize>(&mut self, items: &[[u32; 2]; N], count: usize) -> bool {
        let Placed { places, odd } = &places(items, count);
        // Every place from 0 on must be taken; those of what does not count lie beyond.
        let (mut taken, mut sorted) = (0_u32, [0_u32; 32]);
        for i in 0..N {
            taken |= 1 << (places[i] % 32);
            sorted[places[i] as usize % 32] = items[i][1];
        }
        let all = (1 << count) - 1;
        if odd & 1 != 0 || taken & all != all {
            return false;
        }
        // All places are written, those that count stay.
        let room = &mut self.entries[self.entry_count..][..N];
        for (room, pair) in room.as_chunks_mut::<2>().0.iter_mut().zip(sorted.as_chunks::<2>().0) {
            *room = [pair[0].min(pair[1]), pair[0].max(pair[1])];
        }
        if self.offsets.len() < self.edges + 1 + N {
            self.grow_offsets();
        }
        let start = self.entry_count as u32 + 2;
        for (offset, i) in self.offsets[self.edges + 1..][..N / 2].iter_mut().zip(0..) {
            *offset = start + 2 * i;
        }
        self.entry_count += count;
        self.edges += count / 2;
        true
    }

    #[cold]
    fn grow_offsets(&mut self) {
        self.offsets.resize(self.offsets.len() / 2 * 3 + 2 * SLACK, 0);
    }

    /// Adds any edges from a vertex to larger ones.
    fn any(&mut self, items: &[[u32; 2]]) {
        let mut keys = std::mem::take(&mut self.keys);
        keys.clear();
        keys.extend(items.iter().map(|&[larger, entry]| u64::from(larger) << 32 | u64::from(entry)));
        keys.sort_unstable();
        for edge in keys.chunk_by(|a, b| a >> 32 == b >> 32) {
            let entries = edge.iter().map(|&key| key as u32);
            for (place, entry) in self.entries[self.entry_count..].iter_mut().zip(entries.clone()) {
                *place = entry;
            }
            self.entry_count += edge.len();
            self.edges += 1;
            if self.offsets.len() <= self.edges {
                self.grow_offsets();
            }
            self.offsets[self.edges] = self.entry_count as u32;
            self.counts.add(edge.len(), entries.map(|entry| Entry(entry).direction()).sum());
        }
        self.keys = keys;
    }

    fn finish(self) -> (Vec<u32>, Vec<Entry>, EdgeCounts) {
        let Self { mut offsets, edges, mut entries, entry_count, counts, .. } = self;
        offsets.truncate(edges + 1);
        offsets.shrink_to_fit();
        entries.truncate(entry_count);
        entries.shrink_to_fit();
        (offsets, entries.into_iter().map(Entry).collect(), counts) // in place
    }
}

impl Receive<2> for Table {
    /// 24 / 2 bytes a triangle, or 36 / 3.
    const ROUNDS: usize = 2;

    fn prepare(&mut self, items: usize) {
        self.offsets = vec![0; items / 2 + 1 + SLACK];
        self.entries = vec![0; items + SLACK];
    }

    fn receive(&mut self, _: u32, ends: &[u32], items: &[[u32; 2]]) {
        let mut start = 0;
        for &end in ends {
            let (at, count) = (start as usize, (end - start) as usize);
            start = end;
            let are_pairs = match count {
                0 => continue,
                1..=8 => self.pairs::<8>(items[at..].first_chunk().expect("slack"), count),
                9..=12 => self.pairs::<12>(items[at..].first_chunk().expect("slack"), count),
                13..=16 => self.pairs::<16>(items[at..].first_chunk().expect("slack"), count),
                _ => false,
            };
            if are_pairs {
                self.counts.max_faces = self.counts.max_faces.max(2);
            } else {
                self.any(&items[at..at + count]);
            }
        }
    }
}

/// Ones for the items that count, zeros beyond: of a number n from place 16 − n on.
pub(super) const KEEP: [i32; 32] = {
    let mut keep = [0; 32];
    let mut i = 0;
    while i < 16 {
        keep[i] = -1;
        i += 1;
    }
    keep
};

/// Where the items belong if they are pairs.
struct Placed<const N: usize> {
    /// The half-edges of an edge have the same rank, the number of those that come before. The one against the edge
    /// has the place behind the other.
    places: [u32; N],
    /// Where all are pairs, ranks are even, and so is this.
    odd: u32,
}

/// Compares the first `count` items with each other, each with each. The others get places from `count` on.
// On its own it becomes vector instructions; in place its results would be taken apart too soon.
#[inline(never)]
fn places<const N: usize>(items: &[[u32; 2]; N], count: usize) -> Placed<N> {
    let keep: &[i32; N] = KEEP[16 - count..].first_chunk().expect("there are 16 at most");
    let mut vertices = [0; N];
    for i in 0..N {
        // Compared as signed numbers, which is an instruction; the order is the same.
        vertices[i] = (items[i][0] ^ 1 << 31) as i32 & keep[i] | i32::MAX & !keep[i];
    }
    let mut ranks = [0; N];
    for other in vertices {
        for i in 0..N {
            ranks[i] += u32::from(other < vertices[i]);
        }
    }
    let mut places = [0; N];
    for i in 0..N {
        places[i] = ranks[i] + (items[i][1] & 1);
    }
    Placed { places, odd: ranks.iter().fold(0, |odd, rank| odd | rank) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::solid;
    use crate::random::SplitMix64;
    use crate::topology::has_collapsed;
    use crate::topology::sort::is_scattered;

    /// The edge table by sorting all half-edges at once.
    fn naive(triangles: &[[u32; 3]]) -> (Vec<u32>, Vec<Entry>) {
        let mut half_edges = Vec::new();
        for (face, &[a, b, c]) in (0..).zip(triangles).filter(|(_, triangle)| !has_collapsed(**triangle)) {
            for (corner, (tail, head)) in (0..).zip([(a, b), (b, c), (c, a)]) {
                half_edges.push((tail.min(head), tail.max(head), 3 * face + corner, tail > head));
            }
        }
        half_edges.sort_unstable();
        let mut offsets = vec![0];
        for edge in half_edges.chunk_by(|x, y| (x.0, x.1) == (y.0, y.1)) {
            offsets.push(offsets[offsets.len() - 1] + edge.len() as u32);
        }
        (
            offsets,
            half_edges.iter().map(|half_edge| Entry(half_edge.2 << 1 | u32::from(half_edge.3))).collect(),
        )
    }

    /// Triangles over few vertices, so that edges of many faces, collapsed faces and pinched vertices abound,
    /// among the triangles of a sound surface.
    fn defective(seed: u64) -> (usize, Vec<[u32; 3]>) {
        let mut random = SplitMix64(seed);
        let torus = solid::shuffled(&solid::torus(12, 9, 2.0, 0.75), seed);
        let vertices = torus.vertex_count() + 20;
        let mut triangles = torus.triangles().to_vec();
        for _ in 0..random.below(80) {
            triangles.push(std::array::from_fn(|_| random.below(vertices) as u32));
        }
        for _ in 0..random.below(40) {
            triangles.swap_remove(random.below(triangles.len()));
        }
        (vertices, triangles)
    }

    #[test]
    fn build_sorts_like_one_sort_of_all_half_edges() {
        for seed in 0..200 {
            let (vertices, mut triangles) = defective(seed);
            let (offsets, entries) = naive(&triangles);
            let mut surveys = Vec::new();
            for bits in [0, 1, 4, 20] {
                for build in [build_by, build_surveyed_by] {
                    let topology = build(vertices, triangles.clone(), Blocks { bits });
                    assert_eq!((&topology.offsets, &topology.entries), (&offsets, &entries), "seed {seed}");
                    surveys.push((topology.counts, topology.survey().clone()));
                }
            }
            assert!(surveys.iter().all(|survey| *survey == surveys[0]), "seed {seed}");
            // The sabotage: a face turned over.
            let kept = triangles.iter().position(|&triangle| !has_collapsed(triangle)).unwrap();
            triangles[kept].swap(0, 1);
            assert_ne!(build_by(vertices, triangles, Blocks { bits: 4 }).entries, entries);
        }
    }

    #[test]
    fn build_takes_scattered_meshes_by_blocks() {
        let torus = solid::torus(160, 120, 2.0, 0.75);
        let mixed = solid::shuffled(&torus, 7);
        assert!(!is_scattered(torus.vertex_count(), torus.triangles()));
        assert!(is_scattered(mixed.vertex_count(), mixed.triangles()));
        let built = build(mixed.vertex_count(), mixed.triangles().to_vec());
        assert_eq!((built.offsets.clone(), built.entries.clone()), naive(mixed.triangles()));
        assert_eq!(built, build_by(mixed.vertex_count(), mixed.triangles().to_vec(), Blocks { bits: 0 }));
        assert_eq!((built.shells().count, built.non_manifold_vertices().len()), (1, 0));
    }

    /// By union-find over the corners of the faces, which no star has a part in.
    fn naive_fans(topology: &Topology) -> Vec<(u32, u32)> {
        let corners = 3 * topology.face_count();
        let mut sets = crate::topology::Components::new(corners);
        let at = |half_edge: crate::mesh::HalfEdgeId, vertex| {
            let other = topology.next(half_edge);
            if topology.tail(half_edge) == vertex { half_edge.0 } else { other.0 }
        };
        for edge in topology.edges() {
            for vertex in topology.vertices(edge) {
                let first = topology.half_edges(edge).next().unwrap();
                for half_edge in topology.half_edges(edge) {
                    sets.join(at(first, vertex), at(half_edge, vertex));
                }
            }
        }
        let mut fans = vec![0; topology.vertex_count()];
        for (corner, vertex) in (0..).zip(topology.triangles().as_flattened()) {
            let collapsed = has_collapsed(topology.triangles()[corner as usize / 3]);
            fans[*vertex as usize] += u32::from(!collapsed && sets.find(corner) == corner);
        }
        (0..).zip(fans).filter(|&(_, fans)| fans > 1).collect()
    }

    #[test]
    fn build_finds_the_fans_of_rings_and_tangles() {
        let mut found = 0;
        for seed in 0..200 {
            let (vertices, triangles) = defective(seed);
            let topology = build_by(vertices, triangles, Blocks { bits: 0 });
            let fans: Vec<_> = topology.non_manifold_vertices().iter().map(|&(v, n)| (v.0, n)).collect();
            assert_eq!(fans, naive_fans(&topology), "seed {seed}");
            found += fans.len();
        }
        assert!(found > 100, "{found} vertices of several fans");
        // Closed fans alone: every end is met once coming and once going, yet there are two rings.
        for (n, degree) in [(3_u32, 6), (8, 16), (9, 18)] {
            let ring = |first: u32| (0..n).map(move |i| [0, first + i, first + (i + 1) % n]);
            let cone: Vec<[u32; 3]> = ring(1).chain(ring(n + 1)).collect();
            assert_eq!(cone.len(), degree);
            let topology = build(2 * n as usize + 1, cone);
            assert_eq!(topology.non_manifold_vertices(), [(crate::mesh::VertexId(0), 2)]);
            assert_eq!(topology.shells().count, 2);
            let topology = build(n as usize + 1, ring(1).collect());
            assert_eq!((topology.non_manifold_vertices(), topology.shells().count), (vec![], 1));
        }
    }

    #[test]
    fn build_takes_for_pairs_only_what_is_pairs() {
        // Faces around vertex 0, each with two edges there: all ways for up to six of them to have one other end
        // of four, or none, on either side. Single edges in one direction, pairs in the same one, triples.
        let ends = |code: u32, i: u32| [1 + (code >> (4 * i) & 3), 5 + (code >> (4 * i + 2) & 3)];
        let mut random = SplitMix64(1);
        for faces in 1..=8 {
            for _ in 0..400 {
                let code = random.next() as u32;
                let triangles: Vec<[u32; 3]> = (0..faces)
                    .map(|i| {
                        let [a, b] = ends(code, i);
                        if random.below(2) == 0 { [0, a, b] } else { [0, b, a] }
                    })
                    .collect();
                let built = build(9, triangles.clone());
                assert_eq!((built.offsets, built.entries), naive(&triangles), "{triangles:?}");
            }
        }
    }
}
