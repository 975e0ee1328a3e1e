//! Soft shadows: how much of a lamp with extent reaches each sample.
//!
//! The techniques that read a shadow map share one law: a blocker of stored depth `b` over a receiver of
//! depth `r` has a penumbra of half-width `K·(b − r)` texels, whatever the slope of the receiver
//! ([`LightSpace::penumbra_scale`](super::map::LightSpace::penumbra_scale)). No radius is tuned. Without an
//! extent K is 0, and these techniques are hard shadow maps with a bilinear filter.

pub(super) mod area;
mod around;
mod blocks;
mod contact_blur;
mod edge_search;
mod edges;
#[cfg(feature = "gpu")]
pub mod gpu;
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
