//! Points for the visibility queries.

use super::Options;
use super::lights::source;
use crate::facing::{CasterFaces, FacePlanes};
use crate::geom::{Aabb, Light};
use crate::mesh::Mesh;
use crate::random::SplitMix64;
use crate::silhouette::Silhouette;
use crate::topology::Topology;
use crate::verify::points::draw;
use crate::verify::points::draw::{Sampler, rounded};

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

/// The points of each stratum and light for `mesh`, which has at least one face: about the same number for
/// each light.
pub(super) fn draw(mesh: &Mesh, lights: &[Light], options: &Options) -> Vec<Vec<Vec<[f32; 3]>>> {
    let topology = Topology::of(mesh);
    let planes = FacePlanes::new(mesh);
    let bounds = mesh.bounds().map_or(Aabb::EMPTY, |[low, high]| Aabb { low, high });
    let count = options.queries.div_ceil(lights.len() as u64).max(1);
    let mut random: Vec<SplitMix64> =
        (0..STRATA.len()).map(|stratum| source(options.seed, stratum)).collect();
    let mut points = vec![Vec::with_capacity(lights.len()); STRATA.len()];
    for light in lights {
        let silhouette =
            Silhouette::extract(&topology, &CasterFaces::All.signs(&planes.classify(mesh, light)));
        let sampler = Sampler { mesh, topology: &topology, silhouette: &silhouette, light, bounds };
        for (stratum, (points, random)) in points.iter_mut().zip(&mut random).enumerate() {
            points.push((0..count).map(|_| draw_one(stratum, &sampler, random)).collect());
        }
    }
    points
}

fn draw_one(stratum: usize, sampler: &Sampler<'_>, random: &mut SplitMix64) -> [f32; 3] {
    match stratum {
        0 => sampler.in_box(random),
        1 => sampler.near_face(random),
        2 => sampler.shadow_boundary(random),
        3 => sampler.face_plane(random),
        4 => sampler.vertex_or_edge(random),
        _ => {
            let mut face = sampler.mesh.triangles()[random.below(sampler.mesh.face_count())];
            face.rotate_left(random.below(3));
            let [a, b, _] = face.map(|vertex| sampler.mesh.positions()[vertex as usize].map(f64::from));
            let t = if stratum == 5 { 0.0 } else { random.unit() };
            behind([0, 1, 2].map(|i| a[i] + t * (b[i] - a[i])), sampler.light, random)
        }
    }
}

/// A point whose segment to the light passes through `base` up to rounding. Its distance from `base` is a
/// simple multiple of the light's.
fn behind(base: [f64; 3], light: &Light, random: &mut SplitMix64) -> [f32; 3] {
    let reach = [0.25, 0.5, 1.0, 2.0, 3.0][random.below(5)];
    let towards = light.xyz().map(f64::from);
    rounded([0, 1, 2].map(|i| {
        let away = if light.is_directional() { -towards[i] } else { base[i] - towards[i] };
        base[i] + reach * away
    }))
}
