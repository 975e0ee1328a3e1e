//! Extrusion of shadow volumes on the device.

use super::GpuVolume;
use crate::caster::GpuCaster;
use crate::geom::Light;
use crate::gpu::{Gpu, GpuError, Kernel, Scan, ScanOf, Shader, wgpu};
use crate::shadow::volume::Caps;
use crate::silhouette::{GpuSilhouette, SilhouetteShaders};

/// Words of four faces each that one invocation counts.
const RUN: usize = 16;
/// In the parameters: the volume has caps.
const CAPS: u32 = 1;
/// In the parameters: all vertices at infinity are one.
const DIRECTIONAL: u32 = 2;

/// The bindings of the shader.
mod slot {
    pub(super) const PARAMETERS: u32 = 0;
    pub(super) const SIGNS: u32 = 1;
    pub(super) const RUN_FACES: u32 = 2;
    pub(super) const TRIANGLES: u32 = 3;
    pub(super) const VERTICES: u32 = 4;
    pub(super) const FOUND: u32 = 5;
    pub(super) const QUADS: u32 = 6;
    pub(super) const OFFSETS: u32 = 7;
    pub(super) const ENTRIES: u32 = 8;
    pub(super) const ENDS: u32 = 9;
    pub(super) const VOLUME: u32 = 10;
    pub(super) const DRAWS: u32 = 11;
    pub(super) const DEMAND: u32 = 12;
}

/// The compiled shaders for silhouettes and volumes, for one device. Cheap to clone.
#[derive(Clone, Debug)]
pub struct VolumeShaders {
    silhouettes: SilhouetteShaders,
    count_caps: Kernel,
    arrange: Kernel,
    caps: Kernel,
    find_ends: Kernel,
    sides: Kernel,
    scan: Scan,
}

impl VolumeShaders {
    /// Compiles the shaders, which takes some tens of milliseconds.
    ///
    /// # Errors
    ///
    /// [`GpuError::OutOfMemory`], [`GpuError::Lost`].
    pub fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        let module = shader().module(gpu)?;
        let kernel = |entry| Kernel::new(gpu, &module, entry);
        Ok(Self {
            silhouettes: SilhouetteShaders::new(gpu)?,
            count_caps: kernel("count_caps")?,
            arrange: kernel("arrange")?,
            caps: kernel("caps")?,
            find_ends: kernel("find_ends")?,
            sides: kernel("sides")?,
            scan: Scan::new(gpu)?,
        })
    }

    /// The shaders for silhouettes alone.
    #[must_use]
    pub fn silhouettes(&self) -> &SilhouetteShaders {
        &self.silhouettes
    }
}

fn shader() -> Shader {
    Shader::new("volume", include_str!("../volume.wgsl"))
        .constant("RUN", "u32", RUN)
        .constant("CAPS", "u32", CAPS)
        .constant("DIRECTIONAL", "u32", DIRECTIONAL)
}

/// `Parameters` in `volume.wgsl`.
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
struct Parameters {
    vertices: u32,
    faces: u32,
    capacity: u32,
    flags: u32,
}

/// The size of a recorded volume; `Demand` in `volume.wgsl`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, bytemuck::Pod, bytemuck::Zeroable)]
#[non_exhaustive]
#[repr(C)]
pub struct Demand {
    /// Faces in the light cap.
    pub cap_faces: u32,
    /// Silhouette edges.
    pub edges: u32,
    /// The sum of their `|m|`.
    pub quads: u32,
    /// 1 if the volume exceeded the capacity: then its arguments draw nothing. Otherwise 0.
    pub exceeded: u32,
}

impl Demand {
    /// The number of triangles of the volume.
    #[must_use]
    pub fn triangles(&self, light: &Light) -> u64 {
        let copies = if light.is_directional() { 1 } else { 2 };
        copies * (u64::from(self.cap_faces) + u64::from(self.quads))
    }
}

/// Silhouette and shadow volume of one caster on the device, for light after light.
///
/// [`GpuExtrusion::record`] is all that a frame needs: sides, silhouette and volume in the caller's encoder.
#[derive(Clone, Debug)]
pub struct GpuExtrusion {
    shaders: VolumeShaders,
    silhouette: GpuSilhouette,
    caps: Caps,
    capacity: u32,
    triangles: wgpu::Buffer,
    arguments: wgpu::Buffer,
    demand: wgpu::Buffer,
    parameters: wgpu::Buffer,
    groups: Bindings,
}

