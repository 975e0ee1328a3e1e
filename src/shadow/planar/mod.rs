//! Planar shadows: casters flattened onto the plane of the receiver.
//!
//! `planar` is exact, for the lamp's center. Soft: `planar-layers` is the mean of several such shadows,
//! `planar-blur` and `planar-contact` blur one. `blob` is a dark spot, and `projective` a coverage map from
//! the lamp.
//!
//! Of all that is seen one plane receives these shadows: the one with most samples, or a given one
//! ([`Ground`]). All other samples are passed to the exact ray cast, and counted
//! ([`Visibility::asked_exactly`](crate::shadow::Visibility::asked_exactly)).

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

pub(super) use blob::blob;
pub(super) use blur::{planar_blur, planar_contact};
pub(super) use cpu::planar;
pub(super) use layers::planar_layers;
pub use matrix::{Plane, flattening};
pub use options::{Coefficients, Ground, LayersOptions, MOST_TEXELS, PlanarOptions, TextureOptions};
pub(super) use projective::projective;
