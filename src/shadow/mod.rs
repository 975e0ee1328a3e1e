//! Shadows: one room a technique.

pub mod stencil;
pub mod volume;

#[cfg(feature = "gpu")]
pub use crate::gpu::raster::{Depth, GpuSamples, GpuVisibility};