/// The buffers of each pass.
#[derive(Clone, Debug)]
struct Bindings {
    count_caps: wgpu::BindGroup,
    scan_caps: ScanOf,
    arrange: wgpu::BindGroup,
    caps: wgpu::BindGroup,
    find_ends: wgpu::BindGroup,
    sides: wgpu::BindGroup,
}

impl GpuExtrusion {
    /// Allocates for a silhouette of `caster`, and for a volume of at most `capacity` triangles of 12 bytes.
    /// Without a capacity, for the largest volume of any light: eight triangles per face, or six without
    /// caps.
    ///
    /// # Errors
    ///
    /// [`GpuError::TooLarge`] if it does not fit the device's limits, [`GpuError::OutOfMemory`],
    /// [`GpuError::Lost`].
    pub fn new(
        shaders: &VolumeShaders,
        caster: &GpuCaster,
        caps: Caps,
        capacity: Option<u32>,
    ) -> Result<Self, GpuError> {
        Self::of(shaders, &GpuSilhouette::new(&shaders.silhouettes, caster)?, caps, capacity)
    }

    /// As [`GpuExtrusion::new`], for a silhouette that exists already.
    ///
    /// # Errors
    ///
    /// As [`GpuExtrusion::new`].
    pub fn of(
        shaders: &VolumeShaders,
        silhouette: &GpuSilhouette,
        caps: Caps,
        capacity: Option<u32>,
    ) -> Result<Self, GpuError> {
        let (caster, gpu) = (silhouette.caster(), silhouette.caster().gpu());
        let topology = caster.topology();
        let worst = topology.face_count().saturating_mul(if caps == Caps::Both { 8 } else { 6 });
        // A draw counts vertices in 32 bits.
        let capacity = capacity.unwrap_or(worst).min(u32::MAX / 3);
        let triangles = gpu.storage_for::<[u32; 3]>(
            "triangles of a volume",
            capacity as usize,
            wgpu::BufferUsages::INDEX,
        )?;
        let arguments = gpu.storage_for::<[u32; 5]>("draw arguments", 3, wgpu::BufferUsages::INDIRECT)?;
        let demand = gpu.storage::<Demand>("size of a volume", 1)?;
        let parameters =
            gpu.storage_for::<Parameters>("parameters of a volume", 1, wgpu::BufferUsages::UNIFORM)?;
        let runs = runs(topology.face_count());
        let run_faces = gpu.storage::<u32>("casting faces of runs", runs + 1)?;
        let ends =
            gpu.storage::<[u32; 2]>("ends of silhouette edges", (topology.edge_count() as usize).max(1))?;
        let (edges, quads, signs) = (silhouette.edges(), silhouette.quads(), silhouette.signs());
        let groups = Bindings {
            count_caps: shaders.count_caps.bind(
                gpu,
                &[(slot::PARAMETERS, &parameters), (slot::SIGNS, signs), (slot::RUN_FACES, &run_faces)],
            )?,
            scan_caps: shaders.scan.of(gpu, &run_faces, runs)?,
            arrange: shaders.arrange.bind(
                gpu,
                &[
                    (slot::PARAMETERS, &parameters),
                    (slot::RUN_FACES, &run_faces),
                    (slot::FOUND, edges),
                    (slot::DRAWS, &arguments),
                    (slot::DEMAND, &demand),
                ],
            )?,
            caps: shaders.caps.bind(
                gpu,
                &[
                    (slot::PARAMETERS, &parameters),
                    (slot::SIGNS, signs),
                    (slot::RUN_FACES, &run_faces),
                    (slot::TRIANGLES, topology.triangles()),
                    (slot::VOLUME, &triangles),
                    (slot::DRAWS, &arguments),
                ],
            )?,
            find_ends: shaders.find_ends.bind(
                gpu,
                &[
                    (slot::TRIANGLES, topology.triangles()),
                    (slot::VERTICES, caster.vertices()),
                    (slot::FOUND, edges),
                    (slot::OFFSETS, topology.offsets()),
                    (slot::ENTRIES, topology.entries()),
                    (slot::ENDS, &ends),
                ],
            )?,
            sides: shaders.sides.bind(
                gpu,
                &[
                    (slot::PARAMETERS, &parameters),
                    (slot::FOUND, edges),
                    (slot::QUADS, quads),
                    (slot::ENDS, &ends),
                    (slot::VOLUME, &triangles),
                    (slot::DRAWS, &arguments),
                ],
            )?,
        };
        let (shaders, silhouette) = (shaders.clone(), silhouette.clone());
        Ok(Self { shaders, silhouette, caps, capacity, triangles, arguments, demand, parameters, groups })
    }

