//! The edge table in linear time, without hashing: half-edges by their lower-numbered vertex, then by the
//! other one.
//!
//! At nearly every vertex of nearly every mesh each edge has two half-edges, one in each direction, and there
//! are few of them. So the lists of many vertices are sorted side by side, by a network that makes the same
//! comparisons whatever the order, and each is then tested for that. All other lists are sorted one by one.

use std::sync::{Arc, OnceLock};

use multiversion::multiversion;

use super::counting_sort::{BLOCK_BITS, Blocks, Memory, SLACK};
use super::{EdgeCounts, Entry, Topology, sorting_network};
use crate::built::note_topology;
use crate::mesh::MAX_TRIANGLES;

pub(super) fn build(vertex_count: usize, triangles: Arc<Vec<[u32; 3]>>) -> Topology {
    let mut topology = TopologyBuilder::new().build(vertex_count, triangles);
    topology.offsets.shrink_to_fit();
    topology.entries.shrink_to_fit();
    topology
}

/// A builder of edge tables that reuses its memory.
///
/// First use of memory costs more than the work here: the operating system zeroes it page by page. A builder
/// keeps its working memory, and takes back the memory of tables that are no longer needed.
///
/// Memory: between builds about 8 bytes per vertex and what was given back; tables are not cut to size, so
/// that they hold up to 26 bytes per triangle of a closed mesh instead of 18.
///
/// ```
/// use umbrage::testing::shapes;
/// use umbrage::topology::TopologyBuilder;
/// let mut builder = TopologyBuilder::new();
/// for mesh in [shapes::cube(), shapes::torus(12, 9, 2.0, 0.75)] {
///     let topology = builder.build(mesh.vertex_count(), mesh.triangles().to_vec());
///     assert!(topology.edge_counts().watertight());
///     let triangles = builder.recycle(topology);
///     assert_eq!(*triangles, mesh.triangles());
/// }
/// ```
#[derive(Clone, Debug, Default)]
pub struct TopologyBuilder {
    memory: Memory,
}

impl TopologyBuilder {
    /// A builder without memory.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// The edge table, equal to that of [`Topology::build`].
    ///
    /// # Panics
    ///
    /// As [`Topology::build`].
    #[must_use]
    pub fn build(&mut self, vertex_count: usize, triangles: impl Into<Arc<Vec<[u32; 3]>>>) -> Topology {
        let triangles = triangles.into();
        assert!(
            triangles.len() <= MAX_TRIANGLES,
            "{} triangles; at most {MAX_TRIANGLES} fit",
            triangles.len()
        );
        let blocks = Blocks::for_order_of(vertex_count, &triangles, BLOCK_BITS);
        self.build_by(vertex_count, triangles, blocks)
    }

    /// Keeps the memory of a table for the next one; gives back the triangles.
    pub fn recycle(&mut self, topology: Topology) -> Arc<Vec<[u32; 3]>> {
        let Topology { entries, offsets, triangles, .. } = topology;
        self.memory.take_back(entries, offsets);
        triangles
    }

    fn build_by(&mut self, vertex_count: usize, triangles: Arc<Vec<[u32; 3]>>, blocks: Blocks) -> Topology {
        note_topology(&triangles);
        let mut table = Table::default();
        let collapsed_faces = self.memory.by_smaller_vertex(
            vertex_count,
            &triangles,
            blocks,
            |start, ends, entries, offsets| receive(&mut table, start, ends, entries, offsets),
        );
        let (entries, offsets) = self.memory.table(3 * (triangles.len() - collapsed_faces), table.edges);
        let counts = table.counts;
        let survey = OnceLock::new();
        let topology =
            Topology { vertex_count, triangles, offsets, entries, collapsed_faces, counts, survey };
        #[cfg(debug_assertions)]
        topology.validate();
        topology
    }
}

/// Vertices whose lists are sorted side by side.
const LANES: usize = 32;

/// The edge table as far as it is built.
#[derive(Default)]
struct Table {
    edges: usize,
    counts: EdgeCounts,
    keys: Vec<u64>,
}

#[multiversion(targets("x86_64+avx2+bmi1+bmi2"))]
fn receive(table: &mut Table, mut start: u32, ends: &[u32], entries: &mut [u32], offsets: &mut [u32]) {
    for ends in ends.chunks(LANES) {
        let (mut before, mut most) = (start, 0);
        for &end in ends {
            most = most.max(end - before);
            before = end;
        }
        match most {
            0..=8 => table.add::<8>(start, ends, entries, offsets),
            9..=12 => table.add::<12>(start, ends, entries, offsets),
            _ => table.add::<16>(start, ends, entries, offsets),
        }
        start = before;
    }
}

