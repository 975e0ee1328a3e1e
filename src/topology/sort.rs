//! What belongs to a vertex, brought together: a radix sort by vertex, in linear time and without hashing.

use super::has_collapsed;

/// More blocks than this are more than the processor can write to at once.
const MOST_BLOCKS: usize = 4096;

/// The corners before and after each corner of a face, with a place for the fourth that two bits can name.
pub(super) const NEXT: [usize; 4] = [1, 2, 0, 0];
pub(super) const PREVIOUS: [usize; 4] = [2, 0, 1, 0];

/// Which vertex each corner of a face sends an item to, and which.
pub(super) trait Send<const N: usize>: Copy {
    /// `corner` is 0, 1 or 2; `face` is below [`MAX_TRIANGLES`](crate::mesh::MAX_TRIANGLES).
    fn send(self, face: u32, corner: usize, triangle: &[u32; 3]) -> (u32, [u32; N]);
}

/// Takes the items of all vertices, in ascending order of these.
pub(super) trait Receive<const N: usize> {
    /// In so many rounds the items are sorted, one range of vertices after the other, so that only this fraction of
    /// them is in memory at a time; three rounds at least where they also need to name their vertices. Each
    /// round reads the triangles again.
    const ROUNDS: usize;

    /// How far the items must reach beyond the last one.
    const SLACK: usize = 16;

    /// Told first: how many items there are.
    fn prepare(&mut self, items: usize);

    /// Takes the items of the vertices from `first` on: where each one's end (they start where the ones before
    /// end), and the items, those of each vertex in the order of the faces.
    fn receive(&mut self, first: u32, ends: &[u32], items: &[[u32; N]]);
}

/// How the vertices are taken together on the way.
#[derive(Clone, Copy, Debug)]
pub(super) struct Blocks {
    /// Blocks of 2^`bits` vertices; without blocks for 0.
    pub(super) bits: u32,
}

impl Blocks {
    /// None where the order of the faces keeps to the cache by itself; else of 2^`bits` vertices, or more of a large mesh.
    pub(super) fn for_order_of(vertex_count: usize, triangles: &[[u32; 3]], bits: u32) -> Self {
        let least = (vertex_count / MOST_BLOCKS).checked_ilog2().map_or(0, |log| log + 1);
        Self { bits: if is_scattered(vertex_count, triangles) { bits.max(least) } else { 0 } }
    }
}