    /// The silhouette that is extruded.
    #[must_use]
    pub fn silhouette(&self) -> &GpuSilhouette {
        &self.silhouette
    }

    /// A [`Demand`], once a volume is recorded: four `u32`.
    #[must_use]
    pub fn demand(&self) -> &wgpu::Buffer {
        &self.demand
    }

    /// Records silhouette and volume of a light: [`GpuSilhouette::record`], then
    /// [`GpuExtrusion::record_volume`]. Neither submits nor waits. The volume lies in the buffers of this
    /// extrusion until the next one is recorded.
    ///
    /// # Errors
    ///
    /// [`GpuError::OutOfMemory`], [`GpuError::Lost`].
    pub fn record(&self, encoder: &mut wgpu::CommandEncoder, light: &Light) -> Result<GpuVolume, GpuError> {
        self.silhouette.record(encoder, light)?;
        self.record_volume(encoder, light)
    }

    /// Records the extrusion of the silhouette as it is when the commands run, which must be that of `light`.
    ///
    /// If the volume exceeds the capacity, its arguments draw nothing and [`Demand::exceeded`] is set;
    /// nothing is cut off.
    ///
    /// # Errors
    ///
    /// As [`GpuExtrusion::record`].
    pub fn record_volume(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        light: &Light,
    ) -> Result<GpuVolume, GpuError> {
        let (shaders, groups) = (&self.shaders, &self.groups);
        let caster = self.silhouette.caster();
        let topology = caster.topology();
        self.record_arrangement(encoder, light)?;
        // Few edges are silhouette; they are shared out among these invocations.
        let edges = topology.edge_count() as usize;
        let shared = (edges / 8).max(4096).min(edges);
        if self.caps == Caps::Both {
            shaders.caps.record(encoder, &groups.caps, topology.face_count().div_ceil(4) as usize);
        }
        shaders.find_ends.record(encoder, &groups.find_ends, shared);
        shaders.sides.record(encoder, &groups.sides, shared);
        Ok(GpuVolume {
            vertices: caster.vertices().clone(),
            vertex_count: topology.vertex_count(),
            triangles: self.triangles.clone(),
            arguments: self.arguments.clone(),
            light: *light,
            largest: caster.largest(),
            pieces: [].into(),
        })
    }

    /// Records the offsets of the parts, and whether they fit.
    fn record_arrangement(&self, encoder: &mut wgpu::CommandEncoder, light: &Light) -> Result<(), GpuError> {
        let caster = self.silhouette.caster();
        let flags = if self.caps == Caps::Both { CAPS } else { 0 }
            | if light.is_directional() { DIRECTIONAL } else { 0 };
        let parameters = Parameters {
            vertices: caster.topology().vertex_count(),
            faces: caster.topology().face_count(),
            capacity: self.capacity,
            flags,
        };
        // A buffer of its own, so that one encoder may hold several lights.
        let staged = caster.gpu().upload("parameters of a volume", &[parameters])?;
        encoder.copy_buffer_to_buffer(&staged, 0, &self.parameters, 0, staged.size());
        if self.caps == Caps::Both {
            let runs = runs(caster.topology().face_count());
            self.shaders.count_caps.record(encoder, &self.groups.count_caps, runs);
            self.groups.scan_caps.record(encoder);
        }
        self.shaders.arrange.record(encoder, &self.groups.arrange, 1);
        Ok(())
    }

    /// The size of the volume that was recorded last. Waits for the device.
    ///
    /// # Errors
    ///
    /// [`GpuError::OutOfMemory`], [`GpuError::Lost`].
    pub fn download_demand(&self) -> Result<Demand, GpuError> {
        Ok(self.silhouette.caster().gpu().download::<Demand>(&self.demand, 1)?[0])
    }
}

fn runs(faces: u32) -> usize {
    (faces as usize).div_ceil(4 * RUN)
}