/// Sort key of a half-edge: the higher-numbered vertex in the upper half, the entry in the lower one, as a
/// signed number.
#[inline(always)]
fn key(larger: u32, entry: u32) -> i64 {
    i64::from(larger as i32 ^ i32::MIN) << 32 | i64::from(entry)
}

/// Padding, above the keys of all half-edges: no vertex has the number `u32::MAX`.
const NOTHING: i64 = (i32::MAX as i64) << 32;

impl Table {
    /// Adds the edges from at most [`LANES`] vertices to higher-numbered ones.
    #[inline(always)]
    fn add<const N: usize>(&mut self, start: u32, ends: &[u32], entries: &mut [u32], offsets: &mut [u32]) {
        let mut keys = [[NOTHING; N]; LANES];
        let (mut at, mut are_few) = (start as usize, true);
        for (keys, &end) in keys.iter_mut().zip(ends) {
            let count = end as usize - at;
            let own: &[u32; N] = entries[at..].first_chunk().expect("slack");
            let larger: &[u32; N] = offsets[at + 1..].first_chunk().expect("slack");
            for i in 0..N {
                keys[i] = if i < count { key(larger[i], own[i]) } else { NOTHING | i as i64 };
            }
            are_few &= count <= N;
            at = end as usize;
        }
        let mut sorted = [[0; N]; LANES];
        if !(are_few && sort_pairs(&keys, &mut sorted)) {
            self.add_any(start, ends, entries, offsets);
            return;
        }
        // Store all N lanes per vertex; the next vertex overwrites those past the count, and what the last
        // one overwrote is restored.
        let end = at;
        let kept: [u32; SLACK] = *entries[end..].first_chunk().expect("slack");
        let mut at = start as usize;
        for (sorted, &end) in sorted.iter().zip(ends) {
            *entries[at..].first_chunk_mut().expect("slack") = *sorted;
            at = end as usize;
        }
        *entries[end..].first_chunk_mut().expect("slack") = kept;
        let count = (end - start as usize) / 2;
        for (offset, i) in offsets[self.edges + 1..][..count].iter_mut().zip(1..) {
            *offset = start + 2 * i;
        }
        self.edges += count;
        self.counts.max_faces = self.counts.max_faces.max(2 * usize::from(count > 0));
    }

    /// Adds any edges from some vertices to higher-numbered ones.
    #[cold]
    #[inline(never)]
    fn add_any(&mut self, mut start: u32, ends: &[u32], entries: &mut [u32], offsets: &mut [u32]) {
        for &end in ends {
            let range = start as usize..end as usize;
            self.keys.clear();
            let larger = &offsets[1..][range.clone()];
            self.keys
                .extend(larger.iter().zip(&entries[range]).map(|(&v, &e)| u64::from(v) << 32 | u64::from(e)));
            self.keys.sort_unstable();
            for edge in self.keys.chunk_by(|a, b| a >> 32 == b >> 32) {
                let sum = edge.iter().map(|&key| Entry(key as u32).direction()).sum();
                self.counts.add(edge.len(), sum);
                for (entry, &key) in entries[start as usize..].iter_mut().zip(edge) {
                    *entry = key as u32;
                }
                start += edge.len() as u32;
                self.edges += 1;
                offsets[self.edges] = start;
            }
        }
    }
}

