//! How often something was right, and what that says about all cases.

/// Counts over queries of one kind.
///
/// ```
/// use umbrage::verify::Tally;
///
/// let tally = Tally { queries: 1100, ties: 100, judged: 1000, wrong: 0 };
/// assert_eq!((tally.error(), tally.bound_95()), (0.0, Some(0.003)));
/// assert_eq!(Tally { wrong: 1, ..tally }.bound_95(), None);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Tally {
    /// How many queries.
    pub queries: u64,
    /// Those with more than one right answer, or without a second method to compare with.
    pub ties: u64,
    /// Those whose answer can be wrong.
    pub judged: u64,
    /// Those of them whose answer is wrong.
    pub wrong: u64,
}

impl Tally {
    /// Wrong answers per judged query.
    #[must_use]
    pub fn error(&self) -> f64 {
        self.wrong as f64 / self.judged.max(1) as f64
    }

    /// The bound on the rate of wrong answers, with 95 % confidence; `None` after a wrong answer, or without
    /// a judged query.
    ///
    /// After none in n independent draws the rate is below 3/n: the rule of three, Hanley & Lippman-Hand, "If
    /// nothing goes wrong, is everything all right?", JAMA 1983. Queries that share a mesh, a surface or a
    /// light are not independent.
    #[must_use]
    pub fn bound_95(&self) -> Option<f64> {
        (self.wrong == 0 && self.judged > 0).then(|| (3.0 / self.judged as f64).min(1.0))
    }
}