impl GpuVolume {
    /// Extrudes a silhouette, which must be that of `light`, into buffers of exact size: triangle by triangle
    /// the volume of [`ShadowVolume::extrude`](crate::shadow::volume::ShadowVolume::extrude). Waits for the
    /// device.
    ///
    /// # Errors
    ///
    /// [`GpuError::TooLarge`] if it does not fit the device's limits, [`GpuError::OutOfMemory`],
    /// [`GpuError::Lost`].
    pub fn extrude(
        shaders: &VolumeShaders,
        silhouette: &GpuSilhouette,
        light: &Light,
        caps: Caps,
    ) -> Result<Self, GpuError> {
        let gpu = silhouette.caster().gpu();
        let empty = GpuExtrusion::of(shaders, silhouette, caps, Some(0))?;
        gpu.submit(|encoder| empty.record_arrangement(encoder, light))??;
        // Beyond 32 bits no buffer is large enough, and this error says so.
        let triangles = empty.download_demand()?.triangles(light).min(u32::MAX.into()) as u32;
        let extrusion = GpuExtrusion::of(shaders, silhouette, caps, Some(triangles))?;
        gpu.submit(|encoder| extrusion.record_volume(encoder, light))?
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::caster::Caster;
    use crate::gpu::layout::{assert_layout, members};
    use crate::gpu::tests::gpu;
    use crate::shadow::volume::gpu::Part;
    use crate::testing::shapes;

    #[test]
    fn volume_shader_has_one_layout_in_rust_and_wgsl() {
        let shader = shader();
        assert_layout!(shader.source(), "Parameters", Parameters: vertices, faces, capacity, flags);
        assert_layout!(shader.source(), "Demand", Demand: cap_faces, edges, quads, exceeded);
        use wgpu::util::DrawIndexedIndirectArgs as Arguments;
        let offset = |name: &str, offset| (name.to_owned(), offset);
        let draw = vec![
            offset("vertex_count", std::mem::offset_of!(Arguments, index_count)),
            offset("instance_count", std::mem::offset_of!(Arguments, instance_count)),
            offset("first_vertex", std::mem::offset_of!(Arguments, first_index)),
            offset("base_vertex", std::mem::offset_of!(Arguments, base_vertex)),
            offset("first_instance", std::mem::offset_of!(Arguments, first_instance)),
        ];
        assert_eq!(members(shader.source(), "Draw"), (draw, size_of::<Arguments>()));
        let found = [("edges", 0), ("quads", 4), ("list", 8)].map(|(name, at)| offset(name, at));
        assert_eq!(members(shader.source(), "Found").0, found);
    }

    #[test]
    fn volume_that_does_not_fit_draws_nothing_and_says_so() {
        let Some(gpu) = gpu() else { return };
        let mesh = shapes::icosphere(2);
        let caster = GpuCaster::upload(&gpu, &Caster::new(mesh.clone())).unwrap();
        let shaders = VolumeShaders::new(&gpu).unwrap();
        let silhouette = GpuSilhouette::new(shaders.silhouettes(), &caster).unwrap();
        for (light, copies) in [("point:2,3,4", 2), ("directional:-1,-2,-3", 1)] {
            let light: Light = light.parse().unwrap();
            let found = silhouette.find(&mesh, &light).unwrap();
            let quads: u32 = found.silhouette.edges.iter().map(|edge| edge.multiplicity.unsigned_abs()).sum();
            let sides = silhouette.download_facing().unwrap();
            let casting = sides.iter().filter(|facing| facing.sign() != 0).count();
            let needed = copies * (casting as u32 + quads);
            for (capacity, fits) in
                [(Some(needed), true), (Some(needed - 1), false), (Some(0), false), (None, true)]
            {
                let extrusion = GpuExtrusion::of(&shaders, &silhouette, Caps::Both, capacity).unwrap();
                let volume = gpu.submit(|encoder| extrusion.record_volume(encoder, &light)).unwrap().unwrap();
                let demand = extrusion.download_demand().unwrap();
                assert_eq!((demand.triangles(&light), demand.exceeded == 0), (needed.into(), fits));
                assert_eq!(demand.edges as usize, found.silhouette.edges.len());
                let drawn: usize =
                    Part::ALL.map(|part| volume.download(&gpu, part).unwrap().len()).into_iter().sum();
                assert_eq!(drawn, if fits { needed as usize } else { 0 });
            }
        }
    }
}
