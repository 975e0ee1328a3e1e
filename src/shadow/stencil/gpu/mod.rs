//! The stencil pass on a graphics device, headless.
//!
//! First the receivers' depth, two-sided. Then the volumes, which write no depth: one draw for both of their
//! sides, z-fail (Bilodeau and Songy 1999; John Carmack, 2000; Cass Everitt and Mark J. Kilgard, *Practical
//! and Robust Stenciled Shadow Volumes for Hardware-Accelerated Rendering*, 2002) or z-pass (Tim Heidmann,
//! *Real Shadows, Real Time*, 1991) as the caller says. A caster's faces are never in front of the visible
//! surface, so its caps are drawn with a depth test that always fails: no bias and no polygon offset
//! anywhere.

mod frame;
mod masked;
mod pipelines;
mod zpass_plus;

use std::sync::Arc;

use frame::Scissored;
pub use frame::StencilFrame;
pub use masked::MaskedPass;
use pipelines::Pipelines;
pub use zpass_plus::ZPassPlusPass;

use super::{Counting, ReceiverTiles, ShadowMask};
use crate::caster::GpuCaster;
use crate::gpu::raster::{Depth, Frame, GpuSamples, GpuVisibility, Target, everywhere};
use crate::gpu::{Gpu, GpuError, wgpu};
use crate::shadow::volume::{GpuVolume, Part};
use crate::view::{Projection, Size};

/// A volume, and how it is counted.
#[derive(Clone, Copy, Debug)]
pub struct Draw<'a> {
    /// The volume; with caps for z-fail.
    pub volume: &'a GpuVolume,
    /// How it is counted.
    pub method: super::StencilMethod,
}

/// The compiled pass, for one device. Compiling takes about 50 ms.
#[derive(Clone, Debug)]
pub struct StencilPass {
    gpu: Gpu,
    depth: Depth,
    pipelines: Pipelines,
    within: Option<Arc<ReceiverTiles>>,
}

impl StencilPass {
    /// Compiles the shaders.
    ///
    /// # Errors
    ///
    /// [`GpuError::Lost`], [`GpuError::OutOfMemory`].
    pub fn new(gpu: &Gpu, depth: Depth) -> Result<Self, GpuError> {
        Ok(Self { gpu: gpu.clone(), depth, pipelines: Pipelines::new(gpu, depth)?, within: None })
    }

    /// The same pass for a view whose visible points are known: [`StencilPass::mask`] and
    /// [`StencilPass::visibility`] draw each piece of a volume only where it may count. This concerns volumes
    /// that were [uploaded in pieces](super::StencilVolumes::upload_in_pieces); others are drawn whole. The
    /// counts of what is seen are the same; those of the sky have no meaning.
    ///
    /// Both panic if the picture is not as large as the one whose visible points these are.
    ///
    /// ```
    /// # use umbrage::caster::{Caster, CasterGroup, GpuCaster};
    /// # use umbrage::gpu::{Gpu, GpuError};
    /// # use umbrage::shadow::stencil::{ReceiverTiles, StencilPass};
    /// # use umbrage::shadow::{Depth, Samples};
    /// # use umbrage::{testing::shapes, view::{Camera, Size, Up}};
    /// # let gpu = match Gpu::new(None) { Err(GpuError::NoAdapter) => return Ok(()), gpu => gpu? };
    /// # let (size, light) = (Size::new(64, 48)?, "point:3,9,5".parse()?);
    /// # let caster = Caster::new(shapes::torus(24, 12, 2.0, 0.7));
    /// # let camera = Camera::look_at([6.0, 5.0, 7.0], [0.0; 3], 0.8, Up::Y)?;
    /// # let projection = camera.projection(size, 0.1);
    /// # let receivers = GpuCaster::upload(&gpu, &caster)?;
    /// let samples = Samples::of_view(&CasterGroup::new(vec![&caster]), &projection, size, 1)?;
    /// let tiles = ReceiverTiles::of(&samples);
    /// let volumes = caster.stencil_volumes(&light, &projection, None, None);
    /// let uploaded = volumes.upload_in_pieces(&gpu, &caster)?;
    /// let pass = StencilPass::new(&gpu, Depth::Plane)?;
    /// let mask = |pass: &StencilPass| {
    ///     pass.mask(&projection, size, &receivers, &uploaded.draws(), volumes.counting())
    /// };
    /// let [with, without] = [mask(&pass.within(tiles))?, mask(&pass)?];
    /// for (x, y) in (0..48).flat_map(|y| (0..64).map(move |x| (x, y))) {
    ///     assert_eq!(with.count(x, y), without.count(x, y));
    /// }
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn within(&self, tiles: ReceiverTiles) -> Self {
        Self { within: Some(Arc::new(tiles)), ..self.clone() }
    }

