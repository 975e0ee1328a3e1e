//! Verification of every method against every other, at points and at pixels.
//!
//! [`points`] compares the exact ray cast with the winding numbers of the emitted volumes, at points chosen
//! to be hard. [`pixels`] compares a stencil pass with the ray cast, pixel by pixel.
//! [`reference`](reference()) decides a shadow ray with big integers. [`errors`] compares any technique's
//! visibility with the truth, by kind of error.

pub mod errors;
pub mod pixels;
#[cfg(feature = "verify")]
pub mod points;
#[cfg(feature = "verify")]
mod reference;
mod tally;

#[cfg(feature = "verify")]
pub use reference::{Reference, reference};
#[cfg(feature = "verify")]
pub(crate) use reference::{WholeLight, WholePlane};
pub use tally::Tally;
