//! A shadow volume in buffers of a graphics device, ready to draw.

mod extrude;

use wgpu::BufferUsages;

pub use extrude::{Demand, GpuExtrusion, VolumeShaders};

use std::ops::Range;
use std::sync::Arc;

use super::closed::{BoundarySum, boundary_sum};
use super::{ShadowVolume, VolumePieces};
use crate::geom::{Aabb, Light};
use crate::gpu::{Gpu, GpuError, wgpu};

/// A shadow volume on the device, as [the buffers](crate::gpu#buffers) describes.
///
/// Draw a part without vertex buffer, with [`GpuVolume::arguments`] at [`Part::offset`]: by
/// `draw_indexed_indirect` with the triangles as index buffer, so that `vertex_index` is the vertex id, or by
/// `draw_indirect`, looking the id up.
#[derive(Clone, Debug)]
pub struct GpuVolume {
    vertices: wgpu::Buffer,
    vertex_count: u32,
    triangles: wgpu::Buffer,
    arguments: wgpu::Buffer,
    light: Light,
    largest: f32,
    pieces: Arc<[GpuPiece]>,
}

/// A connected piece of a volume on the device.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::shadow) struct GpuPiece {
    /// The box around its casting faces.
    pub(in crate::shadow) bounds: Aabb,
    /// Its corners among the triangles, for each part.
    pub(in crate::shadow) corners: [Range<u32>; 3],
}

/// A part of a volume.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Part {
    /// The casting faces, as the light sees them.
    LightCap,
    /// The quads that are extruded from the silhouette edges.
    Sides,
    /// The light cap at infinity, reversed.
    DarkCap,
}

impl Part {
    /// All parts, in the order of the arguments.
    pub const ALL: [Self; 3] = [Self::LightCap, Self::Sides, Self::DarkCap];

    /// The offset of this part's arguments in [`GpuVolume::arguments`], in bytes.
    #[must_use]
    pub fn offset(self) -> u64 {
        20 * self as u64
    }
}

impl GpuVolume {
    /// Copies a volume to the device.
    ///
    /// # Errors
    ///
    /// [`GpuError::TooLarge`] if it does not fit the device's limits, [`GpuError::OutOfMemory`].
    pub fn upload(gpu: &Gpu, volume: &ShadowVolume) -> Result<Self, GpuError> {
        Self::upload_ordered(gpu, volume, volume.triangles(), Vec::new())
    }

    /// The same, with the triangles of each part ordered by their piece.
    pub(in crate::shadow) fn upload_in_pieces(
        gpu: &Gpu,
        volume: &ShadowVolume,
        pieces: &VolumePieces,
    ) -> Result<Self, GpuError> {
        let mut order: Vec<usize> = (0..volume.triangles().len()).collect();
        let mut found: Vec<GpuPiece> =
            pieces.boxes.iter().map(|&bounds| GpuPiece { bounds, corners: [(); 3].map(|()| 0..0) }).collect();
        let parts = [volume.light_cap(), volume.sides(), volume.dark_cap()];
        for (part, range) in parts.into_iter().enumerate() {
            let first = range.start;
            order[range.clone()].sort_by_key(|&triangle| pieces.of_triangle[triangle]);
            let runs = order[range].chunk_by(|&a, &b| pieces.of_triangle[a] == pieces.of_triangle[b]);
            let mut start = 3 * first as u32; // corners are counted in 32 bits
            for run in runs {
                let end = start + 3 * run.len() as u32;
                found[pieces.of_triangle[run[0]] as usize].corners[part] = start..end;
                start = end;
            }
        }
        let triangles: Vec<[u32; 3]> = order.into_iter().map(|index| volume.triangles()[index]).collect();
        Self::upload_ordered(gpu, volume, &triangles, found)
    }

    fn upload_ordered(
        gpu: &Gpu,
        volume: &ShadowVolume,
        triangles: &[[u32; 3]],
        pieces: Vec<GpuPiece>,
    ) -> Result<Self, GpuError> {
        let count = volume.positions().len() as u32; // vertex ids are 32 bits
        let id = |index: u32| match index.checked_sub(count) {
            None => index,
            Some(far) => count + volume.extruded[far as usize],
        };
        let triangles: Vec<[u32; 3]> = triangles.iter().map(|corners| corners.map(id)).collect();
        let parts = [volume.light_cap(), volume.sides(), volume.dark_cap()];
        let arguments = parts.map(|part| [3 * part.len() as u32, 1, 3 * part.start as u32, 0, 0]);
        Ok(Self {
            vertices: gpu.upload("vertices of a volume", volume.positions())?,
            vertex_count: count,
            triangles: gpu.upload_for("triangles of a volume", &triangles, BufferUsages::INDEX)?,
            arguments: gpu.upload_for("draw arguments", &arguments, BufferUsages::INDIRECT)?,
            light: *volume.light(),
            largest: volume.positions().as_flattened().iter().fold(0.0, |most, x| most.max(x.abs())),
            pieces: pieces.into(),
        })
    }

