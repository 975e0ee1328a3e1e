//! Counting sort of the half-edges by their lower-numbered vertex, done in the buffers that will hold the
//! finished edge table.
//!
//! A sorted half-edge and a table entry have the same size, and their positions differ only within one
//! vertex, so half-edge ids are sorted directly in `entries`; the other endpoint is kept in `offsets`, which
//! is overwritten only after it has been read: a table has at most as many edges as half-edges, and the
//! offsets of the first n half-edges are written after the endpoints of these have been read.

use std::mem;

use super::has_collapsed;

/// Elements that may be read, or written and restored, past the end of a list.
pub(super) const SLACK: usize = 16;

/// Vertices per block, as a power of two, for half-edges. A block of 2¹³ vertices has about 50,000 half-edges
/// (400 kB), which are sorted within the second-level cache. A million vertices make some hundred blocks of
/// three lists each: about as many write streams as a processor sustains.
pub(super) const BLOCK_BITS: u32 = 13;

/// The largest block, as a power of two: an index within it has 16 bits.
const MAX_BLOCK_BITS: u32 = 16;

/// Blocks beyond which the write streams of the first digit no longer fit the processor's buffers.
const MAX_BLOCKS: usize = 4096;

/// Radix of the sort by vertex.
#[derive(Clone, Copy, Debug)]
pub(super) struct Blocks {
    /// Blocks of 2^`bits` vertices are sorted in two digits; 0 sorts in one digit, without blocks.
    pub(super) bits: u32,
}

impl Blocks {
    /// One digit if the order of the faces keeps to the cache, otherwise blocks of 2^`bits` vertices, or
    /// larger ones for a large mesh.
    pub(super) fn for_order_of(vertex_count: usize, triangles: &[[u32; 3]], bits: u32) -> Self {
        let least = (vertex_count / MAX_BLOCKS).checked_ilog2().map_or(0, |log| log + 1);
        let bits = if is_scattered(vertex_count, triangles) { bits.max(least) } else { 0 };
        Self { bits: bits.min(MAX_BLOCK_BITS) }
    }

    /// The number of blocks.
    pub(super) fn count(self, vertex_count: usize) -> usize {
        vertex_count.div_ceil(1 << self.bits)
    }

    /// The block of a vertex.
    #[inline(always)]
    pub(super) fn of(self, vertex: u32) -> usize {
        (vertex >> self.bits) as usize
    }

    /// The index of a vertex within its block.
    #[inline(always)]
    pub(super) fn low(self, vertex: u32) -> u16 {
        (vertex & ((1 << self.bits) - 1)) as u16
    }
}

