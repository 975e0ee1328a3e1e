//! Casters: a mesh and everything that is known of it before any light.

#[cfg(feature = "gpu")]
mod gpu;
mod group;
mod proofs;
mod rule;
mod shell_boxes;

use std::sync::{Arc, OnceLock};

#[cfg(feature = "gpu")]
pub use gpu::GpuCaster;
pub use group::CasterGroup;
pub use proofs::ShellProof;
pub use rule::CasterRule;
pub(crate) use rule::KeptRule;
pub(crate) use shell_boxes::ShellBox;
pub use shell_boxes::ShellBoxes;

use crate::check::CrackReport;
use crate::facing::FacePlanes;
use crate::geom::{Facing, Light};
use crate::mesh::{Mesh, MeshError, Weld, weld_in_place};
use crate::oracle::Oracle;
use crate::topology::{Shells, Topology};

/// A mesh in world space with everything that is known of it before any light: topology, crack report,
/// shells, face planes, proofs, ray cast.
///
/// Each part is built once, on first use, from any thread; a caster is `Sync`. The parts share the triangle
/// list of the mesh. The functions that build the parts ([`Topology::of`], [`CrackReport::of`],
/// [`FacePlanes::new`], …) are public too, for callers who need a single part.
///
/// ```
/// use umbrage::caster::Caster;
/// use umbrage::geom::Light;
/// use umbrage::shadow::volume::Caps;
///
/// // Vertex and index arrays of your own: a tetrahedron, each vertex given once for each of its faces.
/// let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
/// let positions: Vec<[f32; 3]> = [0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3].map(|i: usize| corners[i]).to_vec();
/// let indices: Vec<u32> = (0..12).collect();
///
/// let caster = Caster::from_indexed(&positions, &indices)?;
/// let volume = caster.volume(&Light::point([2.0, 3.0, 4.0])?, Caps::Both);
/// assert!(volume.boundary_sum().is_closed());
/// assert!(caster.report().counts.sound());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Caster {
    mesh: Mesh,
    topology: OnceLock<Topology>,
    shells: OnceLock<Shells>,
    parts: Parts,
}

/// The parts that depend on positions.
#[derive(Clone, Debug, Default)]
struct Parts {
    report: OnceLock<CrackReport>,
    planes: OnceLock<Arc<FacePlanes>>,
    proofs: OnceLock<Vec<ShellProof>>,
    boxes: OnceLock<ShellBoxes>,
    oracle: OnceLock<Oracle>,
}

impl Caster {
    /// A caster of the mesh as given, welded or not. Nothing is built yet.
    #[must_use]
    pub fn new(mesh: Mesh) -> Self {
        Self { mesh, topology: OnceLock::new(), shells: OnceLock::new(), parts: Parts::default() }
    }

    /// A caster of vertex and index arrays, three indices per face. The arrays are copied, and vertices of
    /// equal positions are welded, such as vertices split for normals or texture coordinates.
    ///
    /// # Errors
    ///
    /// [`MeshError`] if a coordinate is not finite, an index is out of range, or the number of indices is not
    /// a multiple of 3.
    pub fn from_indexed(positions: &[[f32; 3]], indices: &[u32]) -> Result<Self, MeshError> {
        let mesh = Mesh::from_indexed(positions, indices)?;
        Ok(Self::new(weld_in_place(mesh, Weld::Exact).mesh))
    }

    /// The mesh.
    #[must_use]
    pub fn mesh(&self) -> &Mesh {
        &self.mesh
    }

    /// The edge table. Cost on first use: some 20 ns per face; its survey, on first use by shells or crack
    /// report, as much again.
    #[must_use]
    pub fn topology(&self) -> &Topology {
        self.topology.get_or_init(|| Topology::of(&self.mesh))
    }

    /// The connected shells of the mesh.
    #[must_use]
    pub fn shells(&self) -> &Shells {
        self.shells.get_or_init(|| self.topology().shells())
    }

    /// The crack report, without self-intersections. For its cost see [`CrackReport::of`].
    #[must_use]
    pub fn report(&self) -> &CrackReport {
        self.parts.report.get_or_init(|| CrackReport::of(&self.mesh, self.topology()))
    }

    /// A plane per face, for the exact side of many lights. Cost on first use: some 25 ns per face.
    #[must_use]
    pub fn planes(&self) -> &FacePlanes {
        self.shared_planes()
    }

    /// The same planes, to be shared with a [`SilhouetteTree`](crate::silhouette::SilhouetteTree).
    #[must_use]
    pub fn shared_planes(&self) -> &Arc<FacePlanes> {
        self.parts.planes.get_or_init(|| Arc::new(FacePlanes::new(&self.mesh)))
    }

    /// One proof per shell: whether half of the shell's faces cast the same shadow. Cost on first use: a
    /// search for self-intersections, some microseconds per face; see [`ShellProof::of`].
    #[must_use]
    pub fn proofs(&self) -> &[ShellProof] {
        self.parts.proofs.get_or_init(|| {
            ShellProof::with_report(&self.mesh, self.topology(), self.shells(), self.report())
        })
    }

    /// Bounding boxes of the shells and of blocks of their faces.
    #[must_use]
    pub fn shell_boxes(&self) -> &ShellBoxes {
        self.parts.boxes.get_or_init(|| ShellBoxes::new(&self.mesh, self.shells()))
    }

    /// The exact ray cast. Cost on first use: some 330 ns per face.
    #[must_use]
    pub fn oracle(&self) -> &Oracle {
        self.parts.oracle.get_or_init(|| Oracle::build(&self.mesh))
    }

    /// Takes the mesh; all other parts are dropped.
    #[must_use]
    pub fn into_mesh(self) -> Mesh {
        self.mesh
    }

    /// Takes the ray cast, which holds its own copy of the faces; all other parts are dropped.
    #[must_use]
    pub fn into_oracle(self) -> Oracle {
        self.parts.oracle.into_inner().unwrap_or_else(|| Oracle::build(&self.mesh))
    }

    /// The exact side of every face on which `light` lies; one entry per face.
    #[must_use]
    pub fn facing(&self, light: &Light) -> Vec<Facing> {
        self.planes().classify(&self.mesh, light)
    }

    /// Moves the vertices. Topology and shells are kept; all parts that depend on positions are built again
    /// on their next use.
    ///
    /// # Errors
    ///
    /// [`MeshError`] if the number of positions differs from the number of vertices, or if a coordinate is
    /// not finite. After an error the caster is unchanged.
    ///
    /// ```
    /// use umbrage::caster::Caster;
    /// use umbrage::testing::shapes;
    /// let mut caster = Caster::new(shapes::cube());
    /// let edges = caster.topology().edge_count();
    /// let lifted = caster.mesh().positions().iter().map(|&[x, y, z]| [x, y + 5.0, z]).collect();
    /// caster.repose(lifted)?;
    /// assert_eq!(caster.oracle().bounds().low[1], 4.0);
    /// assert_eq!(caster.topology().edge_count(), edges); // not built again
    /// # Ok::<(), umbrage::mesh::MeshError>(())
    /// ```
    pub fn repose(&mut self, positions: Vec<[f32; 3]>) -> Result<(), MeshError> {
        self.mesh.set_positions(positions)?;
        self.parts = Parts::default();
        Ok(())
    }
}

impl From<Mesh> for Caster {
    fn from(mesh: Mesh) -> Self {
        Self::new(mesh)
    }
}
