//! Constant visibility: everything lit, or everything dark.

use super::{Answer, Claim, LampShadow, Samples, Visibility};
use crate::geom::Light;

/// One value for every front-lit sample.
#[derive(Debug)]
pub(super) struct Plain {
    pub(super) value: f32,
    pub(super) light: Light,
}

impl LampShadow for Plain {
    fn shade(&self, samples: &Samples) -> Visibility {
        Visibility::of(samples, &self.light, Claim::Approximate, |_| Answer::of(self.value))
    }
}
