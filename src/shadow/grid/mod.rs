//! Techniques of the light grid: it decides what it can prove, or it sorts the points for the faces.

mod alias_free;
mod hybrid;
mod options;

pub(super) use alias_free::AliasFree;
pub(super) use hybrid::GridHybrid;
pub(crate) use hybrid::by_grid;
pub use options::GridOptions;
