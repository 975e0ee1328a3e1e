//! Where to look: uniform sampling finds nothing where targeted sampling finds one wrong answer in seventy.

use super::Options;
use crate::geom::{Aabb, Light};
use crate::mesh::Mesh;
use crate::random::SplitMix64;
use crate::silhouette::Silhouette;
use crate::topology::Topology;

/// The kinds of points, in the order in which they are drawn in turn:
///
/// - `box`: uniform in the bounding box, twice as large;
/// - `near_face`: on a face, rounded to `f32` and moved by up to two ulps;
/// - `shadow_boundary`: on the sides of the volume, rounded and moved by up to two ulps;
/// - `face_plane`: in the plane of a face, inside or outside it, rounded;
/// - `vertex_or_edge`: on a vertex or at the rounded middle of an edge; half of them moved by up to two ulps.
pub const STRATA: [&str; 5] = ["box", "near_face", "shadow_boundary", "face_plane", "vertex_or_edge"];

/// Draws the points: the index of the stratum, and the place. The same options give the same points.
pub(crate) fn draw(
    mesh: &Mesh,
    topology: &Topology,
    silhouette: &Silhouette,
    light: &Light,
    options: &Options,
) -> Vec<(usize, [f32; 3])> {
    let mut random = SplitMix64(options.seed);
    let bounds =
        mesh.bounds().map_or(Aabb { low: [-1.0; 3], high: [1.0; 3] }, |[low, high]| Aabb { low, high });
    let sampler = Sampler { mesh, topology, silhouette, light, bounds };
    (0..options.points)
        .map(|i| {
            let stratum = i % STRATA.len();
            let p = match stratum {
                _ if mesh.face_count() == 0 => sampler.in_box(&mut random),
                1 => sampler.near_face(&mut random),
                2 => sampler.shadow_boundary(&mut random),
                3 => sampler.face_plane(&mut random),
                4 => sampler.vertex_or_edge(&mut random),
                _ => sampler.in_box(&mut random),
            };
            (stratum, p)
        })
        .collect()
}

/// Draws points of each kind; the mesh has a face.
pub(crate) struct Sampler<'a> {
    pub(crate) mesh: &'a Mesh,
    pub(crate) topology: &'a Topology,
    pub(crate) silhouette: &'a Silhouette,
    pub(crate) light: &'a Light,
    pub(crate) bounds: Aabb,
}

impl Sampler<'_> {
    pub(crate) fn in_box(&self, random: &mut SplitMix64) -> [f32; 3] {
        rounded([0, 1, 2].map(|i| {
            let (low, high) = (f64::from(self.bounds.low[i]), f64::from(self.bounds.high[i]));
            // A flat box gets some thickness.
            let size = (high - low).max(0.25 * self.bounds.diagonal());
            0.5 * (low + high) + (2.0 * random.unit() - 1.0) * size
        }))
    }

    fn corners(&self, random: &mut SplitMix64) -> [[f64; 3]; 3] {
        let face = self.mesh.triangles()[random.below(self.mesh.face_count())];
        face.map(|vertex| self.mesh.positions()[vertex as usize].map(f64::from))
    }

    pub(crate) fn near_face(&self, random: &mut SplitMix64) -> [f32; 3] {
        let corners = self.corners(random);
        let (mut u, mut v) = (random.unit(), random.unit());
        if u + v > 1.0 {
            (u, v) = (1.0 - u, 1.0 - v);
        }
        nudged(combined(corners, u, v), random)
    }

    pub(crate) fn face_plane(&self, random: &mut SplitMix64) -> [f32; 3] {
        // Eighths, so that on axis-aligned faces the point stays exactly in the plane.
        let mut eighths = || (random.below(41) as f64 - 16.0) / 8.0;
        let (u, v) = (eighths(), eighths());
        rounded(combined(self.corners(random), u, v))
    }

    pub(crate) fn vertex_or_edge(&self, random: &mut SplitMix64) -> [f32; 3] {
        let [a, b, _] = self.corners(random);
        let middle = [0, 1, 2].map(|i| 0.5 * (a[i] + b[i]));
        match random.below(4) {
            0 => rounded(a),
            1 => rounded(middle),
            2 => nudged(a, random),
            _ => nudged(middle, random),
        }
    }

    /// A point of a silhouette edge pushed away from the light.
    pub(crate) fn shadow_boundary(&self, random: &mut SplitMix64) -> [f32; 3] {
        if self.silhouette.edges.is_empty() {
            return self.near_face(random);
        }
        let edge = self.silhouette.edges[random.below(self.silhouette.edges.len())].edge;
        let [a, b] = self.topology.vertices(edge).map(|v| self.mesh.positions()[v.index()].map(f64::from));
        // One in four exactly at a vertex.
        let t = if random.below(4) == 0 { 0.0 } else { random.unit() };
        let base: [f64; 3] = [0, 1, 2].map(|i| a[i] + t * (b[i] - a[i]));
        let light = self.light.xyz().map(f64::from);
        let away: [f64; 3] =
            [0, 1, 2].map(|i| if self.light.is_directional() { -light[i] } else { base[i] - light[i] });
        let length = away.iter().map(|x| x * x).sum::<f64>().sqrt();
        if length == 0.0 {
            return nudged(base, random);
        }
        // From a thousandth of the diagonal to one diagonal, evenly in the logarithm.
        let reach = self.bounds.diagonal() * 1000_f64.powf(random.unit() - 1.0);
        nudged([0, 1, 2].map(|i| base[i] + away[i] / length * reach), random)
    }
}

fn combined([a, b, c]: [[f64; 3]; 3], u: f64, v: f64) -> [f64; 3] {
    [0, 1, 2].map(|i| a[i] + u * (b[i] - a[i]) + v * (c[i] - a[i]))
}

/// The nearest `f32` point that is finite.
pub(crate) fn rounded(p: [f64; 3]) -> [f32; 3] {
    p.map(|x| (x as f32).clamp(f32::MIN, f32::MAX) + 0.0)
}

/// The nearest `f32` point, each coordinate moved by −2 … 2 ulps.
pub(crate) fn nudged(p: [f64; 3], random: &mut SplitMix64) -> [f32; 3] {
    rounded(p).map(|mut x| {
        let steps = random.below(5) as i32 - 2;
        for _ in 0..steps.abs() {
            x = if steps > 0 { x.next_up() } else { x.next_down() };
        }
        x.clamp(f32::MIN, f32::MAX) + 0.0
    })
}
