//! Which side of the light each face is on, and the edges where the sides change.
//!
//! An edge's *multiplicity* is the signed sum of its faces' sides: `m = Σ σ·s`, with σ = +1 for a face that runs
//! along the edge (smaller to larger vertex) and −1 against it. An edge is silhouette when `m ≠ 0`. This needs
//! no pairing of faces, so it holds on any mesh: open, non-manifold, not orientable. (Cf. Byungmoon Kim, Kihwan
//! Kim, Greg Turk, *A Shadow-Volume Algorithm for Opaque and Transparent Nonmanifold Casters*, 2008.)

mod auto;
mod clusters;
mod edge_set;
#[cfg(feature = "gpu")]
mod gpu;
mod kinetic;
mod plane;
mod quantised;
mod scan;
mod tree;
#[cfg(test)]
mod trial;

pub use auto::{SilhouetteFinder, SilhouetteMethod, SilhouetteReason};
pub use clusters::{FaceClusters, FacingRanges};
#[cfg(feature = "gpu")]
pub use gpu::{FoundSilhouette, GpuCaster, GpuSilhouette, SilhouetteShaders};
pub use kinetic::{EdgeChange, KineticSilhouette, KineticStep};
pub use plane::FacePlanes;
pub use tree::{SilhouetteTree, TreeSearch};

use crate::geom::Light;
use crate::geom::predicate::{self, Sign};
use crate::mesh::{EdgeId, FaceId, Mesh};
use crate::topology::Topology;

/// The side of a face that the light is on. Decided once and stored: whatever reads it later agrees.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(i8)]
pub enum Facing {
    /// The light is behind the face.
    Back = -1,
    /// The light is exactly in the face's plane, or the face has no area.
    EdgeOn = 0,
    /// The light is in front of the face.
    Front = 1,
}

impl Facing {
    /// −1, 0 or +1.
    #[inline]
    #[must_use]
    pub fn sign(self) -> i8 {
        self as i8
    }

    #[inline]
    pub(crate) fn of(sign: Sign) -> Self {
        match sign {
            Sign::Negative => Self::Back,
            Sign::Zero => Self::EdgeOn,
            Sign::Positive => Self::Front,
        }
    }
}

/// The side of one face that `light` is on, exactly.
///
/// # Panics
///
/// Panics if there is no such face.
#[inline]
#[must_use]
pub fn facing_of(mesh: &Mesh, face: FaceId, light: &Light) -> Facing {
    Facing::of(predicate::side_of_light(mesh.corners(face), light))
}

/// The side of every face that `light` is on, exactly; one entry a face.
///
/// Costs one filtered predicate a face. Memory: 1 byte a face. For many lights on one mesh, [`FacePlanes`] is many times
/// faster.
#[must_use]
pub fn classify(mesh: &Mesh, light: &Light) -> Vec<Facing> {
    (0..mesh.face_count()).map(|face| facing_of(mesh, FaceId::new(face), light)).collect()
}

/// Which faces throw the shadow, and with which sign.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Casters {
    /// Every face that is not edge-on, with its sign. Holds on any mesh.
    #[default]
    All,
    /// Front faces only: the textbook outline, "one face in front, the other not".
    Front,
}

impl Casters {
    /// The sign that each face casts with: one entry a face, −1, 0 or +1.
    #[must_use]
    pub fn signs(self, facing: &[Facing]) -> Vec<i8> {
        let mut signs = Vec::new();
        self.signs_into(facing, &mut signs);
        signs
    }

    /// As [`Casters::signs`], into a buffer that keeps its memory.
    pub fn signs_into(self, facing: &[Facing], signs: &mut Vec<i8>) {
        signs.clear();
        signs.extend(facing.iter().map(|&facing| self.sign(facing)));
    }

    /// The sign that a face casts with.
    #[inline]
    #[must_use]
    pub fn sign(self, facing: Facing) -> i8 {
        if self == Self::All { facing.sign() } else { facing.sign().max(0) }
    }

    /// Which sides a face casts on, as bits: [`CASTS_IN_FRONT`], [`CASTS_BEHIND`].
    #[inline]
    #[must_use]
    pub fn mask(self) -> u8 {
        match self {
            Self::All => CASTS_IN_FRONT | CASTS_BEHIND,
            Self::Front => CASTS_IN_FRONT,
        }
    }
}

/// In a face's mask: it casts if the light is in front of it.
pub const CASTS_IN_FRONT: u8 = 1;
/// In a face's mask: it casts if the light is behind it.
pub const CASTS_BEHIND: u8 = 2;

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
    /// Finds the silhouette for the signs that faces cast with (−1, 0 or +1; see [`Casters::signs`]).
    ///
    /// A scan of all edges: linear time, most of it spent on reading 12 bytes an edge and two signs. Memory: 24 bytes a
    /// silhouette edge at its peak.
    ///
    /// # Panics
    ///
    /// Panics if `signs` has another length than the faces of `topology`.
    ///
    /// ```
    /// use umbrage::{geom::Light, mesh::solid, topology::Topology};
    /// use umbrage::silhouette::{Casters, Silhouette, classify};
    /// let cube = solid::cube();
    /// let topology = Topology::build(cube.vertex_count(), cube.triangles().to_vec());
    /// let facing = classify(&cube, &Light::directional([-1.0, -1.0, -1.0])?);
    /// let silhouette = Silhouette::extract(&topology, &Casters::All.signs(&facing));
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
        scan::extract_into(topology, signs, self);
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
