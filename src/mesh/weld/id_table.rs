//! Hash table of ids; the caller stores the keys.

/// Hash table of ids: open addressing with linear probing, a power of two of slots, at most half of them
/// filled. An id therefore needs fewer bits than a slot has. The remaining bits hold part of the hash, so
/// that few keys are compared in vain.
pub(super) struct Table {
    slots: Vec<u32>,
    /// Mask of the bits of a slot that hold the id.
    id_bits: u32,
}

/// The result for "no id".
pub(super) const NO_ID: u32 = u32::MAX;

/// An empty slot. A filled slot is stored inverted and is never 0: no id consists of ones only, because that
/// many ids do not fit. (Zeroed allocations cost nothing until touched.)
const EMPTY: u32 = 0;

/// Smallest number of slots, far more than a block of vertices can fill.
const LEAST: usize = 1024;

impl Table {
    pub(super) fn for_about(ids: usize) -> Self {
        Self::with_slots((2 * ids).next_power_of_two().max(LEAST))
    }

    fn with_slots(slots: usize) -> Self {
        Self { slots: vec![EMPTY; slots], id_bits: (slots / 2 - 1) as u32 } // ids fit 32 bits
    }

    /// Removes all ids, and sizes the table for about `ids` new ones.
    pub(super) fn reset(&mut self, ids: usize) {
        let slots = (2 * ids).next_power_of_two().max(LEAST);
        self.slots.clear();
        self.slots.resize(slots, EMPTY);
        self.id_bits = (slots / 2 - 1) as u32;
    }

    /// Whether a table with `ids` ids has reached its load limit of one half.
    pub(super) fn is_full(&self, ids: usize) -> bool {
        2 * ids >= self.slots.len()
    }

    /// The id in the home slot of `hash` if the hash bits match, otherwise a value that is no id.
    #[inline(always)]
    pub(super) fn first(&self, hash: u64) -> u32 {
        let slot = !self.slots[hash as usize & (self.slots.len() - 1)];
        if self.is_of(slot, hash) { slot & self.id_bits } else { NO_ID }
    }

    #[inline(always)]
    fn is_of(&self, slot: u32, hash: u64) -> bool {
        (slot ^ (hash >> 32) as u32) & !self.id_bits == 0
    }

    /// The id with this hash for which `same` holds. If there is none, `new` is inserted and returned.
    #[inline(always)]
    pub(super) fn find_or_insert(&mut self, hash: u64, new: u32, same: impl Fn(u32) -> bool) -> u32 {
        let mask = self.slots.len() - 1;
        let mut at = hash as usize & mask;
        loop {
            if self.slots[at] == EMPTY {
                self.slots[at] = !((hash >> 32) as u32 & !self.id_bits | new);
                return new;
            }
            let slot = !self.slots[at];
            if self.is_of(slot, hash) && same(slot & self.id_bits) {
                return slot & self.id_bits;
            }
            at = (at + 1) & mask;
        }
    }

    /// Doubles the number of slots, and reinserts the ids 0, 1, 2, … with the given hashes.
    pub(super) fn grow(&mut self, hashes: impl Iterator<Item = u64>) {
        *self = Self::with_slots(2 * self.slots.len());
        for (id, hash) in (0..).zip(hashes) {
            self.find_or_insert(hash, id, |_| false);
        }
    }
}
