//! Planar shadows: casters flattened onto the plane of the receiver.
//!
//! Of all that is seen one plane receives these shadows: the one with most samples, or a given one
//! ([`Ground`]). All other samples are passed to the exact ray cast, and counted
//! ([`Visibility::asked_exactly`]).

mod boxes;
mod choice;
mod coverage;
mod cpu;
mod interval;
mod matrix;
mod options;
mod polygon;
#[cfg(test)]
mod tests;

use std::fmt::Debug;

pub(super) use cpu::planar;
pub use matrix::{Plane, flattening};
pub use options::{Coefficients, Ground, PlanarOptions};

use super::{Samples, Visibility};

/// A technique with one receiving plane, prepared for one lamp.
pub(super) trait PlanarShadow: Debug + Send + Sync {
    /// Fraction of the lamp that each sample sees.
    fn shade(&self, samples: &Samples) -> Visibility;

    /// Memory held for the lamp, in bytes.
    fn bytes(&self) -> usize;
}
