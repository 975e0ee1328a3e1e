//! The star of a vertex: its faces, and all that is decided by them alone.
//!
//! A face (v, x, y) is an arc x → y in the link of v. Arcs that share an end are faces that share an edge at
//! v, so the fans of v are the connected components of its link. At nearly every vertex of nearly every mesh
//! the arcs form one ring, each end met once coming and once going; that is tested, and the edges are sorted
//! on the way, without a branch that depends on the order of the faces. All else goes the long way.

use bytemuck::{Pod, Zeroable};

use super::fan::Fans;
use super::part::Parts;
use super::shell::Components;
use super::sort::{self, Blocks, NEXT, PREVIOUS, Receive, Send};
use super::{EdgeCounts, Entry, Survey};
use crate::mesh::{FaceId, VertexId};

/// A corner seen from its vertex: its face runs from `from` to `to` on the other side.
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
struct Arc {
    from: u32,
    to: u32,
    /// Four times the face plus the number of the corner: what follows needs no division by three.
    code: u32,
}

impl Arc {
    #[inline]
    fn face(self) -> u32 {
        self.code >> 2
    }

    /// The entry of the edge to `from`, if that is the larger vertex.
    #[inline]
    fn outgoing(self) -> u32 {
        (self.code - self.face()) << 1
    }

    /// The entry of the edge to `to`, if that is the larger vertex: the half-edge before, and its direction.
    #[inline]
    fn incoming(self) -> u32 {
        let step = if self.code & 3 == 0 { 2 } else { u32::MAX };
        (self.code - self.face()).wrapping_add(step) << 1 | 1
    }
}

/// Each corner to its own vertex, as an [`Arc`].
#[derive(Clone, Copy)]
pub(super) struct Arcs;

impl Send<3> for Arcs {
    #[inline(always)]
    fn send(self, face: u32, corner: usize, triangle: &[u32; 3]) -> (u32, [u32; 3]) {
        let (from, to) = (triangle[NEXT[corner]], triangle[PREVIOUS[corner]]);
        (triangle[corner], [from, to, face << 2 | corner as u32])
    }
}

/// A block of 2¹¹ vertices has some 12,000 arcs, 150 kB: sorting it stays in the second-level cache.
pub(super) const BLOCK_BITS: u32 = 11;

/// What the stars of all vertices tell.
pub(super) fn survey(vertex_count: usize, triangles: &[[u32; 3]]) -> Survey {
    let mut stars = Stars::new(vertex_count);
    let blocks = Blocks::for_order_of(vertex_count, triangles, BLOCK_BITS);
    sort::by_vertex(vertex_count, triangles, blocks, Arcs, &mut stars);
    stars.finish().3
}

/// No vertex has this id, see [`Mesh::new`](crate::mesh::Mesh::new).
pub(super) const NONE: u32 = u32::MAX;

/// How much is written beyond the end of a list.
const SLACK: usize = 16;

/// Takes the stars of all vertices in ascending order and makes the edge table and the [`Survey`] of them.
pub(super) struct Stars {
    /// With room for what is written beyond the end.
    offsets: Vec<u32>,
    edges: usize,
    /// The same.
    entries: Vec<u32>,
    entry_count: usize,
    counts: EdgeCounts,
    fans: Fans,
    parts: Parts,
    keys: Vec<(u64, u32)>,
}

impl Stars {
    pub(super) fn new(vertex_count: usize) -> Self {
        Self {
            offsets: Vec::new(),
            edges: 0,
            entries: Vec::new(),
            entry_count: 0,
            counts: EdgeCounts::NONE,
            fans: Fans { several: Vec::new(), vertices: 0, folded: false },
            parts: Parts::new(vertex_count),
            keys: Vec::new(),
        }
    }

