//! Geometry with exact signs: predicates, lights, sides of faces, boxes, bounding volume hierarchies.

mod aabb;
pub(crate) mod box_pairs;
pub mod bvh;
mod facing;
mod light;
pub(crate) mod polygon;
pub mod predicate;
mod segment;
pub(crate) mod signed_volume;

pub use aabb::Aabb;
pub use facing::Facing;
pub use light::{Light, LightError};
pub use segment::Segment;
