//! The light grid: what a light sees, conservatively, in cells.
//!
//! The rays of a light are cut into the cells of a grid. Of each cell that holds a visible point it is known
//! which connected pieces of the casters meet it, between which depths, and whether every ray of the cell
//! crosses such a piece. All bounds are rounded outwards. So most points are proven to be lit or to be dark,
//! and the others are undecided: next to silhouettes, where a map is wrong.
//!
//! (Stefan Hertel, Kai Hormann, Rüdiger Westermann, *A Hybrid GPU Rendering Pipeline for Alias-Free Hard
//! Shadows*, Eurographics 2009, is the nearest relative: conservative shadow maps with ray casting. Pieces
//! instead of triangles prove darkness too, where no single triangle covers a cell.)
//!
//! ```
//! use umbrage::caster::{Caster, CasterGroup};
//! use umbrage::light_grid::{Chain, GridVerdict, LightGrid};
//! use umbrage::testing::shapes;
//!
//! let caster = Caster::new(shapes::torus(24, 12, 2.0, 0.7));
//! let casters = CasterGroup::new(vec![&caster]);
//! let chain = Chain::of(&casters, &"point:0,0,9".parse()?);
//! let points = [[2.0, 0.1, -3.0], [0.1, 0.2, -3.0], [5.0, 5.0, -3.0]];
//! let grid = LightGrid::build(&chain, points, 64);
//! let verdicts = points.map(|p| grid.verdict_at(p));
//! assert_eq!(verdicts, [GridVerdict::Dark, GridVerdict::Lit, GridVerdict::Lit]);
//! # Ok::<(), umbrage::geom::LightError>(())
//! ```

mod bits;
mod cells;
mod chain;
mod extent;
mod facet;
mod fault;
mod grid;
mod occluders;
mod pairs;
mod sheets;
mod soft;
#[cfg(test)]
mod soft_tests;
mod sorted;
#[cfg(test)]
mod sorted_tests;
#[cfg(test)]
mod tests;
mod verdict;
pub(crate) mod view;

pub use chain::Chain;
pub use grid::{GridEntries, LightGrid};
pub(crate) use occluders::Occluders;
pub use soft::{SoftGrid, SoftVerdict};
pub use sorted::sorted_verdicts;
pub use verdict::GridVerdict;
