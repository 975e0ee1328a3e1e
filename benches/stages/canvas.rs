//! A render target for frames, read back after timing.

use umbrage::gpu::{Gpu, wgpu};
use umbrage::shadow::stencil::StencilFrame;

/// A square render target of depth and stencil.
pub(crate) struct Canvas<'a> {
    gpu: &'a Gpu,
    texture: wgpu::Texture,
    view: wgpu::TextureView,
    back: wgpu::Buffer,
}

impl<'a> Canvas<'a> {
    /// A render target of `side` × `side` pixels. `side` must be a multiple of 256, so that rows of a copy
    /// need no padding.
    pub(crate) fn new(gpu: &'a Gpu, side: u32) -> Self {
        assert_eq!(side % wgpu::COPY_BYTES_PER_ROW_ALIGNMENT, 0, "rows without padding");
        let texture = gpu.device().create_texture(&wgpu::TextureDescriptor {
            label: None,
            size: wgpu::Extent3d { width: side, height: side, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: StencilFrame::FORMAT,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC,
            view_formats: &[],
        });
        let back = gpu.device().create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size: 4 * u64::from(side) * u64::from(side),
            usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
            mapped_at_creation: false,
        });
        let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
        Self { gpu, texture, view, back }
    }

    /// Begins a pass with all depths cleared to infinity and all counts to 0.
    pub(crate) fn begin<'e>(&self, encoder: &'e mut wgpu::CommandEncoder) -> wgpu::RenderPass<'e> {
        let store = wgpu::StoreOp::Store;
        encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: None,
            color_attachments: &[],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &self.view,
                depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(0.0), store }),
                stencil_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(0), store }),
            }),
            timestamp_writes: None,
            occlusion_query_set: None,
            multiview_mask: None,
        })
    }

    /// The stencil count of every pixel, row by row from the top.
    pub(crate) fn stencil(&self) -> Vec<u8> {
        self.read(wgpu::TextureAspect::StencilOnly, 1)
    }

    /// Number of pixels where nothing is seen.
    pub(crate) fn sky(&self) -> usize {
        let depth = self.read(wgpu::TextureAspect::DepthOnly, 4);
        depth.chunks_exact(4).filter(|depth| depth == &[0; 4]).count()
    }

    fn read(&self, aspect: wgpu::TextureAspect, pixel: u32) -> Vec<u8> {
        let (device, side) = (self.gpu.device(), self.texture.width());
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let mut from = self.texture.as_image_copy();
        from.aspect = aspect;
        let layout = wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(side * pixel),
            rows_per_image: None,
        };
        let to = wgpu::TexelCopyBufferInfo { buffer: &self.back, layout };
        encoder.copy_texture_to_buffer(from, to, self.texture.size());
        self.gpu.queue().submit([encoder.finish()]);
        let used = ..u64::from(side) * u64::from(side) * u64::from(pixel);
        self.back.map_async(wgpu::MapMode::Read, used, |mapped| mapped.expect("it can be read"));
        device.poll(wgpu::PollType::wait_indefinitely()).expect("the device is there");
        let bytes = self.back.get_mapped_range(used).expect("it is mapped").to_vec();
        self.back.unmap();
        bytes
    }
}
