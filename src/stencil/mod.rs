//! Counting in pixels: how many volumes the visible point of each pixel is in.

#[cfg(feature = "gpu")]
mod gpu;
mod mask;

#[cfg(feature = "gpu")]
pub use gpu::{Depth, Draw, Receivers, StencilPass};
#[cfg(feature = "gpu")]
pub(crate) use gpu::{Pipeline, SOURCE, Target, depth_stencil};
pub use mask::{Counting, ShadowMask};

/// How a volume is counted in the stencil.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StencilMethod {
    /// What is in front of the visible point. Needs no caps; right only where the near rectangle is in no volume.
    ZPass,
    /// What is behind it. Right everywhere.
    ZFail,
}
