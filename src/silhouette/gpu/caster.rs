//! A mesh on the device.

use super::filter::Filter;
use super::shaders::SilhouetteShaders;
use crate::facing::FacePlanes;
use crate::gpu::{Gpu, GpuError, wgpu};
use crate::mesh::Mesh;
use crate::topology::GpuTopology;

/// A mesh on the device, ready for any number of lights.
#[derive(Clone, Debug)]
pub struct GpuCaster {
    pub(super) shaders: SilhouetteShaders,
    /// `array<f32>`, three a vertex.
    pub vertices: wgpu::Buffer,
    /// The largest magnitude of a coordinate of a vertex that has a face, or about that; what draws its volumes scales by it.
    pub largest: f32,
    /// Faces and edges.
    pub topology: GpuTopology,
    /// `None` if its vertices change.
    pub(super) planes: Option<(Filter, wgpu::Buffer)>,
}

impl GpuCaster {
    /// Copies a mesh that rests: its vertices, and a plane for each face. `topology` must be that of `mesh`. Takes
    /// some 30 ns a face.
    ///
    /// # Errors
    ///
    /// [`GpuError::TooLarge`] if it does not fit the device's limits, [`GpuError::OutOfMemory`].
    ///
    /// # Panics
    ///
    /// Panics if `topology` has another number of faces or vertices than `mesh`.
    pub fn new(shaders: &SilhouetteShaders, mesh: &Mesh, topology: GpuTopology) -> Result<Self, GpuError> {
        let planes = FacePlanes::new(mesh);
        Self::with_planes(shaders, mesh, topology, &planes)
    }

    /// As [`GpuCaster::new`], with planes that are there already.
    ///
    /// # Errors
    ///
    /// As [`GpuCaster::new`].
    ///
    /// # Panics
    ///
    /// As [`GpuCaster::new`], and if `planes` are of another number of faces.
    pub fn with_planes(
        shaders: &SilhouetteShaders,
        mesh: &Mesh,
        topology: GpuTopology,
        planes: &FacePlanes,
    ) -> Result<Self, GpuError> {
        assert_eq!(topology.face_count as usize, mesh.face_count(), "the topology is of another mesh");
        assert_eq!(topology.vertex_count as usize, mesh.vertex_count(), "the topology is of another mesh");
        assert_eq!(planes.offsets().len(), mesh.face_count(), "the planes are of another mesh");
        let (filter, values) = Filter::new(mesh, planes);
        let gpu = shaders.gpu();
        Ok(Self {
            shaders: shaders.clone(),
            vertices: gpu.upload("vertices", mesh.positions())?,
            largest: mesh.largest_coordinate(),
            topology,
            planes: Some((filter, gpu.upload("planes of faces", &values)?)),
        })
    }

    /// A mesh whose vertices change, none of whose coordinates is much larger than `largest`: `vertices` is the caller's buffer (`STORAGE`, three `f32` a vertex), which may be
    /// written anew before each [`GpuSilhouette::record`](super::GpuSilhouette::record). Sides are then those of the plain `f32` cross product, which
    /// leaves the range beyond coordinates of about 10¹².
    #[must_use]
    pub fn deforming(
        shaders: &SilhouetteShaders,
        vertices: wgpu::Buffer,
        largest: f32,
        topology: GpuTopology,
    ) -> Self {
        Self { shaders: shaders.clone(), vertices, largest, topology, planes: None }
    }

    /// The device it is on.
    #[must_use]
    pub fn gpu(&self) -> &Gpu {
        self.shaders.gpu()
    }
}
