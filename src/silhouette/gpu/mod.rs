//! Sides and silhouettes on a graphics device: exact, or without waiting for the device.
//!
//! [`SilhouetteShaders`] are compiled once per device, a [`GpuCaster`] is uploaded once per mesh, and a
//! [`GpuSilhouette`] holds the result of one light. There are two methods to compute it:
//!
//! - [`GpuSilhouette::find`] is exact. The shader answers front, back or unsure; unsure faces are decided on
//!   the processor by [`facing_of`] and written back, so the result is that of
//!   [`classify`](crate::facing::classify) and [`Silhouette::extract`], bit for bit. It waits for the device
//!   twice.
//! - [`GpuSilhouette::record`] writes into a caller's encoder and never waits. Unsure faces keep the sign
//!   that `f32` gave. Each face still has one stored sign, so that volumes stay closed.

mod shaders;
#[cfg(test)]
mod tests;

use std::sync::{Arc, Mutex};

use super::{Silhouette, SilhouetteEdge};
use crate::caster::GpuCaster;
use crate::facing::facing_of;
use crate::facing::gpu::LightParameters;
use crate::geom::{Facing, Light};
use crate::gpu::{GpuError, ScanOf, wgpu};
use crate::mesh::{EdgeId, FaceId, Mesh};
pub use shaders::SilhouetteShaders;
use shaders::{EDGES, RUN, slot};

/// Unsure faces that are read back together with their number.
const FIRST_FACES: u64 = 4095;
/// Silhouette edges that are read back together with their number.
const FIRST_EDGES: u64 = 16384;

/// Sides and silhouette of one caster for one light at a time, on the device.
///
/// A caller's own shaders may read the buffers, after the work that was recorded or found last: see
/// [the buffers](crate::gpu#buffers). Clones share them.
#[derive(Clone, Debug)]
pub struct GpuSilhouette {
    shaders: SilhouetteShaders,
    caster: GpuCaster,
    facing: wgpu::Buffer,
    signs: wgpu::Buffer,
    edges: wgpu::Buffer,
    quads: wgpu::Buffer,
    unsure: wgpu::Buffer,
    masks: wgpu::Buffer,
    light: wgpu::Buffer,
    groups: Bindings,
    staging: Arc<Mutex<wgpu::Buffer>>,
}

/// The buffers of each pass.
#[derive(Clone, Debug)]
struct Bindings {
    facing: wgpu::BindGroup,
    drop_collapsed: wgpu::BindGroup,
    choose_casters: wgpu::BindGroup,
    multiply: wgpu::BindGroup,
    count_runs: wgpu::BindGroup,
    scan_runs: ScanOf,
    list_runs: wgpu::BindGroup,
}

/// The result of an exact search.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct FoundSilhouette {
    /// The silhouette of the faces that cast.
    pub silhouette: Silhouette,
    /// The number of faces that the processor decided.
    pub unsure_faces: usize,
}

