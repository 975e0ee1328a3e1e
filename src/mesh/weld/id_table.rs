//! Ids by hash, for those who keep the keys.

/// Ids by hash: open addressing with linear probing, a power of two of slots, at most half of them taken. So an id
/// needs fewer bits than a slot has; the others hold bits of the hash, so that hardly any other vertex is looked at
/// in vain.
pub(super) struct Table {
    slots: Vec<u32>,
    /// Ones where a slot holds the id.
    id_bits: u32,
}

/// No id.
pub(super) const NO_ID: u32 = u32::MAX;

/// A slot without an id; in the others all bits are turned over, and no id has ones only, as that many do not fit.
/// (Memory for zeros comes zeroed and is not touched before its time.)
const EMPTY: u32 = 0;

/// The fewest slots, far more than a block of vertices can fill.
const LEAST: usize = 1024;

impl Table {
    pub(super) fn for_about(ids: usize) -> Self {
        Self::with_slots((2 * ids).next_power_of_two().max(LEAST))
    }

    fn with_slots(slots: usize) -> Self {
        Self { slots: vec![EMPTY; slots], id_bits: (slots / 2 - 1) as u32 } // ids fit 32 bits
    }

    /// Forgets all ids, and has room for about so many others.
    pub(super) fn reset(&mut self, ids: usize) {
        let slots = (2 * ids).next_power_of_two().max(LEAST);
        self.slots.clear();
        self.slots.resize(slots, EMPTY);
        self.id_bits = (slots / 2 - 1) as u32;
    }

    /// Whether another id would be one too many, or nearly.
    pub(super) fn is_full(&self, ids: usize) -> bool {
        2 * ids >= self.slots.len()
    }

    /// The id in the first place where `hash` may be, if it belongs there, or one that there cannot be.
    #[inline(always)]
    pub(super) fn first(&self, hash: u64) -> u32 {
        let slot = !self.slots[hash as usize & (self.slots.len() - 1)];
        if self.is_of(slot, hash) { slot & self.id_bits } else { NO_ID }
    }

    #[inline(always)]
    fn is_of(&self, slot: u32, hash: u64) -> bool {
        (slot ^ (hash >> 32) as u32) & !self.id_bits == 0
    }

    /// The id for which `same` holds, if it is there; otherwise `new`, which is put in its place.
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

    /// Twice as many slots, filled anew with the hashes of the ids 0, 1, 2, …
    pub(super) fn grow(&mut self, hashes: impl Iterator<Item = u64>) {
        *self = Self::with_slots(2 * self.slots.len());
        for (id, hash) in (0..).zip(hashes) {
            self.find_or_insert(hash, id, |_| false);
        }
    }
}