    /// Adds a star if it is one ring, else leaves everything as it is. Of the arcs only the first `degree`
    /// count.
    #[inline]
    fn ring<const N: usize>(&mut self, vertex: u32, arcs: &[Arc; N], degree: usize) -> bool {
        let Ranked { from_place, to_place, outgoing: leaving, incoming: arriving, sum, smaller } =
            &Ranked::new(vertex, arcs, degree);
        let (mut ends, mut next) = ([NONE; N], [0_u32; N]);
        let (mut outgoing, mut incoming) = ([0_u32; N], [0_u32; N]);
        for i in 0..degree {
            let (a, b) = (from_place[i] as usize % N, to_place[i] as usize % N);
            ends[a] = arcs[i].from;
            next[a] = b as u32;
            outgoing[a] = leaving[i];
            incoming[b] = arriving[i];
        }
        let mut wrong = 0;
        for i in 0..degree {
            wrong |= ends[to_place[i] as usize % N] ^ arcs[i].to;
        }
        // All arcs leave different ends if each two of them differ in rank.
        let differ = *sum as usize == degree * (degree - 1) / 2 + (N - degree) * degree;
        // The way from the first place returns there after all others: then it is the only ring.
        let start = 0_u32.wrapping_sub(*smaller) as usize % N;
        let (mut at, mut early) = (next[start] as usize % N, false);
        for _ in 1..degree {
            early |= at == start;
            at = next[at] as usize % N;
        }
        if wrong != 0 || !differ || early || at != start {
            return false;
        }
        let larger = degree - *smaller as usize;
        // All places are written, those that count stay.
        let room = &mut self.entries[self.entry_count..][..2 * N];
        for i in 0..N {
            room[2 * i] = outgoing[i].min(incoming[i]);
            room[2 * i + 1] = outgoing[i].max(incoming[i]);
        }
        if self.offsets.len() < self.edges + 1 + N {
            self.grow_offsets();
        }
        for (i, offset) in self.offsets[self.edges + 1..][..N].iter_mut().enumerate() {
            *offset = (self.entry_count + 2 * (i + 1)) as u32;
        }
        self.entry_count += 2 * larger;
        self.edges += larger;
        self.fans.folded |= degree == 2;
        let smaller = *smaller as usize;
        self.parts.add(vertex, (smaller > 0).then(|| ends[N - smaller]));
        self.parts.connect(vertex, &ends, smaller);
        true
    }

    #[cold]
    fn grow_offsets(&mut self) {
        self.offsets.resize(self.offsets.len() / 2 * 3 + 2 * SLACK, 0);
    }

    /// Adds any star.
    fn tangle(&mut self, vertex: u32, arcs: &[Arc]) {
        // The edges by their other end, each with its half-edges ascending, and with the third vertex of each.
        let mut keys = std::mem::take(&mut self.keys);
        keys.clear();
        for arc in arcs {
            keys.push((u64::from(arc.from) << 32 | u64::from(arc.outgoing()), arc.to));
            keys.push((u64::from(arc.to) << 32 | u64::from(arc.incoming()), arc.from));
        }
        keys.sort_unstable();
        for edge in
            keys.chunk_by(|a, b| a.0 >> 32 == b.0 >> 32).filter(|edge| edge[0].0 >> 32 > u64::from(vertex))
        {
            let entries = edge.iter().map(|key| key.0 as u32);
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
            self.fans.folded |= edge.windows(2).any(|pair| pair[0].1 == pair[1].1);
        }
        let others = keys.chunk_by(|a, b| a.0 >> 32 == b.0 >> 32).map(|edge| (edge[0].0 >> 32) as u32);
        let mut smaller = others.take_while(|&other| other < vertex).peekable();
        self.parts.add(vertex, smaller.peek().copied());
        for other in smaller {
            self.parts.connect(vertex, &[other], 1);
        }
        if arcs.len() > 1 {
            self.find_fans(vertex, arcs, &keys);
        }
        self.keys = keys;
    }

    /// Notes the fans of a vertex if they are several: the components of faces with an edge in common.
    fn find_fans(&mut self, vertex: u32, arcs: &[Arc], keys: &[(u64, u32)]) {
        let mut fans = Components::new(arcs.len());
        let face = |key: &(u64, u32)| (key.0 as u32 >> 1) / 3;
        let number = |face: u32| arcs.partition_point(|arc| arc.face() < face) as u32;
        for pair in keys.windows(2).filter(|pair| pair[0].0 >> 32 == pair[1].0 >> 32) {
            fans.join(number(face(&pair[0])), number(face(&pair[1])));
        }
        let leaders = (0..).zip(arcs).filter(|&(i, _)| fans.find(i) == i);
        let before = self.fans.several.len();
        self.fans.several.extend(leaders.map(|(_, arc)| (VertexId(vertex), FaceId(arc.face()))));
        if self.fans.several.len() == before + 1 {
            self.fans.several.pop();
        }
    }

