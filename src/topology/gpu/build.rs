//! The edge table by compute shaders: two stable radix sorts of the half-edges, then prefix sums. Twin:
//! `../build.rs`.
//!
//! A counting sort by vertex and a small sort per vertex, as on the host, would hang on one vertex of a
//! million faces; the radix sort costs the same for every mesh.

use bytemuck::{Pod, Zeroable};

use super::GpuTopology;
use crate::gpu::{Gpu, GpuError, Kernel, Pairs, Scan, Shader, Sort, wgpu};
use crate::mesh::MAX_TRIANGLES;

/// Compiled shaders that build edge tables on the device.
#[derive(Clone, Debug)]
pub struct GpuTopologyBuilder {
    list: Kernel,
    rekey: Kernel,
    mark: Kernel,
    put_offsets: Kernel,
    sort: Sort,
    scan: Scan,
}

/// Twin of the shader's struct of the same name.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub(super) struct Size {
    pub(super) half_edges: u32,
    pub(super) vertices: u32,
}

/// Twin of the shader's struct of the same name, and the count that the prefix sum leaves.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub(super) struct Found {
    pub(super) bad_face: u32,
    pub(super) kept: u32,
    edges: u32,
}

impl Found {
    const NOTHING: Self = Self { bad_face: u32::MAX, kept: 0, edges: 0 };
}