/// Sorts each list; gives whether every edge has exactly two half-edges, in opposite directions.
// The body of the outer loop has no branch, so that the compiler vectorizes over the lists.
#[inline(always)]
fn sort_pairs<const N: usize>(lists: &[[i64; N]; LANES], sorted: &mut [[u32; N]; LANES]) -> bool {
    let mut wrong = 0;
    for lane in 0..LANES {
        let mut keys = lists[lane];
        sorting_network::sort(&mut keys);
        for i in (0..N).step_by(2) {
            let differ = keys[i] ^ keys[i + 1];
            wrong |= differ >> 32 | differ & 1 ^ 1;
        }
        for i in (2..N).step_by(2) {
            wrong |= i64::from(keys[i - 1] >> 32 == keys[i] >> 32) & i64::from(keys[i] < NOTHING);
        }
        for i in 0..N {
            sorted[lane][i] = keys[i] as u32;
        }
    }
    wrong == 0
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::random::SplitMix64;
    use crate::testing::shapes;
    use crate::topology::counting_sort::is_scattered;
    use crate::topology::has_collapsed;

    fn build(vertex_count: usize, triangles: Vec<[u32; 3]>) -> Topology {
        Topology::build(vertex_count, triangles)
    }

    fn build_by(vertex_count: usize, triangles: Vec<[u32; 3]>, blocks: Blocks) -> Topology {
        TopologyBuilder::new().build_by(vertex_count, triangles.into(), blocks)
    }

    /// The edge table by sorting all half-edges at once.
    fn naive(triangles: &[[u32; 3]]) -> (Vec<u32>, Vec<u32>) {
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
        (offsets, half_edges.iter().map(|half_edge| half_edge.2 << 1 | u32::from(half_edge.3)).collect())
    }

    /// Triangles over few vertices, so that edges of many faces, collapsed faces and pinched vertices abound,
    /// among the triangles of a sound surface.
    pub(in crate::topology) fn defective(seed: u64) -> (usize, Vec<[u32; 3]>) {
        let mut random = SplitMix64(seed);
        let torus = shapes::shuffled(&shapes::torus(12, 9, 2.0, 0.75), seed);
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
            let mut counts = Vec::new();
            for bits in [0, 1, 4, 16] {
                let topology = build_by(vertices, triangles.clone(), Blocks { bits });
                assert_eq!((&topology.offsets, &topology.entries), (&offsets, &entries), "seed {seed}");
                counts.push(topology.counts);
            }
            assert!(counts.iter().all(|other| *other == counts[0]), "seed {seed}");
            // Fault injected: a face turned over.
            let kept = triangles.iter().position(|&triangle| !has_collapsed(triangle)).unwrap();
            triangles[kept].swap(0, 1);
            assert_ne!(build_by(vertices, triangles, Blocks { bits: 4 }).entries, entries);
        }
    }

    #[test]
    fn build_takes_scattered_meshes_by_blocks() {
        let torus = shapes::torus(160, 120, 2.0, 0.75);
        let mixed = shapes::shuffled(&torus, 7);
        assert!(!is_scattered(torus.vertex_count(), torus.triangles()));
        assert!(is_scattered(mixed.vertex_count(), mixed.triangles()));
        let built = Topology::of(&mixed);
        assert_eq!((built.offsets.clone(), built.entries.clone()), naive(mixed.triangles()));
        assert_eq!(built, build_by(mixed.vertex_count(), mixed.triangles().to_vec(), Blocks { bits: 0 }));
        assert_eq!((built.shells().count, built.non_manifold_vertices().len()), (1, 0));
    }

    #[test]
    fn builder_gives_in_used_memory_what_new_memory_gives() {
        let (mut builder, mut random) = (TopologyBuilder::new(), SplitMix64(3));
        let mut waiting: Vec<Topology> = Vec::new();
        for round in 0..120 {
            // Larger, smaller, empty; in order and not; given back at once, later, or never.
            let (vertices, triangles) = match round % 4 {
                0 => defective(round),
                1 => (0, Vec::new()),
                2 => {
                    let n = 3 + random.below(40) as u32;
                    let torus = shapes::torus(n, n, 2.0, 0.75);
                    (torus.vertex_count(), torus.triangles().to_vec())
                }
                _ => (5, vec![[0, 1, 2], [2, 1, 0], [3, 3, 4]]),
            };
            let (offsets, entries) = naive(&triangles);
            let bits = [0, 3, 16][random.below(3)];
            let built = builder.build_by(vertices, triangles.clone().into(), Blocks { bits });
            assert_eq!((&built.offsets, &built.entries), (&offsets, &entries), "round {round}");
            assert_eq!(
                built.edge_counts(),
                build_by(vertices, triangles.clone(), Blocks { bits: 0 }).edge_counts()
            );
            waiting.push(built);
            if random.below(3) > 0 {
                let other = waiting.swap_remove(random.below(waiting.len()));
                let expected = other.triangles.clone();
                assert_eq!(builder.recycle(other), expected);
            }
            // Fault injected: a face less.
            if let Some((_, fewer)) = triangles.split_last().filter(|(last, _)| !has_collapsed(**last)) {
                assert_ne!(
                    builder.build_by(vertices, fewer.to_vec().into(), Blocks { bits }).entries,
                    entries
                );
            }
        }
    }

    #[test]
    fn build_takes_vertices_of_every_number_of_edges() {
        // Fans around a vertex among sound ones: 1 to 40 faces, closed and open, so that lists of all lengths
        // lie side by side, in every lane of those that are sorted together.
        for faces in 1..=40_u32 {
            for closed in [false, true] {
                let torus = shapes::torus(12, 9, 2.0, 0.75);
                let first = torus.vertex_count() as u32;
                let mut triangles = torus.triangles().to_vec();
                let middle = faces % first;
                let end = |i: u32| first + if closed { i % faces } else { i };
                triangles.extend((0..faces).map(|i| [middle, end(i), end(i + 1)]));
                let built = build((first + faces + 1) as usize, triangles.clone());
                assert_eq!((built.offsets, built.entries), naive(&triangles), "{faces} faces, {closed}");
            }
        }
    }

    #[test]
    fn build_takes_for_pairs_only_what_is_pairs() {
        // Faces around vertex 0, each with two edges there, whose other ends are drawn from two sets of four.
        // Single edges in one direction, pairs in the same one, triples.
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
