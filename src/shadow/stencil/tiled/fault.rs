//! Faults that tests inject, to see that a comparison would catch them.

/// What is done wrong on purpose.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Fault {
    /// A ray that runs exactly through an edge meets none of its triangles.
    TieMisses,
    /// Counts from the eye start at 0, whatever the eye is in.
    StartsAtZero,
    /// A tile has the depth of its first sample.
    FirstDepth,
    /// One sample decides a tile that a triangle crosses.
    CrossedIsUniform,
    /// Only triangles behind a tile count in it where its samples are counted from the eye.
    WrongSideDropped,
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
