//! The crack report: everything that is wrong with a mesh, by name, with positions.
//!
//! A defect is data, not an error: any mesh gets a report. Terms are defined at [`Counts`]; what each kind of
//! defect does to a shadow is said by [`DefectKind::effect`].

mod balance;
mod boundary;
mod counts;
mod defect;
mod faces;
mod nesting;
mod report;
mod requirement;
mod self_intersections;
mod shells;
mod t_junctions;
#[cfg(test)]
mod tests;
mod text;

pub use balance::Screen;
pub use boundary::NearMiss;
pub use counts::{Counts, Verdict};
pub use defect::{Defect, DefectKind, Severity};
pub use report::CrackReport;
pub use requirement::{Requirement, Standing, UnknownRequirement};
pub(crate) use self_intersections::{
    Corners, for_each_intersection_among, intersect, is_star, segment_meets,
};
pub use self_intersections::{SelfIntersections, for_each_self_intersection, self_intersections};
pub use shells::ShellReport;
pub(crate) use t_junctions::exact_t_junctions;
