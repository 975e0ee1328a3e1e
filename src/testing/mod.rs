//! Hard inputs, for this crate's tests and for those of others. Promises nothing between versions.
//!
//! [`shapes`] generates meshes, `strategy` draws them for proptest, and `torture` attacks the exactness itself.

pub mod shapes;
#[cfg(any(test, feature = "proptest"))]
pub mod strategy;
#[cfg(feature = "verify")]
pub mod torture;
