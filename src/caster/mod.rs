//! A mesh and all that is known of it before any light.

mod group;
mod proofs;
mod shell_boxes;

use std::sync::OnceLock;

pub use group::CasterGroup;
pub use proofs::ShellProof;
pub(crate) use shell_boxes::ShellBox;
pub use shell_boxes::ShellBoxes;

use crate::check::CrackReport;
use crate::facing::{CasterFaces, FacePlanes};
use crate::geom::{Facing, Light};
use crate::mesh::{Mesh, MeshError, Weld, weld_in_place};
use crate::oracle::Oracle;
use crate::silhouette::Silhouette;
use crate::topology::{Shells, Topology};

/// A mesh in world space and everything that is known of it before any light: topology, crack report, shells, planes,
/// proofs, ray cast.
///
/// Each part is made once, when it is first asked for, from any thread; a caster is `Sync`. Parts share the list of
/// triangles with the mesh. The functions that make the parts ([`Topology::of`], [`CrackReport::of`],
/// [`FacePlanes::new`], …) are the reference, for those who want one of them alone.
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

/// What depends on positions.
#[derive(Clone, Debug, Default)]
struct Parts {
    report: OnceLock<CrackReport>,
    planes: OnceLock<FacePlanes>,
    proofs: OnceLock<Vec<ShellProof>>,
    boxes: OnceLock<ShellBoxes>,
    oracle: OnceLock<Oracle>,
}

impl Caster {
    /// Takes a mesh as it is, welded or not. Nothing is made yet.
    #[must_use]
    pub fn new(mesh: Mesh) -> Self {
        Self { mesh, topology: OnceLock::new(), shells: OnceLock::new(), parts: Parts::default() }
    }

    /// Copies vertex and index arrays, three indices per face, and welds vertices of equal positions, as those that are
    /// split for normals or texture coordinates are.
    ///
    /// # Errors
    ///
    /// [`MeshError`] if a coordinate is not finite, an index is out of range, or the number of indices is not divisible
    /// by 3.
    pub fn from_indexed(positions: &[[f32; 3]], indices: &[u32]) -> Result<Self, MeshError> {
        let mesh = Mesh::from_indexed(positions, indices)?;
        Ok(Self::new(weld_in_place(mesh, Weld::Exact).mesh))
    }

    /// The mesh.
    #[must_use]
    pub fn mesh(&self) -> &Mesh {
        &self.mesh
    }

    /// The edge table, with what the crack report needs of it: some 40 ns per face when first asked for.
    #[must_use]
    pub fn topology(&self) -> &Topology {
        self.topology
            .get_or_init(|| Topology::build_surveyed(self.mesh.vertex_count(), self.mesh.shared_triangles()))
    }

    /// The connected shells.
    #[must_use]
    pub fn shells(&self) -> &Shells {
        self.shells.get_or_init(|| self.topology().shells())
    }

    /// The crack report, without self-intersections: see [`CrackReport::of`] for its cost.
    #[must_use]
    pub fn report(&self) -> &CrackReport {
        self.parts.report.get_or_init(|| CrackReport::of(&self.mesh, self.topology()))
    }

    /// A plane per face, for the exact sides of many lights: some 25 ns per face when first asked for.
    #[must_use]
    pub fn planes(&self) -> &FacePlanes {
        self.parts.planes.get_or_init(|| FacePlanes::new(&self.mesh))
    }

    /// What is proven of each shell: whether half its faces cast the same shadow. Looks for self-intersections, which
    /// takes some microseconds per face when first asked for; see [`ShellProof::of`].
    #[must_use]
    pub fn proofs(&self) -> &[ShellProof] {
        self.parts.proofs.get_or_init(|| {
            ShellProof::with_report(&self.mesh, self.topology(), self.shells(), self.report())
        })
    }

    /// Boxes around the shells and around blocks of their faces.
    #[must_use]
    pub fn shell_boxes(&self) -> &ShellBoxes {
        self.parts.boxes.get_or_init(|| ShellBoxes::new(&self.mesh, self.shells()))
    }

    /// The exact ray cast: some 330 ns per face when first asked for.
    #[must_use]
    pub fn oracle(&self) -> &Oracle {
        self.parts.oracle.get_or_init(|| Oracle::build(&self.mesh))
    }

    /// The mesh alone.
    #[must_use]
    pub fn into_mesh(self) -> Mesh {
        self.mesh
    }

    /// The ray cast alone, which has the faces of its own; all else is let go of.
    #[must_use]
    pub fn into_oracle(self) -> Oracle {
        self.parts.oracle.into_inner().unwrap_or_else(|| Oracle::build(&self.mesh))
    }

    /// The side of every face that `light` is on, exactly; one entry per face.
    #[must_use]
    pub fn facing(&self, light: &Light) -> Vec<Facing> {
        self.planes().classify(&self.mesh, light)
    }

    /// The silhouette edges for the faces that cast. For light after light, a
    /// [`SilhouetteFinder`](crate::silhouette::SilhouetteFinder) is faster.
    #[must_use]
    pub fn silhouette(&self, light: &Light, faces: CasterFaces) -> Silhouette {
        Silhouette::extract(self.topology(), &faces.signs(&self.facing(light)))
    }

    /// Moves the vertices. Topology and shells stay; whatever depends on positions is made again when it is next asked
    /// for.
    ///
    /// # Errors
    ///
    /// [`MeshError`] if there are more or fewer positions than vertices, or a coordinate is not finite; then nothing has
    /// changed.
    ///
    /// ```
    /// use umbrage::caster::Caster;
    /// use umbrage::testing::shapes;
    /// let mut caster = Caster::new(shapes::cube());
    /// let edges = caster.topology().edge_count();
    /// let lifted = caster.mesh().positions().iter().map(|&[x, y, z]| [x, y + 5.0, z]).collect();
    /// caster.repose(lifted)?;
    /// assert_eq!(caster.oracle().bounds().low[1], 4.5);
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
