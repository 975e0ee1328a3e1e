//! The edge table in buffers of a graphics device, copied there or built there.

mod build;
#[cfg(test)]
mod tests;

pub use build::GpuTopologyBuilder;

use super::Topology;
use crate::gpu::{Gpu, GpuError, wgpu};

/// An edge table on the device, bit-equal to that of a [`Topology`].
///
/// Edges are numbered in the order of their vertices `(a, b)`, `a < b`. The entries of edge `e` are those
/// from `offsets[e]` up to `offsets[e + 1]`, ascending. An entry is a half-edge, `entry >> 1`, and its
/// direction, `entry & 1`: 0 from the edge's lower- to its higher-numbered vertex, 1 back. Half-edge `h` is
/// corner `h` of the triangle list: of face `h / 3`, starting at vertex `triangles[h]`.
#[derive(Clone, Debug)]
pub struct GpuTopology {
    /// `array<u32>`, one more than there are edges.
    pub offsets: wgpu::Buffer,
    /// `array<u32>`, three per face that has not collapsed. Four unspecified bytes if there is none.
    pub entries: wgpu::Buffer,
    /// The number of edges.
    pub edge_count: u32,
    /// The number of faces, collapsed ones included.
    pub face_count: u32,
    /// The number of vertices, used or not.
    pub vertex_count: u32,
    /// `array<u32>`, three per face.
    pub triangles: wgpu::Buffer,
}

impl GpuTopology {
    /// Copies an edge table to the device.
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
            triangles: gpu.upload("triangles", topology.triangles())?,
        })
    }

    /// The edge table of triangles that are on the device already, bit-equal to that of [`Topology::build`]
    /// and [`GpuTopology::upload`]. Compiles its shaders first: keep a [`GpuTopologyBuilder`] to build often.
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
    /// assert_eq!(topology.edge_count, 18);
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
