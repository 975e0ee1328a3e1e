//! Planar shadows on a graphics device.
//!
//! (Mark Kilgard, *Improving Shadows and Reflections via the Stencil Buffer*, 1999.) The samples of the plane
//! are marked in the stencil; the flattened casters are drawn where they are marked, without a depth test,
//! and take the mark away: each sample once, however many casters overlap. Nothing is drawn outside the
//! plane's visible samples, and no depth is compared, so that there is no offset of any kind.

#[cfg(test)]
mod tests;
mod uniform;

use wgpu::{CompareFunction, StencilFaceState, StencilOperation};

use self::uniform::PlaneUniform;
use super::Plane;
use crate::caster::{Caster, GpuCaster};
use crate::geom::Light;
use crate::gpu::raster::{
    self, Frame, GpuSamples, GpuVisibility, Pipeline, Receivers, depth_stencil, everywhere,
};
use crate::gpu::{Gpu, GpuError, Shader, wgpu};
use crate::mesh::{FaceId, Mesh};

pub(super) const SOURCE: &str = include_str!("planar.wgsl");

/// The mark of a sample that the plane receives and nothing covers.
const MARK: u32 = 1;

/// The compiled pass, for one device.
#[derive(Clone, Debug)]
pub struct PlanarPass {
    gpu: Gpu,
    mark: wgpu::RenderPipeline,
    cast: wgpu::RenderPipeline,
    lit: wgpu::RenderPipeline,
}

/// How the flattened casters are drawn.
#[derive(Clone, Copy, Debug)]
struct Rules {
    /// By the device, if it has clip distances.
    clips_by_device: bool,
    /// Where: at marked samples.
    compare: CompareFunction,
    /// What is made of the mark.
    operation: StencilOperation,
}

impl Rules {
    const RIGHT: Self = Self {
        clips_by_device: true,
        compare: CompareFunction::Equal,
        operation: StencilOperation::IncrementClamp,
    };
}

/// The casters of a scene on the device, with the faces that lie in a plane.
#[derive(Clone, Debug)]
pub struct GpuGround {
    plane: Plane,
    casters: Receivers,
    /// Bits of the faces that are seen, and of those that cast.
    seen_bits: wgpu::Buffer,
    caster_bits: wgpu::Buffer,
    bytes: usize,
}

impl GpuGround {
    /// A plane under casters. `seen` has the faces of the samples, `caster` those of `on_device`.
    ///
    /// # Errors
    ///
    /// [`GpuError::Subnormal`] if the casters are too small to be drawn, [`GpuError::TooLarge`],
    /// [`GpuError::OutOfMemory`], [`GpuError::Lost`].
    pub fn new(
        gpu: &Gpu,
        plane: Plane,
        seen: &Caster,
        caster: &Caster,
        on_device: &GpuCaster,
    ) -> Result<Self, GpuError> {
        let [seen, casting] = [seen, caster].map(|it| bits(it.mesh(), &plane));
        let upload = |words: &[u32]| gpu.upload("faces of a plane", words);
        Ok(Self {
            plane,
            casters: on_device.receivers()?,
            seen_bits: upload(&seen)?,
            caster_bits: upload(&casting)?,
            bytes: size_of_val(&*seen) + size_of_val(&*casting),
        })
    }

    /// Memory on the device without the casters', in bytes.
    #[must_use]
    pub fn bytes(&self) -> usize {
        self.bytes
    }
}

/// One bit per face: whether the plane holds it. At least one word.
fn bits(mesh: &Mesh, plane: &Plane) -> Vec<u32> {
    let mut words = vec![0; mesh.face_count().div_ceil(32).max(1)];
    for face in 0..mesh.face_count() {
        let is_on_plane = plane.holds(mesh.corners(FaceId::new(face)));
        words[face / 32] |= u32::from(is_on_plane) << (face % 32);
    }
    words
}

