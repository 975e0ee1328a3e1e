//! The planner: which shadows a scene calls for, by which technique, and why.
//!
//! A [`Budget`] says how many samples may be wrong, and how long a picture may take. The plan names a
//! technique for each lamp and each group of receivers, with a bound of its error, the [`Evidence`] of this
//! bound, a predicted time, and the reason of the choice. What is left out is listed with the bound that
//! allows it.
//!
//! **Called for**: an effect (a lamp, its casters, its receivers; the penumbra of a lamp; ambient occlusion)
//! is called for under a budget if leaving it out changes more samples than the budget allows. Each dropped
//! effect is charged its bound. The bounds are added up, so that the sum of many small ones is within the
//! budget too.

mod binomial;
mod budget;
mod candidates;
mod check;
mod choose;
mod costs;
mod effects;
mod evidence;
mod frame_cache;
mod look;
mod planner;
mod probe;
mod reason;
pub mod relevance;
mod report;
mod run;
mod scenery;
mod shadow_plan;
#[cfg(test)]
mod tests;
mod trial;

pub use budget::{Budget, BudgetError};
pub use check::{Check, Checked, FIRST_LOOK, Judgment, check, count_wrong, exact_technique};
#[cfg(feature = "files")]
pub use costs::CostsError;
pub use costs::{CostKey, Costs, Step, Work};
pub use evidence::Evidence;
pub use frame_cache::{Frame, FrameCache, FrameError, Made, Moment, Posed};
pub use planner::plan;
pub use run::{Run, Task, run};
pub use scenery::Scenery;
pub use shadow_plan::{
    Effect, GridFigures, GroupPlan, LampPlan, Prediction, Receivers, Rejected, ShadowPlan,
};
