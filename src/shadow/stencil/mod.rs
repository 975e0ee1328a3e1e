//! The stencil pass: counting a shadow volume's faces along the way of every pixel.
//!
//! What is decided before anything is drawn stands here, and needs no graphics device: [`ShellMethods`] chooses z-pass
//! or z-fail for every shell and says why, and [`max_depth_complexity`] bounds the counts, so that one that would not fit the
//! stencil is known beforehand.

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
pub(crate) use gpu::SOURCE;
#[cfg(feature = "gpu")]
pub use gpu::{Depth, Draw, Receivers, StencilFrame, StencilPass};
pub use mask::{Counting, ShadowMask};
pub use method::ShellMethods;
#[cfg(feature = "gpu")]
pub use volumes::GpuStencilVolumes;
pub use volumes::StencilVolumes;

/// Which faces of a shadow volume the stencil counts at a pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum StencilMethod {
    /// Those in front of the visible surface: no caps, but wrong if the near rectangle of the camera is in a volume
    /// or is cut by one.
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
