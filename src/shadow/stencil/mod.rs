//! Stencil shadow volumes: the faces of a volume are counted along the view ray of every pixel.
//!
//! This module holds the decisions that come before drawing and need no graphics device. [`ShellMethods`]
//! chooses z-pass or z-fail for every shell, with a reason. [`max_depth_complexity`] bounds the counts, so
//! that an overflow of the stencil is known in advance.

mod cpu;
mod depth_complexity;
#[cfg(feature = "gpu")]
mod fault;
#[cfg(feature = "gpu")]
mod gpu;
mod light_pyramid;
mod mask;
mod method;
#[cfg(feature = "gpu")]
mod scissor;
#[cfg(all(test, feature = "gpu"))]
mod scissor_tests;
mod tiled;
mod volumes;
#[cfg(test)]
mod volumes_tests;
mod zpass_plus;
mod zpass_verdict;

pub(super) use cpu::StencilCounting;
pub use depth_complexity::{DepthComplexity, max_depth_complexity};
#[cfg(feature = "gpu")]
pub use gpu::{Draw, MaskedPass, StencilFrame, StencilPass, ZPassPlusPass};
pub use mask::{Counting, ShadowMask};
pub use method::ShellMethods;
#[cfg(feature = "gpu")]
pub use scissor::ReceiverTiles;
pub use tiled::CounterOptions;
pub(super) use tiled::{ClosedVolume, Counter, TiledCounting};
#[cfg(feature = "gpu")]
pub use volumes::GpuStencilVolumes;
pub use volumes::StencilVolumes;
pub(super) use zpass_plus::ZPassPlus;
pub use zpass_verdict::{ZPassVerdict, zpass_verdict};

/// Method of stencil counting: which faces of a shadow volume are counted at a pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum StencilMethod {
    /// Counts the faces in front of the visible surface. Needs no caps, but is wrong if the near rectangle of
    /// the camera is in a volume or is cut by one.
    ZPass,
    /// Counts the faces behind the visible surface (depth-fail). Correct for any camera, but needs both caps.
    ZFail,
}

impl StencilMethod {
    /// Both methods.
    pub const ALL: [Self; 2] = [Self::ZPass, Self::ZFail];

    /// Lower-case name, as on the command line and in reports.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::ZPass => "zpass",
            Self::ZFail => "zfail",
        }
    }
}
