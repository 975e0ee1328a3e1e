//! Clips, skins and morph targets: what moves a scene, and where it puts vertices at a time.
//!
//! A [`Rig`] holds the node tree, skins and [`Clip`]s of a file. [`Scene::pose`](crate::scene::Scene::pose)
//! puts it at a [`Pose`]: a clip and a time, or a frame.
//!
//! Source: Khronos, *glTF 2.0 Specification*, §3.7.2.2 (morph targets), §3.7.3 (skins), §3.11 (animations)
//! and appendix C (interpolation).
//!
//! Times, matrices and weighted sums are `f64`; each position is rounded to `f32` once, at the end. Outside
//! of its first and last key a channel holds the value there.
#![cfg_attr(
    not(feature = "files"),
    allow(dead_code, unused_imports, reason = "it is the readers of files that fill rigs")
)]

mod clip;
mod deform;
mod fault;
mod morph;
mod pose;
mod rig;
mod skin;
#[cfg(test)]
mod tests;
mod track;
mod transform;

pub(crate) use clip::Channel;
pub use clip::{Clip, Property};
pub(crate) use deform::Deformed;
pub(crate) use morph::between;
pub use pose::{Moment, Pose, PoseError};
pub use rig::Rig;
pub(crate) use rig::{AtRest, Node, Placing, Posed};
pub(crate) use skin::{Influences, Skin};
pub use track::Interpolation;
pub(crate) use track::Track;
pub(crate) use transform::Local;
