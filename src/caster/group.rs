//! Several casters under one ray cast.

use std::sync::OnceLock;

use super::Caster;
use crate::geom::Aabb;
use crate::mesh::Mesh;
use crate::oracle::Oracle;

/// The casters of a scene, and the exact ray cast over all of them.
///
/// One caster lends its own ray cast; several get one tree over all faces, made when first asked for. Faces are then
/// numbered caster after caster: [`Oracle::mesh_face`] separates the two.
///
/// ```
/// use umbrage::caster::{Caster, CasterGroup};
/// use umbrage::mesh::FaceId;
/// use umbrage::testing::shapes;
/// let casters = [Caster::new(shapes::cube()), Caster::new(shapes::tetrahedron())];
/// let group = CasterGroup::new(casters.iter().collect());
/// assert_eq!(group.oracle().mesh_face(FaceId(13)), (1, FaceId(1)));
/// ```
#[derive(Debug)]
pub struct CasterGroup<'a> {
    casters: Vec<&'a Caster>,
    oracle: OnceLock<Oracle>,
}

impl<'a> CasterGroup<'a> {
    /// Nothing is made yet.
    #[must_use]
    pub fn new(casters: Vec<&'a Caster>) -> Self {
        Self { casters, oracle: OnceLock::new() }
    }

    /// The casters, in their order.
    #[must_use]
    pub fn casters(&self) -> &[&'a Caster] {
        &self.casters
    }

    /// The exact ray cast over all of them.
    #[must_use]
    pub fn oracle(&self) -> &Oracle {
        match self.casters[..] {
            [caster] => caster.oracle(),
            _ => self.oracle.get_or_init(|| {
                let meshes: Vec<&Mesh> = self.casters.iter().map(|caster| caster.mesh()).collect();
                Oracle::over(&meshes)
            }),
        }
    }

    /// The box around all faces.
    #[must_use]
    pub fn bounds(&self) -> Aabb {
        self.oracle().bounds()
    }
}
