//! The edge table in linear time, without hashing: a radix sort of the corners by vertex.

use super::star::{Arc, Stars};
use super::{Topology, has_collapsed};
use crate::mesh::MAX_TRIANGLES;

/// The corners are sorted in this many rounds, one range of vertices after the other, so that only this
/// fraction of them is in memory at a time: 36 / 4 bytes a triangle, or 48 / 4 where the order is random.
const ROUNDS: usize = 4;

/// A block of 2¹¹ vertices has some 12,000 corners, 150 kB: sorting it stays in the second-level cache.
const BLOCK_BITS: u32 = 11;

/// More blocks than this are more than the processor can write to at once.
const MOST_BLOCKS: usize = 4096;

pub(super) fn build(vertex_count: usize, triangles: Vec<[u32; 3]>) -> Topology {
    assert!(triangles.len() <= MAX_TRIANGLES, "{} triangles; at most {MAX_TRIANGLES} fit", triangles.len());
    let least = (vertex_count / MOST_BLOCKS).checked_ilog2().map_or(0, |log| log + 1);
    let bits = if is_scattered(vertex_count, &triangles) { BLOCK_BITS.max(least) } else { 0 };
    build_by(vertex_count, triangles, bits)
}

/// The same by blocks of 2^`bits` vertices; without blocks for 0.
fn build_by(vertex_count: usize, triangles: Vec<[u32; 3]>, bits: u32) -> Topology {
    let (mut ends, collapsed_faces) = corners_by_block(vertex_count, &triangles, bits);
    let kept = triangles.len() - collapsed_faces;
    let mut stars = Stars::new(vertex_count, kept);
    let mut sorter = Sorter::default();
    let mut first = 0;
    while first < ends.len() {
        // Counts turn into places as far as this round goes.
        let (mut last, mut corners) = (first, 0);
        while last < ends.len() && corners * ROUNDS <= 3 * kept {
            let count = std::mem::replace(&mut ends[last], corners as u32); // at most 3 × MAX_TRIANGLES
            corners += count as usize;
            last += 1;
        }
        let blocks = &mut ends[first..last];
        let low = (first as u32) << bits;
        if bits == 0 {
            sorter.arcs.resize((corners + Stars::SLACK).max(sorter.arcs.len()), Arc::default());
            scatter_near(&triangles, low, blocks, &mut sorter.arcs);
            stars.add(low, blocks, &sorter.arcs);
        } else {
            sorter.corners.resize(corners.max(sorter.corners.len()), Corner::default());
            scatter_far(&triangles, low, bits, blocks, &mut sorter.corners);
            sorter.finish(low, bits, blocks, vertex_count, &mut stars);
        }
        first = last;
    }
    drop((sorter, ends));
    let (offsets, entries, survey) = stars.finish();
    let topology = Topology { vertex_count, triangles, offsets, entries, collapsed_faces, survey };
    #[cfg(debug_assertions)]
    topology.validate();
    topology
}

/// Whether consecutive faces lie far apart, by a sample: then a write for each corner would miss the cache.
fn is_scattered(vertex_count: usize, triangles: &[[u32; 3]]) -> bool {
    const SAMPLE: usize = 1024;
    const NEAR: u32 = 64;
    if vertex_count >> BLOCK_BITS < 8 {
        return false; // it fits the cache whatever the order
    }
    let near = |pair: &[[u32; 3]]| pair[0].iter().any(|&a| pair[1].iter().any(|&b| a.abs_diff(b) < NEAR));
    let pairs = triangles.len().saturating_sub(1);
    let sample = pairs.min(SAMPLE);
    let together = (0..sample).filter(|i| {
        let at = i * (pairs / sample);
        near(&triangles[at..at + 2])
    });
    2 * together.count() < sample
}

/// How many corners the vertices of each block have, and how many faces have collapsed.
fn corners_by_block(vertex_count: usize, triangles: &[[u32; 3]], bits: u32) -> (Vec<u32>, usize) {
    let mut counts = vec![0_u32; vertex_count.div_ceil(1 << bits)];
    let mut collapsed = 0;
    for corners in triangles {
        let [a, b, c] = *corners;
        assert!((a.max(b).max(c) as usize) < vertex_count, "{corners:?} of {vertex_count} vertices");
        if has_collapsed(*corners) {
            collapsed += 1;
            continue;
        }
        for vertex in [a, b, c] {
            counts[(vertex >> bits) as usize] += 1;
        }
    }
    (counts, collapsed)
}