/// Whether consecutive faces lie far apart, by a sample: then a write for each corner would miss the cache.
pub(super) fn is_scattered(vertex_count: usize, triangles: &[[u32; 3]]) -> bool {
    const SAMPLE: usize = 1024;
    const NEAR: u32 = 64;
    if vertex_count < 1 << 14 {
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

/// Sends an item from each corner of each face that has not collapsed. Gives the number of those that have.
///
/// # Panics
///
/// Panics if an index is not below `vertex_count`.
pub(super) fn by_vertex<const N: usize, S: Send<N>, R: Receive<N>>(
    vertex_count: usize,
    triangles: &[[u32; 3]],
    Blocks { bits }: Blocks,
    sender: S,
    receiver: &mut R,
) -> usize {
    let (mut ends, collapsed) = items_by_block(vertex_count, triangles, bits, sender);
    let all = 3 * (triangles.len() - collapsed);
    receiver.prepare(all);
    let rounds = if bits == 0 { R::ROUNDS } else { R::ROUNDS.max(3) };
    let mut sorter = Sorter { addressed: Vec::new(), items: Vec::new(), ends: Vec::new() };
    let mut first = 0;
    while first < ends.len() {
        // Counts turn into places as far as this round goes.
        let (mut last, mut items) = (first, 0);
        while last < ends.len() && items * rounds <= all {
            let count = std::mem::replace(&mut ends[last], items as u32); // at most 3 × MAX_TRIANGLES
            items += count as usize;
            last += 1;
        }
        let blocks = &mut ends[first..last];
        let low = (first as u32) << bits;
        if bits == 0 {
            provide(&mut sorter.items, [0; N], items + R::SLACK);
            scatter_near(triangles, low, blocks, sender, &mut sorter.items);
            receiver.receive(low, blocks, &sorter.items);
        } else {
            provide(&mut sorter.addressed, (0, [0; N]), items);
            scatter_far(triangles, low, bits, blocks, sender, &mut sorter.addressed);
            sorter.finish(low, bits, blocks, vertex_count, receiver);
        }
        first = last;
    }
    collapsed
}

/// How many items the vertices of each block get, and how many faces have collapsed.
fn items_by_block<const N: usize, S: Send<N>>(
    vertex_count: usize,
    triangles: &[[u32; 3]],
    bits: u32,
    sender: S,
) -> (Vec<u32>, usize) {
    let mut counts = vec![0_u32; vertex_count.div_ceil(1 << bits)];
    let mut collapsed = 0;
    for triangle in triangles {
        let [a, b, c] = *triangle;
        assert!((a.max(b).max(c) as usize) < vertex_count, "{triangle:?} of {vertex_count} vertices");
        if has_collapsed(*triangle) {
            collapsed += 1;
            continue;
        }
        for corner in 0..3 {
            counts[(sender.send(0, corner, triangle).0 >> bits) as usize] += 1;
        }
    }
    (counts, collapsed)
}

/// The radix sort in one digit: writes the items for vertices from `low` on to the places of their vertices,
/// which turn from starts into ends on the way. The items of a vertex keep their order.
fn scatter_near<const N: usize, S: Send<N>>(
    triangles: &[[u32; 3]],
    low: u32,
    places: &mut [u32],
    sender: S,
    sorted: &mut [[u32; N]],
) {
    for (face, triangle) in (0..).zip(triangles) {
        if has_collapsed(*triangle) {
            continue;
        }
        for corner in 0..3 {
            let (vertex, item) = sender.send(face, corner, triangle);
            // What lies below `low` wraps around and is out of range as well.
            if let Some(place) = places.get_mut(vertex.wrapping_sub(low) as usize) {
                sorted[*place as usize] = item;
                *place += 1;
            }
        }
    }
}

/// The first of two digits: the same by blocks of vertices, each item behind its vertex.
///
/// In a shuffled mesh it is a coin toss whether an item belongs to this round, so those that do are first
/// listed without a branch, a few triangles at a time.
fn scatter_far<const N: usize, S: Send<N>>(
    triangles: &[[u32; 3]],
    low: u32,
    bits: u32,
    places: &mut [u32],
    sender: S,
    sorted: &mut [(u32, [u32; N])],
) {
    const CHUNK: usize = 1024;
    let span = (places.len() as u64) << bits;
    let mut listed = [0_u32; 3 * CHUNK + 4];
    for (first, chunk) in (0..).step_by(CHUNK).zip(triangles.chunks(CHUNK)) {
        let mut count = 0;
        for (face, triangle) in (0..).zip(chunk) {
            if has_collapsed(*triangle) {
                continue;
            }
            for corner in 0..3 {
                let vertex = sender.send(0, corner, triangle).0;
                listed[count] = face << 2 | corner as u32;
                count += usize::from(u64::from(vertex.wrapping_sub(low)) < span);
            }
        }
        for &code in &listed[..count] {
            let face = code >> 2;
            let sent = sender.send(first + face, (code & 3) as usize, &chunk[face as usize]);
            let place = &mut places[(sent.0.wrapping_sub(low) >> bits) as usize];
            sorted[*place as usize] = sent;
            *place += 1;
        }
    }
}

/// Makes a buffer long enough. What it holds is of no use any more; new pages come zeroed, and are not touched here.
fn provide<T: Clone>(buffer: &mut Vec<T>, zero: T, len: usize) {
    if buffer.len() < len {
        *buffer = Vec::new(); // first, so that never both are there
        *buffer = vec![zero; len];
    }
}

/// Memory that serves all rounds.
struct Sorter<const N: usize> {
    addressed: Vec<(u32, [u32; N])>,
    items: Vec<[u32; N]>,
    ends: Vec<u32>,
}

impl<const N: usize> Sorter<N> {
    /// The other digit: sorts each block by vertex.
    fn finish<R: Receive<N>>(
        &mut self,
        low: u32,
        bits: u32,
        blocks: &[u32],
        vertex_count: usize,
        receiver: &mut R,
    ) {
        let mut start = 0;
        for (block, &end) in (0..).zip(blocks) {
            let addressed = &self.addressed[start as usize..end as usize];
            start = end;
            let first = low + (block << bits);
            let vertices = (vertex_count - first as usize).min(1 << bits);
            self.ends.clear();
            self.ends.resize(vertices, 0);
            for (vertex, _) in addressed {
                self.ends[(vertex - first) as usize] += 1;
            }
            let mut sum = 0;
            for end in &mut self.ends {
                (sum, *end) = (sum + *end, sum);
            }
            provide(&mut self.items, [0; N], addressed.len() + R::SLACK);
            for &(vertex, item) in addressed {
                let place = &mut self.ends[(vertex - first) as usize];
                self.items[*place as usize] = item;
                *place += 1;
            }
            receiver.receive(first, &self.ends, &self.items);
        }
    }
}
