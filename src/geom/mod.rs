//! Geometry whose signs are exact: predicates, lights, boxes.

mod aabb;
pub mod bvh;
mod light;
pub mod predicate;
mod segment;
pub(crate) mod volume;

pub use aabb::Aabb;
pub use light::{Light, LightError};
pub use segment::Segment;
