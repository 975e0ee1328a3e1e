//! The stencil pass on a graphics device, headless.
//!
//! First the receivers' depth, two-sided. Then the volumes, which write no depth: one draw for both of their sides,
//! z-fail (Bilodeau and Songy 1999; John Carmack, 2000; Cass Everitt and Mark J. Kilgard, *Practical and Robust
//! Stenciled Shadow Volumes for Hardware-Accelerated Rendering*, 2002) or z-pass (Tim Heidmann, *Real Shadows, Real
//! Time*, 1991) as the caller says. A caster's faces are never in front of the visible surface, so its caps are
//! drawn so as to fail the depth test whatever they are: no bias and no polygon offset anywhere.

mod frame;
mod pipeline;

use frame::Frame;
use pipeline::{FORMAT, Pipelines};

use super::{Counting, ShadowMask};
use crate::geom::Projection;
use crate::gpu::{Gpu, GpuError, wgpu};
use crate::mesh::{FaceId, Mesh};
use crate::scene::Size;
use crate::silhouette::FacePlanes;
use crate::volume::{GpuVolume, Part};

/// Where the depth of a fragment comes from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Depth {
    /// From the plane of its face or side, in the fragment: off by some units in the last place, even where a side
    /// runs from near the eye to infinity.
    #[default]
    Plane,
    /// Interpolated from the corners by the rasteriser: fewer instructions, and an error that scales with the
    /// nearest corner's depth, not the pixel's.
    Interpolated,
}

/// The surfaces that shadows fall on, on the device.
#[derive(Clone, Debug)]
pub struct Receivers {
    vertices: wgpu::Buffer,
    triangles: wgpu::Buffer,
    normals: wgpu::Buffer,
    corners: u32,
    /// The largest magnitude of a coordinate.
    largest: f32,
}

impl Receivers {
    /// Copies the faces of a mesh, with their unit normals, to the device.
    ///
    /// # Errors
    ///
    /// [`GpuError::TooLarge`] if they do not fit the device's limits, [`GpuError::OutOfMemory`].
    pub fn upload(gpu: &Gpu, mesh: &Mesh) -> Result<Self, GpuError> {
        let planes = FacePlanes::new(mesh);
        let normals: Vec<[f32; 3]> =
            (0..mesh.face_count()).map(|face| planes.normal(FaceId::new(face))).collect();
        let coordinates = mesh.positions().as_flattened().iter();
        Ok(Self {
            vertices: gpu.upload("vertices of receivers", mesh.positions())?,
            triangles: gpu.upload("faces of receivers", mesh.triangles())?,
            normals: gpu.upload("normals of receivers", &normals)?,
            corners: 3 * mesh.face_count() as u32, // a mesh has fewer than 2³² corners
            largest: coordinates.fold(0.0, |most, x| most.max(x.abs())),
        })
    }
}

/// A volume, and how it is counted.
#[derive(Clone, Copy, Debug)]
pub struct Draw<'a> {
    /// The volume; with caps for z-fail.
    pub volume: &'a GpuVolume,
    /// How it is counted.
    pub method: super::StencilMethod,
}

/// The compiled pass. Made once for a device; about 50 ms.
#[derive(Clone, Debug)]
pub struct StencilPass {
    gpu: Gpu,
    pipelines: Pipelines,
}

impl StencilPass {
    /// Compiles the shaders.
    ///
    /// # Errors
    ///
    /// [`GpuError::Lost`], [`GpuError::OutOfMemory`].
    pub fn new(gpu: &Gpu, depth: Depth) -> Result<Self, GpuError> {
        Ok(Self { gpu: gpu.clone(), pipelines: Pipelines::new(gpu, depth == Depth::Plane)? })
    }

