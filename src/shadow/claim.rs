//! The claim of a technique: what its values promise.

use std::fmt;

/// The promise that comes with a [`Visibility`](super::Visibility). Each claim has a test that fails if the
/// claim is false.
///
/// A *judged* sample is front-lit, and its exact verdict is not grazing.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Claim {
    /// The value equals the truth at every judged sample.
    Exact,
    /// The value equals the truth at every judged sample outside the rasterizer's footprint of a boundary:
    /// counting on a device.
    WithinFootprint,
    /// The value differs from the truth at no more than this fraction of the judged samples.
    Bounded(f32),
    /// Nothing is promised.
    Approximate,
}

impl Claim {
    /// Lower-case name, as in reports: `exact`, `within_footprint`, `bounded`, `approximate`.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Exact => "exact",
            Self::WithinFootprint => "within_footprint",
            Self::Bounded(_) => "bounded",
            Self::Approximate => "approximate",
        }
    }
}

impl fmt::Display for Claim {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Exact => f.write_str("exact"),
            Self::WithinFootprint => f.write_str("exact within the rasterizer's footprint"),
            Self::Bounded(fraction) => write!(f, "at most {fraction} of the samples are wrong"),
            Self::Approximate => f.write_str("approximate"),
        }
    }
}
