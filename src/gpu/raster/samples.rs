//! What a camera sees of the receivers.

use wgpu::{CompareFunction, StencilFaceState, TextureFormat};

use super::pipeline::{Pipeline, depth_stencil, layout};
use super::{Depth, Frame, Receivers, SOURCE, Target};
use crate::gpu::{Gpu, GpuError, Shader, Texture, wgpu};
use crate::view::{Projection, Size};

/// The visible point and face of every sample of a picture, on the device: depth and a face id, 12 bytes per
/// sample. Twin of [`Samples`](crate::shadow::Samples).
///
/// Techniques compute a [`GpuVisibility`](super::GpuVisibility) from it for each lamp. Coinciding faces have
/// one visible face.
#[derive(Clone, Debug)]
pub struct GpuSamples {
    pub(crate) gpu: Gpu,
    pub(crate) projection: Projection,
    pub(crate) receivers: Receivers,
    /// The values in `uniform`.
    pub(crate) frame: Frame,
    pub(crate) uniform: wgpu::Buffer,
    pub(crate) target: Target,
    /// The depth in `target`, for shaders.
    pub(crate) depth: wgpu::TextureView,
    /// The visible face and 1; 0 where there is none.
    pub(crate) faces: Texture,
}

const FACES: TextureFormat = TextureFormat::R32Uint;

impl GpuSamples {
    /// Draws receivers as a camera sees them.
    pub(crate) fn draw(
        gpu: &Gpu,
        receivers: Receivers,
        projection: &Projection,
        size: Size,
        depth: Depth,
    ) -> Result<Self, GpuError> {
        let target = Target::new(gpu, size)?;
        let faces = gpu.texture("visible faces", size, FACES)?;
        let frame = receivers.frame(projection, size)?;
        let uniform = gpu.uniform(&frame)?;
        let (layout, keep) = (layout(gpu)?, StencilFaceState::IGNORE);
        let pipeline = Pipeline {
            vertex: "receiver",
            fragment: Some(if depth == Depth::Plane { "face_of_plane" } else { "face" }),
            targets: &[Some(FACES.into())],
            depth_stencil: Some(depth_stencil(true, CompareFunction::Greater, keep, keep)),
            layout: Some(&layout),
        };
        let pipeline = pipeline.build(gpu, &Shader::new("samples", SOURCE).module(gpu)?)?;
        let bind = gpu.bind_group(&layout, receivers.bindings(&uniform))?;
        gpu.submit(|encoder| {
            let mut pass = target.begin(encoder, &[Some(faces.attachment(true))]);
            pass.set_pipeline(&pipeline);
            pass.set_bind_group(0, &bind, &[]);
            pass.draw(0..receivers.corners, 0..1);
        })?;
        let (gpu, projection, depth) = (gpu.clone(), *projection, target.depth());
        Ok(Self { gpu, projection, receivers, frame, uniform, target, depth, faces })
    }

    /// Reads the depth back, row after row from the top: reversed, 0 where nothing is seen.
    pub(crate) fn download_depth(&self) -> Result<Vec<f32>, GpuError> {
        let texture = &self.target.0;
        let back = self.gpu.staging_for(texture, 4)?;
        self.gpu.submit(|encoder| texture.copy(encoder, wgpu::TextureAspect::DepthOnly, 4, &back))?;
        self.gpu.mapped(&back, |bytes| texture.rows(bytes, 4, bytemuck::pod_read_unaligned))
    }

    /// Samples per row and column.
    #[must_use]
    pub fn size(&self) -> Size {
        self.faces.size
    }

    /// The camera.
    #[must_use]
    pub fn projection(&self) -> &Projection {
        &self.projection
    }
}
