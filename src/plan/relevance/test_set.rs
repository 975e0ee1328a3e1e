//! Which tests run.

use super::RelevanceTest;

/// A set of tests.
///
/// ```
/// use umbrage::plan::relevance::{RelevanceTest, TestSet};
/// let tests = TestSet::ALL.without(RelevanceTest::Faint);
/// assert!(tests.has(RelevanceTest::Zero) && !tests.has(RelevanceTest::Faint));
/// assert_eq!(TestSet::default(), TestSet::ALL);
/// assert!(TestSet::only(RelevanceTest::Sky).has(RelevanceTest::Sky));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct TestSet(u16);

impl TestSet {
    /// All tests.
    pub const ALL: Self = Self((1 << RelevanceTest::ALL.len()) - 1);
    /// No test: everything is kept.
    pub const NONE: Self = Self(0);

    /// One test.
    #[must_use]
    pub fn only(test: RelevanceTest) -> Self {
        Self(1 << test as u16)
    }

    /// The set with one more test.
    #[must_use]
    pub fn with(self, test: RelevanceTest) -> Self {
        Self(self.0 | 1 << test as u16)
    }

    /// The set without a test.
    #[must_use]
    pub fn without(self, test: RelevanceTest) -> Self {
        Self(self.0 & !(1 << test as u16))
    }

    /// Whether the set has a test.
    #[must_use]
    pub fn has(self, test: RelevanceTest) -> bool {
        self.0 & 1 << test as u16 != 0
    }
}

impl Default for TestSet {
    fn default() -> Self {
        Self::ALL
    }
}