    /// Counts for each pixel of a picture how many of the `volumes` its visible point is in. All volumes of
    /// one light belong in one call; their counts add up.
    ///
    /// With [`Counting::Stencil`] counts are right modulo 256.
    ///
    /// # Errors
    ///
    /// [`GpuError::Subnormal`] if the receivers are too small to be drawn; [`GpuError::TooLarge`] or
    /// [`GpuError::Picture`] if the picture does not fit the device's limits; [`GpuError::OutOfMemory`];
    /// [`GpuError::Lost`].
    pub fn mask(
        &self,
        projection: &Projection,
        size: Size,
        receivers: &GpuCaster,
        volumes: &[Draw<'_>],
        counting: Counting,
    ) -> Result<ShadowMask, GpuError> {
        let receivers = receivers.receivers()?;
        let target = Target::new(&self.gpu, size)?;
        let frame = self.gpu.uniform(&receivers.frame(projection, size)?)?;
        let bind = self.gpu.bind_group(&self.pipelines.receivers.layout, receivers.bindings(&frame))?;
        let counter = self.counter(&target, projection, volumes, counting)?;
        let depth_back = self.gpu.staging_for(&target.0, 4)?;
        let stencil_back = self.gpu.staging_for(&target.0, 1)?;
        self.gpu.submit(|encoder| {
            let mut pass = target.begin(encoder, &[]);
            self.pipelines.receivers.draw(&mut pass, &bind, &receivers.triangles, receivers.corners);
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

    /// The visibility of every sample: 1 where its visible point is in none of the `volumes` of one light,
    /// otherwise 0. Submits without waiting.
    ///
    /// With [`Counting::Stencil`] a count of 256 passes for 0. The counts go to the stencil of the samples;
    /// with [`Counting::Integer`] they take 4 bytes per sample for a while.
    ///
    /// # Errors
    ///
    /// [`GpuError::TooLarge`] if the counts do not fit the device's limits, [`GpuError::OutOfMemory`],
    /// [`GpuError::Lost`].
    pub fn visibility(
        &self,
        samples: &GpuSamples,
        volumes: &[Draw<'_>],
        counting: Counting,
    ) -> Result<GpuVisibility, GpuError> {
        let (target, pipelines) = (&samples.target, &self.pipelines);
        let visibility = GpuVisibility::hard(&self.gpu, samples.size())?;
        let counter = self.counter(target, &samples.projection, volumes, counting)?;
        let bind = match &counter.counts {
            None => None,
            Some(counts) => {
                let layout = pipelines.lit_by_count.get_bind_group_layout(0);
                let resources = [(0, samples.uniform.as_entire_binding()), (5, counts.as_entire_binding())];
                Some(self.gpu.bind_group(&layout, resources)?)
            }
        };
        let pipeline = if bind.is_some() { &pipelines.lit_by_count } else { &pipelines.lit };
        self.gpu.submit(|encoder| {
            self.count(encoder, target, &counter);
            let pass = target.begin_read_only(encoder, &[Some(visibility.0.attachment(true))]);
            everywhere(pass, pipeline, bind.as_ref());
        })?;
        Ok(visibility)
    }

    /// The signed sum of all triangles of the volumes at each pixel, in front of the visible point or behind
    /// it, modulo 256: 0 everywhere if the volumes are closed and the eye is in none of them. A test of what
    /// the rasterizer makes of them.
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
            .map(|(volume, _)| self.bind_volume(&self.volume_frame(projection, size, volume)?, volume))
            .collect::<Result<_, _>>()?;
        let back = self.gpu.staging_for(&target.0, 1)?;
        self.gpu.submit(|encoder| {
            let mut pass = target.begin(encoder, &[]);
            for ((volume, parts), bind) in volumes.iter().zip(&bindings) {
                pass.set_bind_group(0, bind, &[]);
                parts
                    .iter()
                    .for_each(|&part| frame::draw_part(&mut pass, &self.pipelines.caps, volume, part));
            }
            drop(pass);
            target.0.copy(encoder, wgpu::TextureAspect::StencilOnly, 1, &back);
        })?;
        self.gpu.mapped(&back, |bytes| target.0.rows(bytes, 1, |b| b[0]))
    }

    /// Prepares to count the volumes of one light.
    fn counter<'a>(
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
            let frame = self.volume_frame(projection, target.0.size, draw.volume)?;
            match &counts {
                None => self.bind_volume(&frame, draw.volume),
                Some(counts) => {
                    let more =
                        [(4, wgpu::BindingResource::TextureView(&depth)), (5, counts.as_entire_binding())];
                    let resources = volume_bindings(&frame, draw.volume).into_iter().chain(more);
                    self.gpu.bind_group(&self.pipelines.counting_layout, resources)
                }
            }
        };
        let bindings = volumes.iter().map(bind).collect::<Result<_, _>>()?;
        let scissored = volumes.iter().map(|draw| self.scissored(draw, target.0.size)).collect();
        Ok(Counter { volumes, bindings, scissored, counts })
    }

    /// The pieces of a volume with the rectangles that they are drawn in; `None` to draw it whole. Pieces of
    /// the same rectangles go together.
    fn scissored(&self, draw: &Draw<'_>, size: Size) -> Option<Vec<Scissored>> {
        let tiles = self.within.as_ref().filter(|_| !draw.volume.pieces().is_empty())?;
        assert_eq!(tiles.size(), [size.width(), size.height()], "visible points of another view");
        let mut found: Vec<Scissored> = Vec::new();
        for piece in draw.volume.pieces() {
            let triangles = piece.corners.iter().map(|corners| corners.len() / 3).sum();
            let rectangles = tiles.rectangles(draw.volume.light(), &piece.bounds, triangles);
            if rectangles.is_empty() {
                continue;
            }
            match found.iter_mut().find(|found| found.rectangles == rectangles) {
                Some(found) => found.corners.push(piece.corners.clone()),
                None => found.push(Scissored { corners: vec![piece.corners.clone()], rectangles }),
            }
        }
        Some(found)
    }

    /// Counts in the stencil, which is cleared to 0 first, or in the counter's buffer. The depth is drawn
    /// already.
    fn count(&self, encoder: &mut wgpu::CommandEncoder, target: &Target, counter: &Counter<'_>) {
        let pipelines = &self.pipelines;
        let (mut pass, chosen) = match counter.counts {
            None => (target.begin_counting(encoder), pipelines.stencil()),
            Some(_) => (target.begin_read_only(encoder, &[]), pipelines.integer()),
        };
        for ((draw, bind), scissored) in counter.volumes.iter().zip(&counter.bindings).zip(&counter.scissored)
        {
            match scissored {
                None => frame::draw_volume(&mut pass, draw.method, bind, draw.volume, chosen),
                Some(scissored) => {
                    pass.set_bind_group(0, bind, &[]);
                    frame::draw_within(&mut pass, draw, scissored, chosen, target.0.size);
                }
            }
        }
    }

    /// The device that the pass was compiled for.
    #[must_use]
    pub fn gpu(&self) -> &Gpu {
        &self.gpu
    }

    /// Where the depth of the fragments comes from.
    #[must_use]
    pub fn depth(&self) -> Depth {
        self.depth
    }

    /// The camera and light of a volume.
    fn volume_frame(
        &self,
        projection: &Projection,
        size: Size,
        volume: &GpuVolume,
    ) -> Result<wgpu::Buffer, GpuError> {
        let frame = Frame::new(projection, size, volume.largest())?;
        self.gpu.uniform(&frame.with_light(volume.light(), volume.largest(), volume.vertex_count()))
    }

    fn bind_volume(&self, frame: &wgpu::Buffer, volume: &GpuVolume) -> Result<wgpu::BindGroup, GpuError> {
        self.gpu.bind_group(&self.pipelines.receivers.layout, volume_bindings(frame, volume))
    }
}

/// What bindings 0 to 3 of raster.wgsl hold. A volume has no normals: the vertices take their place.
fn volume_bindings<'a>(
    frame: &'a wgpu::Buffer,
    volume: &'a GpuVolume,
) -> [(u32, wgpu::BindingResource<'a>); 4] {
    let buffers = [frame, volume.vertices(), volume.triangles(), volume.vertices()];
    let [frame, vertices, triangles, planes] = buffers.map(wgpu::Buffer::as_entire_binding);
    [(0, frame), (1, vertices), (2, triangles), (3, planes)]
}

/// The volumes of one light, ready to be counted.
struct Counter<'a> {
    volumes: &'a [Draw<'a>],
    bindings: Vec<wgpu::BindGroup>,
    /// Per volume: where its pieces are drawn; `None` if it is drawn whole.
    scissored: Vec<Option<Vec<Scissored>>>,
    /// One `i32` per pixel, where the stencil does not count.
    counts: Option<wgpu::Buffer>,
}

