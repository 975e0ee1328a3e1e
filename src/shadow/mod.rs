//! Shadows: one contract for every technique, one module per technique.
//!
//! A [`Technique`] answers a [`Request`]: how much of a lamp's light reaches each visible point
//! ([`Samples`]), as a [`Visibility`] with a [`Claim`]. [`Technique::ALL`] lists the built techniques.
//! Measurements, pictures and tests iterate this list, so that every new technique is measured, rendered and
//! compared with the truth.
//!
//! ```
//! use umbrage::caster::{Caster, CasterGroup};
//! use umbrage::scene::Lamp;
//! use umbrage::shadow::{Request, Samples, Technique};
//! use umbrage::testing::shapes;
//! use umbrage::view::{Camera, Size, Up};
//!
//! let caster = Caster::new(shapes::torus(24, 12, 2.0, 0.7));
//! let casters = CasterGroup::new(vec![&caster]);
//! let size = Size::new(64, 48)?;
//! let camera = Camera::fit(&casters.bounds(), Up::Y, size.aspect());
//! let projection = camera.projection(size, camera.near([caster.mesh()], size));
//! let samples = Samples::of_view(&casters, &projection, size, 1)?;
//! let lamp: Lamp = "point:3,9,5".parse()?;
//! let visibility = Technique::Rays.shade(&Request { casters: &casters, lamp: &lamp, samples: &samples })?;
//! assert!(visibility.values().iter().any(|&lit| lit == 1.0));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod claim;
mod grid;
pub mod lod;
pub mod map;
mod name;
mod options;
mod plain;
pub mod planar;
mod prepared;
mod rays;
mod reconstruct;
mod samples;
pub mod soft;
pub mod stencil;
mod technique;
pub(crate) mod tiles;
mod visibility;
pub mod volume;

#[cfg(feature = "gpu")]
pub use crate::gpu::raster::{Depth, GpuSamples, GpuVisibility};
pub use claim::Claim;
pub use grid::GridOptions;
pub(crate) use grid::by_grid;
pub use name::TechniqueError;
use prepared::LampShadow;
pub use prepared::{PrepareError, Prepared, Request};
pub use reconstruct::ReconstructOptions;
pub use samples::{Samples, TooManySamples};
pub use stencil::CounterOptions;
pub use technique::Technique;
pub(crate) use visibility::{Answer, is_front_lit};
pub use visibility::{Updates, Visibility};
