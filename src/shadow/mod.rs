//! Shadows: one room a technique.

pub mod stencil;
pub mod volume;
