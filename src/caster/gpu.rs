//! A caster on a graphics device.

use super::Caster;
use crate::built::{self, Part};
use crate::facing::FacePlanes;
use crate::facing::gpu::{Filter, LightParameters};
use crate::geom::Light;
use crate::gpu::raster::{Depth, GpuSamples, Receivers};
use crate::gpu::{Gpu, GpuError, wgpu};
use crate::mesh::Mesh;
use crate::topology::{GpuTopology, Topology};
use crate::view::{Projection, Size};

/// A mesh on a graphics device, with what silhouettes, volumes and techniques need of it: positions,
/// triangles, edge table, and a plane per face. [The buffers](crate::gpu#buffers) lists what they hold.
/// Clones share the buffers.
#[derive(Clone, Debug)]
pub struct GpuCaster {
    gpu: Gpu,
    vertices: wgpu::Buffer,
    largest: f32,
    topology: GpuTopology,
    /// `None` if the vertices change.
    planes: Option<GpuPlanes>,
}

/// The planes of the faces of a mesh at rest.
#[derive(Clone, Debug)]
struct GpuPlanes {
    filter: Filter,
    values: wgpu::Buffer,
}

impl GpuCaster {
    /// Copies a caster to the device, each part once: 12 bytes per vertex and, for a closed mesh, 50 bytes
    /// per face.
    ///
    /// # Errors
    ///
    /// [`GpuError::TooLarge`] if a part does not fit the device's limits, [`GpuError::OutOfMemory`],
    /// [`GpuError::Lost`].
    pub fn upload(gpu: &Gpu, caster: &Caster) -> Result<Self, GpuError> {
        Self::with_planes(gpu, caster.mesh(), caster.topology(), caster.planes())
    }

    pub(crate) fn with_planes(
        gpu: &Gpu,
        mesh: &Mesh,
        topology: &Topology,
        planes: &FacePlanes,
    ) -> Result<Self, GpuError> {
        built::note(Part::Upload, mesh);
        let (filter, values) = Filter::new(mesh, planes);
        Ok(Self {
            gpu: gpu.clone(),
            vertices: gpu.upload("vertices", mesh.positions())?,
            largest: mesh.largest_coordinate(),
            topology: GpuTopology::upload(gpu, topology)?,
            planes: Some(GpuPlanes { filter, values: gpu.upload("planes of faces", &values)? }),
        })
    }

    /// A caster whose vertices change, none of whose coordinates is much larger than `largest`.
    ///
    /// `vertices` is the caller's buffer of usage `STORAGE`, three `f32` per vertex, which may be written
    /// anew before each frame is recorded. Sides are then those of the plain `f32` cross product, which
    /// overflows for coordinates beyond about 10¹². A topology that was built on the device draws with
    /// [`Depth::Interpolated`] only if its triangle buffer has usage `INDEX`.
    #[must_use]
    pub fn deforming(gpu: &Gpu, vertices: wgpu::Buffer, largest: f32, topology: GpuTopology) -> Self {
        Self { gpu: gpu.clone(), vertices, largest, topology, planes: None }
    }

    /// The device.
    #[must_use]
    pub fn gpu(&self) -> &Gpu {
        &self.gpu
    }

    /// Positions: `array<f32>`, three per vertex.
    #[must_use]
    pub fn vertices(&self) -> &wgpu::Buffer {
        &self.vertices
    }

    /// The largest magnitude of a coordinate of a vertex that has a face, or more.
    #[must_use]
    pub fn largest(&self) -> f32 {
        self.largest
    }

    /// Triangles and edges.
    #[must_use]
    pub fn topology(&self) -> &GpuTopology {
        &self.topology
    }

    /// The planes of the faces: `array<vec4f>`. `None` for a deforming caster.
    #[must_use]
    pub fn planes(&self) -> Option<&wgpu::Buffer> {
        self.planes.as_ref().map(|planes| &planes.values)
    }

