//! Views of a scene: cameras, projections, the rays of pixels.

mod camera;
mod near;
mod projection;
mod rays;
mod size;
mod up;

pub use camera::{Camera, CameraError, Lens};
pub use projection::{Projection, ProjectionError, ProjectionKind};
pub use rays::{Projected, Ray, Rays};
pub use size::{Size, SizeError};
pub use up::Up;