impl GpuTopologyBuilder {
    /// Compiles the shaders.
    ///
    /// # Errors
    ///
    /// [`GpuError::OutOfMemory`], [`GpuError::Lost`].
    pub fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        let module = shader().module(gpu)?;
        Ok(Self {
            list: Kernel::new(gpu, &module, "list")?,
            rekey: Kernel::new(gpu, &module, "rekey")?,
            mark: Kernel::new(gpu, &module, "mark")?,
            put_offsets: Kernel::new(gpu, &module, "put_offsets")?,
            sort: Sort::new(gpu)?,
            scan: Scan::new(gpu)?,
        })
    }

    /// Builds the edge table of the first `face_count` triangles of a buffer, `array<u32>`, three corners
    /// each, with usage `STORAGE`. The result shares that buffer; its other buffers are of exact size.
    ///
    /// Linear time: the half-edges, 16 bytes each while they are sorted, are moved twice per six bits of the
    /// vertex count. Device memory: about 60 bytes per triangle besides the result, for that time. Waits once
    /// for the device, to read three words: the numbers of edges and entries, and whether an index was bad.
    ///
    /// # Errors
    ///
    /// [`GpuError::BadIndex`] if a corner is not below `vertex_count`; [`GpuError::TooSmall`] if `triangles`
    /// holds fewer than `face_count`; [`GpuError::TooLarge`] if a buffer exceeds the device's limits, or the
    /// faces [`MAX_TRIANGLES`]; [`GpuError::OutOfMemory`]; [`GpuError::Lost`].
    pub fn build(
        &self,
        gpu: &Gpu,
        vertex_count: u32,
        triangles: &wgpu::Buffer,
        face_count: u32,
    ) -> Result<GpuTopology, GpuError> {
        check_size(gpu, triangles, face_count)?;
        // A key is a vertex, or the vertex count.
        let bits = u32::BITS - vertex_count.leading_zeros();
        let (offsets, entries, edge_count) =
            self.build_by(gpu, vertex_count, triangles, 3 * face_count as usize, bits)?;
        let triangles = triangles.clone(); // the handle
        Ok(GpuTopology { offsets, entries, edge_count, face_count, vertex_count, triangles })
    }

    /// Offsets, entries and edge count of the first `half_edges` half-edges, sorted by the lowest `bits` bits
    /// of their vertices.
    pub(super) fn build_by(
        &self,
        gpu: &Gpu,
        vertex_count: u32,
        triangles: &wgpu::Buffer,
        half_edges: usize,
        bits: u32,
    ) -> Result<(wgpu::Buffer, wgpu::Buffer, u32), GpuError> {
        if half_edges == 0 {
            return Ok((gpu.storage::<u32>("offsets", 1)?, gpu.storage::<u32>("entries", 0)?, 0));
        }
        let size = gpu.uniform(&Size { half_edges: half_edges as u32, vertices: vertex_count })?;
        let pairs = || -> Result<_, GpuError> {
            let keys = gpu.storage::<u32>("keys of half-edges", half_edges + 1)?; // for the prefix sum
            Ok(Pairs { keys, values: gpu.storage::<u32>("half-edges", half_edges)? })
        };
        let (listed, spare) = (pairs()?, pairs()?);
        let found = gpu.upload("what was found", &[Found::NOTHING])?;

        let list = self
            .list
            .bind(gpu, &[(0, triangles), (1, &listed.keys), (2, &listed.values), (5, &found), (6, &size)])?;
        let (by_larger, [pairs, spare]) = self.sort.of(gpu, &listed, &spare, half_edges, bits)?;
        let rekey =
            self.rekey.bind(gpu, &[(0, triangles), (1, &pairs.keys), (2, &pairs.values), (6, &size)])?;
        let (by_smaller, [pairs, spare]) = self.sort.of(gpu, pairs, spare, half_edges, bits)?;
        let edges = &spare.keys;
        let buffers =
            [(0, triangles), (1, &pairs.keys), (2, &pairs.values), (3, edges), (5, &found), (6, &size)];
        let mark = self.mark.bind(gpu, &buffers)?;
        let scan = self.scan.of(gpu, edges, half_edges)?;
        let staging = gpu.staging(size_of::<Found>() as u64)?;
        gpu.submit(|encoder| {
            self.list.record(encoder, &list, half_edges);
            by_larger.record(encoder);
            self.rekey.record(encoder, &rekey, half_edges);
            by_smaller.record(encoder);
            self.mark.record(encoder, &mark, half_edges);
            scan.record(encoder);
            encoder.copy_buffer_to_buffer(&found, 0, &staging, 0, 8);
            encoder.copy_buffer_to_buffer(edges, 4 * half_edges as u64, &staging, 8, 4);
        })?;
        let Found { bad_face, kept, edges: edge_count } =
            gpu.mapped(&staging, bytemuck::pod_read_unaligned)?;
        if bad_face != u32::MAX {
            return Err(GpuError::BadIndex { face: bad_face, vertex_count });
        }

        let offsets = gpu.storage::<u32>("offsets of edges", edge_count as usize + 1)?;
        let entries = gpu.storage::<u32>("entries of edges", kept as usize)?;
        let put = self.put_offsets.bind(gpu, &[(3, edges), (4, &offsets), (5, &found), (6, &size)])?;
        gpu.submit(|encoder| {
            self.put_offsets.record(encoder, &put, half_edges);
            encoder.copy_buffer_to_buffer(&pairs.values, 0, &entries, 0, 4 * u64::from(kept));
        })?;
        Ok((offsets, entries, edge_count))
    }
}

/// Refuses what does not fit: no shader reads beyond a buffer, but its result would be that of another mesh.
fn check_size(gpu: &Gpu, triangles: &wgpu::Buffer, face_count: u32) -> Result<(), GpuError> {
    let what = "triangles";
    let (bytes, needed) = (triangles.size(), 12 * u64::from(face_count));
    if bytes < needed {
        return Err(GpuError::TooSmall { what, bytes, needed });
    }
    let limit = 12 * MAX_TRIANGLES as u64;
    if needed > limit {
        let remedy = "split the mesh";
        return Err(GpuError::TooLarge { what, bytes: needed, limit, remedy });
    }
    gpu.checked_size::<u8>(what, usize::try_from(bytes).unwrap_or(usize::MAX))?;
    Ok(())
}

pub(super) fn shader() -> Shader {
    Shader::new("topology", include_str!("../topology.wgsl"))
}
