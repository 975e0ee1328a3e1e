//! Groups of casters that share one ray cast.

use std::sync::OnceLock;

use super::Caster;
use crate::geom::Aabb;
use crate::mesh::Mesh;
use crate::oracle::Oracle;

/// The casters of a scene, with one exact ray cast over all of them.
///
/// A single caster lends its own ray cast. Several casters get one tree over all faces, built on first use.
/// The faces are then numbered caster by caster: [`Oracle::mesh_face`] splits such a number into caster and
/// face.
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
    /// A group of casters. Nothing is built yet.
    #[must_use]
    pub fn new(casters: Vec<&'a Caster>) -> Self {
        Self { casters, oracle: OnceLock::new() }
    }

    /// The casters, in the order given.
    #[must_use]
    pub fn casters(&self) -> &[&'a Caster] {
        &self.casters
    }

    /// The exact ray cast over all casters, built on first use.
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

    /// Bounding box of all faces.
    #[must_use]
    pub fn bounds(&self) -> Aabb {
        self.oracle().bounds()
    }
}
