//! What a face's own plane hides of a lamp.

use crate::scene::Lamp;
use crate::shadow::map::{unit_normal, wide};
use crate::shadow::{LampShadow, Samples, Visibility};

/// Cuts values at the share of the lamp above the plane of the sample's face.
///
/// A visible point lies strictly before its face, so that this face hides what is below its plane: no value
/// beyond this share is ever true. A map knows only blockers above the plane.
pub(in crate::shadow) fn above_horizon(visibility: &mut Visibility, samples: &Samples, lamp: &Lamp) {
    visibility.cut(samples, |hit| {
        let (Some(patch), Some(normal)) = (lamp.patch(hit.point), unit_normal(hit.corners)) else {
            return 1.0;
        };
        let toward_eye = normal * f64::from(hit.side.value());
        patch.share_above(wide(hit.point), toward_eye) as f32
    });
}

/// A technique that does not know what a face's own plane hides: its values are cut there.
#[derive(Debug)]
pub(super) struct AboveHorizon<T> {
    shadow: T,
    lamp: Lamp,
}

impl<T> AboveHorizon<T> {
    pub(super) fn new(shadow: T, lamp: &Lamp) -> Self {
        Self { shadow, lamp: lamp.clone() }
    }
}

impl<T: LampShadow> LampShadow for AboveHorizon<T> {
    fn shade(&self, samples: &Samples) -> Visibility {
        let mut visibility = self.shadow.shade(samples);
        above_horizon(&mut visibility, samples, &self.lamp);
        visibility
    }

    fn bytes(&self) -> usize {
        self.shadow.bytes()
    }

    fn texel_world(&self) -> Option<f64> {
        self.shadow.texel_world()
    }

    fn bias_world(&self) -> Option<f64> {
        self.shadow.bias_world()
    }
}
