//! Where a picture is taken from: cameras, projections, the rays of pixels.

mod camera;
mod pinhole;
mod projection;
mod size;
mod up;

pub use camera::{Camera, CameraError};
pub use pinhole::{Pinhole, Projected};
pub use projection::Projection;
pub use size::{Size, SizeError};
pub use up::Up;
