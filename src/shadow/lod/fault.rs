//! Faults that tests inject, to see that a comparison would catch them.

/// What is done wrong on purpose.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Fault {
    /// The shadow of an edge moves no farther than the edge.
    EdgeMovesByDelta,
    /// Shells that are seen are simplified too.
    SeenAreSimplified,
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
