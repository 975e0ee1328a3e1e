//! Lights: anywhere, and where a given mesh likes them least.

use proptest::prelude::*;
use proptest::sample::Index;

use super::feature::{Feature, feature, rounded, ulps};
use super::mesh::place;
use crate::geom::Light;
use crate::mesh::Mesh;

/// A point light or a directional one, often on the grid.
pub fn light() -> impl Strategy<Value = Light> + Clone {
    (place(), any::<bool>()).prop_map(|(xyz, directional)| light_of(xyz, directional))
}

/// A light that is drawn before its mesh is known; `any::<LightPick>()` draws one.
///
/// On a vertex, on an edge, on a face, in a face's plane, or one unit in the last place beside; inside the box
/// around the mesh; anywhere; up to 2⁴⁰ away; directional along an axis, along an edge, or anywhere.
#[derive(Clone, Copy, Debug)]
pub struct LightPick(Kind);

#[derive(Clone, Copy, Debug)]
enum Kind {
    Anywhere([f32; 3], bool),
    On(Feature, [i8; 3]),
    /// At so many eighths of the box, from its low corner.
    Within([u8; 3]),
    /// Towards a place, times two to that.
    Far([f32; 3], i32),
    AlongAxis(usize, bool),
    AlongEdge(Index, u8),
}

impl LightPick {
    /// The light for `mesh`.
    #[must_use]
    pub fn at(&self, mesh: &Mesh) -> Light {
        match self.0 {
            Kind::Anywhere(xyz, directional) => light_of(xyz, directional),
            Kind::On(feature, ulps) => light_of(rounded(feature.at(mesh), ulps), false),
            Kind::Within(eighths) => {
                let [low, high] = mesh.bounds().unwrap_or_default().map(|corner| corner.map(f64::from));
                let at = [0, 1, 2].map(|i| low[i] + f64::from(eighths[i]) / 8.0 * (high[i] - low[i]));
                light_of(rounded(at, [0; 3]), false)
            }
            Kind::Far(xyz, exponent) => light_of(xyz.map(|x| x * 2.0_f32.powi(exponent)), false),
            Kind::AlongAxis(axis, down) => {
                let mut travel = [0.0; 3];
                travel[axis] = if down { -1.0 } else { 1.0 };
                light_of(travel, true)
            }
            Kind::AlongEdge(face, first) => {
                let edge = |corner| Feature { face, first: corner, eighths: [0, 0] }.at(mesh);
                let (a, b) = (edge(first), edge((first + 1) % 3));
                light_of(rounded([0, 1, 2].map(|i| b[i] - a[i]), [0; 3]), true)
            }
        }
    }
}

impl Arbitrary for LightPick {
    type Parameters = ();
    type Strategy = BoxedStrategy<Self>;

    fn arbitrary_with((): ()) -> BoxedStrategy<Self> {
        prop_oneof![
            2 => (place(), any::<bool>()).prop_map(|(xyz, directional)| Kind::Anywhere(xyz, directional)),
            4 => (feature(), ulps()).prop_map(|(feature, ulps)| Kind::On(feature, ulps)),
            1 => [0_u8..=8, 0_u8..=8, 0_u8..=8].prop_map(Kind::Within),
            1 => (place(), 3_i32..=40).prop_map(|(xyz, exponent)| Kind::Far(xyz, exponent)),
            1 => (0_usize..3, any::<bool>()).prop_map(|(axis, down)| Kind::AlongAxis(axis, down)),
            1 => (any::<Index>(), 0_u8..3).prop_map(|(face, first)| Kind::AlongEdge(face, first)),
        ]
        .prop_map(LightPick)
        .boxed()
    }
}

/// A light that travels along `xyz`, or stands there where that is no direction.
fn light_of(xyz: [f32; 3], directional: bool) -> Light {
    match Light::directional(xyz) {
        Ok(light) if directional => light,
        _ => Light::point(xyz).expect("finite coordinates"),
    }
}
