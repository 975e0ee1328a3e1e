//! Which points are asked about.

use crate::mesh::Mesh;
use crate::random::SplitMix64;
use crate::verify::points::draw::{Sampler, nudged, rounded};

/// A kind of points; the first five are those of [`STRATA`](crate::verify::points::STRATA).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Aim {
    /// In the bounding box, twice as large.
    Box,
    /// On a face, moved by up to two ulps.
    Face,
    /// On the sides of the volume, moved by up to two ulps.
    Boundary,
    /// In the plane of a face.
    Plane,
    /// On a vertex, an edge or a face but for rounding, half of the places at eighths.
    Surface,
    /// On a vertex or the middle of an edge, or up to two ulps off.
    Vertex,
    /// Each coordinate that of some vertex.
    Corner,
    /// Behind a vertex or the middle of a silhouette edge by a simple multiple of the light's distance; half of them up to two ulps off.
    Behind,
    /// On the light, beside it, or halfway to a vertex.
    Light,
}

impl Aim {
    pub(crate) fn draw(self, sampler: &Sampler<'_>, random: &mut SplitMix64) -> [f32; 3] {
        match self {
            Self::Box => sampler.in_box(random),
            Self::Face => sampler.near_face(random),
            Self::Boundary => sampler.shadow_boundary(random),
            Self::Plane => sampler.face_plane(random),
            Self::Surface => surface(sampler.mesh, random),
            Self::Vertex => sampler.vertex_or_edge(random),
            Self::Corner => [0, 1, 2].map(|i| vertex(sampler.mesh, random)[i]),
            Self::Behind => behind(sampler, random),
            Self::Light => near_light(sampler, random),
        }
    }
}

fn vertex(mesh: &Mesh, random: &mut SplitMix64) -> [f32; 3] {
    let face = mesh.triangles()[random.below(mesh.face_count())];
    mesh.positions()[face[random.below(3)] as usize]
}

fn surface(mesh: &Mesh, random: &mut SplitMix64) -> [f32; 3] {
    let mut face = mesh.triangles()[random.below(mesh.face_count())];
    face.rotate_left(random.below(3));
    let [a, b, c] = face.map(|vertex| mesh.positions()[vertex as usize].map(f64::from));
    let in_eighths = random.below(2) == 0;
    let mut part = || if in_eighths { random.below(9) as f64 / 8.0 } else { random.unit() };
    let (mut u, mut v) = (part(), part());
    match random.below(3) {
        0 => (u, v) = (0.0, 0.0),
        1 => v = 0.0,
        _ if u + v > 1.0 => (u, v) = (1.0 - u, 1.0 - v),
        _ => {}
    }
    rounded([0, 1, 2].map(|i| a[i] + u * (b[i] - a[i]) + v * (c[i] - a[i])))
}

fn behind(sampler: &Sampler<'_>, random: &mut SplitMix64) -> [f32; 3] {
    let edges = &sampler.silhouette.edges;
    let base = if random.below(2) == 0 || edges.is_empty() {
        vertex(sampler.mesh, random).map(f64::from)
    } else {
        let ends = sampler.topology.vertices(edges[random.below(edges.len())].edge);
        let [a, b] = ends.map(|vertex| sampler.mesh.positions()[vertex.index()].map(f64::from));
        [0, 1, 2].map(|i| 0.5 * (a[i] + b[i]))
    };
    let light = sampler.light.xyz().map(f64::from);
    let reach = [0.25, 0.5, 1.0, 2.0, 3.0][random.below(5)];
    let p = [0, 1, 2].map(|i| {
        let away = if sampler.light.is_directional() { -light[i] } else { base[i] - light[i] };
        base[i] + reach * away
    });
    if random.below(2) == 0 { rounded(p) } else { nudged(p, random) }
}

fn near_light(sampler: &Sampler<'_>, random: &mut SplitMix64) -> [f32; 3] {
    let light = sampler.light.xyz().map(f64::from);
    match random.below(4) {
        _ if sampler.light.is_directional() => sampler.in_box(random),
        0 => rounded(light),
        1 => nudged(light, random),
        _ => {
            let v = vertex(sampler.mesh, random).map(f64::from);
            rounded([0, 1, 2].map(|i| 0.5 * (light[i] + v[i])))
        }
    }
}