/// Whether consecutive faces have distant vertices, estimated from a sample: then a write per corner would
/// miss the cache.
pub(super) fn is_scattered(vertex_count: usize, triangles: &[[u32; 3]]) -> bool {
    const SAMPLE: usize = 1024;
    const NEAR: u32 = 64;
    if vertex_count < 1 << 14 {
        return false; // fits the cache in any order
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

/// Turns counts into the positions where their lists start; gives the sum and the largest count.
pub(super) fn starts_of(counts: &mut [u32]) -> (u32, u32) {
    let (mut sum, mut most) = (0, 0);
    for count in counts {
        most = most.max(*count);
        (sum, *count) = (sum + *count, sum); // at most 3 × MAX_TRIANGLES
    }
    (sum, most)
}

/// Buffers of an edge table and of its construction, all reusable.
#[derive(Clone, Debug, Default)]
pub(super) struct Memory {
    /// The sorted half-edges, then the entries of the table.
    pub(super) entries: Vec<u32>,
    /// At index i + 1 the higher-numbered vertex of half-edge i, then the offsets of the table.
    pub(super) offsets: Vec<u32>,
    /// End of the half-edges of each vertex; while sorting in two digits, of each block of vertices.
    ends: Vec<u32>,
    /// When sorting in two digits: the index of each lower-numbered vertex within its block.
    lows: Vec<u16>,
    block: Block,
}

/// A copy of the half-edges of the block that is being sorted.
#[derive(Clone, Debug, Default)]
struct Block {
    entries: Vec<u32>,
    larger: Vec<u32>,
    ends: Vec<u32>,
}

/// Fills `list` with `len` zeros, reusing its memory if that suffices.
pub(super) fn zeroed<T: Clone + Default>(list: &mut Vec<T>, len: usize) {
    if list.capacity() < len {
        *list = Vec::new(); // free the old buffer first, to keep the peak low
        *list = vec![T::default(); len]; // zeroed lazily by the system
    } else {
        list.clear();
        list.resize(len, T::default());
    }
}

/// Resizes `list` to `len` elements of unspecified value.
fn provide<T: Clone + Default>(list: &mut Vec<T>, len: usize) {
    if list.capacity() < len { zeroed(list, len) } else { list.resize(len, T::default()) }
}

impl Memory {
    /// Takes the table out of the buffers that it was built in.
    pub(super) fn table(&mut self, entry_count: usize, edges: usize) -> (Vec<u32>, Vec<u32>) {
        let (mut entries, mut offsets) = (mem::take(&mut self.entries), mem::take(&mut self.offsets));
        entries.truncate(entry_count);
        offsets[0] = 0;
        offsets.truncate(edges + 1);
        (entries, offsets)
    }

    /// Keeps the buffers of a table where they are larger than the present ones.
    pub(super) fn take_back(&mut self, entries: Vec<u32>, offsets: Vec<u32>) {
        for (own, other) in [(&mut self.entries, entries), (&mut self.offsets, offsets)] {
            if own.capacity() < other.capacity() {
                *own = other;
            }
        }
    }

    /// Sorts the half-edges of all faces that have not collapsed. Gives the number of collapsed faces.
    ///
    /// `receive` is called for ranges of ascending vertices, with: the start of the first vertex's
    /// half-edges; the end of each vertex's; the half-edges as entries; and their higher-numbered vertices,
    /// shifted by one index.
    ///
    /// # Panics
    ///
    /// Panics if an index is not below `vertex_count`.
    pub(super) fn by_smaller_vertex(
        &mut self,
        vertex_count: usize,
        triangles: &[[u32; 3]],
        blocks: Blocks,
        mut receive: impl FnMut(u32, &[u32], &mut [u32], &mut [u32]),
    ) -> usize {
        zeroed(&mut self.ends, blocks.count(vertex_count));
        let collapsed = count(vertex_count, triangles, blocks, &mut self.ends);
        let (sum, most) = starts_of(&mut self.ends);
        provide(&mut self.entries, sum as usize + SLACK);
        provide(&mut self.offsets, sum as usize + 1 + SLACK);
        let Self { entries, offsets, ends, lows, block } = self;
        if blocks.bits == 0 {
            scatter::<false>(triangles, blocks, ends, entries, &mut offsets[1..], &mut []);
            receive(0, ends, entries, offsets);
            return collapsed;
        }
        provide(lows, entries.len());
        scatter::<true>(triangles, blocks, ends, entries, &mut offsets[1..], lows);
        block.make_room(most as usize);
        let mut start = 0;
        for (number, &end) in ends.iter().enumerate() {
            let vertices = (vertex_count - (number << blocks.bits)).min(1 << blocks.bits);
            let range = start as usize..end as usize;
            block.sort(
                start,
                vertices,
                &lows[range.clone()],
                &mut entries[range.clone()],
                &mut offsets[1..][range],
            );
            receive(start, &block.ends, entries, offsets);
            start = end;
        }
        collapsed
    }
}

impl Block {
    /// Reserves exactly `most` half-edges.
    fn make_room(&mut self, most: usize) {
        for list in [&mut self.entries, &mut self.larger] {
            list.clear();
            list.reserve_exact(most);
        }
    }

    /// The second digit of the sort: by vertex within the block, whose half-edges begin at `start`.
    fn sort(&mut self, start: u32, vertices: usize, lows: &[u16], entries: &mut [u32], larger: &mut [u32]) {
        let larger = &mut larger[..entries.len()];
        self.entries.clear();
        self.entries.extend_from_slice(entries);
        self.larger.clear();
        self.larger.extend_from_slice(larger);
        zeroed(&mut self.ends, vertices);
        for &low in lows {
            self.ends[usize::from(low)] += 1;
        }
        starts_of(&mut self.ends);
        for ((&low, &entry), &vertex) in lows.iter().zip(&self.entries).zip(&self.larger) {
            let at = &mut self.ends[usize::from(low)];
            (entries[*at as usize], larger[*at as usize]) = (entry, vertex);
            *at += 1;
        }
        for end in &mut self.ends {
            *end += start;
        }
    }
}

/// Counts the half-edges of each block; gives the number of collapsed faces.
fn count(vertex_count: usize, triangles: &[[u32; 3]], blocks: Blocks, counts: &mut [u32]) -> usize {
    let mut collapsed = 0;
    for triangle in triangles {
        let [a, b, c] = *triangle;
        let most = a.max(b).max(c);
        assert!((most as usize) < vertex_count, "{triangle:?} of {vertex_count} vertices");
        if has_collapsed(*triangle) {
            collapsed += 1;
            continue;
        }
        // The least corner is the lower-numbered vertex of two half-edges, the middle one of one.
        let least = a.min(b).min(c);
        let middle = a ^ b ^ c ^ least ^ most;
        counts[blocks.of(least)] += 2;
        counts[blocks.of(middle)] += 1;
    }
    collapsed
}

/// Writes each half-edge to the next free slot of its lower-numbered vertex, or of the block of that vertex.
fn scatter<const BY_BLOCK: bool>(
    triangles: &[[u32; 3]],
    blocks: Blocks,
    slots: &mut [u32],
    entries: &mut [u32],
    larger: &mut [u32],
    lows: &mut [u16],
) {
    // Same length as `entries`, so one bounds check covers all lists.
    let larger = &mut larger[..entries.len()];
    let lows = if BY_BLOCK { &mut lows[..entries.len()] } else { &mut [] };
    let list_of = |vertex: u32| if BY_BLOCK { blocks.of(vertex) } else { vertex as usize };
    for (first, &[a, b, c]) in (0..).step_by(6).zip(triangles) {
        if has_collapsed([a, b, c]) {
            continue;
        }
        // Branch-free: these comparisons are unpredictable, and branches would be mispredicted.
        let (least, most) = (a.min(b).min(c), a.max(b).max(c));
        let middle = a ^ b ^ c ^ least ^ most;
        // The half-edges from the least corner, from the next one, and from the previous one; `falls` is 1 if
        // the next corner is the largest.
        let (second, third) = (u32::from(b == least), u32::from(c == least));
        let from_least = first + 2 * (second + 2 * third);
        let from_next = first + 2 * (1 + second - third);
        let from_last = first + 2 * (2 - 2 * second - third);
        let falls = u32::from(a < b) ^ u32::from(b < c) ^ u32::from(c < a);
        let swap = (middle ^ most) & 0_u32.wrapping_sub(falls);
        let slot = &mut slots[list_of(least)];
        let at = *slot as usize;
        *slot += 2;
        *entries[at..].first_chunk_mut().expect("a slot for each") = [from_least, from_last | 1];
        *larger[at..].first_chunk_mut().expect("a slot for each") = [middle ^ swap, most ^ swap];
        if BY_BLOCK {
            *lows[at..].first_chunk_mut().expect("a slot for each") = [blocks.low(least); 2];
        }
        let slot = &mut slots[list_of(middle)];
        let at = *slot as usize;
        *slot += 1;
        (entries[at], larger[at]) = (from_next | falls, most);
        if BY_BLOCK {
            lows[at] = blocks.low(middle);
        }
    }
}
