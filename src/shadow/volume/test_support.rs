//! Test support: a volume.

use super::{Caps, ShadowVolume};
use crate::facing::{CasterFaces, classify};
use crate::geom::Light;
use crate::mesh::Mesh;
use crate::silhouette::Silhouette;
use crate::topology::Topology;

/// The shadow of the unit square of two faces at height `z`, under a point light.
pub(super) fn under(light: [f32; 3], z: f32) -> ShadowVolume {
    let corners = [[0.0, 0.0, z], [1.0, 0.0, z], [1.0, 1.0, z], [0.0, 1.0, z]];
    let mesh = Mesh::new(corners.to_vec(), vec![[0, 1, 2], [0, 2, 3]]).expect("a sheet");
    let light = Light::point(light).expect("finite");
    let topology = Topology::of(&mesh);
    let signs = CasterFaces::All.signs(&classify(&mesh, &light));
    let silhouette = Silhouette::extract(&topology, &signs);
    ShadowVolume::extrude(&mesh, &topology, &light, &signs, &silhouette, Caps::Both)
}