impl GpuSilhouette {
    /// Allocates the buffers for the result of a light: at most 2 bytes per face and 12 per edge, and 4 more
    /// per face of a caster at rest. All faces cast until [`GpuSilhouette::set_masks`] says otherwise.
    ///
    /// # Errors
    ///
    /// [`GpuError::TooLarge`] if it does not fit the device's limits, [`GpuError::OutOfMemory`].
    pub fn new(shaders: &SilhouetteShaders, caster: &GpuCaster) -> Result<Self, GpuError> {
        let (gpu, topology) = (caster.gpu(), caster.topology());
        let (faces, edges) = (topology.face_count() as usize, topology.edge_count() as usize);
        let sixteens = faces.div_ceil(16).max(1); // no buffer is empty
        let facing = gpu.storage::<[u32; 4]>("sides of faces", sixteens)?;
        let signs = gpu.storage::<[u32; 4]>("signs of faces", sixteens)?;
        let masks = gpu.storage::<[u32; 4]>("which faces cast", sixteens)?;
        let listed = if caster.planes().is_some() { faces } else { 0 };
        let unsure = gpu.storage::<u32>("unsure faces", 1 + listed.max(1))?;
        let multiplicities = gpu.storage::<i32>("multiplicities", edges)?;
        let runs = edges.div_ceil(RUN);
        let counts = gpu.storage::<u32>("silhouette edges of runs", 2 * runs + 1)?;
        let found = gpu.storage::<[u32; 2]>("silhouette edges", 1 + edges.max(1))?;
        let quads = gpu.storage::<u32>("quads before an edge", edges)?;
        let light = gpu.storage_for::<LightParameters>("light", 1, wgpu::BufferUsages::UNIFORM)?;
        let face_count = gpu.uniform(&[topology.face_count(), 0, 0, 0])?;
        let edge_count = gpu.uniform(&[topology.edge_count(), 0, 0, 0])?;
        let groups = Bindings {
            facing: match caster.planes() {
                Some(planes) => shaders.facing_by_planes.bind(
                    gpu,
                    &[
                        (slot::LIGHT, &light),
                        (slot::PLANES, planes),
                        (slot::FACING, &facing),
                        (slot::UNSURE, &unsure),
                    ],
                )?,
                None => shaders.facing_by_positions.bind(
                    gpu,
                    &[
                        (slot::LIGHT, &light),
                        (slot::FACING, &facing),
                        (slot::TRIANGLES, topology.triangles()),
                        (slot::VERTICES, caster.vertices()),
                    ],
                )?,
            },
            drop_collapsed: shaders.drop_collapsed.bind(
                gpu,
                &[(slot::TRIANGLES, topology.triangles()), (slot::MASKS, &masks), (slot::SIZE, &face_count)],
            )?,
            choose_casters: shaders.choose_casters.bind(
                gpu,
                &[
                    (slot::FACING, &facing),
                    (slot::MASKS, &masks),
                    (slot::SIGNS, &signs),
                    (slot::SIZE, &face_count),
                ],
            )?,
            multiply: shaders.multiply.bind(
                gpu,
                &[
                    (slot::SIGNS, &signs),
                    (slot::OFFSETS, topology.offsets()),
                    (slot::ENTRIES, topology.entries()),
                    (slot::MULTIPLICITIES, &multiplicities),
                    (slot::SIZE, &edge_count),
                ],
            )?,
            count_runs: shaders.count_runs.bind(
                gpu,
                &[(slot::MULTIPLICITIES, &multiplicities), (slot::RUNS, &counts), (slot::SIZE, &edge_count)],
            )?,
            scan_runs: shaders.scan.of(gpu, &counts, 2 * runs)?,
            list_runs: shaders.list_runs.bind(
                gpu,
                &[
                    (slot::MULTIPLICITIES, &multiplicities),
                    (slot::RUNS, &counts),
                    (slot::FOUND, &found),
                    (slot::QUADS, &quads),
                    (slot::SIZE, &edge_count),
                ],
            )?,
        };
        let first = (4 + 4 * FIRST_FACES).max(8 + 8 * FIRST_EDGES);
        let staging = Arc::new(Mutex::new(gpu.staging(first)?));
        let (shaders, caster) = (shaders.clone(), caster.clone());
        let silhouette = Self {
            shaders,
            caster,
            facing,
            signs,
            edges: found,
            quads,
            unsure,
            masks,
            light,
            groups,
            staging,
        };
        silhouette.set_masks(&vec![crate::facing::CasterFaces::All.mask(); faces])?;
        Ok(silhouette)
    }

    /// Sets on which sides each face casts, one entry per face:
    /// [`CasterFaces::mask`](crate::facing::CasterFaces::mask), or those of
    /// [`ShellFaces::masks`](crate::shadow::volume::ShellFaces::masks). Holds for everything found or
    /// recorded afterwards.
    ///
    /// # Errors
    ///
    /// [`GpuError::OutOfMemory`], [`GpuError::Lost`].
    ///
    /// # Panics
    ///
    /// Panics if there is not one mask per face.
    pub fn set_masks(&self, masks: &[u8]) -> Result<(), GpuError> {
        let faces = self.caster.topology().face_count() as usize;
        assert_eq!(masks.len(), faces, "one mask per face");
        let mut padded = masks.to_vec();
        padded.resize(faces.next_multiple_of(4), 0);
        let (gpu, shaders) = (self.caster.gpu(), &self.shaders);
        let staged = gpu.upload("which faces cast", &padded)?;
        gpu.submit(|encoder| {
            encoder.copy_buffer_to_buffer(&staged, 0, &self.masks, 0, padded.len() as u64);
            shaders.drop_collapsed.record(encoder, &self.groups.drop_collapsed, faces.div_ceil(4));
        })
    }

    /// The caster.
    #[must_use]
    pub fn caster(&self) -> &GpuCaster {
        &self.caster
    }

    /// The side of each face: `array<u32>`, four faces per word.
    #[must_use]
    pub fn facing(&self) -> &wgpu::Buffer {
        &self.facing
    }

    /// As [`GpuSilhouette::facing`], with 0 for faces that do not cast.
    #[must_use]
    pub fn signs(&self) -> &wgpu::Buffer {
        &self.signs
    }

    /// The silhouette edges with their multiplicities.
    #[must_use]
    pub fn edges(&self) -> &wgpu::Buffer {
        &self.edges
    }

    /// For each silhouette edge the sum of `|m|` over those before it: `array<u32>`.
    #[must_use]
    pub fn quads(&self) -> &wgpu::Buffer {
        &self.quads
    }

