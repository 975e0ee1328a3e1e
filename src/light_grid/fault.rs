//! Faults that tests inject, to see that a comparison would catch them.

/// What is done wrong on purpose.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Fault {
    /// An edge of multiplicity ±2 is no boundary.
    NoOutline,
    /// Faces are united across every edge.
    UnitedAcross,
    /// A generic ray that may touch an edge counts as crossing the face.
    TouchIsCrossing,
    /// Bounds of the nearness are rounded inwards.
    RoundedInwards,
    /// The sheet of the visible face may be crossed twice.
    TwoCrossings,
}

/// The fault that is injected: none, outside of tests.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Faults(#[cfg(test)] pub(super) Option<Fault>);

impl Faults {
    #[inline(always)]
    pub(super) fn has(self, _fault: Fault) -> bool {
        #[cfg(test)]
        return self.0 == Some(_fault);
        #[cfg(not(test))]
        false
    }
}
