//! The stencil pass: counting the faces of shadow volumes along the ray of every pixel.
//!
//! What is decided before anything is drawn needs no graphics device: [`ShellMethods`] chooses z-pass or
//! z-fail for every shell, with the reason, and [`max_depth_complexity`] bounds the counts, so that an
//! overflow of the stencil is known beforehand.

mod cpu;
mod depth_complexity;
#[cfg(feature = "gpu")]
mod gpu;
mod light_pyramid;
mod mask;
mod method;
mod volumes;

pub(super) use cpu::StencilCounting;
pub use depth_complexity::{DepthComplexity, max_depth_complexity};
#[cfg(feature = "gpu")]
pub use gpu::{Draw, StencilFrame, StencilPass};
pub use mask::{Counting, ShadowMask};
pub use method::ShellMethods;
#[cfg(feature = "gpu")]
pub use volumes::GpuStencilVolumes;
pub use volumes::StencilVolumes;

/// The faces of a shadow volume that the stencil counts at a pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum StencilMethod {
    /// Those in front of the visible surface: no caps, but wrong if the near rectangle of the camera is in a
    /// volume or is cut by one.
    ZPass,
    /// Those behind it (also known as depth-fail): right wherever the camera is, and needs both caps.
    ZFail,
}

impl StencilMethod {
    /// Both.
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
