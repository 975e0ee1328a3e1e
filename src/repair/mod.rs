//! Repair: a mesh into one that casts better, one step a file, every change listed.
//!
//! Each step takes a mesh and gives a mesh and a [`Step`]: what it changed, and what it left and why. The
//! documentation of its function states its guarantee. Only [`weld`](fn@weld) within a distance moves a
//! vertex. No step invents a vertex, deletes a shell, or removes a self-intersection.
//!
//! [`prepare()`] runs the steps in their order.

mod change;
mod collapsed;
mod duplicates;
mod fill;
mod index_map;
mod orient;
mod parity;
mod prepare;
mod radial;
mod rewrite;
mod shadow_indices;
mod skin;
mod split;
mod stitch;
#[cfg(test)]
mod test_support;
mod unreferenced;
mod walls;
mod weld;

pub use change::{Change, ChangeKind, Left, Patch, Step};
pub use collapsed::drop_collapsed;
pub use duplicates::drop_duplicates;
pub use fill::{Fill, fill};
pub use index_map::IndexMap;
pub use orient::orient;
pub use prepare::{Options, Prepared, prepare};
pub use shadow_indices::shadow_indices;
pub use split::split;
pub use stitch::stitch;
pub use unreferenced::drop_unreferenced;
pub use weld::weld;
