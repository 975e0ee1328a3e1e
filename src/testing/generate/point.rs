//! Points where the answer is easy to get wrong: uniform sampling finds nothing where targeted sampling finds
//! one wrong answer in seventy.

use super::Draw;
use super::feature::{along, combined, corners, edge, face, nudged, plane, rounded, vertex};
use crate::facing::{CasterFaces, classify};
use crate::geom::{Aabb, Light};
use crate::mesh::Mesh;
use crate::silhouette::Silhouette;
use crate::topology::Topology;

/// A kind of point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum PointKind {
    /// At a position of the grid of integers, or near it.
    Anywhere,
    /// On a vertex, an edge, a face or in a face's plane but for rounding; one in four is up to two ulps off.
    Feature,
    /// Three in four on a vertex, an edge or a face, but for rounding.
    Surface,
    /// On a vertex or the middle of an edge; half of them up to two ulps off.
    VertexOrEdge,
    /// On a face, up to two ulps off.
    NearFace,
    /// In the plane of a face.
    FacePlane,
    /// Each coordinate that of some vertex.
    Corner,
    /// Behind a vertex or the middle of a silhouette edge by a simple multiple of the light's distance; half
    /// of them up to two ulps off.
    Behind,
    /// Behind a vertex, but for rounding.
    BehindVertex,
    /// Behind a point of an edge, but for rounding.
    BehindEdge,
    /// Behind any feature, or between it and the light; one in four is up to two ulps off.
    BehindFeature,
    /// Behind a point of a silhouette edge at an eighth; one in four is up to two ulps off.
    BehindSilhouette,
    /// On the sides of the volume, up to two ulps off.
    Boundary,
    /// In the bounding box, twice as large, at eighths.
    Around,
    /// In the bounding box, twice as large.
    Box,
    /// On the light, up to two ulps off, or halfway to a vertex.
    Light,
}

