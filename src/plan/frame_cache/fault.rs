//! Parts of keys that tests forget, to see that a comparison would catch them.

/// The part of a key that is forgotten.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Fault {
    Frame,
    Place,
    Light,
    View,
    Casters,
    Brightness,
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
