//! Points where the answer is easy to get wrong: uniform sampling finds nothing where targeted sampling finds
//! one wrong answer in seventy.

use super::feature::{Feature, along, corner, nudged, rounded};
use crate::facing::{CasterFaces, classify};
use crate::geom::{Aabb, Light};
use crate::mesh::Mesh;
use crate::random::Draw;
use crate::silhouette::Silhouette;
use crate::topology::Topology;

/// A kind of point. A number says how many in four are moved by up to two ulps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum PointKind {
    /// At a position of the grid of integers, or near it.
    Anywhere,
    /// On one of these, but for rounding.
    On(&'static [Feature], u32),
    /// Behind one of these, seen from the light, by a simple multiple of its distance.
    Behind(&'static [Feature], u32),
    /// Between one of these and the light.
    Before(&'static [Feature], u32),
    /// Behind a point of a silhouette edge, at an eighth of the edge.
    BehindSilhouette(u32),
    /// On the sides of the volume, up to two ulps off.
    Boundary,
    /// Each coordinate that of some vertex.
    Corner,
    /// In the bounding box, twice as large, at eighths.
    Around,
    /// In the bounding box, twice as large.
    Box,
    /// On the light, up to two ulps off, or halfway to a vertex.
    Light,
}

impl PointKind {
    /// On a vertex or the middle of an edge; half of them up to two ulps off.
    pub(crate) const VERTEX_OR_EDGE: Self = Self::On(&[Feature::Vertex, Feature::Middle], 2);
    /// On a face, up to two ulps off.
    pub(crate) const NEAR_FACE: Self = Self::On(&[Feature::Face], 4);
    /// In the plane of a face.
    pub(crate) const FACE_PLANE: Self = Self::On(&[Feature::Plane], 0);

    /// What [`Sampler::any`] draws from, the harder kinds several times; the simplest first.
    const WEIGHTED: [Self; 14] = {
        use PointKind::{Anywhere, Around, Corner, Light};
        let [on, before] = [Self::On(Feature::ANY, 1), Self::Before(Feature::ANY, 1)];
        let [hidden, edge] = [Self::Behind(Feature::ANY, 1), Self::BehindSilhouette(1)];
        [Anywhere, on, on, before, hidden, hidden, hidden, hidden, edge, edge, edge, Corner, Around, Light]
    };
}

/// A point for `mesh` under `light`. Builds the topology and the silhouette of the mesh.
pub fn point(draw: &mut dyn Draw, mesh: &Mesh, light: &Light) -> [f32; 3] {
    Sampler::of(mesh, light).any(draw)
}

/// Draws points around a mesh and its shadow.
pub(crate) struct Sampler<'a> {
    mesh: &'a Mesh,
    light: &'a Light,
    /// Of the mesh, or around the origin.
    pub(crate) bounds: Aabb,
    silhouette: Vec<[[f64; 3]; 2]>,
}

impl<'a> Sampler<'a> {
    /// With a silhouette of its own, of all faces.
    pub(crate) fn of(mesh: &'a Mesh, light: &'a Light) -> Self {
        let topology = Topology::of(mesh);
        let silhouette = Silhouette::extract(&topology, &CasterFaces::All.signs(&classify(mesh, light)));
        Self::new(mesh, light, &topology, &silhouette)
    }

    pub(crate) fn new(
        mesh: &'a Mesh,
        light: &'a Light,
        topology: &Topology,
        silhouette: &Silhouette,
    ) -> Self {
        let ends = |edge| topology.vertices(edge).map(|v| mesh.positions()[v.index()].map(f64::from));
        Self {
            mesh,
            light,
            bounds: mesh
                .bounds()
                .map_or(Aabb { low: [-1.0; 3], high: [1.0; 3] }, |[low, high]| Aabb { low, high }),
            silhouette: silhouette.edges.iter().map(|edge| ends(edge.edge)).collect(),
        }
    }

    /// A point of any kind.
    pub(crate) fn any(&self, draw: &mut dyn Draw) -> [f32; 3] {
        let kind = draw.pick(&PointKind::WEIGHTED);
        self.draw(kind, draw)
    }

    pub(crate) fn draw(&self, kind: PointKind, draw: &mut dyn Draw) -> [f32; 3] {
        let mesh = self.mesh;
        match kind {
            PointKind::Anywhere => draw.position(),
            PointKind::On(features, nudged) => {
                let p = draw.pick(features).draw(draw, mesh);
                settled(draw, p, nudged)
            }
            PointKind::Behind(features, nudged) => {
                let p = draw.pick(features).draw(draw, mesh);
                self.behind(draw, p, nudged)
            }
            PointKind::Before(features, nudged) => {
                let p = draw.pick(features).draw(draw, mesh);
                let p = self.pushed(p, -f64::from(1 + draw.below(7)) / 8.0);
                settled(draw, p, nudged)
            }
            PointKind::BehindSilhouette(nudged) => {
                let t = if draw.flag() { f64::from(draw.below(9)) / 8.0 } else { 0.0 };
                let p = self.silhouette_point(draw, t);
                self.behind(draw, p, nudged)
            }
            PointKind::Boundary => self.boundary(draw),
            PointKind::Corner => corner(draw, mesh),
            PointKind::Around => self.in_box(|| f64::from(draw.between(-8, 8)) / 8.0),
            PointKind::Light if !self.light.is_directional() => {
                let light = self.light.xyz().map(f64::from);
                match draw.below(4) {
                    0 => rounded(light),
                    1 => nudged(draw, light),
                    _ => rounded(along([light, Feature::Vertex.draw(draw, mesh)], 0.5)),
                }
            }
            PointKind::Box | PointKind::Light => self.in_box(|| draw.signed()),
        }
    }

    /// The center of the box plus `part`, from −1 to 1, of its size along each axis. A flat box gets some
    /// thickness.
    fn in_box(&self, mut part: impl FnMut() -> f64) -> [f32; 3] {
        let least = 0.25 * self.bounds.diagonal();
        rounded([0, 1, 2].map(|i| {
            let (low, high) = (f64::from(self.bounds.low[i]), f64::from(self.bounds.high[i]));
            0.5 * (low + high) + part() * (high - low).max(least)
        }))
    }

    /// The point at `t` of a silhouette edge, or a vertex where there is no such edge.
    fn silhouette_point(&self, draw: &mut dyn Draw, t: f64) -> [f64; 3] {
        if self.silhouette.is_empty() {
            return Feature::Vertex.draw(draw, self.mesh);
        }
        along(draw.pick(&self.silhouette), t)
    }

    /// From the light to `p`; against the direction to a directional light.
    fn away(&self, p: [f64; 3]) -> [f64; 3] {
        let light = self.light.xyz().map(f64::from);
        [0, 1, 2].map(|i| if self.light.is_directional() { -light[i] } else { p[i] - light[i] })
    }

    /// `p` moved away from the light by `t` times its distance.
    fn pushed(&self, p: [f64; 3], t: f64) -> [f64; 3] {
        let away = self.away(p);
        [0, 1, 2].map(|i| p[i] + t * away[i])
    }

    /// `p` moved away from the light by a simple multiple of its distance: doubling it keeps the coordinates
    /// of a grid exact.
    fn behind(&self, draw: &mut dyn Draw, p: [f64; 3], nudged: u32) -> [f32; 3] {
        let eighths = match draw.below(5) {
            0 | 1 => 8,
            2 => draw.pick(&[16, 4, 2, 24]),
            3 => 1 + draw.below(32),
            _ => 1 + draw.below(2048),
        };
        settled(draw, self.pushed(p, f64::from(eighths) / 8.0), nudged)
    }

    /// A point of a silhouette edge pushed away from the light.
    fn boundary(&self, draw: &mut dyn Draw) -> [f32; 3] {
        // One in four exactly at a vertex.
        let t = if draw.below(4) == 0 { 0.0 } else { draw.unit() };
        let base = self.silhouette_point(draw, t);
        let away = self.away(base);
        let length = away.iter().map(|x| x * x).sum::<f64>().sqrt();
        // From a thousandth of the diagonal to one diagonal, evenly in the logarithm.
        let reach = self.bounds.diagonal() * 1000_f64.powf(draw.unit() - 1.0);
        let reach = if length > 0.0 { reach / length } else { 0.0 };
        nudged(draw, [0, 1, 2].map(|i| base[i] + reach * away[i]))
    }
}

/// Rounded; `nudged_quarters` in four are moved by up to two ulps.
fn settled(draw: &mut dyn Draw, p: [f64; 3], nudged_quarters: u32) -> [f32; 3] {
    if draw.below(4) >= 4 - nudged_quarters { nudged(draw, p) } else { rounded(p) }
}
