//! The shadow volume: light cap, sides, dark cap; closed for every mesh and every choice of signs.
//!
//! For faces with stored signs `s` ∈ {−1, 0, +1} and edges with multiplicities `m = Σ σ·s`, the volume is the
//! chain `K − K∞ + Σ m·Q`: every casting face towards the light, the same faces pushed away from it to
//! infinity and reversed, and `|m|` copies of the quad that each silhouette edge sweeps. Its boundary cancels
//! edge by edge, whatever the signs are, because `∂K = Σ m·e` by definition. This is the sum of the prisms
//! that the single faces cast (Graham Aldridge and Eric Woods, *Robust, Geometry-Independent Shadow Volumes*,
//! 2004; Byungmoon Kim, Kihwan Kim, Greg Turk, *A Shadow-Volume Algorithm for Opaque and Transparent
//! Nonmanifold Casters*, 2008).
//!
//! The winding number of the volume at a point counts the casting faces between that point and the light.

mod cap;
mod cap_clusters;
mod caster_faces;
mod closed;
mod extrude;
mod finite;
mod frame;
#[cfg(feature = "gpu")]
mod gpu;
pub(crate) mod parting;
#[cfg(feature = "gpu")]
mod pieces;
#[cfg(feature = "verify")]
mod winding_brute;
#[cfg(test)]
mod test_support;
mod winding;

use std::ops::Range;

pub use caster_faces::ShellFaces;
pub use closed::BoundarySum;
pub use extrude::{BufferTooSmall, ExtrudeInput, Extruder, VolumeParts};
pub use finite::FiniteVolume;
pub use frame::{FrameExtruder, FrameVolume};
#[cfg(feature = "gpu")]
pub use gpu::{Demand, GpuExtrusion, GpuVolume, Part, VolumeShaders};
#[cfg(feature = "gpu")]
pub(super) use pieces::VolumePieces;
#[cfg(feature = "verify")]
pub(crate) use winding::stands_on;
pub use winding::{WindingIndex, winding_number};
pub(super) use winding::{axes, weighted, winding_of};
#[cfg(feature = "verify")]
pub(crate) use winding_brute::WindingTable;

use crate::geom::predicate::Homogeneous;
use crate::geom::{Aabb, Light};
use crate::mesh::{Mesh, VertexId};
use crate::silhouette::Silhouette;
use crate::topology::Topology;

/// Which caps a volume has.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Caps {
    /// Light cap and dark cap: the volume is closed, as depth-fail counting needs.
    #[default]
    Both,
    /// Sides only, which is enough for depth-pass counting with the eye outside every volume.
    None,
}

/// A shadow volume as one indexed triangle mesh with vertices at infinity.
///
/// Vertices `0 .. finite` are vertices of the caster, `w = 1`; the rest lie at infinity, `w = 0`, and are
/// kept symbolically as (caster vertex, light), never rounded. Triangles run counter-clockwise seen from
/// outside.
#[derive(Clone, Debug)]
pub struct ShadowVolume {
    light: Light,
    /// Positions of the finite vertices.
    positions: Vec<[f32; 3]>,
    /// The caster's vertex behind each finite vertex.
    casters: Vec<VertexId>,
    /// The finite vertex behind each vertex at infinity.
    extruded: Vec<u32>,
    triangles: Vec<[u32; 3]>,
    light_cap: usize,
    sides: usize,
}

impl ShadowVolume {
    /// Extrudes the faces of `mesh` that cast (`signs`, one entry per face, −1, 0 or +1) away from `light`.
    ///
    /// `silhouette` must be that of the same signs; then the volume is closed, whatever the signs. Its
    /// winding number counts what they say if faces that a point light lies on have sign 0, as those of
    /// [`classify`](crate::facing::classify) do: from a point on such a face no direction leads away from the
    /// light. Linear in faces and silhouette edges. For light after light, an [`Extruder`] does the same in
    /// memory that is kept.
    ///
    /// Memory: at its peak less than 60 bytes per face of the mesh and per triangle of the volume.
    ///
    /// # Panics
    ///
    /// Panics if `signs` or `topology` has another number of faces than `mesh`, or `silhouette` names an edge
    /// that `topology` does not have.
    ///
    /// ```
    /// use umbrage::geom::Light;
    /// use umbrage::testing::shapes;
    /// use umbrage::topology::Topology;
    /// use umbrage::facing::{CasterFaces, classify};
    /// use umbrage::silhouette::Silhouette;
    /// use umbrage::shadow::volume::{Caps, ShadowVolume};
    /// let mesh = shapes::cube();
    /// let light = Light::point([2.0, 3.0, 5.0])?;
    /// let topology = Topology::of(&mesh);
    /// let signs = CasterFaces::Front.signs(&classify(&mesh, &light));
    /// let silhouette = Silhouette::extract(&topology, &signs);
    /// let volume = ShadowVolume::extrude(&mesh, &topology, &light, &signs, &silhouette, Caps::Both);
    /// assert!(volume.boundary_sum().is_closed());
    /// assert_eq!((volume.light_cap().len(), volume.sides().len()), (6, 2 * 6));
    /// # Ok::<(), umbrage::geom::LightError>(())
    /// ```
    #[must_use]
    pub fn extrude(
        mesh: &Mesh,
        topology: &Topology,
        light: &Light,
        signs: &[i8],
        silhouette: &Silhouette,
        caps: Caps,
    ) -> Self {
        let mut volume = Self {
            light: *light,
            positions: Vec::new(),
            casters: Vec::new(),
            extruded: Vec::new(),
            triangles: Vec::new(),
            light_cap: 0,
            sides: 0,
        };
        let cast = ExtrudeInput { mesh, topology, light, signs, silhouette, caps };
        Extruder::unprepared().extrude_into(&cast, &mut volume);
        volume
    }

