//! Relevance: which lamps, casters and receivers can change a sample.
//!
//! Every test answers "surely irrelevant" or "kept". What is dropped is listed with the test, the kind of
//! equality that the test preserves, and a bound. The tests run from the cheapest on, each on what the ones
//! before have kept.
//!
//! A caster that is dropped because it crosses no ray changes no count. A caster that is dropped because
//! another one shadows it is farther from the lamp than that one along every ray. So of all faces that a ray
//! crosses the nearest to the lamp belongs to a caster that is kept, and no verdict changes, whatever the
//! order and the combination of the tests.
//!
//! ```
//! use umbrage::caster::{Caster, CasterGroup};
//! use umbrage::mesh::Mesh;
//! use umbrage::plan::relevance::{Outcome, Pieces, Question, TestSet, relevant};
//! use umbrage::shadow::Samples;
//! use umbrage::testing::shapes;
//! use umbrage::view::{Camera, Size, Up};
//!
//! // A floor, a cube over it, and one below it.
//! let floor = shapes::cuboid([-9.0, -2.0, -9.0], [9.0, -1.5, 9.0]);
//! let below = shapes::translated(&shapes::cube(), [0.0, -5.0, 0.0]);
//! let caster = Caster::new(Mesh::concat(&[floor, shapes::cube(), below])?);
//! let casters = CasterGroup::new(vec![&caster]);
//! let size = Size::new(32, 32)?;
//! let camera = Camera::look_at([9.0, 9.0, 9.0], [0.0; 3], 1.0, Up::Y)?;
//! let samples = Samples::of_view(&casters, &camera.projection(size, 0.1), size, 1)?;
//!
//! let (pieces, lamp) = (Pieces::of(&casters), "point:1,9,2".parse()?);
//! let found = relevant(&Question {
//!     casters: &casters,
//!     pieces: &pieces,
//!     lamp: &lamp,
//!     number: 0,
//!     samples: &samples,
//!     physical_falloff: false,
//!     level: 0.0,
//!     tests: TestSet::ALL,
//! });
//! assert_eq!((found.outcome, found.kept), (Outcome::Shadows, vec![1]));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod apart;
mod casting;
mod copies;
mod dropped;
mod fault;
mod grid;
mod lamp;
mod pieces;
mod question;
mod reach;
mod receivers;
mod shadowed;
mod solids;
mod test_set;
#[cfg(test)]
mod tests;

pub use casting::casting;
pub use dropped::{Dropped, Equality, RelevanceTest, Triple};
pub use pieces::{Piece, Pieces};
pub use question::{Outcome, Question, Relevance, relevant};
pub(super) use reach::may_light;
pub use test_set::TestSet;