    /// The offsets and entries of the edge table, and what was found on the way.
    pub(super) fn finish(self) -> (Vec<u32>, Vec<u32>, EdgeCounts, Survey) {
        let Self { mut offsets, edges, mut entries, entry_count, counts, fans, parts, .. } = self;
        offsets.truncate(edges + 1);
        offsets.shrink_to_fit();
        entries.truncate(entry_count);
        entries.shrink_to_fit();
        (offsets, entries, counts, Survey { fans, components: parts.count() })
    }
}

impl Receive<3> for Stars {
    /// 36 / 4 bytes a triangle, or 48 / 4.
    const ROUNDS: usize = 4;

    fn prepare(&mut self, arcs: usize) {
        self.offsets = vec![0; arcs / 2 + 1 + SLACK];
        self.entries = vec![0; arcs + 2 * SLACK];
    }

    fn receive(&mut self, first: u32, ends: &[u32], arcs: &[[u32; 3]]) {
        let arcs: &[Arc] = bytemuck::cast_slice(arcs);
        let mut start = 0;
        for (vertex, &end) in (first..).zip(ends) {
            let degree = (end - start) as usize;
            let at = start as usize;
            start = end;
            if degree == 0 {
                continue;
            }
            self.fans.vertices += 1;
            let is_ring = match degree {
                0..=1 => false,
                2..=8 => self.ring::<8>(vertex, arcs[at..].first_chunk().expect("slack"), degree),
                9..=16 => self.ring::<16>(vertex, arcs[at..].first_chunk().expect("slack"), degree),
                _ => false,
            };
            if !is_ring {
                self.tangle(vertex, &arcs[at..at + degree]);
            } else {
                self.counts.max_faces = self.counts.max_faces.max(2);
            }
        }
    }
}

/// Ones for the items that count, zeros beyond: of a number n from place 16 − n on.
const KEEP: [i32; 32] = {
    let mut keep = [0; 32];
    let mut i = 0;
    while i < 16 {
        keep[i] = -1;
        i += 1;
    }
    keep
};

/// A star whose ends are compared with each other, each with each.
struct Ranked<const N: usize> {
    /// For each arc the place of its two ends in ascending order, that of the smallest larger vertex being 0:
    /// smaller ones wrap around to the back.
    from_place: [u32; N],
    to_place: [u32; N],
    /// What it would enter into the edge table for each of its ends.
    outgoing: [u32; N],
    incoming: [u32; N],
    /// The ranks of the ends that arcs leave, summed up; places of no arc have rank `degree`.
    sum: u32,
    /// How many of those ends are smaller vertices.
    smaller: u32,
}

impl<const N: usize> Ranked<N> {
    // On its own it becomes vector instructions; in place its results would be taken apart too soon.
    #[inline(never)]
    fn new(vertex: u32, arcs: &[Arc; N], degree: usize) -> Self {
        // Compared as signed numbers, which is an instruction; the order is the same.
        let signed = |id: u32| (id ^ 1 << 31) as i32;
        let keep: &[i32; N] = KEEP[16 - degree..].first_chunk().expect("a degree is 16 at most here");
        let (mut from, mut to) = ([0; N], [0; N]);
        for i in 0..N {
            from[i] = signed(arcs[i].from) & keep[i] | i32::MAX & !keep[i];
            to[i] = signed(arcs[i].to);
        }
        let (mut from_rank, mut to_rank) = ([0; N], [0; N]);
        for other in from {
            for i in 0..N {
                from_rank[i] += u32::from(other < from[i]);
            }
        }
        for other in from {
            for i in 0..N {
                to_rank[i] += u32::from(other < to[i]);
            }
        }
        let smaller: u32 = from.iter().map(|&other| u32::from(other < signed(vertex))).sum();
        let place = |rank: u32| rank.wrapping_sub(smaller) % N as u32;
        Self {
            from_place: from_rank.map(place),
            to_place: to_rank.map(place),
            outgoing: arcs.map(Arc::outgoing),
            incoming: arcs.map(Arc::incoming),
            sum: from_rank.iter().sum(),
            smaller,
        }
    }
}
