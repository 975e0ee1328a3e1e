//! Soft shadows: how much of a lamp with extent reaches each sample.
//!
//! The techniques that read a shadow map share one law: a blocker of stored depth `b` over a receiver of
//! depth `r` has a penumbra of half-width `K·(b − r)` texels, whatever the slope of the receiver
//! ([`LightSpace::penumbra_scale`](super::map::LightSpace::penumbra_scale)). No radius is tuned. Without an
//! extent K is 0, and these techniques are hard shadow maps with a bilinear filter.

pub(super) mod area;
mod blocks;
mod contact_blur;
mod edge_search;
mod edges;
mod horizon;
mod hybrid;
mod light_map;
mod moments;
mod offsets;
mod options;
mod pcss;
mod pyramid;
pub(super) mod samples;
mod silhouettes;
mod single_sample;
mod sums;
#[cfg(test)]
mod tests;
mod window;

use std::fmt::Debug;

pub(super) use contact_blur::contact_blur;
pub(super) use horizon::above_horizon;
pub(super) use hybrid::soft_hybrid;
pub(super) use moments::{msm, vsm};
pub use options::{
    Certain, PcssOptions, Profile, Search, SilhouetteOptions, SingleSampleOptions, SoftHybridOptions,
    SoftMapOptions, Taps,
};
pub(super) use pcss::pcss;
pub use samples::SamplesOptions;
pub(super) use silhouettes::{penumbra_map, smoothies};
pub(super) use single_sample::single_sample;
pub(super) use sums::Sums;

use super::{Samples, Visibility};

/// A soft technique with a shadow map, prepared for one lamp.
pub(super) trait SoftShadow: Debug + Send + Sync {
    /// Fraction of the lamp that each sample sees.
    fn shade(&self, samples: &Samples) -> Visibility;

    /// Memory held for the lamp, in bytes.
    fn bytes(&self) -> usize;

    /// Side of a texel in mesh units, in the middle of what is seen.
    fn texel_world(&self) -> f64;

    /// Whether the values know what the face's own plane hides of the lamp. A map does not.
    fn sees_horizon(&self) -> bool {
        false
    }

    /// The bias of a plane that meets the light at 45° in the worst direction, in mesh units along the light.
    fn bias_world(&self) -> f64 {
        self.texel_world() * light_map::SLACK * std::f64::consts::SQRT_2
    }
}
