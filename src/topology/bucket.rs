//! Half-edges brought together at their smaller vertices: a counting sort in linear time, in the memory of the result.
//!
//! A half-edge takes as much room in the sorted list as in the edge table, and at the same place up to the order
//! of those of its vertex. So the list is made where the table will stand: the half-edges in the memory of the
//! entries, the larger vertices in that of the offsets. Those are at most as many, and come later: the offsets of the
//! first n half-edges are written when the larger vertices of these have been read.

use std::mem;

use super::has_collapsed;
use super::sort::Blocks;

/// How much is read, or written and restored, beyond the end of a list.
pub(super) const SLACK: usize = 16;

/// A block of 2¹³ vertices has some 50,000 half-edges, 400 kB: sorting it stays in the second-level cache. There are a
/// hundred blocks or so of a million vertices, three lists each: as many as the processor can write to at once.
pub(super) const BLOCK_BITS: u32 = 13;

/// The most vertices of a block: a number in it is one of 16 bits.
const MOST_BITS: u32 = 16;

/// Memory of an edge table, and what it takes to make one. All of it may be used again.
#[derive(Clone, Debug, Default)]
pub(super) struct Memory {
    /// The sorted half-edges, then the entries of the table.
    pub(super) entries: Vec<u32>,
    /// At place i + 1 the larger vertex of half-edge i, then the offsets of the table.
    pub(super) offsets: Vec<u32>,
    /// Where the half-edges of each vertex end; of each block of vertices on the way.
    ends: Vec<u32>,
    /// Where the order of the faces is random, the place of each smaller vertex in its block.
    lows: Vec<u16>,
    block: Block,
}

/// The half-edges of the block that is being sorted, as they were.
#[derive(Clone, Debug, Default)]
struct Block {
    entries: Vec<u32>,
    larger: Vec<u32>,
    ends: Vec<u32>,
}

/// Half-edges at their smaller vertices, a range of these at a time.
pub(super) trait Receive {
    /// Takes those of some vertices: where each one's end, the first starting at `start`; the half-edges as entries;
    /// and their larger vertices, one place further on.
    fn receive(&mut self, start: u32, ends: &[u32], entries: &mut [u32], offsets: &mut [u32]);
}

/// Makes a list of zeros, in memory that was used before if it is enough.
pub(super) fn zeroed<T: Clone + Default>(list: &mut Vec<T>, len: usize) {
    if list.capacity() < len {
        *list = Vec::new(); // first, so that never both are there
        *list = vec![T::default(); len]; // new pages come zeroed, and are not touched here
    } else {
        list.clear();
        list.resize(len, T::default());
    }
}

/// Makes a list long enough, whatever it holds.
fn provide<T: Clone + Default>(list: &mut Vec<T>, len: usize) {
    if list.capacity() < len { zeroed(list, len) } else { list.resize(len, T::default()) }
}

impl Memory {
    /// Takes the table out of the memory that it was made in.
    pub(super) fn table(&mut self, entry_count: usize, edges: usize) -> (Vec<u32>, Vec<u32>) {
        let (mut entries, mut offsets) = (mem::take(&mut self.entries), mem::take(&mut self.offsets));
        entries.truncate(entry_count);
        offsets[0] = 0;
        offsets.truncate(edges + 1);
        (entries, offsets)
    }

    /// Keeps the memory of a table, where it is more than what is there.
    pub(super) fn take_back(&mut self, entries: Vec<u32>, offsets: Vec<u32>) {
        for (own, other) in [(&mut self.entries, entries), (&mut self.offsets, offsets)] {
            if own.capacity() < other.capacity() {
                *own = other;
            }
        }
    }

    /// Sends the half-edges of all faces that have not collapsed to the receiver, those of ascending vertices. Gives
    /// the number of collapsed faces.
    ///
    /// # Panics
    ///
    /// Panics if an index is not below `vertex_count`.
    pub(super) fn by_smaller_vertex(
        &mut self,
        vertex_count: usize,
        triangles: &[[u32; 3]],
        Blocks { bits }: Blocks,
        receiver: &mut impl Receive,
    ) -> usize {
        let bits = bits.min(MOST_BITS);
        zeroed(&mut self.ends, vertex_count.div_ceil(1 << bits));
        let collapsed = count(vertex_count, triangles, bits, &mut self.ends);
        let (mut sum, mut most) = (0, 0);
        for end in &mut self.ends {
            most = most.max(*end as usize);
            (sum, *end) = (sum + *end, sum); // at most 3 × MAX_TRIANGLES
        }
        provide(&mut self.entries, sum as usize + SLACK);
        provide(&mut self.offsets, sum as usize + 1 + SLACK);
        let Self { entries, offsets, ends, lows, block } = self;
        if bits == 0 {
            scatter::<false>(triangles, 0, ends, entries, &mut offsets[1..], &mut []);
            receiver.receive(0, ends, entries, offsets);
            return collapsed;
        }
        provide(lows, entries.len());
        scatter::<true>(triangles, bits, ends, entries, &mut offsets[1..], lows);
        block.make_room(most);
        let mut start = 0;
        for (number, &end) in ends.iter().enumerate() {
            let vertices = (vertex_count - (number << bits)).min(1 << bits);
            let range = start as usize..end as usize;
            block.sort(
                start,
                vertices,
                &lows[range.clone()],
                &mut entries[range.clone()],
                &mut offsets[1..][range],
            );
            receiver.receive(start, &block.ends, entries, offsets);
            start = end;
        }
        collapsed
    }
}