    /// Counts for each pixel of a picture how many of the `volumes` its visible point is in. All volumes of one light
    /// belong in one call; their counts add up.
    ///
    /// With [`Counting::Stencil`] counts are right modulo 256.
    ///
    /// # Errors
    ///
    /// [`GpuError::TooLarge`] if the picture does not fit the device's limits, [`GpuError::OutOfMemory`],
    /// [`GpuError::Lost`].
    pub fn mask(
        &self,
        projection: &Projection,
        size: Size,
        receivers: &Receivers,
        volumes: &[Draw<'_>],
        counting: Counting,
    ) -> Result<ShadowMask, GpuError> {
        let target = Target::new(&self.gpu, size)?;
        target.require_memory(&self.gpu, counting)?;
        let bindings = self.bindings(projection, size, receivers, volumes)?;
        let depth_back = self.gpu.staging(target.row_bytes(4) * u64::from(size.height()))?;
        match counting {
            Counting::Stencil => {
                let stencil_back = self.gpu.staging(target.row_bytes(1) * u64::from(size.height()))?;
                self.gpu.submit(|encoder| {
                    let mut pass = target.begin(encoder);
                    self.draw_receivers(&mut pass, receivers, &bindings.receivers);
                    for (draw, bind) in volumes.iter().zip(&bindings.volumes) {
                        self.draw_volume(&mut pass, draw, bind);
                    }
                    drop(pass);
                    target.copy(encoder, wgpu::TextureAspect::DepthOnly, 4, &depth_back);
                    target.copy(encoder, wgpu::TextureAspect::StencilOnly, 1, &stencil_back);
                })?;
                let counts =
                    self.gpu.mapped(&stencil_back, |bytes| target.rows(bytes, 1, |b| i32::from(b[0])))?;
                self.finish(&target, counting, counts, &depth_back)
            }
            Counting::Integer => {
                let counts = self.gpu.storage::<i32>("counts of pixels", size.pixels())?;
                let depth = target.texture.create_view(&wgpu::TextureViewDescriptor {
                    aspect: wgpu::TextureAspect::DepthOnly,
                    ..Default::default()
                });
                let counted: Vec<_> = volumes
                    .iter()
                    .zip(&bindings.frames)
                    .map(|(draw, frame)| self.bind_counting(draw.volume, frame, &counts, &depth))
                    .collect::<Result<_, _>>()?;
                self.gpu.submit(|encoder| {
                    let mut pass = target.begin(encoder);
                    self.draw_receivers(&mut pass, receivers, &bindings.receivers);
                    drop(pass);
                    let mut pass = target.begin_read_only(encoder);
                    for (draw, bind) in volumes.iter().zip(&counted) {
                        self.count_volume(&mut pass, draw, bind);
                    }
                    drop(pass);
                    target.copy(encoder, wgpu::TextureAspect::DepthOnly, 4, &depth_back);
                })?;
                let counts = self.gpu.download::<i32>(&counts, size.pixels())?;
                self.finish(&target, counting, counts, &depth_back)
            }
        }
    }

    /// What all triangles of the volumes add up to in each pixel, in front or behind, drawn so as to fail the depth
    /// test: 0 everywhere if they are closed and the eye is in none of them. Modulo 256.
    ///
    /// # Errors
    ///
    /// As [`StencilPass::mask`].
    pub fn signed_sum(
        &self,
        projection: &Projection,
        size: Size,
        volumes: &[(&GpuVolume, &[Part])],
    ) -> Result<Vec<u8>, GpuError> {
        let target = Target::new(&self.gpu, size)?;
        let bindings: Vec<_> = volumes
            .iter()
            .map(|(volume, _)| self.bind_volume(projection, size, volume).map(|(bind, _)| bind))
            .collect::<Result<_, _>>()?;
        let back = self.gpu.staging(target.row_bytes(1) * u64::from(size.height()))?;
        self.gpu.submit(|encoder| {
            let mut pass = target.begin(encoder);
            pass.set_pipeline(&self.pipelines.caps);
            for ((volume, parts), bind) in volumes.iter().zip(&bindings) {
                pass.set_bind_group(0, bind, &[]);
                parts.iter().for_each(|part| pass.draw_indirect(&volume.arguments, part.offset()));
            }
            drop(pass);
            target.copy(encoder, wgpu::TextureAspect::StencilOnly, 1, &back);
        })?;
        self.gpu.mapped(&back, |bytes| target.rows(bytes, 1, |b| b[0]))
    }

    fn finish(
        &self,
        target: &Target,
        counting: Counting,
        counts: Vec<i32>,
        depth: &wgpu::Buffer,
    ) -> Result<ShadowMask, GpuError> {
        let receiver = self.gpu.mapped(depth, |bytes| target.rows(bytes, 4, |b| b != [0; 4]))?;
        Ok(ShadowMask::new(target.size, counting, counts, receiver))
    }

    fn draw_receivers(&self, pass: &mut wgpu::RenderPass<'_>, receivers: &Receivers, bind: &wgpu::BindGroup) {
        pass.set_pipeline(&self.pipelines.receivers);
        pass.set_bind_group(0, bind, &[]);
        pass.draw(0..receivers.corners, 0..1);
    }

    fn draw_volume(&self, pass: &mut wgpu::RenderPass<'_>, draw: &Draw<'_>, bind: &wgpu::BindGroup) {
        let arguments = &draw.volume.arguments;
        pass.set_bind_group(0, bind, &[]);
        match draw.method {
            super::StencilMethod::ZPass => {
                pass.set_pipeline(&self.pipelines.zpass_sides);
                pass.draw_indirect(arguments, Part::Sides.offset());
            }
            super::StencilMethod::ZFail => {
                pass.set_pipeline(&self.pipelines.zfail_sides);
                pass.draw_indirect(arguments, Part::Sides.offset());
                pass.set_pipeline(&self.pipelines.caps);
                pass.draw_indirect(arguments, Part::LightCap.offset());
                pass.draw_indirect(arguments, Part::DarkCap.offset());
            }
        }
    }

    fn count_volume(&self, pass: &mut wgpu::RenderPass<'_>, draw: &Draw<'_>, bind: &wgpu::BindGroup) {
        let arguments = &draw.volume.arguments;
        pass.set_bind_group(0, bind, &[]);
        match draw.method {
            super::StencilMethod::ZPass => {
                pass.set_pipeline(&self.pipelines.count_before);
                pass.draw_indirect(arguments, Part::Sides.offset());
            }
            super::StencilMethod::ZFail => {
                pass.set_pipeline(&self.pipelines.count_behind);
                pass.draw_indirect(arguments, Part::Sides.offset());
                pass.set_pipeline(&self.pipelines.count_all);
                pass.draw_indirect(arguments, Part::LightCap.offset());
                pass.draw_indirect(arguments, Part::DarkCap.offset());
            }
        }
    }

    fn bindings(
        &self,
        projection: &Projection,
        size: Size,
        receivers: &Receivers,
        volumes: &[Draw<'_>],
    ) -> Result<Bindings, GpuError> {
        let frame = self.gpu.uniform(&Frame::new(projection, size, receivers.largest, None, 0))?;
        let buffers = [&frame, &receivers.vertices, &receivers.triangles, &receivers.normals];
        let receivers = self.bind(buffers)?;
        let bound = volumes.iter().map(|draw| self.bind_volume(projection, size, draw.volume));
        let (volumes, frames) = bound.collect::<Result<Vec<_>, _>>()?.into_iter().unzip();
        Ok(Bindings { receivers, volumes, frames })
    }

    fn bind_volume(
        &self,
        projection: &Projection,
        size: Size,
        volume: &GpuVolume,
    ) -> Result<(wgpu::BindGroup, wgpu::Buffer), GpuError> {
        let frame = Frame::new(projection, size, volume.largest, Some(&volume.light), volume.vertex_count);
        let frame = self.gpu.uniform(&frame)?;
        // No normals: the vertices stand in.
        let bind = self.bind([&frame, &volume.vertices, &volume.triangles, &volume.vertices])?;
        Ok((bind, frame))
    }

    fn bind(&self, buffers: [&wgpu::Buffer; 4]) -> Result<wgpu::BindGroup, GpuError> {
        let entries: Vec<_> = (0..)
            .zip(buffers)
            .map(|(binding, buffer)| wgpu::BindGroupEntry { binding, resource: buffer.as_entire_binding() })
            .collect();
        let layout = &self.pipelines.layout;
        self.gpu.attempt(|| {
            let descriptor = wgpu::BindGroupDescriptor { label: None, layout, entries: &entries };
            self.gpu.device().create_bind_group(&descriptor)
        })
    }

    fn bind_counting(
        &self,
        volume: &GpuVolume,
        frame: &wgpu::Buffer,
        counts: &wgpu::Buffer,
        depth: &wgpu::TextureView,
    ) -> Result<wgpu::BindGroup, GpuError> {
        let buffers = [frame, &volume.vertices, &volume.triangles, &volume.vertices, counts];
        let mut entries: Vec<_> = (0..)
            .zip(buffers)
            .map(|(binding, buffer)| wgpu::BindGroupEntry { binding, resource: buffer.as_entire_binding() })
            .collect();
        entries
            .push(wgpu::BindGroupEntry { binding: 5, resource: wgpu::BindingResource::TextureView(depth) });
        let layout = &self.pipelines.counting_layout;
        self.gpu.attempt(|| {
            let descriptor = wgpu::BindGroupDescriptor { label: None, layout, entries: &entries };
            self.gpu.device().create_bind_group(&descriptor)
        })
    }
}

struct Bindings {
    receivers: wgpu::BindGroup,
    volumes: Vec<wgpu::BindGroup>,
    frames: Vec<wgpu::Buffer>,
}

/// Depth and stencil of a picture.
struct Target {
    texture: wgpu::Texture,
    view: wgpu::TextureView,
    size: Size,
}

impl Target {
    fn new(gpu: &Gpu, size: Size) -> Result<Self, GpuError> {
        let side = size.width().max(size.height());
        let limit = gpu.limits().max_texture_dimension_2d;
        if side > limit {
            return Err(GpuError::Picture { side, limit });
        }
        let texture = gpu.attempt(|| {
            gpu.device().create_texture(&wgpu::TextureDescriptor {
                label: Some("depth and stencil"),
                size: wgpu::Extent3d { width: size.width(), height: size.height(), depth_or_array_layers: 1 },
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format: FORMAT,
                usage: wgpu::TextureUsages::RENDER_ATTACHMENT
                    | wgpu::TextureUsages::COPY_SRC
                    | wgpu::TextureUsages::TEXTURE_BINDING,
                view_formats: &[],
            })
        })?;
        let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
        Ok(Self { texture, view, size })
    }

    /// Refuses a picture whose depths or counts are more than a buffer may hold.
    fn require_memory(&self, gpu: &Gpu, counting: Counting) -> Result<(), GpuError> {
        let (limits, rows) = (gpu.limits(), u64::from(self.size.height()));
        let mut wanted = vec![("the depths of a picture", self.row_bytes(4) * rows, limits.max_buffer_size)];
        if counting == Counting::Integer {
            let limit = limits.max_storage_buffer_binding_size.min(limits.max_buffer_size);
            wanted.push(("the counts of a picture", 4 * self.size.pixels() as u64, limit));
        }
        match wanted.into_iter().find(|(_, bytes, limit)| bytes > limit) {
            None => Ok(()),
            Some((what, bytes, limit)) => {
                Err(GpuError::TooLarge { what, bytes, limit, remedy: "use a smaller --size" })
            }
        }
    }

    /// Begins a pass with everything infinitely far and counted 0.
    fn begin<'e>(&self, encoder: &'e mut wgpu::CommandEncoder) -> wgpu::RenderPass<'e> {
        let store = wgpu::StoreOp::Store;
        self.pass(
            encoder,
            Some(wgpu::Operations { load: wgpu::LoadOp::Clear(0.0), store }),
            Some(wgpu::Operations { load: wgpu::LoadOp::Clear(0), store }),
        )
    }

