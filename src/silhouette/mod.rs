//! Silhouettes: the edges at which the side that faces show to the light changes.
//!
//! An edge's *multiplicity* is the signed sum of its faces' sides: `m = Σ σ·s`, with σ = +1 for a face that
//! runs along the edge (smaller to larger vertex) and −1 against it. An edge is silhouette when `m ≠ 0`. This
//! needs no pairing of faces, so it holds on any mesh: open, non-manifold, not orientable. (Cf. Byungmoon
//! Kim, Kihwan Kim, Greg Turk, *A Shadow-Volume Algorithm for Opaque and Transparent Nonmanifold Casters*,
//! 2008.)

mod edge_set;
mod finder;
#[cfg(feature = "gpu")]
mod gpu;
mod kinetic;
mod linear;
#[cfg(test)]
pub(crate) mod test_support;
mod tree;

pub use finder::{SilhouetteFinder, SilhouetteMethod};
#[cfg(feature = "gpu")]
pub use gpu::{FoundSilhouette, GpuSilhouette, SilhouetteShaders};
pub use kinetic::{EdgeChange, KineticSilhouette, KineticStep};
pub use tree::{SilhouetteTree, TreeSearch};

use crate::caster::Caster;
use crate::facing::CasterFaces;
use crate::geom::Light;
use crate::mesh::EdgeId;
use crate::topology::Topology;

/// An edge where the sides change.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SilhouetteEdge {
    /// Which edge.
    pub edge: EdgeId,
    /// Signed; ±2 on a closed mesh in general position with all faces casting, ±1 with front faces only,
    /// beyond that where more faces meet. Never 0.
    pub multiplicity: i32,
}

/// The silhouette of a mesh for one light, sorted by edge.
#[derive(Clone, Debug, PartialEq, Eq, Default)]
pub struct Silhouette {
    /// The edges, ascending, each once.
    pub edges: Vec<SilhouetteEdge>,
}

impl Silhouette {
    /// Finds the silhouette for the signs that faces cast with (−1, 0 or +1; see [`CasterFaces::signs`]).
    ///
    /// A scan of all edges: linear time, most of it spent on reading 12 bytes per edge
    /// and two signs. Memory: 24 bytes per silhouette edge at its peak.
    ///
    /// # Panics
    ///
    /// Panics if `signs` has another length than the faces of `topology`.
    ///
    /// ```
    /// use umbrage::geom::Light;
    /// use umbrage::testing::shapes;
    /// use umbrage::topology::Topology;
    /// use umbrage::facing::{CasterFaces, classify};
    /// use umbrage::silhouette::Silhouette;
    /// let cube = shapes::cube();
    /// let topology = Topology::of(&cube);
    /// let facing = classify(&cube, &Light::directional([-1.0, -1.0, -1.0])?);
    /// let silhouette = Silhouette::extract(&topology, &CasterFaces::All.signs(&facing));
    /// assert_eq!(silhouette.edges.len(), 6); // along the body diagonal: a hexagon
    /// # Ok::<(), umbrage::geom::LightError>(())
    /// ```
    #[must_use]
    pub fn extract(topology: &Topology, signs: &[i8]) -> Self {
        let mut silhouette = Self::default();
        silhouette.extract_into(topology, signs);
        silhouette
    }

    /// As [`Silhouette::extract`], in place of what was found before, whose memory is kept.
    ///
    /// # Panics
    ///
    /// As [`Silhouette::extract`].
    pub fn extract_into(&mut self, topology: &Topology, signs: &[i8]) {
        linear::extract_into(topology, signs, self);
    }

    /// The connected components of the silhouette: edges ascend within each, and components come in the order
    /// of their first edges. On a closed manifold in general position each is a closed loop.
    ///
    /// # Panics
    ///
    /// Panics if the silhouette was found on another topology with fewer edges.
    #[must_use]
    pub fn loops(&self, topology: &Topology) -> Vec<Vec<EdgeId>> {
        topology.connected(self.edges.iter().map(|edge| edge.edge).collect())
    }

    /// The largest magnitude of any multiplicity; 0 for an empty silhouette.
    #[must_use]
    pub fn max_multiplicity(&self) -> u32 {
        self.edges.iter().map(|edge| edge.multiplicity.unsigned_abs()).max().unwrap_or(0)
    }
}

impl Caster {
    /// The silhouette edges for the given casting faces. For a sequence of lights a [`SilhouetteFinder`] is
    /// faster.
    #[must_use]
    pub fn silhouette(&self, light: &Light, faces: CasterFaces) -> Silhouette {
        Silhouette::extract(self.topology(), &faces.signs(&self.facing(light)))
    }
}
