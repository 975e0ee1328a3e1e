//! The edge table in buffers of a graphics device, copied there or built there.

mod build;
#[cfg(test)]
mod tests;

pub use build::GpuTopologyBuilder;

use super::Topology;
use crate::gpu::{Gpu, GpuError, wgpu};

/// An edge table on the device, the same words as a [`Topology`] holds: see [the
/// buffers](crate::gpu#buffers).
#[derive(Clone, Debug)]
pub struct GpuTopology {
    offsets: wgpu::Buffer,
    entries: wgpu::Buffer,
    edge_count: u32,
    face_count: u32,
    vertex_count: u32,
    triangles: wgpu::Buffer,
}

impl GpuTopology {
    /// Copies an edge table to the device, for a
    /// [`GpuCaster::deforming`](crate::caster::GpuCaster::deforming) caster. A caster at rest is copied whole
    /// by [`GpuCaster::upload`](crate::caster::GpuCaster::upload).
    ///
    /// # Errors
    ///
    /// [`GpuError::TooLarge`] if it does not fit the device's limits, [`GpuError::OutOfMemory`],
    /// [`GpuError::Lost`].
    pub fn upload(gpu: &Gpu, topology: &Topology) -> Result<Self, GpuError> {
        Ok(Self {
            offsets: gpu.upload("offsets of edges", &topology.offsets)?,
            entries: gpu.upload("entries of edges", &topology.entries)?,
            edge_count: topology.edge_count() as u32, // ids are 32 bits
            face_count: topology.face_count() as u32,
            vertex_count: topology.vertex_count() as u32,
            triangles: gpu.upload_for("triangles", topology.triangles(), wgpu::BufferUsages::INDEX)?,
        })
    }

    /// The range of entries of each edge: `array<u32>`, one more than there are edges.
    #[must_use]
    pub fn offsets(&self) -> &wgpu::Buffer {
        &self.offsets
    }

    /// The half-edges of each edge with their directions: `array<u32>`.
    #[must_use]
    pub fn entries(&self) -> &wgpu::Buffer {
        &self.entries
    }

    /// The triangle list: `array<u32>`, three per face.
    #[must_use]
    pub fn triangles(&self) -> &wgpu::Buffer {
        &self.triangles
    }

    /// The number of edges.
    #[must_use]
    pub fn edge_count(&self) -> u32 {
        self.edge_count
    }

    /// The number of faces, collapsed ones included.
    #[must_use]
    pub fn face_count(&self) -> u32 {
        self.face_count
    }

    /// The number of vertices, used or not.
    #[must_use]
    pub fn vertex_count(&self) -> u32 {
        self.vertex_count
    }

    /// Builds the edge table of a triangle list on the device, bit for bit the one that [`Topology::build`]
    /// and [`GpuTopology::upload`] give. Compiles the shaders first: keep a [`GpuTopologyBuilder`] to build
    /// often.
    ///
    /// # Errors
    ///
    /// Those of [`GpuTopologyBuilder::new`] and [`GpuTopologyBuilder::build`].
    ///
    /// ```
    /// # use umbrage::gpu::{Gpu, GpuError, wgpu::{self, util::DeviceExt}};
    /// use umbrage::testing::shapes;
    /// use umbrage::topology::GpuTopology;
    /// # fn main() -> Result<(), GpuError> {
    /// # let gpu = match Gpu::new(None) { Err(GpuError::NoAdapter) => return Ok(()), gpu => gpu? };
    /// let cube = shapes::cube();
    /// let triangles = gpu.device().create_buffer_init(&wgpu::util::BufferInitDescriptor {
    ///     label: None,
    ///     contents: bytemuck::cast_slice(cube.triangles()),
    ///     usage: wgpu::BufferUsages::STORAGE,
    /// });
    /// let topology = GpuTopology::build(&gpu, 8, &triangles, 12)?;
    /// assert_eq!(topology.edge_count(), 18);
    /// # Ok(())
    /// # }
    /// ```
    pub fn build(
        gpu: &Gpu,
        vertex_count: u32,
        triangles: &wgpu::Buffer,
        face_count: u32,
    ) -> Result<Self, GpuError> {
        GpuTopologyBuilder::new(gpu)?.build(gpu, vertex_count, triangles, face_count)
    }

    /// Reads offsets and entries back. Waits for the work that writes them.
    ///
    /// # Errors
    ///
    /// [`GpuError::Lost`], [`GpuError::OutOfMemory`].
    pub fn download(&self, gpu: &Gpu) -> Result<(Vec<u32>, Vec<u32>), GpuError> {
        let offsets: Vec<u32> = gpu.download(&self.offsets, self.edge_count as usize + 1)?;
        let count = offsets.last().map_or(0, |&end| end as usize);
        let entries = gpu.download(&self.entries, count)?;
        Ok((offsets, entries))
    }
}
