//! A set of edges that knows its order: one bit an edge, and one bit for every 64 of those.

/// Insertion in any order and constant time; a walk in ascending order that skips what is empty 4096 edges at a time.
#[derive(Clone, Debug, Default)]
pub(super) struct EdgeSet {
    words: Vec<u64>,
    /// A bit for each word that is not zero.
    summary: Vec<u64>,
}

impl EdgeSet {
    /// The empty set, for so many edges.
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
        // Fewer than 2^32 edges, so that their numbers fit.
        words.flat_map(|word| Bits(self.words[word]).map(move |low| word as u32 * 64 + low))
    }

    /// Calls `visit` with every 64 edges of which some are in the set: the first one's number, and a bit for each. The
    /// set is empty afterwards.
    #[inline]
    pub(super) fn drain(&mut self, mut visit: impl FnMut(u32, u64)) {
        for (high, bits) in self.summary.iter_mut().enumerate() {
            for low in Bits(std::mem::take(bits)) {
                let word = high * 64 + low as usize;
                visit(word as u32 * 64, std::mem::take(&mut self.words[word]));
            }
        }
    }
}

/// The places of the bits that are set, ascending.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bits(pub(super) u64);

impl Iterator for Bits {
    type Item = u32;

    #[inline]
    fn next(&mut self) -> Option<u32> {
        (self.0 != 0).then(|| {
            let place = self.0.trailing_zeros();
            self.0 &= self.0 - 1;
            place
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
            let mut drained = Vec::new();
            set.drain(|first, bits| drained.extend(Bits(bits).map(|bit| first + bit)));
            prop_assert_eq!(drained, expected);
            prop_assert_eq!(set.iter().count(), 0);
        }
    }
}
