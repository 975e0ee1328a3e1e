//! Geometry whose signs are exact: predicates, lights, boxes.

mod light;
pub mod predicate;

pub use light::{Light, LightError};
