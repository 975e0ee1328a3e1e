//! Shadow maps: the depth nearest to the light, per texel.
//!
//! (Lance Williams, *Casting Curved Shadows on Curved Surfaces*, SIGGRAPH 1978.) The facing of a sample is
//! decided exactly before a map is read, so that maps are asked about front-lit samples alone.

mod bias;
#[cfg(test)]
mod bias_tests;
mod clip;
mod cpu;
mod filter;
mod fit;
#[cfg(feature = "gpu")]
pub mod gpu;
mod hybrid;
mod ids;
mod neighborhood;
mod options;
mod raster;
mod receiver;
#[cfg(test)]
mod nearest_tests;
#[cfg(test)]
mod shadow_tests;
mod space;
#[cfg(test)]
mod tests;
mod texel;
mod view_fit;

pub use bias::{Bias, Reach, Rule};
pub use cpu::MapShadow;
pub use filter::Filter;
pub(in crate::shadow) use filter::shift;
pub use hybrid::HybridShadow;
pub use ids::IdShadow;
pub use options::{ExactOptions, Fit, MapOptions, NearestOptions, PcfOptions};
pub use raster::{DepthSource, PolygonOffset, ShadowMap};
pub use receiver::{Receiver, Tap};
pub use space::{DepthPlane, Frame, LightSpace, Lookup, Spread};
pub(in crate::shadow) use space::{unit_normal, wide};
pub use texel::{Layered, Named, Texel};

/// Largest side of a map in texels: that of a texture on every device since 2012.
pub const MAX_SIZE: u32 = 16_384;

/// Why a map cannot be made.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum MapError {
    /// The side is 0, or too large.
    #[error("size={size} is not a side of a shadow map: write 1 to {MAX_SIZE}")]
    Size {
        /// The side.
        size: u32,
    },
    /// The reach is 0, or too large.
    #[error("reach={reach} is not a reach in texels: write 1 to 16")]
    Reach {
        /// The reach.
        reach: u32,
    },
    /// [`Bias::Offset`] without [`DepthSource::Interpolated`].
    #[error("bias=offset moves an interpolated depth, and depth=plane replaces it: use depth=interpolated")]
    OffsetOfPlane,
    /// A search on a graphics adapter, asked of the form of the CPU.
    #[error("search=device needs a graphics adapter, and this is the form of the CPU: use search=cpu")]
    Device,
    /// The texels do not fit the memory, or the limit of 4 GiB.
    #[error(
        "size={size} takes {} MiB in {layers} layers, more than there is or than 4096 MiB: choose a smaller size",
        bytes >> 20
    )]
    Memory {
        /// The side.
        size: u32,
        /// Number of layers.
        layers: usize,
        /// Bytes of all layers.
        bytes: usize,
    },
}