    /// The number of unsure faces, then their ids: `array<u32>`.
    #[must_use]
    pub fn unsure(&self) -> &wgpu::Buffer {
        &self.unsure
    }

    /// The side of every face for `light`, and the silhouette of those that cast, exactly. `mesh` must be the
    /// one that was uploaded. Waits for the device. Clones share their buffers: one light at a time, on one
    /// thread.
    ///
    /// # Errors
    ///
    /// [`GpuError::OutOfMemory`], [`GpuError::Lost`].
    ///
    /// # Panics
    ///
    /// Panics if `mesh` has another number of faces, or if the caster deforms: then sides have no error
    /// bound.
    pub fn find(&self, mesh: &Mesh, light: &Light) -> Result<FoundSilhouette, GpuError> {
        let unsure_faces = self.classify(mesh, light)?;
        Ok(FoundSilhouette { silhouette: self.extract()?, unsure_faces })
    }

    /// The first half of [`GpuSilhouette::find`]: the side of every face, in [`GpuSilhouette::facing`].
    /// Returns the number of faces that the processor decided.
    ///
    /// # Errors
    ///
    /// As [`GpuSilhouette::find`].
    ///
    /// # Panics
    ///
    /// As [`GpuSilhouette::find`].
    pub fn classify(&self, mesh: &Mesh, light: &Light) -> Result<usize, GpuError> {
        let faces = self.caster.topology().face_count();
        assert_eq!(mesh.face_count(), faces as usize, "the caster is of another mesh");
        assert!(self.caster.planes().is_some(), "a deforming caster has no exact sides");
        let unsure = self.unsure_faces(light)?;
        if !unsure.is_empty() {
            self.settle(unsure.iter().map(|&face| (face, facing_of(mesh, FaceId(face), light))))?;
        }
        Ok(unsure.len())
    }

    /// Runs the filter and reads back the unsure faces, ascending.
    fn unsure_faces(&self, light: &Light) -> Result<Vec<u32>, GpuError> {
        let gpu = self.caster.gpu();
        let staging = self.staging.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        let size = self.unsure.size().min(4 + 4 * FIRST_FACES);
        gpu.submit(|encoder| {
            self.record_facing(encoder, light)?;
            encoder.copy_buffer_to_buffer(&self.unsure, 0, &staging, 0, size);
            Ok::<(), GpuError>(())
        })??;
        let (count, mut faces) = gpu.mapped(&staging, |bytes| {
            let words: &[u32] = bytemuck::cast_slice(&bytes[..size as usize]);
            let count = words[0] as usize;
            (count, words[1..].iter().copied().take(count).collect::<Vec<u32>>())
        })?;
        if count > faces.len() {
            faces = gpu.download::<u32>(&self.unsure, 1 + count)?.split_off(1);
        }
        faces.sort_unstable();
        Ok(faces)
    }

    /// Writes sides that were decided exactly, ascending by face.
    fn settle(&self, settled: impl Iterator<Item = (u32, Facing)>) -> Result<(), GpuError> {
        // A word holds four faces: index of the word, the bits that are kept, the bits that are set.
        let mut patches: Vec<[u32; 3]> = Vec::new();
        for (face, facing) in settled {
            let shift = 8 * (face % 4);
            let bits = u32::from(facing.sign() as u8) << shift;
            match patches.last_mut().filter(|patch| patch[0] == face / 4) {
                Some(patch) => (patch[1], patch[2]) = (patch[1] & !(0xff << shift), patch[2] | bits),
                None => patches.push([face / 4, !(0xff << shift), bits]),
            }
        }
        let (gpu, settle) = (self.caster.gpu(), &self.shaders.settle);
        let buffer = gpu.upload("settled faces", &patches)?;
        let size = gpu.uniform(&[patches.len() as u32, 0, 0, 0])?;
        let buffers = [(slot::PATCHES, &buffer), (slot::FACING, &self.facing), (slot::SIZE, &size)];
        let bindings = settle.bind(gpu, &buffers)?;
        gpu.submit(|encoder| settle.record(encoder, &bindings, patches.len()))
    }

    /// The second half of [`GpuSilhouette::find`]: the silhouette of the sides that are stored. Waits for the
    /// device.
    ///
    /// # Errors
    ///
    /// [`GpuError::OutOfMemory`], [`GpuError::Lost`].
    pub fn extract(&self) -> Result<Silhouette, GpuError> {
        let gpu = self.caster.gpu();
        let staging = self.staging.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        let size = self.edges.size().min(8 + 8 * FIRST_EDGES);
        gpu.submit(|encoder| {
            self.record_edges(encoder);
            encoder.copy_buffer_to_buffer(&self.edges, 0, &staging, 0, size);
        })?;
        let (count, edges) = gpu.mapped(&staging, |bytes| {
            let words: &[[u32; 2]] = bytemuck::cast_slice(&bytes[..size as usize]);
            let count = words[0][0] as usize;
            (count, listed(&words[1..(1 + count).min(words.len())]))
        })?;
        if count == edges.len() {
            return Ok(Silhouette { edges });
        }
        let words = gpu.download::<[u32; 2]>(&self.edges, 1 + count)?;
        Ok(Silhouette { edges: listed(&words[1..]) })
    }

