//! Textures that are drawn into, and read back row by row.

use super::{Gpu, GpuError};
use crate::view::Size;

/// A texture to draw into and to read in shaders.
#[derive(Clone, Debug)]
pub(crate) struct Texture {
    pub(crate) texture: wgpu::Texture,
    pub(crate) view: wgpu::TextureView,
    pub(crate) size: Size,
}

impl Gpu {
    /// A texture of `size`, zero until it is drawn into.
    pub(crate) fn texture(
        &self,
        what: &'static str,
        size: Size,
        format: wgpu::TextureFormat,
    ) -> Result<Texture, GpuError> {
        let side = size.width().max(size.height());
        let limit = self.limits.max_texture_dimension_2d;
        if side > limit {
            return Err(GpuError::Picture { side, limit });
        }
        let texture = self.attempt(|| {
            self.device.create_texture(&wgpu::TextureDescriptor {
                label: Some(what),
                size: wgpu::Extent3d { width: size.width(), height: size.height(), depth_or_array_layers: 1 },
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage: wgpu::TextureUsages::RENDER_ATTACHMENT
                    | wgpu::TextureUsages::COPY_SRC
                    | wgpu::TextureUsages::TEXTURE_BINDING,
                view_formats: &[],
            })
        })?;
        let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
        Ok(Texture { texture, view, size })
    }

    /// A buffer for a [`Texture::copy`] that the host can read, for pixels of `pixel` bytes.
    pub(crate) fn staging_for(&self, texture: &Texture, pixel: u32) -> Result<wgpu::Buffer, GpuError> {
        let bytes = texture.row_bytes(pixel) * u64::from(texture.size.height());
        let limit = self.limits.max_buffer_size;
        if bytes > limit {
            let remedy = "use a smaller --size";
            return Err(GpuError::TooLarge { what: "pixels of a picture", bytes, limit, remedy });
        }
        self.staging(bytes)
    }
}

impl Texture {
    /// An attachment that is cleared to 0 before the pass, or drawn over.
    pub(crate) fn attachment(&self, clear: bool) -> wgpu::RenderPassColorAttachment<'_> {
        let load = if clear { wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT) } else { wgpu::LoadOp::Load };
        wgpu::RenderPassColorAttachment {
            view: &self.view,
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations { load, store: wgpu::StoreOp::Store },
        }
    }

    /// Begins a pass that has no depth.
    pub(crate) fn begin<'e>(
        &self,
        encoder: &'e mut wgpu::CommandEncoder,
        clear: bool,
    ) -> wgpu::RenderPass<'e> {
        encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            color_attachments: &[Some(self.attachment(clear))],
            ..wgpu::RenderPassDescriptor::default()
        })
    }

    /// Bytes per row in a buffer.
    fn row_bytes(&self, pixel: u32) -> u64 {
        u64::from(self.size.width() * pixel).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT.into())
    }

    /// Copies pixels of `pixel` bytes each to a buffer of [`Gpu::staging_for`].
    pub(crate) fn copy(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        aspect: wgpu::TextureAspect,
        pixel: u32,
        to: &wgpu::Buffer,
    ) {
        let from = wgpu::TexelCopyTextureInfo {
            texture: &self.texture,
            mip_level: 0,
            origin: wgpu::Origin3d::ZERO,
            aspect,
        };
        let layout = wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(self.row_bytes(pixel) as u32), // at most 16 × 2¹⁴
            rows_per_image: None,
        };
        encoder.copy_texture_to_buffer(
            from,
            wgpu::TexelCopyBufferInfo { buffer: to, layout },
            self.texture.size(),
        );
    }

    /// The pixels of a copy, without the padding of its rows.
    pub(crate) fn rows<T>(&self, bytes: &[u8], pixel: usize, read: impl Fn(&[u8]) -> T) -> Vec<T> {
        let row = self.row_bytes(pixel as u32) as usize;
        let width = self.size.width() as usize * pixel;
        bytes.chunks_exact(row).flat_map(|row| row[..width].chunks_exact(pixel).map(&read)).collect()
    }
}