impl PlanarPass {
    /// Compiles the shaders.
    ///
    /// # Errors
    ///
    /// [`GpuError::Lost`], [`GpuError::OutOfMemory`].
    pub fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        Self::with(gpu, Rules::RIGHT)
    }

    fn with(gpu: &Gpu, rules: Rules) -> Result<Self, GpuError> {
        let by_device =
            rules.clips_by_device && gpu.device().features().contains(wgpu::Features::CLIP_DISTANCES);
        let clips = if by_device { include_str!("clipped.wgsl") } else { include_str!("discarded.wgsl") };
        let mut shader = Shader::new("planar shadow", &format!("{}{SOURCE}{clips}", raster::SOURCE));
        if by_device {
            shader = shader.enabling("clip_distances");
        }
        let module = shader.module(gpu)?;
        let stencil = |compare, pass_op| {
            let face = StencilFaceState { compare, pass_op, ..StencilFaceState::IGNORE };
            Some(depth_stencil(false, CompareFunction::Always, face, face))
        };
        let build = |vertex, fragment, targets, depth_stencil| {
            Pipeline { vertex, fragment, targets, depth_stencil, layout: None }.build(gpu, &module)
        };
        let discards = (!by_device).then_some("discard_sides");
        let replace = stencil(CompareFunction::Always, StencilOperation::Replace);
        let marked = stencil(CompareFunction::Equal, StencilOperation::Keep);
        Ok(Self {
            mark: build("everywhere", Some("mark"), &[], replace)?,
            cast: build("caster", discards, &[], stencil(rules.compare, rules.operation))?,
            lit: build("everywhere", Some("lit"), &[Some(GpuVisibility::HARD.into())], marked)?,
            gpu: gpu.clone(),
        })
    }

    /// The visibility of the samples on the plane: 1 where no caster is between them and the light, otherwise
    /// 0. All other samples are 0: they are not this technique's. Submits without waiting.
    ///
    /// With the light in the plane all is 1: such samples turn from it.
    ///
    /// # Errors
    ///
    /// [`GpuError::Picture`] if the samples do not fit the device's limits, [`GpuError::OutOfMemory`],
    /// [`GpuError::Lost`], [`GpuError::NotBuilt`] for a camera that is drawn on the CPU alone.
    pub fn visibility(
        &self,
        samples: &GpuSamples,
        ground: &GpuGround,
        light: &Light,
    ) -> Result<GpuVisibility, GpuError> {
        let visibility = GpuVisibility::hard(&self.gpu, samples.size())?;
        let casters = &ground.casters;
        let frame = casters.frame(&samples.projection, samples.size())?;
        let casting = match ground.plane.towards(light) {
            Some(plane) => Some(self.bind_casters(ground, &frame, &plane, light)?),
            None => None,
        };
        let faces = wgpu::BindingResource::TextureView(&samples.faces.view);
        let seen = [(7, ground.seen_bits.as_entire_binding()), (8, faces)];
        let marking = self.gpu.bind_group(&self.mark.get_bind_group_layout(0), seen)?;
        self.gpu.submit(|encoder| {
            let mut pass = samples.target.begin_counting(encoder);
            pass.set_stencil_reference(MARK);
            pass.set_pipeline(&self.mark);
            pass.set_bind_group(0, &marking, &[]);
            pass.draw(0..3, 0..1);
            if let Some(casting) = &casting {
                pass.set_pipeline(&self.cast);
                pass.set_bind_group(0, casting, &[]);
                pass.draw(0..casters.corners, 0..1);
            }
            drop(pass);
            let mut pass = samples.target.begin_read_only(encoder, &[Some(visibility.0.attachment(true))]);
            pass.set_stencil_reference(MARK);
            everywhere(pass, &self.lit, None);
        })?;
        Ok(visibility)
    }

    fn bind_casters(
        &self,
        ground: &GpuGround,
        frame: &Frame,
        plane: &Plane,
        light: &Light,
    ) -> Result<wgpu::BindGroup, GpuError> {
        let casters = &ground.casters;
        let plane = self.gpu.uniform(&PlaneUniform::new(plane, light, frame.scale))?;
        let frame = self.gpu.uniform(frame)?;
        let resources = [
            (0, frame.as_entire_binding()),
            (1, casters.vertices.as_entire_binding()),
            (2, casters.triangles.as_entire_binding()),
            (6, plane.as_entire_binding()),
            (7, ground.caster_bits.as_entire_binding()),
        ];
        self.gpu.bind_group(&self.cast.get_bind_group_layout(0), resources)
    }
}
