//! Planar shadows: casters flattened onto the plane of the receiver.
//!
//! `planar` is exact, for the lamp's center. Soft: `planar-layers` is the mean of several such shadows,
//! `planar-blur` and `planar-contact` blur one. `blob` is a dark spot, and `projective` a coverage map from
//! the lamp.
//!
//! Of all that is seen one plane receives these shadows: the one with most samples, or a given one
//! ([`Ground`]). All other samples are passed to the exact ray cast, and counted
//! ([`Visibility::asked_exactly`]).

mod blob;
mod blur;
mod boxes;
mod choice;
mod coverage;
mod cpu;
#[cfg(feature = "gpu")]
pub mod gpu;
mod interval;
mod layers;
mod matrix;
mod options;
mod polygon;
mod projective;
mod rays;
#[cfg(test)]
mod soft_tests;
#[cfg(test)]
mod tests;
mod texture;

use std::fmt::Debug;

pub(super) use blob::blob;
pub(super) use blur::{planar_blur, planar_contact};
pub(super) use cpu::planar;
pub(super) use layers::planar_layers;
pub use matrix::{Plane, flattening};
pub use options::{Coefficients, Ground, LayersOptions, MOST_TEXELS, PlanarOptions, TextureOptions};
pub(super) use projective::projective;

use super::{Samples, Visibility};

/// A technique with one receiving plane, prepared for one lamp.
pub(super) trait PlanarShadow: Debug + Send + Sync {
    /// Fraction of the lamp that each sample sees.
    fn shade(&self, samples: &Samples) -> Visibility;

    /// Memory held for the lamp, in bytes.
    fn bytes(&self) -> usize;

    /// Side of a texel in mesh units, in the middle of what is seen; `None` without a map of the lamp.
    fn texel_world(&self) -> Option<f64> {
        None
    }
}
