//! Rasterization: what every technique that draws triangles needs, and nothing that knows of a technique.
//!
//! [`Receivers`] are triangles in storage buffers, [`Frame`] is the camera and light that shaders are given,
//! and [`GpuSamples`] is what the camera sees of the receivers: depth and face of every sample. A technique
//! turns samples into a [`GpuVisibility`], which the picture multiplies into the light of its lamp.

mod frame;
mod pipeline;
mod receivers;
mod samples;
mod target;
mod visibility;

pub(crate) use frame::{Frame, to_one};
pub(crate) use pipeline::{Drawing, FORMAT, Pipeline, counting_layout, depth_stencil, everywhere};
pub use receivers::Depth;
pub(crate) use receivers::{ReceiverDepth, Receivers};
pub use samples::GpuSamples;
pub(crate) use target::Target;
pub use visibility::GpuVisibility;

/// WGSL that the shaders of all passes start with.
pub(crate) const SOURCE: &str = include_str!("raster.wgsl");
