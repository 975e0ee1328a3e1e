//! What a fragment does to the count: a depth test, and the outcome that counts.

use std::cmp::Ordering;

use super::triangle::Meeting;

/// Depth test of a fragment against what is seen. Depth is reversed: greater is nearer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum DepthTest {
    Greater,
    LessEqual,
    /// Only as a fault that tests inject.
    #[cfg(test)]
    Less,
}

/// A stencil state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct State {
    pub(super) test: DepthTest,
    /// Whether a fragment counts that passes the test, or one that fails it.
    pub(super) counts_passed: bool,
}

impl State {
    /// Fragments before the visible point, from the eye's own count.
    pub(super) const ZPASS: Self = Self { test: DepthTest::Greater, counts_passed: true };
    /// Fragments behind the visible point.
    pub(super) const ZFAIL: Self = Self { test: DepthTest::Greater, counts_passed: false };
    /// The same fragments by the complement of the test. (William Bilodeau and Michael Songy, *Real Time
    /// Shadows*, 1999.)
    pub(super) const REVERSED: Self = Self { test: DepthTest::LessEqual, counts_passed: true };

    /// Whether the counts are those from the eye to the visible point.
    pub(super) fn is_from_eye(self) -> bool {
        self == Self::ZPASS
    }

    /// What a triangle adds to the count of a sample: `None` if it does not count. `is_own` says whether it
    /// is a cap that is the visible face itself, at the same depth.
    pub(super) fn update(self, meeting: Meeting, is_own: impl FnOnce() -> bool) -> Option<i32> {
        let (order, value) = match meeting {
            Meeting::Before(value) => (Ordering::Greater, value),
            Meeting::Behind(value) if is_own() => (Ordering::Equal, value),
            Meeting::Behind(value) => (Ordering::Less, value),
            Meeting::Miss | Meeting::On => return None,
        };
        (self.test.passes(order) == self.counts_passed).then_some(value)
    }
}

impl DepthTest {
    /// Whether a fragment passes whose depth compares like this with that of what is seen.
    fn passes(self, order: Ordering) -> bool {
        match self {
            Self::Greater => order.is_gt(),
            Self::LessEqual => order.is_le(),
            #[cfg(test)]
            Self::Less => order.is_lt(),
        }
    }
}
