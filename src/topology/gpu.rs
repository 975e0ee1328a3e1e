//! An edge table in buffers of a graphics device.

use super::Topology;
use crate::gpu::{Gpu, GpuError, wgpu};

/// The half-edges and edges of a triangle list on the device, numbered as in [`Topology`].
#[derive(Clone, Debug)]
pub struct GpuTopology {
    /// `array<u32>`, `edge_count + 1`: where each edge's entries start.
    pub offsets: wgpu::Buffer,
    /// `array<u32>`: half-edge id `<< 1`, and 1 in the lowest bit if it runs from the edge's larger vertex to its
    /// smaller. Ascending within an edge.
    pub entries: wgpu::Buffer,
    /// How many edges there are.
    pub edge_count: u32,
    /// How many faces there are, collapsed ones included.
    pub face_count: u32,
    /// How many vertices there are, used or not.
    pub vertex_count: u32,
    /// `array<u32>`, three a face.
    pub triangles: wgpu::Buffer,
}

impl GpuTopology {
    /// Copies an edge table to the device.
    ///
    /// # Errors
    ///
    /// [`GpuError::TooLarge`] if it does not fit the device's limits, [`GpuError::OutOfMemory`].
    pub fn upload(gpu: &Gpu, topology: &Topology) -> Result<Self, GpuError> {
        let entries: Vec<u32> = topology.entries.iter().map(|entry| entry.0).collect();
        Ok(Self {
            offsets: gpu.upload("edge offsets", &topology.offsets)?,
            entries: gpu.upload("edge entries", &entries)?,
            // All of them are ids of 32 bits.
            edge_count: topology.edge_count() as u32,
            face_count: topology.face_count() as u32,
            vertex_count: topology.vertex_count() as u32,
            triangles: gpu.upload("triangles", &topology.triangles)?,
        })
    }
}
