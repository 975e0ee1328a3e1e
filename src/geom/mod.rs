//! Geometry whose signs are exact: predicates, lights, boxes, the projection.

mod aabb;
pub mod bvh;
mod light;
pub(crate) mod overlap;
pub mod predicate;
mod projection;
mod segment;
pub(crate) mod volume;

pub use aabb::Aabb;
pub use light::{Light, LightError};
pub use projection::Projection;
pub use segment::Segment;
