//! Soft shadows: how much of a lamp with extent reaches each sample.

pub(super) mod samples;

pub use samples::SamplesOptions;
