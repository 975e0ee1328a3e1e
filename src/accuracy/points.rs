//! Points for the visibility queries.

use super::Options;
use super::lights::source;
use crate::facing::{CasterFaces, FacePlanes};
use crate::geom::Light;
use crate::mesh::Mesh;
use crate::random::SplitMix64;
use crate::silhouette::Silhouette;
use crate::topology::Topology;
use crate::verify::points::draw;
use crate::verify::points::feature::Feature;
use crate::verify::points::sampler::{PointKind, Sampler};

/// Names of the point strata. See [`Question::strata`](super::Question::strata).
pub(super) const STRATA: [&str; 7] = [
    draw::STRATA[0],
    draw::STRATA[1],
    draw::STRATA[2],
    draw::STRATA[3],
    draw::STRATA[4],
    "behind_vertex",
    "behind_edge",
];

/// What each of [`STRATA`] draws.
const KINDS: [PointKind; 7] = [
    draw::KINDS[0],
    draw::KINDS[1],
    draw::KINDS[2],
    draw::KINDS[3],
    draw::KINDS[4],
    PointKind::Behind(&[Feature::Vertex], 0),
    PointKind::Behind(&[Feature::Edge], 0),
];

/// The points of each stratum and light for `mesh`, which has at least one face: about the same number for
/// each light.
pub(super) fn draw(mesh: &Mesh, lights: &[Light], options: &Options) -> Vec<Vec<Vec<[f32; 3]>>> {
    let topology = Topology::of(mesh);
    let planes = FacePlanes::new(mesh);
    let count = options.queries.div_ceil(lights.len() as u64).max(1);
    let mut random: Vec<SplitMix64> =
        (0..STRATA.len()).map(|stratum| source(options.seed, stratum)).collect();
    let mut points = vec![Vec::with_capacity(lights.len()); STRATA.len()];
    for light in lights {
        let silhouette =
            Silhouette::extract(&topology, &CasterFaces::All.signs(&planes.classify(mesh, light)));
        let sampler = Sampler::new(mesh, light, &topology, &silhouette);
        for (kind, (points, random)) in KINDS.into_iter().zip(points.iter_mut().zip(&mut random)) {
            points.push((0..count).map(|_| sampler.draw(kind, random)).collect());
        }
    }
    points
}
