//! Relevance: which lamps, casters and receivers can change a sample.
//!
//! Every test answers "surely irrelevant" or "kept". What is dropped is listed with the test, the kind of
//! equality that the test preserves, and a bound.

mod dropped;

pub use dropped::{Dropped, Equality, RelevanceTest, Triple};
