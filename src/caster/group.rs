//! Groups of casters that share one ray cast.

use std::sync::{Arc, OnceLock};

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
///
/// Receivers that do not cast are seen, and nothing more:
///
/// ```
/// use umbrage::caster::{Caster, CasterGroup};
/// use umbrage::mesh::Mesh;
/// use umbrage::testing::shapes;
/// let (cube, floor) = (shapes::cube(), shapes::sheet(1));
/// let seen = Caster::new(Mesh::concat(&[cube.clone(), floor])?);
/// let caster = Caster::new(cube);
/// let group = CasterGroup::new(vec![&caster]).seen_with(&seen);
/// assert_eq!((group.bounds(), group.oracle().bounds()), (seen.oracle().bounds(), caster.oracle().bounds()));
/// # Ok::<(), umbrage::mesh::MeshError>(())
/// ```
#[derive(Debug)]
pub struct CasterGroup<'a> {
    casters: Vec<&'a Caster>,
    /// All that is seen, if that is more than the casters.
    seen: Option<&'a Caster>,
    oracle: OnceLock<Arc<Oracle>>,
}

impl<'a> CasterGroup<'a> {
    /// A group of casters. Nothing is built yet.
    #[must_use]
    pub fn new(casters: Vec<&'a Caster>) -> Self {
        Self { casters, seen: None, oracle: OnceLock::new() }
    }

    /// The same group in a scene of which more is seen than casts. `seen` has the faces of all casters and of
    /// all receivers.
    #[must_use]
    pub fn seen_with(self, seen: &'a Caster) -> Self {
        Self { seen: Some(seen), ..self }
    }

    /// The same group with a ray cast that was built before, over casters of the same positions in the same
    /// order.
    #[must_use]
    pub(crate) fn with_oracle(self, oracle: Arc<Oracle>) -> Self {
        Self { oracle: OnceLock::from(oracle), ..self }
    }

    /// The exact ray cast over all casters, to be kept for another group.
    pub(crate) fn shared_oracle(&self) -> Arc<Oracle> {
        self.oracle.get_or_init(|| Arc::new(self.build())).clone()
    }

    fn build(&self) -> Oracle {
        let meshes: Vec<&Mesh> = self.casters.iter().map(|caster| caster.mesh()).collect();
        Oracle::over(&meshes)
    }

    /// The casters, in the order given.
    #[must_use]
    pub fn casters(&self) -> &[&'a Caster] {
        &self.casters
    }

    /// The exact ray cast over all casters, built on first use.
    #[must_use]
    pub fn oracle(&self) -> &Oracle {
        match (self.oracle.get(), &self.casters[..]) {
            (Some(oracle), _) => oracle,
            (None, [caster]) => caster.oracle(),
            (None, _) => self.oracle.get_or_init(|| Arc::new(self.build())),
        }
    }

    /// The exact ray cast over all that is seen: the casters, unless [`CasterGroup::seen_with`] says more.
    #[must_use]
    pub fn seen(&self) -> &Oracle {
        self.seen.map_or_else(|| self.oracle(), Caster::oracle)
    }

    /// All that is seen, if that is more than the casters.
    #[must_use]
    pub fn seen_caster(&self) -> Option<&'a Caster> {
        self.seen
    }

    /// Several casters as one, with faces numbered as those of [`CasterGroup::oracle`], for a device that
    /// takes one caster. `None` for a single caster, which is that already.
    ///
    /// # Errors
    ///
    /// [`MeshError::TooLarge`](crate::mesh::MeshError::TooLarge) if the sums do not fit 32-bit ids.
    #[cfg(feature = "gpu")]
    pub(crate) fn joined(&self) -> Result<Option<Caster>, crate::mesh::MeshError> {
        if self.casters.len() == 1 {
            return Ok(None);
        }
        let meshes: Vec<Mesh> = self.casters.iter().map(|caster| caster.mesh().clone()).collect();
        Mesh::concat(&meshes).map(|mesh| Some(Caster::new(mesh)))
    }

    /// Bounding box of all that is seen.
    #[must_use]
    pub fn bounds(&self) -> Aabb {
        self.seen().bounds()
    }
}
