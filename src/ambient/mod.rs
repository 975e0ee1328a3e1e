//! Ambient occlusion: how much of the sky above a surface point no face hides.
//!
//! [`Ambient::openness`] is the share of the light of an even sky that arrives, weighted by the cosine to the
//! normal: 1 with nothing in the way, 0 inside a closed shell. Occlusion is 1 less openness.

mod at_point;
pub mod disks;
mod exact;
mod fan;
mod fit;
mod inside;
mod lattice;
mod rays;
mod receivers;
mod ring;
#[cfg(feature = "verify")]
mod sample;
mod sides;
mod smooth;
mod start;
#[cfg(test)]
mod bound_tests;
#[cfg(test)]
mod closed_tests;

pub use at_point::PointRays;
pub use exact::{Exact, exact, exact_bent_part, exact_part};
pub use fit::{Ask, InsideError, MOST_INSIDE};
pub use rays::{Cast, Effort, MOST_RAYS, RayOptions, Reach, Ring};
pub use receivers::{Per, Receiver, Receivers};

/// Openness of receivers, one value each, in their order.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Ambient {
    /// (1/π) ∫ over the open directions above the horizon of the cosine to the normal: 0 to 1.
    pub openness: Vec<f32>,
    /// The mean of the open directions, of length 1; zero where nothing is open. Only if asked for.
    pub bent: Option<Vec<[f32; 3]>>,
    /// Receivers inside the solid of another closed shell, ascending; their openness is 0.
    pub inside: Vec<u32>,
    /// The standard error of one value, where the method estimates it from its own samples.
    pub standard_error: Option<f64>,
}
