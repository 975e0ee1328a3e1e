//! Points where the answer is easy to get wrong.

use proptest::prelude::*;
use proptest::sample::Index;

use super::feature::{Feature, feature, rounded, ulps};
use super::mesh::place;
use crate::facing::{CasterFaces, classify};
use crate::geom::Light;
use crate::mesh::Mesh;
use crate::silhouette::Silhouette;
use crate::topology::Topology;

/// A point that is drawn before its mesh and light are known; `any::<PointPick>()` draws one.
///
/// On a vertex, on an edge, on a face, in a face's plane; such a place pushed away from the light or pulled towards
/// it; on a side of the shadow volume, behind a silhouette edge or one of its ends; anywhere in twice the
/// box around the mesh, or anywhere. One in four is moved by one unit in the last place.
#[derive(Clone, Copy, Debug)]
pub struct PointPick {
    kind: Kind,
    ulps: [i8; 3],
}

#[derive(Clone, Copy, Debug)]
enum Kind {
    Anywhere([f32; 3]),
    On(Feature),
    /// From a feature so many eighths of its way to the light: negative is away from it.
    Behind(Feature, i16),
    /// A silhouette edge, a place on it in eighths, and how far away from the light.
    Boundary(Index, u8, i16),
    /// At so many eighths of the box, from its low corner.
    Around([i8; 3]),
}

impl PointPick {
    /// The point for `mesh` and `light`. Behind a silhouette it costs a topology of the mesh.
    #[must_use]
    pub fn at(&self, mesh: &Mesh, light: &Light) -> [f32; 3] {
        let place = match self.kind {
            Kind::Anywhere(place) => place.map(f64::from),
            Kind::On(feature) => feature.at(mesh),
            Kind::Behind(feature, eighths) => pushed(feature.at(mesh), light, eighths),
            Kind::Boundary(edge, along, eighths) => {
                let base = silhouette_place(mesh, light, edge, f64::from(along) / 8.0);
                pushed(base.unwrap_or_default(), light, eighths)
            }
            Kind::Around(eighths) => {
                let [low, high] = mesh.bounds().unwrap_or_default().map(|corner| corner.map(f64::from));
                [0, 1, 2].map(|i| low[i] + f64::from(eighths[i]) / 8.0 * (high[i] - low[i]))
            }
        };
        rounded(place, self.ulps)
    }
}

impl Arbitrary for PointPick {
    type Parameters = ();
    type Strategy = BoxedStrategy<Self>;

    fn arbitrary_with((): ()) -> BoxedStrategy<Self> {
        // Doubling the way keeps the coordinates of a grid exact.
        let away = || prop_oneof![2 => Just(-8_i16), 2 => -32_i16..=-1, 1 => -2048_i16..=-1];
        let kind = prop_oneof![
            1 => place().prop_map(Kind::Anywhere),
            2 => feature().prop_map(Kind::On),
            4 => (feature(), away()).prop_map(|(feature, eighths)| Kind::Behind(feature, eighths)),
            1 => (feature(), 1_i16..8).prop_map(|(feature, eighths)| Kind::Behind(feature, eighths)),
            3 => (any::<Index>(), prop_oneof![Just(0_u8), 0_u8..=8], away())
                .prop_map(|(edge, along, eighths)| Kind::Boundary(edge, along, eighths)),
            2 => [-4_i8..=12, -4_i8..=12, -4_i8..=12].prop_map(Kind::Around),
        ];
        (kind, ulps()).prop_map(|(kind, ulps)| PointPick { kind, ulps }).boxed()
    }
}

/// `place` moved by so many eighths of the way to the light (of the direction, where the light is at infinity).
fn pushed(place: [f64; 3], light: &Light, eighths: i16) -> [f64; 3] {
    let (t, l) = (f64::from(eighths) / 8.0, light.xyz().map(f64::from));
    [0, 1, 2].map(|i| place[i] + t * if light.is_directional() { l[i] } else { l[i] - place[i] })
}

/// A place on a silhouette edge; `None` where there is none.
fn silhouette_place(mesh: &Mesh, light: &Light, edge: Index, t: f64) -> Option<[f64; 3]> {
    let topology = Topology::of(mesh);
    let edges = Silhouette::extract(&topology, &CasterFaces::All.signs(&classify(mesh, light))).edges;
    let edge = edges.get(edge.index(edges.len().max(1)))?.edge;
    let [a, b] = topology.vertices(edge).map(|vertex| mesh.positions()[vertex.index()].map(f64::from));
    Some([0, 1, 2].map(|i| a[i] + t * (b[i] - a[i])))
}
