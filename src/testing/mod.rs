//! Hard inputs, for this crate's tests and for those of others. Promises nothing between versions.
//!
//! [`shapes`] generates meshes, `strategy` draws them for proptest, and `torture` attacks the exactness itself.

#[cfg(any(test, feature = "testing"))]
pub use crate::built::{Part as BuiltPart, record as record_built};

#[cfg(feature = "verify")]
pub mod generate;
pub mod shapes;
#[cfg(any(test, feature = "testing"))]
pub mod strategy;
#[cfg(feature = "verify")]
pub mod torture;
