//! Test support: a reference scan, meshes and lights full of ties.

use proptest::prelude::*;

use super::Silhouette;
use crate::facing::{CasterFaces, classify};
use crate::geom::{Aabb, Light};
use crate::mesh::{FaceId, Mesh};
use crate::testing::shapes;
use crate::topology::Topology;

/// The reference: the exact predicate for every face, then all edges.
pub(crate) fn scan(mesh: &Mesh, topology: &Topology, light: &Light, casters: CasterFaces) -> Silhouette {
    Silhouette::extract(topology, &casters.signs(&classify(mesh, light)))
}

/// A small torus, with a hole or without, its vertices on a small grid: nearly every edge has two faces, and
/// ties, flat faces and coinciding vertices are common.
pub(crate) fn crumpled() -> impl Strategy<Value = Mesh> {
    let coordinate = prop_oneof![6 => (-2_i8..=2).prop_map(f32::from), 1 => -2.0_f32..2.0];
    let place = prop::array::uniform3(coordinate);
    (prop::collection::vec(place, 10 * 12), 0_usize..6).prop_map(|(positions, hole)| {
        let mut triangles = shapes::torus(10, 12, 2.0, 1.0).triangles().to_vec();
        triangles.truncate(triangles.len() - hole);
        Mesh::new(positions, triangles).expect("finite, and as many as a torus has")
    })
}

/// `count` lights, often on the grid.
pub(crate) fn light(count: usize) -> impl Strategy<Value = Vec<Light>> {
    let coordinate = prop_oneof![4 => (-3_i8..=3).prop_map(f32::from), 1 => -3.0_f32..3.0];
    let light = (prop::array::uniform3(coordinate), any::<bool>()).prop_map(|(xyz, directional)| {
        match Light::directional(xyz) {
            Ok(light) if directional => light,
            _ => Light::point(xyz).expect("finite"),
        }
    });
    prop::collection::vec(light, count)
}

/// Lights outside, inside, far away, on vertices, in planes of faces and one ulp off them, and directional
/// ones.
pub(crate) fn lights(mesh: &Mesh) -> Vec<Light> {
    let [low, high] = mesh.bounds().expect("it has faces");
    let bounds = Aabb { low, high };
    let (center, size) = (bounds.center(), bounds.diagonal() as f32);
    let mut places = vec![
        center,
        [center[0] + size, center[1] + 0.7 * size, center[2] + 0.4 * size],
        [1_099_511_627_776.0, -1.0, 3.0],
    ];
    for face in (0..mesh.face_count()).step_by(mesh.face_count().div_ceil(8)) {
        let [a, b, c] = mesh.corners(FaceId::new(face));
        let beyond = [0, 1, 2].map(|i| a[i] + 3.0 * (b[i] - a[i]) + 2.0 * (c[i] - a[i]));
        places.extend([a, beyond, beyond.map(f32::next_up), beyond.map(f32::next_down)]);
    }
    let mut lights: Vec<Light> = places.into_iter().map(|at| Light::point(at).expect("finite")).collect();
    for travel in [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [1.0, 2.0, -0.5]] {
        lights.push(Light::directional(travel).expect("not zero"));
    }
    lights
}
