//! The stencil pass on a graphics device, headless.
//!
//! First the receivers' depth, two-sided. Then the volumes, which write no depth: one draw for both of their sides,
//! z-fail (Bilodeau and Songy 1999; John Carmack, 2000; Cass Everitt and Mark J. Kilgard, *Practical and Robust
//! Stenciled Shadow Volumes for Hardware-Accelerated Rendering*, 2002) or z-pass (Tim Heidmann, *Real Shadows, Real
//! Time*, 1991) as the caller says. A caster's faces are never in front of the visible surface, so its caps are
//! drawn so as to fail the depth test whatever they are: no bias and no polygon offset anywhere.

mod frame;
mod pipelines;
mod uniforms;

pub use frame::StencilFrame;
use pipelines::Pipelines;
pub(crate) use pipelines::SOURCE;
pub(crate) use uniforms::Frame;

use super::{Counting, ShadowMask};
use crate::caster::Caster;
use crate::gpu::raster::Target;
use crate::gpu::{Gpu, GpuError, wgpu};
use crate::mesh::FaceId;
use crate::shadow::volume::{GpuVolume, Part};
use crate::view::Size;
use crate::view::{Projection, ProjectionKind};

/// Where the depth of a fragment comes from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Depth {
    /// From the plane of its face or side, in the fragment: off by some units in the last place, even where a side
    /// runs from near the eye to infinity, and never of a place beyond the lines where the side ends, its silhouette
    /// edge and the two on which that edge's ends are extruded: a rasterizer may cover a pixel there. Only the side of
    /// an edge nearly in line with the light has a plane that is itself inexact, by the inverse of the sine of that
    /// angle; it is as thin as the angle is small.
    #[default]
    Plane,
    /// Interpolated from the corners by the rasterizer: fewer instructions, and an error that scales with the
    /// nearest corner's depth, not the pixel's.
    Interpolated,
}

/// The surfaces that shadows fall on, on the device.
#[derive(Clone, Debug)]
pub struct Receivers {
    vertices: wgpu::Buffer,
    triangles: wgpu::Buffer,
    pub(crate) normals: wgpu::Buffer,
    pub(crate) corners: u32,
    /// The largest magnitude of a coordinate.
    largest: f32,
}