#[cfg(test)]
mod tests {
    use super::pipelines::Behind;
    use super::*;
    use crate::caster::Caster;
    use crate::gpu::tests::limited_gpu;
    use crate::mesh::Mesh;
    use crate::shadow::stencil::StencilMethod;
    use crate::testing::shapes;
    use crate::view::{Camera, ProjectionKind, Up};

    /// Byte for byte. The light cap is as deep as what is seen: with a strict test it is lost.
    #[test]
    fn zpass_reversed_on_a_device_equals_zfail_and_a_strict_test_does_not() {
        use wgpu::CompareFunction::{Always, Less, LessEqual};
        let Some(gpu) = limited_gpu(|_| {}) else { return };
        let floor = shapes::cuboid([-6.0, -2.0, -6.0], [6.0, -1.0, 6.0]);
        for solid in [shapes::torus(24, 12, 1.5, 0.5), shapes::open_cube()] {
            let caster = Caster::new(Mesh::concat(&[solid, floor.clone()]).unwrap());
            let receivers = GpuCaster::upload(&gpu, &caster).unwrap();
            let size = Size::new(64, 48).unwrap();
            let camera = Camera::look_at([3.0, 4.0, 5.0], [0.0; 3], 1.0, Up::Y).unwrap();
            let projection = camera.projection(size, 0.1);
            for light in ["point:1,6,2", "directional:0.3,-1,0.2"] {
                let light = light.parse().unwrap();
                let volume =
                    GpuVolume::upload(&gpu, &caster.volume(&light, crate::shadow::volume::Caps::Both));
                let volume = volume.unwrap();
                let draw = [Draw { volume: &volume, method: StencilMethod::ZFail }];
                let counts = |behind| {
                    let pipelines = Pipelines::behind_by(&gpu, Depth::Plane, behind).unwrap();
                    let pass = StencilPass { gpu: gpu.clone(), depth: Depth::Plane, pipelines, within: None };
                    let mask = pass.mask(&projection, size, &receivers, &draw, Counting::Stencil).unwrap();
                    mask.raw().to_vec()
                };
                let zfail = counts(Behind::Fails);
                assert!(zfail.iter().filter(|&&count| count != 0).count() > 50);
                assert_eq!(counts(Behind::Passes { sides: LessEqual, caps: Always }), zfail);
                assert_ne!(counts(Behind::Passes { sides: Less, caps: Less }), zfail);
            }
        }
    }

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
        let receivers = GpuCaster::upload(&gpu, &Caster::new(mesh)).unwrap();
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
