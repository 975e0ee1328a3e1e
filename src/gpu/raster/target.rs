//! The depth and stencil that a pass draws into.

use super::pipeline::FORMAT;
use crate::gpu::{Gpu, GpuError, Texture, wgpu};
use crate::view::Size;

/// Depth and stencil of a picture: 8 bytes per pixel.
#[derive(Clone, Debug)]
pub(crate) struct Target(pub(crate) Texture);

const STORE: wgpu::StoreOp = wgpu::StoreOp::Store;

impl Target {
    pub(crate) fn new(gpu: &Gpu, size: Size) -> Result<Self, GpuError> {
        Ok(Self(gpu.texture("depth and stencil", size, FORMAT)?))
    }

    /// Begins a pass cleared to infinitely far and a count of 0.
    pub(crate) fn begin<'e>(
        &self,
        encoder: &'e mut wgpu::CommandEncoder,
        colors: &[Option<wgpu::RenderPassColorAttachment<'_>>],
    ) -> wgpu::RenderPass<'e> {
        let depth = wgpu::Operations { load: wgpu::LoadOp::Clear(0.0), store: STORE };
        let stencil = wgpu::Operations { load: wgpu::LoadOp::Clear(0), store: STORE };
        self.pass(encoder, colors, Some(depth), Some(stencil))
    }

    /// Begins a pass that keeps the depth and clears the counts to 0.
    pub(crate) fn begin_counting<'e>(&self, encoder: &'e mut wgpu::CommandEncoder) -> wgpu::RenderPass<'e> {
        let depth = wgpu::Operations { load: wgpu::LoadOp::Load, store: STORE };
        let stencil = wgpu::Operations { load: wgpu::LoadOp::Clear(0), store: STORE };
        self.pass(encoder, &[], Some(depth), Some(stencil))
    }

    /// Begins a pass that tests depth and stencil and changes neither.
    pub(crate) fn begin_read_only<'e>(
        &self,
        encoder: &'e mut wgpu::CommandEncoder,
        colors: &[Option<wgpu::RenderPassColorAttachment<'_>>],
    ) -> wgpu::RenderPass<'e> {
        self.pass(encoder, colors, None, None)
    }

    fn pass<'e>(
        &self,
        encoder: &'e mut wgpu::CommandEncoder,
        color_attachments: &[Option<wgpu::RenderPassColorAttachment<'_>>],
        depth_ops: Option<wgpu::Operations<f32>>,
        stencil_ops: Option<wgpu::Operations<u32>>,
    ) -> wgpu::RenderPass<'e> {
        encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: None,
            color_attachments,
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &self.0.view,
                depth_ops,
                stencil_ops,
            }),
            timestamp_writes: None,
            occlusion_query_set: None,
            multiview_mask: None,
        })
    }

    /// The depth alone, for shaders that read it.
    pub(crate) fn depth(&self) -> wgpu::TextureView {
        self.0.texture.create_view(&wgpu::TextureViewDescriptor {
            aspect: wgpu::TextureAspect::DepthOnly,
            ..Default::default()
        })
    }
}
