//! Drawing triangles: pipelines, and depth and stencil to draw into.

mod pipeline;
mod target;

pub(crate) use pipeline::{FORMAT, Pipeline, depth_stencil};
pub(crate) use target::Target;