    /// Records sides and silhouette for `light`; unsure faces keep the sign that `f32` gave. Neither submits
    /// nor waits. [`GpuSilhouette::unsure`] starts with their number, to be read at any time. Several lights
    /// may be recorded into one encoder: each with its own [`GpuSilhouette`], or with one whose result is
    /// used before the next is recorded.
    ///
    /// # Errors
    ///
    /// [`GpuError::OutOfMemory`], [`GpuError::Lost`].
    pub fn record(&self, encoder: &mut wgpu::CommandEncoder, light: &Light) -> Result<(), GpuError> {
        self.record_facing(encoder, light)?;
        self.record_edges(encoder);
        Ok(())
    }

    /// The first half of [`GpuSilhouette::record`]: the side of every face.
    ///
    /// # Errors
    ///
    /// As [`GpuSilhouette::record`].
    pub fn record_facing(&self, encoder: &mut wgpu::CommandEncoder, light: &Light) -> Result<(), GpuError> {
        let parameters = self.parameters(light)?;
        let shaders = &self.shaders;
        encoder.copy_buffer_to_buffer(&parameters, 0, &self.light, 0, parameters.size());
        encoder.clear_buffer(&self.unsure, 0, Some(4));
        let facing = match self.caster.planes() {
            Some(_) => &shaders.facing_by_planes,
            None => &shaders.facing_by_positions,
        };
        let groups = self.caster.topology().face_count().div_ceil(4) as usize;
        facing.record(encoder, &self.groups.facing, groups);
        Ok(())
    }

    /// The second half of [`GpuSilhouette::record`]: the silhouette of the sides that are stored.
    pub fn record_edges(&self, encoder: &mut wgpu::CommandEncoder) {
        let (shaders, groups) = (&self.shaders, &self.groups);
        let faces = self.caster.topology().face_count() as usize;
        let edges = self.caster.topology().edge_count() as usize;
        let runs = edges.div_ceil(RUN);
        shaders.choose_casters.record(encoder, &groups.choose_casters, faces.div_ceil(16));
        shaders.multiply.record(encoder, &groups.multiply, edges.div_ceil(EDGES));
        shaders.count_runs.record(encoder, &groups.count_runs, runs);
        groups.scan_runs.record(encoder);
        shaders.list_runs.record(encoder, &groups.list_runs, runs.max(1));
    }

    /// The side of every face as stored. Waits for the device.
    ///
    /// # Errors
    ///
    /// [`GpuError::OutOfMemory`], [`GpuError::Lost`].
    pub fn download_facing(&self) -> Result<Vec<Facing>, GpuError> {
        let side = |byte: i8| match byte {
            1 => Facing::Front,
            0 => Facing::EdgeOn,
            _ => Facing::Back,
        };
        let faces = self.caster.topology().face_count() as usize;
        Ok(self.caster.gpu().download::<i8>(&self.facing, faces)?.into_iter().map(side).collect())
    }

    /// The number of unsure faces in what was recorded last. Waits for the device.
    ///
    /// # Errors
    ///
    /// [`GpuError::OutOfMemory`], [`GpuError::Lost`].
    pub fn download_unsure_count(&self) -> Result<usize, GpuError> {
        Ok(self.caster.gpu().download::<u32>(&self.unsure, 1)?[0] as usize)
    }

    /// The unsure faces in what was recorded last, ascending. Waits for the device.
    ///
    /// # Errors
    ///
    /// [`GpuError::OutOfMemory`], [`GpuError::Lost`].
    pub fn download_unsure(&self) -> Result<Vec<FaceId>, GpuError> {
        let words = self.caster.gpu().download::<u32>(&self.unsure, 1 + self.download_unsure_count()?)?;
        let mut faces: Vec<FaceId> = words[1..].iter().copied().map(FaceId).collect();
        faces.sort_unstable();
        Ok(faces)
    }

    /// The parameters of a light, in a buffer of its own, so that one encoder may hold several lights.
    fn parameters(&self, light: &Light) -> Result<wgpu::Buffer, GpuError> {
        self.caster.gpu().upload("light", &[self.caster.light(light)])
    }
}

fn listed(words: &[[u32; 2]]) -> Vec<SilhouetteEdge> {
    let edge = |&[edge, m]: &[u32; 2]| SilhouetteEdge { edge: EdgeId(edge), multiplicity: m.cast_signed() };
    words.iter().map(edge).collect()
}