    /// Draws the caster as a camera sees it, for techniques and pictures. Compiles a pipeline and submits.
    ///
    /// # Errors
    ///
    /// [`GpuError::Subnormal`] if the mesh is too small to be drawn; [`GpuError::Picture`] if the samples do
    /// not fit the device's limits; [`GpuError::OutOfMemory`]; [`GpuError::Lost`].
    pub fn samples(&self, projection: &Projection, size: Size, depth: Depth) -> Result<GpuSamples, GpuError> {
        GpuSamples::draw(&self.gpu, self.receivers()?, projection, size, depth)
    }

    /// The caster as surfaces to draw.
    pub(crate) fn receivers(&self) -> Result<Receivers, GpuError> {
        // Numbers below 2⁻¹²⁶ may be flushed; of a mesh this large they are its last few bits.
        const SMALLEST: f32 = f32::MIN_POSITIVE * (1 << 24) as f32;
        if self.largest > 0.0 && self.largest < SMALLEST {
            return Err(GpuError::Subnormal(self.largest));
        }
        let (planes, plane_stride) = match &self.planes {
            Some(planes) => (&planes.values, planes.filter.stride()),
            None => (&self.vertices, 0),
        };
        Ok(Receivers {
            vertices: self.vertices.clone(),
            triangles: self.topology.triangles().clone(),
            planes: planes.clone(),
            plane_stride,
            corners: 3 * self.topology.face_count(), // a mesh has fewer than 2³² corners
            largest: self.largest,
        })
    }

    /// A light as the shader for sides takes it.
    pub(crate) fn light(&self, light: &Light) -> LightParameters {
        match &self.planes {
            Some(planes) => planes.filter.light(light),
            None => {
                let [x, y, z, w] = light.homogeneous();
                let faces = self.topology.face_count();
                LightParameters { xyz: [x, y, z], w, reach: 0.0, floor: 0.0, faces, padding: 0 }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gpu::tests::gpu;
    use crate::shadow::stencil::StencilPass;
    use crate::shadow::volume::{Caps, GpuExtrusion, VolumeShaders};
    use crate::testing::shapes;

    #[test]
    fn gpu_caster_is_uploaded_once_for_silhouette_volume_and_stencil() {
        let Some(gpu) = gpu() else { return };
        let caster = Caster::new(shapes::icosphere(2));
        let (triangles, built) = built::record(|| {
            let on_device = GpuCaster::upload(&gpu, &caster).unwrap();
            let shaders = VolumeShaders::new(&gpu).unwrap();
            let extrusion = GpuExtrusion::new(&shaders, &on_device, Caps::Both, None).unwrap();
            let light = "point:3,4,5".parse().unwrap();
            let volume = gpu.submit(|encoder| extrusion.record(encoder, &light)).unwrap().unwrap();
            let projection = Projection {
                eye: [0.0, 0.0, 5.0],
                right: [1.0, 0.0, 0.0],
                up: [0.0, 1.0, 0.0],
                forward: [0.0, 0.0, -1.0],
                near: 0.1,
                kind: crate::view::ProjectionKind::InfinitePerspective,
            };
            let pass = StencilPass::new(&gpu, Depth::Plane).unwrap();
            let size = Size::new(8, 8).unwrap();
            pass.prepare(&projection, size, &on_device, &[]).unwrap();
            [volume.triangles().clone(), on_device.topology().triangles().clone()]
        });
        let uploads = built.iter().filter(|(part, _)| *part == Part::Upload).count();
        assert_eq!(uploads, 1);
        assert_ne!(triangles[0], triangles[1]);
        // A second upload is seen.
        let (_, again) = built::record(|| [(); 2].map(|()| GpuCaster::upload(&gpu, &caster).unwrap()));
        assert_eq!(again.iter().filter(|(part, _)| *part == Part::Upload).count(), 2);
    }

    #[test]
    fn gpu_caster_that_a_device_may_flush_is_refused_where_it_is_drawn() {
        let Some(gpu) = gpu() else { return };
        let tiny = Caster::new(shapes::scaled(&shapes::cube(), 1e-40));
        let error = GpuCaster::upload(&gpu, &tiny).unwrap().receivers().unwrap_err();
        assert!(matches!(error, GpuError::Subnormal(_)), "{error}");
        let small = Caster::new(shapes::scaled(&shapes::cube(), 1e-30));
        assert!(GpuCaster::upload(&gpu, &small).unwrap().receivers().is_ok());
    }
}
