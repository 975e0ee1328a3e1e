//! A set of numbers, each with its rank.

/// A bitmap that knows how many bits are set before each word.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct RankedBits {
    words: Vec<u64>,
    before: Vec<u32>,
    count: u32,
}

impl RankedBits {
    /// The set of the given numbers, all below `end`.
    pub(super) fn of(numbers: impl Iterator<Item = u32>, end: u32) -> Self {
        let mut words = vec![0_u64; end.div_ceil(64) as usize];
        for number in numbers {
            words[number as usize / 64] |= 1 << (number % 64);
        }
        Self::of_words(words)
    }

    /// All numbers below `end`.
    pub(super) fn all(end: u32) -> Self {
        let mut words = vec![u64::MAX; end.div_ceil(64) as usize];
        if let (Some(last), 1..) = (words.last_mut(), end % 64) {
            *last = (1 << (end % 64)) - 1;
        }
        Self::of_words(words)
    }

    fn of_words(words: Vec<u64>) -> Self {
        let mut count = 0;
        let mut before = Vec::with_capacity(words.len());
        for word in &words {
            before.push(count);
            count += word.count_ones();
        }
        Self { words, before, count }
    }

    /// Number of elements.
    pub(super) fn count(&self) -> u32 {
        self.count
    }

    /// The number of smaller elements, if the set has this one.
    #[inline]
    pub(super) fn rank(&self, number: u32) -> Option<u32> {
        let (word, bit) = (number as usize / 64, 1 << (number % 64));
        let bits = self.words[word];
        (bits & bit != 0).then(|| self.before[word] + (bits & (bit - 1)).count_ones())
    }

    /// Memory in bytes.
    pub(super) fn bytes(&self) -> usize {
        12 * self.words.len()
    }
}

#[cfg(test)]
mod tests {
    use super::RankedBits;
    use crate::random::SplitMix64;

    #[test]
    fn ranked_bits_are_a_sorted_set_with_ranks() {
        let mut random = SplitMix64(1);
        for end in [1, 63, 64, 65, 1000] {
            for count in [0, 1, 40, 3000] {
                let mut numbers: Vec<u32> = (0..count).map(|_| random.below(end) as u32).collect();
                let bits = RankedBits::of(numbers.iter().copied(), end as u32);
                numbers.sort_unstable();
                numbers.dedup();
                assert_eq!(bits.count() as usize, numbers.len());
                assert_eq!(RankedBits::all(end as u32).count() as usize, end);
                for number in 0..end as u32 {
                    assert_eq!(
                        bits.rank(number).map(|rank| rank as usize),
                        numbers.binary_search(&number).ok()
                    );
                }
            }
        }
    }
}
