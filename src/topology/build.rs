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
    let bits = if is_scattered(vertex_count, &triangles) {
        let least = (vertex_count / MOST_BLOCKS).checked_ilog2().map_or(0, |log| log + 1);
        BLOCK_BITS.max(least)
    } else {
        0
    };
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
            scatter(&triangles, low, bits, blocks, &mut sorter.arcs, |_, arc| arc);
            stars.add(low, blocks, &sorter.arcs);
        } else {
            sorter.corners.resize(corners.max(sorter.corners.len()), Corner::default());
            scatter(&triangles, low, bits, blocks, &mut sorter.corners, |vertex, arc| Corner { vertex, arc });
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

/// One digit of the radix sort: writes the corners at vertices from `low` on to the places of their blocks,
/// which turn from starts into ends on the way. Within a block corners keep their order.
#[inline]
fn scatter<T>(
    triangles: &[[u32; 3]],
    low: u32,
    bits: u32,
    places: &mut [u32],
    sorted: &mut [T],
    make: impl Fn(u32, Arc) -> T,
) {
    for (face, &triangle) in (0..).zip(triangles) {
        if has_collapsed(triangle) {
            continue;
        }
        let [a, b, c] = triangle;
        for (corner, [vertex, from, to]) in (0..).zip([[a, b, c], [b, c, a], [c, a, b]]) {
            // What lies below `low` wraps around and is out of range as well.
            if let Some(place) = places.get_mut((vertex.wrapping_sub(low) >> bits) as usize) {
                sorted[*place as usize] = make(vertex, Arc::new(face, corner, from, to));
                *place += 1;
            }
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
