//! The plan of a scene's shadows.

use std::time::Duration;

use super::relevance::Dropped;
use super::{Budget, Evidence};
use crate::shadow::Technique;

/// Which shadows a scene calls for, by which techniques, and why.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct ShadowPlan {
    /// The budget.
    pub budget: Budget,
    /// Number of samples that see a surface.
    pub samples: usize,
    /// Number of samples that were looked at before the choice.
    pub probed: usize,
    /// One plan a lamp, in the order of the scene.
    pub lamps: Vec<LampPlan>,
    /// What is left out, with the test that allows it.
    pub dropped: Vec<Dropped>,
    /// Penumbrae and ambient occlusion: called for, or not.
    pub effects: Vec<Effect>,
    /// Error and time of the whole picture.
    pub total: Prediction,
    /// What is not worked out, in words, with bounds.
    pub not_computed: Vec<String>,
    /// The best plan within the time of the budget and its error, in words, if the predicted time is more.
    pub over_time: Option<String>,
    /// Whether the predictions are within the budget.
    pub meets_budget: bool,
    /// Time to make the plan.
    pub planning: Duration,
}

/// The plan of one lamp.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct LampPlan {
    /// Number of the lamp.
    pub lamp: usize,
    /// The lamp's name.
    pub name: String,
    /// Fraction of the samples that face the lamp, estimated.
    pub facing: f64,
    /// Fraction of the samples that face the lamp and are dark, estimated.
    pub shadowed: f64,
    /// Number of pieces that could cast.
    pub pieces: usize,
    /// The pieces that cast.
    pub kept: Vec<u32>,
    /// One plan a group of receivers.
    pub groups: Vec<GroupPlan>,
    /// The light grid that was built for the choice: side, undecided and penumbra fractions, time.
    pub grid: Option<GridFigures>,
}

/// What the light grid of a lamp tells.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct GridFigures {
    /// Cells along each side.
    pub side: u32,
    /// Fraction of the probed samples that are neither proven lit nor proven dark.
    pub undecided: f64,
    /// Fraction of the probed samples that may be in a penumbra; `None` for a lamp without extent.
    pub maybe_penumbra: Option<f64>,
    /// Time to build and ask it.
    pub time: Duration,
}

/// The receivers of a group.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Receivers {
    /// All samples.
    All,
    /// The samples on the plane that most samples lie on.
    Plane,
    /// All others.
    Others,
}

/// The technique of a group of receivers, and why it was chosen.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct GroupPlan {
    /// The receivers.
    pub receivers: Receivers,
    /// Number of samples, estimated.
    pub samples: usize,
    /// The technique.
    pub technique: Technique,
    /// Whether it runs on the graphics adapter.
    pub on_device: bool,
    /// Its error, and its time with what no other lamp shares.
    pub prediction: Prediction,
    /// The comparison that decided, in words.
    pub reason: String,
    /// The techniques that were not chosen.
    pub rejected: Vec<Rejected>,
}

/// A predicted error and a predicted time.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Prediction {
    /// Fraction of the samples that are wrong.
    pub error: f64,
    /// Evidence of the error.
    pub evidence: Evidence,
    /// Upper bound of the error: proven, or of 95 % confidence.
    pub bound: f64,
    /// Time.
    pub time: Duration,
    /// Evidence of the time.
    pub time_evidence: Evidence,
}

/// A technique that was not chosen.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Rejected {
    /// The technique.
    pub technique: Technique,
    /// Whether it would run on the graphics adapter.
    pub on_device: bool,
    /// Its error and time; `None` where it is not applicable, or its error is not bounded.
    pub prediction: Option<Prediction>,
    /// Why not, in words.
    pub why: String,
}

/// An effect beside hard shadows, and whether the scene calls for it.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Effect {
    /// The effect, such as `penumbra of light 1` or `ambient occlusion`.
    pub name: String,
    /// Whether it is called for.
    pub called: bool,
    /// Upper bound of the fraction of samples that it changes.
    pub bound: f64,
    /// Evidence of this bound.
    pub evidence: Evidence,
    /// Why, in words.
    pub reason: String,
}