    /// The connected pieces; none if they were not told apart.
    pub(in crate::shadow) fn pieces(&self) -> &[GpuPiece] {
        &self.pieces
    }

    /// Finite vertices: `array<f32>`, three per vertex.
    #[must_use]
    pub fn vertices(&self) -> &wgpu::Buffer {
        &self.vertices
    }

    /// The number of finite vertices.
    #[must_use]
    pub fn vertex_count(&self) -> u32 {
        self.vertex_count
    }

    /// Vertex ids: `array<u32>`, three per triangle. Of usage `INDEX` too.
    #[must_use]
    pub fn triangles(&self) -> &wgpu::Buffer {
        &self.triangles
    }

    /// Draw arguments: five words for each part in the order of [`Part::ALL`].
    #[must_use]
    pub fn arguments(&self) -> &wgpu::Buffer {
        &self.arguments
    }

    /// The light that the volume was extruded from.
    #[must_use]
    pub fn light(&self) -> &Light {
        &self.light
    }

    /// The largest magnitude of a coordinate of the vertices, or more.
    #[must_use]
    pub fn largest(&self) -> f32 {
        self.largest
    }

    /// Reads the triangles of a part back, as vertex ids.
    ///
    /// # Errors
    ///
    /// [`GpuError::Lost`], [`GpuError::OutOfMemory`].
    pub fn download(&self, gpu: &Gpu, part: Part) -> Result<Vec<[u32; 3]>, GpuError> {
        let arguments = gpu.download::<[u32; 5]>(&self.arguments, 3)?;
        let [vertices, _, first, ..] = arguments[part as usize];
        let triangles = gpu.download::<[u32; 3]>(&self.triangles, (first + vertices) as usize / 3)?;
        Ok(triangles[first as usize / 3..].to_vec())
    }

    /// The certificate that the volume on the device is closed: see [`ShadowVolume::boundary_sum`]. Reads all
    /// triangles back.
    ///
    /// # Errors
    ///
    /// [`GpuError::Lost`], [`GpuError::OutOfMemory`].
    pub fn boundary_sum(&self, gpu: &Gpu) -> Result<BoundarySum, GpuError> {
        let mut triangles = Vec::new();
        for part in Part::ALL {
            triangles.extend(self.download(gpu, part)?);
        }
        if self.light.is_directional() {
            let one_far = |id: u32| id.min(self.vertex_count);
            triangles.iter_mut().for_each(|corners| *corners = corners.map(one_far));
        }
        Ok(boundary_sum(&triangles))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::facing::{CasterFaces, classify};
    use crate::gpu::tests::gpu;
    use crate::shadow::volume::Caps;
    use crate::silhouette::Silhouette;
    use crate::testing::shapes;
    use crate::topology::Topology;

    #[test]
    fn volume_comes_back_from_the_device_as_it_went() {
        let Some(gpu) = gpu() else { return };
        let mesh = shapes::menger_sponge(1);
        let topology = Topology::of(&mesh);
        for light in ["point:3,4,5", "directional:-1,-2,-0.5"] {
            let light: Light = light.parse().unwrap();
            let signs = CasterFaces::All.signs(&classify(&mesh, &light));
            let silhouette = Silhouette::extract(&topology, &signs);
            let volume = ShadowVolume::extrude(&mesh, &topology, &light, &signs, &silhouette, Caps::Both);
            let lent = GpuVolume::upload(&gpu, &volume).unwrap();
            let ranges = [volume.light_cap(), volume.sides(), volume.dark_cap()];
            for (part, range) in Part::ALL.into_iter().zip(ranges) {
                let count = lent.vertex_count;
                let id = |id: u32| match id.checked_sub(count) {
                    Some(_) if light.is_directional() => count,
                    _ => id,
                };
                let back = lent.download(&gpu, part).unwrap().into_iter().map(|corners| corners.map(id));
                assert_eq!(back.collect::<Vec<_>>(), volume.triangles()[range].to_vec());
            }
        }
    }
}
