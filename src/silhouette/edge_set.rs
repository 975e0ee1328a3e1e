//! A sorted set of edges: a bitmap with one bit per edge, and a summary with one bit per 64 edges.

/// Insertion and removal in constant time; iteration in ascending order, which skips 4096 absent edges at a
/// time.
#[derive(Clone, Debug, Default)]
pub(super) struct EdgeSet {
    words: Vec<u64>,
    /// One bit per word: whether it is not zero.
    summary: Vec<u64>,
}

impl EdgeSet {
    /// The empty set, for edges below `edges`.
    pub(super) fn new(edges: usize) -> Self {
        let words = edges.div_ceil(64);
        Self { words: vec![0; words], summary: vec![0; words.div_ceil(64)] }
    }

    #[inline]
    pub(super) fn insert(&mut self, edge: u32) {
        let word = edge as usize / 64;
        self.words[word] |= 1 << (edge % 64);
        self.summary[word / 64] |= 1 << (word % 64);
    }

    #[inline]
    pub(super) fn remove(&mut self, edge: u32) {
        let word = edge as usize / 64;
        self.words[word] &= !(1 << (edge % 64));
        if self.words[word] == 0 {
            self.summary[word / 64] &= !(1 << (word % 64));
        }
    }

    /// The edges, ascending.
    pub(super) fn iter(&self) -> impl Iterator<Item = u32> + '_ {
        let words = self
            .summary
            .iter()
            .enumerate()
            .flat_map(|(high, &bits)| Bits(bits).map(move |low| high * 64 + low as usize));
        // Edge ids are 32 bits.
        words.flat_map(|word| Bits(self.words[word]).map(move |low| word as u32 * 64 + low))
    }
}

/// A sorted set of edges with a sign each, filled and drained again and again.
#[derive(Clone, Debug, Default)]
pub(super) struct SignedEdges {
    /// For 64 edges: which are in the set, and which of those are negative.
    words: Vec<[u64; 2]>,
    /// One bit per pair of words: whether it is not zero.
    summary: Vec<u64>,
    len: usize,
}

impl SignedEdges {
    /// The empty set, for edges below `edges`.
    pub(super) fn new(edges: usize) -> Self {
        let words = edges.div_ceil(64);
        Self { words: vec![[0; 2]; words], summary: vec![0; words.div_ceil(64)], len: 0 }
    }

    pub(super) fn len(&self) -> usize {
        self.len
    }

    /// Adds an edge that is not in the set, negative if `negative` is 1 and not if it is 0.
    #[inline(always)]
    pub(super) fn insert(&mut self, edge: u32, negative: u32) {
        let word = edge as usize / 64;
        let [present, signs] = &mut self.words[word];
        *present |= 1 << (edge % 64);
        *signs |= u64::from(negative) << (edge % 64);
        self.summary[word / 64] |= 1 << (word % 64);
        self.len += 1;
    }

    /// Calls `visit` for every block of 64 edges that holds some: with the id of its first edge, a word of
    /// the edges in the set, and a word of those that are negative. The set is empty afterwards.
    #[inline(always)]
    pub(super) fn drain(&mut self, mut visit: impl FnMut(u32, u64, u64)) {
        self.len = 0;
        for (high, bits) in self.summary.iter_mut().enumerate() {
            for low in Bits(std::mem::take(bits)) {
                let word = high * 64 + low as usize;
                let [present, negative] = std::mem::take(&mut self.words[word]);
                visit(word as u32 * 64, present, negative);
            }
        }
    }
}

/// The indices of the bits that are set, ascending.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bits(pub(super) u64);

impl Iterator for Bits {
    type Item = u32;

    #[inline]
    fn next(&mut self) -> Option<u32> {
        (self.0 != 0).then(|| {
            let index = self.0.trailing_zeros();
            self.0 &= self.0 - 1;
            index
        })
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn edge_set_is_a_sorted_set(steps in prop::collection::vec((0_u32..9000, any::<bool>()), 0..200)) {
            let (mut set, mut expected) = (EdgeSet::new(9000), BTreeSet::new());
            for (edge, insert) in steps {
                if insert {
                    set.insert(edge);
                    expected.insert(edge);
                } else {
                    set.remove(edge);
                    expected.remove(&edge);
                }
            }
            let expected: Vec<u32> = expected.into_iter().collect();
            prop_assert_eq!(set.iter().collect::<Vec<_>>(), expected.clone());
        }

        #[test]
        fn edge_set_with_signs_is_drained_in_order_and_then_empty(
            edges in prop::collection::btree_map(0_u32..9000, 0_u32..2, 0..200),
            shuffled in any::<u64>(),
        ) {
            let mut set = SignedEdges::new(9000);
            let mut inserted: Vec<(u32, u32)> = edges.clone().into_iter().collect();
            inserted.sort_by_key(|(edge, _)| u64::from(*edge).wrapping_mul(shuffled | 1));
            for _ in 0..2 {
                inserted.iter().for_each(|&(edge, negative)| set.insert(edge, negative));
                prop_assert_eq!(set.len(), edges.len());
                let mut drained = Vec::new();
                set.drain(|first, present, negative| {
                    drained.extend(Bits(present).map(|bit| (first + bit, (negative >> bit & 1) as u32)));
                });
                prop_assert!(drained.into_iter().eq(edges.clone()));
                prop_assert_eq!(set.len(), 0);
            }
        }
    }
}