    /// The bytes that it holds.
    #[must_use]
    pub fn bytes(&self) -> usize {
        size_of_val(&self.positions[..])
            + size_of_val(&self.casters[..])
            + size_of_val(&self.extruded[..])
            + size_of_val(&self.triangles[..])
    }

    /// The light it was extruded from.
    #[must_use]
    pub fn light(&self) -> &Light {
        &self.light
    }

    /// How many vertices there are, finite ones first.
    #[must_use]
    pub fn vertex_count(&self) -> usize {
        self.positions.len() + self.extruded.len()
    }

    /// Positions of the finite vertices, which come first.
    #[must_use]
    pub fn positions(&self) -> &[[f32; 3]] {
        &self.positions
    }

    /// The caster's vertex behind each finite vertex.
    #[must_use]
    pub fn casters(&self) -> &[VertexId] {
        &self.casters
    }

    /// All triangles: light cap, then sides, then dark cap.
    #[must_use]
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// The range of the light cap among the triangles.
    #[must_use]
    pub fn light_cap(&self) -> Range<usize> {
        0..self.light_cap
    }

    /// The range of the sides among the triangles.
    #[must_use]
    pub fn sides(&self) -> Range<usize> {
        self.light_cap..self.light_cap + self.sides
    }

    /// The range of the dark cap among the triangles. Empty for a directional light, which sends every vertex
    /// to one point at infinity.
    #[must_use]
    pub fn dark_cap(&self) -> Range<usize> {
        self.light_cap + self.sides..self.triangles.len()
    }

    /// A vertex, exactly.
    ///
    /// # Panics
    ///
    /// Panics if there is no such vertex.
    #[inline]
    #[must_use]
    pub fn vertex(&self, index: u32) -> Homogeneous {
        match (index as usize).checked_sub(self.positions.len()) {
            None => Homogeneous::point(self.positions[index as usize]),
            Some(far) => {
                let base = self.positions[self.extruded[far] as usize];
                Homogeneous::extruded(base, &self.light)
            }
        }
    }

    /// The finite vertex that a vertex is, or was extruded from; `None` for the one vertex at infinity of a
    /// directional light.
    pub(super) fn finite_vertex(&self, index: u32) -> Option<u32> {
        match (index as usize).checked_sub(self.positions.len()) {
            None => Some(index),
            Some(_) if self.light.is_directional() => None,
            Some(far) => Some(self.extruded[far]),
        }
    }

    /// The corners of a triangle, exactly.
    #[inline]
    pub(crate) fn corners(&self, triangle: [u32; 3]) -> [Homogeneous; 3] {
        [self.vertex(triangle[0]), self.vertex(triangle[1]), self.vertex(triangle[2])]
    }

    /// Vertices as `f32` for drawing: `[x, y, z, w]`, `w` 1 or 0, one entry per vertex.
    ///
    /// Finite vertices are exact. A vertex at infinity is `v − L` (or the direction in which a directional
    /// light travels, which is exact) with each coordinate rounded once: off by at most 2⁻²⁴ of itself, or by
    /// 2⁻¹⁵⁰ below the normal range. All vertices at infinity are halved if one of them would leave `f32`;
    /// only their directions count, and one of 2⁻¹⁴⁹ then vanishes.
    #[must_use]
    pub fn to_f32(&self) -> Vec<[f32; 4]> {
        let far = || (self.positions.len()..self.vertex_count()).map(|i| self.vertex(i as u32).to_f64());
        let too_large = |[x, y, z, _]: [f64; 4]| [x, y, z].iter().any(|x| x.abs() > f64::from(f32::MAX));
        let scale = if far().any(too_large) { 0.5 } else { 1.0 };
        let near = self.positions.iter().map(|&[x, y, z]| [x, y, z, 1.0]);
        near.chain(far().map(|far| far.map(|x| (x * scale) as f32))).collect()
    }

    /// Vertices as `f32` positions with those at infinity clamped to `far` mesh units from the vertex that
    /// they were extruded from, to look at. One entry per vertex. Such a volume does not hold all of the
    /// shadow out to that distance; [`ShadowVolume::finite`] does.
    #[must_use]
    pub fn clamped(&self, far: f32) -> Vec<[f32; 3]> {
        let mut positions = self.positions.clone();
        positions.extend(self.extruded.iter().enumerate().map(|(i, &base)| {
            let [x, y, z, _] = self.vertex((self.positions.len() + i) as u32).to_f64();
            let length = (x * x + y * y + z * z).sqrt();
            let step = if length > 0.0 { f64::from(far) / length } else { 0.0 };
            let base = self.positions[base as usize];
            let bound = f64::from(f32::MAX);
            [(x, 0), (y, 1), (z, 2)].map(|(d, i)| (f64::from(base[i]) + d * step).clamp(-bound, bound) as f32)
        }));
        positions
    }

    /// The box around the finite vertices.
    #[must_use]
    pub fn finite_bounds(&self) -> Aabb {
        Aabb::around(self.positions.iter().copied())
    }

    /// Injects a fault: removes the last side triangle, if there is one.
    #[cfg(all(test, feature = "verify"))]
    pub(crate) fn forget_a_side(&mut self) {
        if self.sides > 0 {
            self.triangles.remove(self.light_cap + self.sides - 1);
            self.sides -= 1;
        }
    }

    /// The certificate: the signed sum over all directed edges of all triangles, from the triangles alone.
    /// Memory: 48 bytes per triangle.
    #[must_use]
    pub fn boundary_sum(&self) -> BoundarySum {
        closed::boundary_sum(&self.triangles)
    }
}
