//! Techniques of the light grid: it decides what it can prove, or it sorts the points for the faces.

mod hybrid;
mod options;

pub(super) use hybrid::GridHybrid;
pub use options::GridOptions;
