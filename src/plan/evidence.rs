//! How well a number is known.

use std::fmt;

/// Evidence of an error or of a time, from the strongest to the weakest.
///
/// ```
/// use umbrage::plan::Evidence;
/// assert!(Evidence::Exact.proves() && Evidence::Proven.proves() && !Evidence::Sampled.proves());
/// assert_eq!(Evidence::Proven.weaker(Evidence::Assumed), Evidence::Assumed);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Evidence {
    /// No error at any sample that is not grazing, by construction.
    Exact,
    /// A bound with a proof.
    Proven,
    /// Samples, with the confidence bound of Clopper and Pearson (1934).
    Sampled,
    /// A built-in figure.
    Assumed,
}

impl Evidence {
    /// Name in reports.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Exact => "exact",
            Self::Proven => "proven",
            Self::Sampled => "sampled",
            Self::Assumed => "assumed",
        }
    }

    /// Whether the number cannot be wrong.
    #[must_use]
    pub fn proves(self) -> bool {
        self <= Self::Proven
    }

    /// The weaker one: the evidence of a sum.
    #[must_use]
    pub fn weaker(self, other: Self) -> Self {
        self.max(other)
    }
}

impl fmt::Display for Evidence {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}
