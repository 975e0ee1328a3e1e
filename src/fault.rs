//! Faults that tests inject: each module lists its own, and asks for them where they would be made.

/// The type `Faults` of a module with an enumeration `Fault`: the fault that is injected, and none outside of
/// tests, where asking costs nothing.
macro_rules! faults {
    () => {
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
    };
}

pub(crate) use faults;
