//! Constant visibility: everything lit, or everything dark.

use super::{Answer, Claim, Samples, Visibility};
use crate::geom::Light;

/// One value for every front-lit sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Plain {
    Lit,
    Dark,
}

impl Plain {
    pub(super) fn shade(self, light: &Light, samples: &Samples) -> Visibility {
        let value = if self == Self::Lit { 1.0 } else { 0.0 };
        Visibility::of(samples, light, Claim::Approximate, |_| Answer::of(value))
    }
}
