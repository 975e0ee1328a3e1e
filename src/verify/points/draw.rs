//! Which points are judged.

use super::Options;
use super::sampler::{PointKind, Sampler};
use crate::random::SplitMix64;

/// The kinds of points, in the order in which they are drawn in turn:
///
/// - `box`: uniform in the bounding box, twice as large;
/// - `near_face`: on a face, rounded to `f32` and moved by up to two ulps;
/// - `shadow_boundary`: on the sides of the volume, rounded and moved by up to two ulps;
/// - `face_plane`: in the plane of a face, inside or outside it, rounded;
/// - `vertex_or_edge`: on a vertex or at the rounded middle of an edge; half of them moved by up to two ulps.
pub const STRATA: [&str; 5] = ["box", "near_face", "shadow_boundary", "face_plane", "vertex_or_edge"];

/// What each of [`STRATA`] draws.
pub(crate) const KINDS: [PointKind; 5] = [
    PointKind::Box,
    PointKind::NEAR_FACE,
    PointKind::Boundary,
    PointKind::FACE_PLANE,
    PointKind::VERTEX_OR_EDGE,
];

/// Draws the points: the index of the stratum, and the position. The same options give the same points.
pub(crate) fn draw(sampler: &Sampler<'_>, options: &Options) -> Vec<(usize, [f32; 3])> {
    let mut random = SplitMix64(options.seed);
    let strata = (0..STRATA.len()).cycle().take(options.points);
    strata.map(|stratum| (stratum, sampler.draw(KINDS[stratum], &mut random))).collect()
}
