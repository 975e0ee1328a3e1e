//! Copies: pieces with the same faces in the same positions.

use hashbrown::HashMap;

use super::Pieces;
use crate::caster::CasterGroup;

/// A face by the positions of its corners, in an order that does not depend on where it starts nor on how it
/// is wound: that does not change what it hides.
type Key = [[u32; 3]; 3];

fn key(corners: [[f32; 3]; 3]) -> Key {
    let mut key = corners.map(|corner| corner.map(f32::to_bits));
    key.sort_unstable();
    key
}

/// A mixing function, so that sums over faces collide by chance only.
fn mixed(key: Key) -> u64 {
    key.as_flattened().iter().fold(0x9e37_79b9_7f4a_7c15, |hash: u64, &bits| {
        let hash = (hash ^ u64::from(bits)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        hash ^ (hash >> 29)
    })
}

impl Pieces {
    /// Whether each piece is a copy of one with a lower number. Linear time: each piece is compared with one
    /// other at most.
    pub(super) fn copies(&self, casters: &CasterGroup<'_>) -> &[bool] {
        self.copies.get_or_init(|| {
            let keys = |piece: usize| self.corners(casters, piece).map(key);
            let mut first: HashMap<(u64, usize), usize> = HashMap::with_capacity(self.len());
            let copy = |piece: usize| {
                let hash = keys(piece).fold(0_u64, |sum, key| sum.wrapping_add(mixed(key)));
                let other = *first.entry((hash, self.piece(piece).faces)).or_insert(piece);
                let sorted = |piece: usize| {
                    let mut keys: Vec<Key> = keys(piece).collect();
                    keys.sort_unstable();
                    keys
                };
                other != piece && sorted(other) == sorted(piece)
            };
            (0..self.len()).map(copy).collect()
        })
    }
}
