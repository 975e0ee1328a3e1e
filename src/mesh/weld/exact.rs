//! Vertices with bit-equal positions become one, by hashing.

use hashbrown::DefaultHashBuilder;
use std::hash::BuildHasher;

use super::{Merged, Used, far, near};
use crate::mesh::Mesh;

pub(super) fn merged(mesh: &Mesh, used: &Used) -> Merged {
    let points = Points::of(mesh);
    if repeats_nearby(&points) { near::merged(&points, used) } else { far::merged(&points, used) }
}

/// Whether the vertices of a place mostly come soon after each other, by a sample.
fn repeats_nearby(points: &Points<'_>) -> bool {
    const WINDOW: usize = 64;
    const SAMPLE: usize = 64;
    let windows = points.positions.len() / WINDOW;
    if windows < 4 * SAMPLE {
        return true; // all of it is near
    }
    let repeated = |window: usize| {
        let at = window * (windows / SAMPLE) * WINDOW;
        let mut keys: Vec<[u32; 3]> = (at..at + WINDOW).map(|vertex| points.bits(vertex as u32)).collect();
        keys.sort_unstable();
        keys.windows(2).filter(|pair| pair[0] == pair[1]).count()
    };
    4 * (0..SAMPLE).map(repeated).sum::<usize>() > SAMPLE * WINDOW
}

/// The vertices by the bits of their positions.
pub(super) struct Points<'a> {
    pub(super) positions: &'a [[f32; 3]],
    frames: &'a [Vec<[f32; 3]>],
    seeds: [u64; 2],
}

impl<'a> Points<'a> {
    pub(super) fn of(mesh: &'a Mesh) -> Self {
        // Seeded by chance, so that no file can be made to collide; ids do not depend on it.
        let seeds = [0, 1].map(|i| DefaultHashBuilder::default().hash_one(i));
        Self { positions: &mesh.positions, frames: &mesh.frames, seeds }
    }

    /// Those of the first frame.
    #[inline(always)]
    pub(super) fn bits(&self, vertex: u32) -> [u32; 3] {
        let [x, y, z] = self.positions[vertex as usize];
        [x.to_bits(), y.to_bits(), z.to_bits()]
    }

    /// Of a vertex in all frames; `key` are its bits in the first.
    #[inline(always)]
    pub(super) fn hash(&self, key: [u32; 3], vertex: u32) -> u64 {
        let hash = self.mix(self.seeds[1], key);
        if self.frames.is_empty() { hash } else { self.hash_frames(hash, vertex) }
    }

    fn hash_frames(&self, hash: u64, vertex: u32) -> u64 {
        let more = |hash, frame: &Vec<[f32; 3]>| self.mix(hash, frame[vertex as usize].map(f32::to_bits));
        self.frames.iter().fold(hash, more)
    }

    #[inline(always)]
    fn mix(&self, hash: u64, [x, y, z]: [u32; 3]) -> u64 {
        // Both halves of a product with seeded factors, as foldhash and wyhash do.
        let left = u64::from(x) << 32 | u64::from(y);
        let product = u128::from(left ^ self.seeds[0]) * u128::from(u64::from(z) ^ hash);
        (product >> 64) as u64 ^ product as u64
    }

    /// Whether two vertices with equal bits in the first frame have so in the others.
    #[inline(always)]
    pub(super) fn same_frames(&self, a: u32, b: u32) -> bool {
        let same = |frame: &Vec<[f32; 3]>| {
            frame[a as usize].map(f32::to_bits) == frame[b as usize].map(f32::to_bits)
        };
        self.frames.is_empty() || self.frames.iter().all(same)
    }
}
