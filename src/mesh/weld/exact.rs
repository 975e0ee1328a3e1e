//! Exact welding: vertices with bit-equal positions become one, by hashing.

use hashbrown::DefaultHashBuilder;
use std::hash::BuildHasher;

use super::{Kept, Used, bucketed, streaming};
use crate::mesh::Mesh;

/// Writes the welded id of each used vertex to its slot in `vertex_of`. The other slots are not changed.
pub(super) fn merge(mesh: &Mesh, used: &Used, vertex_of: &mut [u32]) -> Kept {
    if !mesh.frames.is_empty() {
        streaming::merge(&Points::<true>::of(mesh), used, vertex_of)
    } else if repeats_nearby(mesh) {
        streaming::merge(&Points::<false>::of(mesh), used, vertex_of)
    } else {
        bucketed::merge(&Points::of(mesh), used, vertex_of)
    }
}

/// Whether vertices with equal positions are mostly close together in the list, estimated from a sample of
/// windows.
fn repeats_nearby(mesh: &Mesh) -> bool {
    const WINDOW: usize = 64;
    const SAMPLE: usize = 64;
    let windows = mesh.positions.len() / WINDOW;
    if windows < 4 * SAMPLE {
        return true; // the whole list is short
    }
    let repeated = |window: usize| {
        let at = window * (windows / SAMPLE) * WINDOW;
        let mut keys: Vec<_> = mesh.positions[at..at + WINDOW].iter().map(|p| p.map(f32::to_bits)).collect();
        keys.sort_unstable();
        keys.windows(2).filter(|pair| pair[0] == pair[1]).count()
    };
    4 * (0..SAMPLE).map(repeated).sum::<usize>() > SAMPLE * WINDOW
}

/// Vertices per block: the data noted per block fits the first-level cache.
pub(super) const BLOCK: usize = 256;

/// A vertex with the bits of its position: x below y in the first word, z below the vertex in the second.
#[derive(Clone, Copy, Debug)]
pub(super) struct Record(pub(super) [u64; 2]);

impl Record {
    /// A record that equals no vertex, since coordinates are finite.
    pub(super) const NOWHERE: Self = Self([u64::MAX, u32::MAX as u64]);

    #[inline(always)]
    pub(super) fn new([x, y, z]: [f32; 3], vertex: u32) -> Self {
        let pair = |low: u32, high: u32| u64::from(low) | u64::from(high) << 32;
        Self([pair(x.to_bits(), y.to_bits()), pair(z.to_bits(), vertex)])
    }

    #[inline(always)]
    pub(super) fn vertex(self) -> u32 {
        (self.0[1] >> 32) as u32
    }

    #[inline(always)]
    pub(super) fn position(self) -> [f32; 3] {
        // Without `map`: closures on arrays are not always inlined.
        let [x, y, z] = [self.0[0] as u32, (self.0[0] >> 32) as u32, self.0[1] as u32];
        [f32::from_bits(x), f32::from_bits(y), f32::from_bits(z)]
    }

    #[inline(always)]
    pub(super) fn is_at(self, other: Self) -> bool {
        (self.0[0] ^ other.0[0]) | (self.0[1] ^ other.0[1]) << 32 == 0
    }
}

/// The vertices, compared by the bits of their positions, in several frames if `MOVING`.
pub(super) struct Points<'a, const MOVING: bool> {
    positions: &'a [[f32; 3]],
    frames: &'a [Vec<[f32; 3]>],
    seeds: [u64; 2],
}

impl<'a, const MOVING: bool> Points<'a, MOVING> {
    pub(super) fn of(mesh: &'a Mesh) -> Self {
        debug_assert_eq!(MOVING, !mesh.frames.is_empty());
        // Random seeds, so that no file can be crafted to collide. The ids do not depend on the seeds.
        let seeds = [0, 1].map(|i| DefaultHashBuilder::default().hash_one(i));
        Self { positions: &mesh.positions, frames: &mesh.frames, seeds }
    }

    /// Calls `each` with all used vertices in order, one block at a time.
    #[inline(always)]
    pub(super) fn for_each_block(&self, used: &Used, mut each: impl FnMut(&[Record])) {
        let (mut block, mut next) = ([Record::NOWHERE; BLOCK], 0);
        loop {
            match self.read(used, &mut next, &mut block) {
                [] => return,
                block => each(block),
            }
        }
    }

    /// Reads used vertices from `next` on into `block`, as many as fit, and advances `next` past them.
    #[inline(always)]
    fn read<'b>(&self, used: &Used, next: &mut u32, block: &'b mut [Record; BLOCK]) -> &'b [Record] {
        let mut count = 0;
        match &used.referenced {
            None => {
                let rest = &self.positions[*next as usize..];
                for (&position, record) in rest.iter().zip(&mut *block) {
                    *record = Record::new(position, *next);
                    *next += 1; // vertices are fewer than 2³²
                    count += 1;
                }
            }
            Some(referenced) => {
                let rest = *next as usize..;
                for (&position, &used) in self.positions[rest.clone()].iter().zip(&referenced[rest]) {
                    if count == BLOCK {
                        break;
                    }
                    block[count] = Record::new(position, *next);
                    *next += 1;
                    count += usize::from(used);
                }
            }
        }
        &block[..count]
    }

    /// Hash of a vertex's position in all frames.
    #[inline(always)]
    pub(super) fn hash(&self, record: Record) -> u64 {
        let hash = self.mix(self.seeds[1], record);
        if MOVING { self.hash_frames(hash, record.vertex()) } else { hash }
    }

    fn hash_frames(&self, hash: u64, vertex: u32) -> u64 {
        let more = |hash, frame: &Vec<[f32; 3]>| self.mix(hash, Record::new(frame[vertex as usize], 0));
        self.frames.iter().fold(hash, more)
    }

    #[inline(always)]
    fn mix(&self, hash: u64, Record([left, right]): Record) -> u64 {
        // Both halves of a product with seeded factors, as in foldhash and wyhash.
        let product = u128::from(left ^ self.seeds[0]) * u128::from(u64::from(right as u32) ^ hash);
        (product >> 64) as u64 ^ product as u64
    }

    /// Whether two vertices with equal bits in the first frame have equal bits in the other frames.
    #[inline(always)]
    pub(super) fn same_frames(&self, a: u32, b: u32) -> bool {
        let same = |frame: &Vec<[f32; 3]>| {
            frame[a as usize].map(f32::to_bits) == frame[b as usize].map(f32::to_bits)
        };
        !MOVING || self.frames.iter().all(same)
    }
}
