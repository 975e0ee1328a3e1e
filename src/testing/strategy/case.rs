//! A mesh with a light and points that are hard for it.

use proptest::collection::vec;
use proptest::prelude::*;

use super::{LightPick, PointPick};
use crate::geom::Light;
use crate::mesh::Mesh;

/// What a shadow test is asked about.
#[derive(Clone, Debug, PartialEq)]
pub struct Case {
    /// What casts.
    pub mesh: Mesh,
    /// Where the light comes from.
    pub light: Light,
    /// Where to ask.
    pub points: Vec<[f32; 3]>,
}

/// Meshes from `meshes`, each with a [`LightPick`] and one to `points` [`PointPick`]s of its own.
///
/// # Panics
///
/// Panics if `points` is 0.
pub fn case(
    meshes: impl Strategy<Value = Mesh> + Clone,
    points: usize,
) -> impl Strategy<Value = Case> + Clone {
    (meshes, any::<LightPick>(), vec(any::<PointPick>(), 1..=points)).prop_map(|(mesh, light, points)| {
        let light = light.at(&mesh);
        let points = points.iter().map(|point| point.at(&mesh, &light)).collect();
        Case { mesh, light, points }
    })
}