/// The radix sort in one digit: writes the corners at vertices from `low` on to the places of their vertices,
/// which turn from starts into ends on the way. The corners of a vertex keep their order.
fn scatter_near(triangles: &[[u32; 3]], low: u32, places: &mut [u32], sorted: &mut [Arc]) {
    for (face, &triangle) in (0..).zip(triangles) {
        if has_collapsed(triangle) {
            continue;
        }
        let [a, b, c] = triangle;
        for (corner, [vertex, from, to]) in (0..).zip([[a, b, c], [b, c, a], [c, a, b]]) {
            // What lies below `low` wraps around and is out of range as well.
            if let Some(place) = places.get_mut(vertex.wrapping_sub(low) as usize) {
                sorted[*place as usize] = Arc::new(face, corner, from, to);
                *place += 1;
            }
        }
    }
}

/// The first of two digits: the same by blocks of vertices.
///
/// In a shuffled mesh it is a coin toss whether a corner belongs to this round, so those that do are first
/// listed without a branch, a few triangles at a time.
fn scatter_far(triangles: &[[u32; 3]], low: u32, bits: u32, places: &mut [u32], sorted: &mut [Corner]) {
    const CHUNK: usize = 1024;
    const NEXT: [usize; 4] = [1, 2, 0, 0];
    const PREVIOUS: [usize; 4] = [2, 0, 1, 0];
    let span = (places.len() as u64) << bits;
    let mut listed = [0_u32; 3 * CHUNK + 4];
    for (first, chunk) in (0..).step_by(CHUNK).zip(triangles.chunks(CHUNK)) {
        let mut count = 0;
        for (face, &triangle) in (0..).zip(chunk) {
            if has_collapsed(triangle) {
                continue;
            }
            for (corner, vertex) in (0..).zip(triangle) {
                listed[count] = face << 2 | corner;
                count += usize::from(u64::from(vertex.wrapping_sub(low)) < span);
            }
        }
        for &code in &listed[..count] {
            let triangle = &chunk[(code >> 2) as usize];
            let corner = (code & 3) as usize;
            let (vertex, from, to) = (triangle[corner], triangle[NEXT[corner]], triangle[PREVIOUS[corner]]);
            let place = &mut places[(vertex.wrapping_sub(low) >> bits) as usize];
            sorted[*place as usize] =
                Corner { vertex, arc: Arc::new(first + (code >> 2), code & 3, from, to) };
            *place += 1;
        }
    }
}

/// A corner on its way into the order of the vertices.
#[derive(Clone, Copy, Default)]
struct Corner {
    vertex: u32,
    arc: Arc,
}

/// Memory that serves all rounds.
#[derive(Default)]
struct Sorter {
    corners: Vec<Corner>,
    arcs: Vec<Arc>,
    ends: Vec<u32>,
}

impl Sorter {
    /// The other digit: sorts each block by vertex.
    fn finish(&mut self, low: u32, bits: u32, blocks: &[u32], vertex_count: usize, stars: &mut Stars) {
        let mut start = 0;
        for (block, &end) in (0..).zip(blocks) {
            let corners = &self.corners[start as usize..end as usize];
            start = end;
            let first = low + (block << bits);
            let vertices = (vertex_count - first as usize).min(1 << bits);
            self.ends.clear();
            self.ends.resize(vertices, 0);
            for corner in corners {
                self.ends[(corner.vertex - first) as usize] += 1;
            }
            let mut sum = 0;
            for end in &mut self.ends {
                (sum, *end) = (sum + *end, sum);
            }
            self.arcs.resize((corners.len() + Stars::SLACK).max(self.arcs.len()), Arc::default());
            for corner in corners {
                let place = &mut self.ends[(corner.vertex - first) as usize];
                self.arcs[*place as usize] = corner.arc;
                *place += 1;
            }
            stars.add(first, &self.ends, &self.arcs);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::solid;
    use crate::random::SplitMix64;
    use crate::topology::Entry;

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
            let near = build_by(vertices, triangles.clone(), 0);
            assert_eq!((&near.offsets, &near.entries), (&offsets, &entries), "seed {seed}");
            for bits in [1, 4, 20] {
                assert_eq!(build_by(vertices, triangles.clone(), bits), near, "seed {seed}, {bits} bits");
            }
            // The sabotage: a face turned over.
            let kept = triangles.iter().position(|&triangle| !has_collapsed(triangle)).unwrap();
            triangles[kept].swap(0, 1);
            assert_ne!(build_by(vertices, triangles, 4).entries, entries);
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
        assert_eq!(built, build_by(mixed.vertex_count(), mixed.triangles().to_vec(), 0));
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
            let topology = build_by(vertices, triangles, 0);
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
}