impl Receivers {
    /// Copies the faces of a caster, with their unit normals, to the device.
    ///
    /// # Errors
    ///
    /// [`GpuError::TooLarge`] if they do not fit the device's limits, [`GpuError::OutOfMemory`].
    pub fn upload(gpu: &Gpu, caster: &Caster) -> Result<Self, GpuError> {
        // Numbers below 2⁻¹²⁶ may be flushed; of a mesh this large they are its last few bits.
        const SMALLEST: f32 = f32::MIN_POSITIVE * (1 << 24) as f32;
        let mesh = caster.mesh();
        let largest = mesh.largest_coordinate();
        if largest > 0.0 && largest < SMALLEST {
            return Err(GpuError::Subnormal(largest));
        }
        let planes = caster.planes();
        let normals: Vec<[f32; 3]> =
            (0..mesh.face_count()).map(|face| planes.normal(FaceId::new(face))).collect();
        Ok(Self {
            vertices: gpu.upload("vertices of receivers", mesh.positions())?,
            triangles: gpu.upload_for("faces of receivers", mesh.triangles(), wgpu::BufferUsages::INDEX)?,
            normals: gpu.upload("normals of receivers", &normals)?,
            corners: 3 * mesh.face_count() as u32, // a mesh has fewer than 2³² corners
            largest,
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
    depth: Depth,
    pipelines: Pipelines,
}

impl StencilPass {
    /// Compiles the shaders.
    ///
    /// # Errors
    ///
    /// [`GpuError::Lost`], [`GpuError::OutOfMemory`].
    pub fn new(gpu: &Gpu, depth: Depth) -> Result<Self, GpuError> {
        Ok(Self { gpu: gpu.clone(), depth, pipelines: Pipelines::new(gpu, depth == Depth::Plane)? })
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
        let receivers_frame = self.gpu.uniform(&self.frame(projection, size, receivers)?)?;
        let bind = self.bind_receivers(&receivers_frame, receivers)?;
        let counter = self.counter(&target, projection, volumes, counting)?;
        let depth_back = self.gpu.staging_for(&target.0, 4)?;
        let stencil_back = self.gpu.staging_for(&target.0, 1)?;
        self.gpu.submit(|encoder| {
            let mut pass = target.begin(encoder, &[]);
            pass.set_bind_group(0, &bind, &[]);
            self.pipelines.receivers.all(&mut pass, &receivers.triangles, receivers.corners);
            drop(pass);
            self.count(encoder, &target, &counter);
            target.0.copy(encoder, wgpu::TextureAspect::DepthOnly, 4, &depth_back);
            target.0.copy(encoder, wgpu::TextureAspect::StencilOnly, 1, &stencil_back);
        })?;
        let counts = match &counter.counts {
            None => self.gpu.mapped(&stencil_back, |bytes| target.0.rows(bytes, 1, |b| i32::from(b[0])))?,
            Some(counts) => self.gpu.download::<i32>(counts, size.pixels())?,
        };
        let receiver = self.gpu.mapped(&depth_back, |bytes| target.0.rows(bytes, 4, |b| b != [0; 4]))?;
        Ok(ShadowMask::new(size, counting, counts, receiver))
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
        let back = self.gpu.staging_for(&target.0, 1)?;
        self.gpu.submit(|encoder| {
            let mut pass = target.begin(encoder, &[]);
            for ((volume, parts), bind) in volumes.iter().zip(&bindings) {
                pass.set_bind_group(0, bind, &[]);
                let volume = (*volume).into();
                parts.iter().for_each(|part| self.pipelines.caps.part(&mut pass, &volume, *part));
            }
            drop(pass);
            target.0.copy(encoder, wgpu::TextureAspect::StencilOnly, 1, &back);
        })?;
        self.gpu.mapped(&back, |bytes| target.0.rows(bytes, 1, |b| b[0]))
    }

    /// Prepares to count the volumes of one light.
    pub(crate) fn counter<'a>(
        &self,
        target: &Target,
        projection: &Projection,
        volumes: &'a [Draw<'a>],
        counting: Counting,
    ) -> Result<Counter<'a>, GpuError> {
        let counts = match counting {
            Counting::Stencil => None,
            Counting::Integer => {
                let counts = self.gpu.storage::<i32>("counts of pixels", target.0.size.pixels());
                Some(counts.map_err(GpuError::for_a_picture)?)
            }
        };
        let depth = target.depth();
        let bind = |draw: &Draw<'_>| {
            let (bind, frame) = self.bind_volume(projection, target.0.size, draw.volume)?;
            match &counts {
                None => Ok(bind),
                Some(counts) => self.bind_counting(draw.volume, &frame, counts, &depth),
            }
        };
        let bindings = volumes.iter().map(bind).collect::<Result<_, _>>()?;
        Ok(Counter { volumes, bindings, counts })
    }

    /// Counts in the stencil, which is 0 before, or in the counter's buffer. Depth is there already.
    pub(crate) fn count(&self, encoder: &mut wgpu::CommandEncoder, target: &Target, counter: &Counter<'_>) {
        let pipelines = &self.pipelines;
        let (mut pass, chosen) = match counter.counts {
            None => (target.begin_counting(encoder), pipelines.stencil()),
            Some(_) => (target.begin_read_only(encoder, &[]), pipelines.integer()),
        };
        for (draw, bind) in counter.volumes.iter().zip(&counter.bindings) {
            frame::draw_volume(&mut pass, draw.method, bind, &draw.volume.into(), chosen);
        }
    }

    /// The device that it was compiled for.
    #[must_use]
    pub fn gpu(&self) -> &Gpu {
        &self.gpu
    }

    /// Where the depth of its fragments comes from.
    #[must_use]
    pub fn depth(&self) -> Depth {
        self.depth
    }

    /// What group 0 of a pipeline holds that draws receivers: see [`StencilPass::bind_receivers`].
    pub(crate) fn layout(&self) -> &wgpu::BindGroupLayout {
        &self.pipelines.layout
    }

    /// Refuses projections whose depth the shaders do not have.
    pub(crate) fn frame(
        &self,
        projection: &Projection,
        size: Size,
        receivers: &Receivers,
    ) -> Result<Frame, GpuError> {
        drawable(projection)?;
        Ok(Frame::new(projection, size, receivers.largest, None, 0))
    }

    pub(crate) fn bind_receivers(
        &self,
        frame: &wgpu::Buffer,
        receivers: &Receivers,
    ) -> Result<wgpu::BindGroup, GpuError> {
        self.bind([frame, &receivers.vertices, &receivers.triangles, &receivers.normals])
    }

    fn bind_volume(
        &self,
        projection: &Projection,
        size: Size,
        volume: &GpuVolume,
    ) -> Result<(wgpu::BindGroup, wgpu::Buffer), GpuError> {
        drawable(projection)?;
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

fn drawable(projection: &Projection) -> Result<(), GpuError> {
    match projection.kind {
        ProjectionKind::InfinitePerspective => Ok(()),
        ProjectionKind::Perspective { .. } => Err(GpuError::NotBuilt("a far plane")),
        ProjectionKind::Orthographic { .. } => Err(GpuError::NotBuilt("an orthographic camera")),
    }
}

/// The volumes of one light, ready to be counted.
pub(crate) struct Counter<'a> {
    volumes: &'a [Draw<'a>],
    bindings: Vec<wgpu::BindGroup>,
    /// One `i32` a pixel, where the stencil does not count.
    pub(crate) counts: Option<wgpu::Buffer>,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gpu::tests::limited_gpu;
    use crate::testing::shapes;
    use crate::view::{Camera, Up};

    #[test]
    fn stencil_picture_beyond_the_limits_is_refused_with_a_smaller_size_as_the_remedy() {
        let limited = limited_gpu(|limits| {
            limits.max_buffer_size = 1 << 16;
            limits.max_storage_buffer_binding_size = 1 << 13;
            limits.max_texture_dimension_2d = 2048;
        });
        let Some(gpu) = limited else { return };
        let pass = StencilPass::new(&gpu, Depth::Plane).unwrap();
        let mesh = shapes::cube();
        let receivers = Receivers::upload(&gpu, &Caster::new(mesh)).unwrap();
        let camera = Camera::look_at([3.0, 4.0, 5.0], [0.0; 3], 1.0, Up::Y).unwrap();
        let mask = |width, height, counting| {
            let size = Size::new(width, height).unwrap();
            pass.mask(&camera.projection(size, 1.0), size, &receivers, &[], counting)
        };
        assert!(mask(64, 64, Counting::Stencil).is_ok());
        let size = Size::new(64, 64).unwrap();
        let infinite = camera.projection(size, 1.0);
        let ending = Projection { kind: ProjectionKind::Perspective { far: 9.0 }, ..infinite };
        for projection in [ending, camera.orthographic(3.0).unwrap().projection(size, 1.0)] {
            let refused = pass.mask(&projection, size, &receivers, &[], Counting::Stencil);
            assert!(matches!(refused, Err(GpuError::NotBuilt(_))), "{refused:?}");
        }
        for (width, height, counting) in
            [(64, 64, Counting::Integer), (128, 200, Counting::Stencil), (2049, 1, Counting::Stencil)]
        {
            let error = mask(width, height, counting).unwrap_err();
            assert!(matches!(error, GpuError::TooLarge { .. } | GpuError::Picture { .. }), "{error}");
            assert!(error.to_string().contains("use a smaller --size"), "{error}");
        }
    }
}