impl Block {
    /// For so many half-edges and no more.
    fn make_room(&mut self, most: usize) {
        for list in [&mut self.entries, &mut self.larger] {
            list.clear();
            list.reserve_exact(most);
        }
    }

    /// The other digit of the sort: by vertex, within a block that starts at place `start`.
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
        let mut sum = 0;
        for end in &mut self.ends {
            (sum, *end) = (sum + *end, sum);
        }
        for ((&low, &entry), &vertex) in lows.iter().zip(&self.entries).zip(&self.larger) {
            let place = &mut self.ends[usize::from(low)];
            (entries[*place as usize], larger[*place as usize]) = (entry, vertex);
            *place += 1;
        }
        for end in &mut self.ends {
            *end += start;
        }
    }
}

/// Counts the half-edges of each block of 2^`bits` vertices; gives the number of collapsed faces.
fn count(vertex_count: usize, triangles: &[[u32; 3]], bits: u32, counts: &mut [u32]) -> usize {
    let mut collapsed = 0;
    for triangle in triangles {
        let [a, b, c] = *triangle;
        let most = a.max(b).max(c);
        assert!((most as usize) < vertex_count, "{triangle:?} of {vertex_count} vertices");
        if has_collapsed(*triangle) {
            collapsed += 1;
            continue;
        }
        // Of two half-edges the smallest vertex is the smaller one, of one the vertex in the middle.
        let least = a.min(b).min(c);
        let middle = a ^ b ^ c ^ least ^ most;
        counts[(least >> bits) as usize] += 2;
        counts[(middle >> bits) as usize] += 1;
    }
    collapsed
}

/// Writes each half-edge to the next place in the list of its smaller vertex, or of the block of that.
fn scatter<const BY_BLOCK: bool>(
    triangles: &[[u32; 3]],
    bits: u32,
    places: &mut [u32],
    entries: &mut [u32],
    larger: &mut [u32],
    lows: &mut [u16],
) {
    // Of one length, so that one look tells that a place is there.
    let larger = &mut larger[..entries.len()];
    let lows = if BY_BLOCK { &mut lows[..entries.len()] } else { &mut [] };
    let low = |vertex: u32| (vertex & ((1 << bits) - 1)) as u16;
    let list_of = |vertex: u32| (if BY_BLOCK { vertex >> bits } else { vertex }) as usize;
    for (first, &[a, b, c]) in (0..).step_by(6).zip(triangles) {
        if has_collapsed([a, b, c]) {
            continue;
        }
        // In arithmetic alone: what the processor would have to guess here it would guess wrong.
        let (least, most) = (a.min(b).min(c), a.max(b).max(c));
        let middle = a ^ b ^ c ^ least ^ most;
        // The half-edges from the least corner, the next one, the one before; and whether that next one has the most.
        let (second, third) = (u32::from(b == least), u32::from(c == least));
        let from_least = first + 2 * (second + 2 * third);
        let from_next = first + 2 * (1 + second - third);
        let from_last = first + 2 * (2 - 2 * second - third);
        let falls = u32::from(a < b) ^ u32::from(b < c) ^ u32::from(c < a);
        let swap = (middle ^ most) & 0_u32.wrapping_sub(falls);
        let place = &mut places[list_of(least)];
        let at = *place as usize;
        *place += 2;
        *entries[at..].first_chunk_mut().expect("a place for each") = [from_least, from_last | 1];
        *larger[at..].first_chunk_mut().expect("a place for each") = [middle ^ swap, most ^ swap];
        if BY_BLOCK {
            *lows[at..].first_chunk_mut().expect("a place for each") = [low(least); 2];
        }
        let place = &mut places[list_of(middle)];
        let at = *place as usize;
        *place += 1;
        (entries[at], larger[at]) = (from_next | falls, most);
        if BY_BLOCK {
            lows[at] = low(middle);
        }
    }
}