impl PointKind {
    /// What [`Sampler::any`] draws from, the harder kinds several times; the simplest first.
    const WEIGHTED: [Self; 16] = [
        Self::Anywhere,
        Self::Feature,
        Self::Feature,
        Self::Feature,
        Self::BehindFeature,
        Self::BehindFeature,
        Self::BehindFeature,
        Self::BehindFeature,
        Self::BehindFeature,
        Self::BehindSilhouette,
        Self::BehindSilhouette,
        Self::BehindSilhouette,
        Self::Corner,
        Self::Around,
        Self::Around,
        Self::Light,
    ];
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
            PointKind::Feature => {
                let p = self.feature(draw);
                seldom_nudged(draw, p)
            }
            PointKind::Surface => rounded(match draw.below(3) {
                0 => vertex(draw, mesh),
                1 => {
                    let [a, b, _] = corners(draw, mesh);
                    let t = if draw.flag() { draw.unit() } else { f64::from(draw.below(9)) / 8.0 };
                    along([a, b], t)
                }
                _ => face(draw, mesh),
            }),
            PointKind::VertexOrEdge => {
                let [a, b, _] = corners(draw, mesh);
                let p = if draw.flag() { along([a, b], 0.5) } else { a };
                if draw.flag() { nudged(draw, p) } else { rounded(p) }
            }
            PointKind::NearFace => {
                let p = self.on_face(draw);
                nudged(draw, p)
            }
            PointKind::FacePlane => rounded(plane(draw, mesh)),
            PointKind::Corner => rounded([0, 1, 2].map(|i| vertex(draw, mesh)[i])),
            PointKind::Behind => {
                let p = if draw.flag() { self.silhouette_point(draw, 0.5) } else { vertex(draw, mesh) };
                let p = self.behind(draw, p);
                if draw.flag() { nudged(draw, p) } else { rounded(p) }
            }
            PointKind::BehindVertex => {
                let p = vertex(draw, mesh);
                rounded(self.behind(draw, p))
            }
            PointKind::BehindEdge => {
                let [a, b, _] = corners(draw, mesh);
                let p = along([a, b], draw.unit());
                rounded(self.behind(draw, p))
            }
            PointKind::BehindFeature => {
                let p = self.feature(draw);
                let p = match draw.below(5) {
                    4 => self.pushed(p, -f64::from(1 + draw.below(7)) / 8.0),
                    _ => self.behind(draw, p),
                };
                seldom_nudged(draw, p)
            }
            PointKind::BehindSilhouette => {
                let t = if draw.flag() { f64::from(draw.below(9)) / 8.0 } else { 0.0 };
                let p = self.silhouette_point(draw, t);
                let p = self.behind(draw, p);
                seldom_nudged(draw, p)
            }
            PointKind::Boundary => self.boundary(draw),
            PointKind::Around => self.in_box(|| f64::from(draw.between(-8, 8)) / 8.0),
            PointKind::Box => self.in_box(|| draw.signed()),
            PointKind::Light => {
                let at = self.light.xyz().map(f64::from);
                match draw.below(4) {
                    _ if self.light.is_directional() => self.in_box(|| draw.signed()),
                    0 => rounded(at),
                    1 => nudged(draw, at),
                    _ => rounded(along([at, vertex(draw, mesh)], 0.5)),
                }
            }
        }
    }

    /// A vertex, or a point of an edge, of a face, or of a face's plane.
    fn feature(&self, draw: &mut dyn Draw) -> [f64; 3] {
        match draw.below(4) {
            0 => vertex(draw, self.mesh),
            1 => edge(draw, self.mesh),
            2 => face(draw, self.mesh),
            _ => plane(draw, self.mesh),
        }
    }

    /// A point of a face, evenly.
    fn on_face(&self, draw: &mut dyn Draw) -> [f64; 3] {
        let corners = corners(draw, self.mesh);
        let (u, v) = (draw.unit(), draw.unit());
        if u + v > 1.0 { combined(corners, 1.0 - u, 1.0 - v) } else { combined(corners, u, v) }
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
            return vertex(draw, self.mesh);
        }
        along(draw.pick(&self.silhouette), t)
    }

    /// `p` moved away from the light by `t` times its distance, or by `t` of the direction towards it.
    fn pushed(&self, p: [f64; 3], t: f64) -> [f64; 3] {
        let away = self.away(p);
        [0, 1, 2].map(|i| p[i] + t * away[i])
    }

    fn away(&self, p: [f64; 3]) -> [f64; 3] {
        let light = self.light.xyz().map(f64::from);
        [0, 1, 2].map(|i| if self.light.is_directional() { -light[i] } else { p[i] - light[i] })
    }

    /// `p` moved away from the light by a simple multiple of its distance: doubling it keeps the coordinates
    /// of a grid exact.
    fn behind(&self, draw: &mut dyn Draw, p: [f64; 3]) -> [f64; 3] {
        let eighths = match draw.below(5) {
            0 | 1 => 8,
            2 => draw.pick(&[16, 4, 2, 24]),
            3 => 1 + draw.below(32),
            _ => 1 + draw.below(2048),
        };
        self.pushed(p, f64::from(eighths) / 8.0)
    }

    /// A point of a silhouette edge pushed away from the light.
    fn boundary(&self, draw: &mut dyn Draw) -> [f32; 3] {
        if self.silhouette.is_empty() {
            return self.draw(PointKind::NearFace, draw);
        }
        // One in four exactly at a vertex.
        let t = if draw.below(4) == 0 { 0.0 } else { draw.unit() };
        let base = self.silhouette_point(draw, t);
        let away = self.away(base);
        let length = away.iter().map(|x| x * x).sum::<f64>().sqrt();
        if length == 0.0 {
            return nudged(draw, base);
        }
        // From a thousandth of the diagonal to one diagonal, evenly in the logarithm.
        let reach = self.bounds.diagonal() * 1000_f64.powf(draw.unit() - 1.0);
        nudged(draw, [0, 1, 2].map(|i| base[i] + away[i] / length * reach))
    }
}

/// Rounded; one in four is moved by up to two ulps.
fn seldom_nudged(draw: &mut dyn Draw, p: [f64; 3]) -> [f32; 3] {
    if draw.below(4) == 3 { nudged(draw, p) } else { rounded(p) }
}