    /// Begins a pass that can look at the depth, and change nothing.
    fn begin_read_only<'e>(&self, encoder: &'e mut wgpu::CommandEncoder) -> wgpu::RenderPass<'e> {
        self.pass(encoder, None, None)
    }

    fn pass<'e>(
        &self,
        encoder: &'e mut wgpu::CommandEncoder,
        depth_ops: Option<wgpu::Operations<f32>>,
        stencil_ops: Option<wgpu::Operations<u32>>,
    ) -> wgpu::RenderPass<'e> {
        encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: None,
            color_attachments: &[],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &self.view,
                depth_ops,
                stencil_ops,
            }),
            timestamp_writes: None,
            occlusion_query_set: None,
            multiview_mask: None,
        })
    }

    /// How many bytes a row takes in a buffer.
    fn row_bytes(&self, pixel: u32) -> u64 {
        u64::from(self.size.width() * pixel).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT.into())
    }

    fn copy(
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
            bytes_per_row: Some(self.row_bytes(pixel) as u32), // at most 4 × 2¹⁴
            rows_per_image: None,
        };
        encoder.copy_texture_to_buffer(
            from,
            wgpu::TexelCopyBufferInfo { buffer: to, layout },
            self.texture.size(),
        );
    }

    /// The pixels of a copy without what pads its rows.
    fn rows<T>(&self, bytes: &[u8], pixel: usize, read: impl Fn(&[u8]) -> T) -> Vec<T> {
        let row = self.row_bytes(pixel as u32) as usize;
        let width = self.size.width() as usize * pixel;
        bytes.chunks_exact(row).flat_map(|row| row[..width].chunks_exact(pixel).map(&read)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gpu::tests::limited_gpu;
    use crate::mesh::solid;
    use crate::scene::{Camera, Up};

    #[test]
    fn stencil_picture_beyond_the_limits_is_refused_with_a_smaller_size_as_the_remedy() {
        let limited = limited_gpu(|limits| {
            limits.max_buffer_size = 1 << 16;
            limits.max_storage_buffer_binding_size = 1 << 13;
            limits.max_texture_dimension_2d = 2048;
        });
        let Some(gpu) = limited else { return };
        let pass = StencilPass::new(&gpu, Depth::Plane).unwrap();
        let mesh = solid::cube();
        let receivers = Receivers::upload(&gpu, &mesh).unwrap();
        let camera = Camera::look_at([3.0, 4.0, 5.0], [0.0; 3], 1.0, Up::Y).unwrap();
        let mask = |width, height, counting| {
            let size = Size::new(width, height).unwrap();
            pass.mask(&camera.projection(size, 1.0), size, &receivers, &[], counting)
        };
        assert!(mask(64, 64, Counting::Stencil).is_ok());
        for (width, height, counting) in
            [(64, 64, Counting::Integer), (128, 200, Counting::Stencil), (2049, 1, Counting::Stencil)]
        {
            let error = mask(width, height, counting).unwrap_err();
            assert!(matches!(error, GpuError::TooLarge { .. } | GpuError::Picture { .. }), "{error}");
            assert!(error.to_string().ends_with("use a smaller --size"), "{error}");
        }
    }
}
