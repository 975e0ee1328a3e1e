//! The lit picture by stencil shadows: ambient light everywhere, then lamp by lamp what its volumes leave lit.
//!
//! The shading is that of the exact picture, constant for constant, so that the two can be laid side by side.
//! The receivers' pass keeps which face is seen, so that coinciding faces are not lit twice; everything after it is
//! one triangle over the whole picture.

use bytemuck::{Pod, Zeroable};
use glam::{DVec3, Vec3};
use wgpu::{CompareFunction, StencilFaceState, TextureAspect, TextureFormat};

use super::shade::{AMBIENT, AMBIENT_SLOPE, MOST_FALLOFF, SPECULAR, SPECULAR_SQUARINGS, cosines};
use super::{ABOVE, BELOW, Falloff, GROUND, Picture, ShadedLight, View, buffer, color, ground};
use crate::caster::Caster;
use crate::geom::Facing;
use crate::geom::Light;
use crate::gpu::raster::{Pipeline, Target, depth_stencil};
use crate::gpu::{Gpu, GpuError, Shader, Texture, wgpu};
use crate::mesh::{FaceId, Mesh};
use crate::parallel;
use crate::shadow::stencil::{Counting, Depth, Draw, Receivers, SOURCE, StencilPass};
use crate::view::Projection;
use crate::view::Size;

/// What keeps the light of one lamp away.
#[derive(Clone, Copy, Debug)]
pub struct LampShadow<'a> {
    /// Its volumes.
    pub draws: &'a [Draw<'a>],
    /// How they are counted. A stencil of eight bits is right modulo 256.
    pub counting: Counting,
}

/// Renders `caster` as [`render`](super::render) does, with the shadows that a stencil pass counts.
///
/// `receivers` are the faces of `caster`, `projection` is the view's camera, and each lamp of the view has one of the
/// `shadows`. Every pixel is the mean of `edge_samples`² samples, each counted for itself. What is nearer than the near
/// plane is not seen.
///
/// Compiling the shaders takes some tens of milliseconds. On the device a sample takes 20 bytes, 24 where a lamp is
/// counted in whole numbers, and a pixel 16; there may be 2²⁶ samples.
///
/// # Errors
///
/// [`GpuError::Picture`] or [`GpuError::TooLarge`] if the picture, or a color and a normal for each face, do not fit
/// the device's limits; [`GpuError::OutOfMemory`], of the host too; [`GpuError::Lost`].
///
/// # Panics
///
/// Panics if there is not one shadow a lamp, or `receivers` have another number of faces than `caster`.
pub fn render_stencil(
    pass: &StencilPass,
    caster: &Caster,
    receivers: &Receivers,
    view: &View<'_>,
    projection: &Projection,
    shadows: &[LampShadow<'_>],
) -> Result<Picture, GpuError> {
    let (mesh, planes) = (caster.mesh(), caster.planes());
    assert_eq!(shadows.len(), view.lamps.len(), "one shadow a lamp");
    assert_eq!(receivers.corners as usize, 3 * mesh.face_count(), "the receivers are another mesh");
    let gpu = pass.gpu();
    let stage = Stage::new(pass, mesh, receivers, view, projection)?;
    let eye = Light::point(projection.eye).expect("cameras are finite");
    let from_eye: Vec<i32> = planes.classify(mesh, &eye).into_iter().map(side).collect();
    stage.begin(receivers, &gpu.upload("sides of faces", &from_eye)?)?;
    let mut facing = Vec::new();
    for (lamp, shadow) in view.lamps.iter().zip(shadows) {
        planes.classify_into(mesh, &lamp.light, &mut facing);
        let lit = |(&eye, &lamp): (&i32, &Facing)| if side(lamp) == eye { eye } else { 0 };
        let sides: Vec<i32> = from_eye.iter().zip(&facing).map(lit).collect();
        stage.add(lamp, shadow, &gpu.upload("sides of faces", &sides)?)?;
    }
    stage.finish(view.size)
}

fn side(facing: Facing) -> i32 {
    facing.sign().into()
}

/// Mirrors `struct Scene` in picture.wgsl.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
struct SceneUniform {
    up: [f32; 3],
    first_ground: u32,
    ground_center: [f32; 3],
    diagonals: f32,
    samples: u32,
    padding: [u32; 3],
}

impl SceneUniform {
    fn new(view: &View<'_>, projection: &Projection, scale: f32) -> Self {
        let mut up = [0.0; 3];
        up[view.up.axis()] = 1.0;
        let scale = f64::from(scale);
        let (first_ground, center, diagonals) = match &view.ground {
            None => (u32::MAX, DVec3::ZERO, 0.0),
            Some(ground) => {
                let from_eye = ground.center - wide(projection.eye);
                (ground.first_face.0, from_eye * scale, 1.0 / (ground.diagonal * scale))
            }
        };
        Self {
            up,
            first_ground,
            ground_center: center.as_vec3().into(),
            diagonals: diagonals.min(f32::MAX.into()) as f32,
            samples: view.edge_samples.max(1),
            padding: [0; 3],
        }
    }
}

/// Mirrors `struct Lamp` in picture.wgsl.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
struct LampUniform {
    towards: [f32; 3],
    approach: f32,
    color: [f32; 3],
    outer: f32,
    spot: [f32; 3],
    slope: f32,
    per_full: f32,
    per_range: f32,
    padding: [u32; 2],
}

impl LampUniform {
    fn new(lamp: &ShadedLight, projection: &Projection, scale: f32) -> Self {
        let xyz = wide(lamp.light.xyz());
        let (mut per_full, mut per_range) = (0.0, 0.0);
        let (towards, approach) = if lamp.light.is_directional() {
            (xyz.normalize_or_zero(), 0.0)
        } else {
            // Neither the lamp's distance nor that of the farthest place is more than 1 then.
            let from_eye = xyz - wide(projection.eye);
            let factor = f64::from(scale).min(1.0 / from_eye.length());
            if let Falloff::Physical { full_at, range } = lamp.falloff {
                per_full = 1.0 / (factor * full_at);
                per_range = range.map_or(0.0, |range| 1.0 / (factor * f64::from(range)));
            }
            (from_eye * factor, factor / f64::from(scale))
        };
        // Without a cone every direction is within.
        let (spot, outer, slope) = lamp.cone.map_or(([0.0; 3], -2.0, 1.0), |cone| {
            let (outer, width) = cosines(cone);
            (cone.direction, outer, 1.0 / width)
        });
        Self {
            towards: towards.as_vec3().into(),
            approach: approach as f32,
            color: lamp.color,
            outer,
            spot,
            slope,
            // 0 would say that there is no falloff.
            per_full: (per_full as f32).clamp(if per_full > 0.0 { f32::MIN_POSITIVE } else { 0.0 }, f32::MAX),
            per_range: (per_range as f32).min(f32::MAX),
            padding: [0; 2],
        }
    }
}

fn wide(p: [f32; 3]) -> DVec3 {
    DVec3::from(p.map(f64::from))
}

/// What is drawn into, with what, and what all passes know.
struct Stage<'a> {
    pass: &'a StencilPass,
    projection: &'a Projection,
    pipelines: Pipelines,
    target: Target,
    depth: wgpu::TextureView,
    faces: Texture,
    light: Texture,
    /// By what the frame scales.
    scale: f32,
    frame: wgpu::Buffer,
    scene: wgpu::Buffer,
    paint: wgpu::Buffer,
    receivers: wgpu::BindGroup,
    normals: &'a wgpu::Buffer,
}

/// Depth and stencil, face, light.
const SAMPLE_BYTES: u64 = 8 + 4 + 8;

/// What a picture may take on the device: a software one takes it from the host.
const MOST_BYTES: u64 = SAMPLE_BYTES << 26;

const FACES: TextureFormat = TextureFormat::R32Uint;
const LIGHT: TextureFormat = TextureFormat::Rgba16Float;
const RESOLVED: TextureFormat = TextureFormat::Rgba32Float;

impl<'a> Stage<'a> {
    fn new(
        pass: &'a StencilPass,
        mesh: &Mesh,
        receivers: &'a Receivers,
        view: &View<'_>,
        projection: &'a Projection,
    ) -> Result<Self, GpuError> {
        let gpu = pass.gpu();
        let samples = view.edge_samples.max(1);
        let [width, height] =
            [view.size.width(), view.size.height()].map(|side| side.saturating_mul(samples));
        let limit = gpu.limits().max_texture_dimension_2d.min(Size::MOST);
        let size =
            Size::new(width, height).map_err(|_| GpuError::Picture { side: width.max(height), limit })?;
        let bytes = size.pixels() as u64 * SAMPLE_BYTES;
        if bytes > MOST_BYTES {
            let remedy = "use a smaller --size, fewer --samples, or --method rays";
            return Err(GpuError::TooLarge {
                what: "samples of a picture",
                bytes,
                limit: MOST_BYTES,
                remedy,
            });
        }
        let target = Target::new(gpu, size)?;
        let frame = pass.frame(projection, size, receivers)?;
        let scale = frame.scale;
        let frame = gpu.uniform(&frame)?;
        let ground = view.ground.map_or(FaceId(u32::MAX), |ground| ground.first_face);
        let color = |face| if face < ground { (view.paint)(face) } else { GROUND.to_array() };
        let paint: Vec<[f32; 3]> = (0..mesh.face_count()).map(|face| color(FaceId::new(face))).collect();
        Ok(Self {
            pass,
            projection,
            pipelines: Pipelines::new(pass)?,
            depth: target.depth(),
            target,
            faces: gpu.texture("visible faces", size, FACES)?,
            light: gpu.texture("light", size, LIGHT)?,
            scale,
            scene: gpu.uniform(&SceneUniform::new(view, projection, scale))?,
            paint: gpu.upload("colors of faces", &paint)?,
            receivers: pass.bind_receivers(&frame, receivers)?,
            frame,
            normals: &receivers.normals,
        })
    }

    /// Depth, visible faces, and the light that needs no lamp.
    fn begin(&self, receivers: &Receivers, sides: &wgpu::Buffer) -> Result<(), GpuError> {
        let bind = self.bind(
            &self.pipelines.ambient,
            &[
                (0, self.frame.as_entire_binding()),
                (3, self.normals.as_entire_binding()),
                (5, wgpu::BindingResource::TextureView(&self.depth)),
                (6, self.scene.as_entire_binding()),
                (8, sides.as_entire_binding()),
                (9, self.paint.as_entire_binding()),
                (10, wgpu::BindingResource::TextureView(&self.faces.view)),
            ],
        )?;
        self.pass.gpu().submit(|encoder| {
            let mut pass = self.target.begin(encoder, &[Some(color(&self.faces, true))]);
            pass.set_pipeline(&self.pipelines.faces);
            pass.set_bind_group(0, &self.receivers, &[]);
            pass.draw(0..receivers.corners, 0..1);
            drop(pass);
            let pass = begin(encoder, &self.light);
            everywhere(pass, &self.pipelines.ambient, &bind);
        })
    }

    /// The light of one lamp, where it is counted in no volume.
    fn add(&self, lamp: &ShadedLight, shadow: &LampShadow<'_>, sides: &wgpu::Buffer) -> Result<(), GpuError> {
        let gpu = self.pass.gpu();
        let counter = self.pass.counter(&self.target, self.projection, shadow.draws, shadow.counting)?;
        let lamp = gpu.uniform(&LampUniform::new(lamp, self.projection, self.scale))?;
        let mut entries = vec![
            (0, self.frame.as_entire_binding()),
            (3, self.normals.as_entire_binding()),
            (5, wgpu::BindingResource::TextureView(&self.depth)),
            (6, self.scene.as_entire_binding()),
            (7, lamp.as_entire_binding()),
            (8, sides.as_entire_binding()),
            (9, self.paint.as_entire_binding()),
            (10, wgpu::BindingResource::TextureView(&self.faces.view)),
        ];
        let pipeline = match &counter.counts {
            None => &self.pipelines.lamp,
            Some(counts) => {
                entries.push((4, counts.as_entire_binding()));
                &self.pipelines.counted_lamp
            }
        };
        let bind = self.bind(pipeline, &entries)?;
        gpu.submit(|encoder| {
            self.pass.count(encoder, &self.target, &counter);
            let pass = self.target.begin_read_only(encoder, &[Some(color(&self.light, false))]);
            everywhere(pass, pipeline, &bind);
        })
    }

    /// The mean of the samples, as bytes.
    fn finish(&self, size: Size) -> Result<Picture, GpuError> {
        const PIXEL: usize = 16;
        let gpu = self.pass.gpu();
        let resolved = gpu.texture("picture", size, RESOLVED)?;
        let back = gpu.staging_for(&resolved, PIXEL as u32)?;
        let bind = self.bind(
            &self.pipelines.resolve,
            &[
                (6, self.scene.as_entire_binding()),
                (11, wgpu::BindingResource::TextureView(&self.light.view)),
            ],
        )?;
        let mut pixels = buffer(size, [0; 4]).map_err(|_| GpuError::OutOfMemory)?;
        gpu.submit(|encoder| {
            let pass = begin(encoder, &resolved);
            everywhere(pass, &self.pipelines.resolve, &bind);
            resolved.copy(encoder, TextureAspect::All, PIXEL as u32, &back);
        })?;
        gpu.mapped(&back, |bytes| {
            let row_bytes = bytes.len() / size.height() as usize;
            parallel::rows(&mut pixels, size.width() as usize, |y, row| {
                for (pixel, light) in row.iter_mut().zip(bytes[y * row_bytes..].chunks_exact(PIXEL)) {
                    let [r, g, b, _]: [f32; 4] = bytemuck::pod_read_unaligned(light);
                    *pixel = color::encode(Vec3::new(r, g, b));
                }
            });
        })?;
        Ok(Picture { size, pixels })
    }

    fn bind(
        &self,
        pipeline: &wgpu::RenderPipeline,
        entries: &[(u32, wgpu::BindingResource<'_>)],
    ) -> Result<wgpu::BindGroup, GpuError> {
        let gpu = self.pass.gpu();
        let entries: Vec<_> = entries
            .iter()
            .map(|(binding, resource)| wgpu::BindGroupEntry { binding: *binding, resource: resource.clone() })
            .collect();
        gpu.attempt(|| {
            gpu.device().create_bind_group(&wgpu::BindGroupDescriptor {
                label: None,
                layout: &pipeline.get_bind_group_layout(0),
                entries: &entries,
            })
        })
    }
}

/// A texture to draw into: from 0, or over what is there.
fn color(texture: &Texture, clear: bool) -> wgpu::RenderPassColorAttachment<'_> {
    let load = if clear { wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT) } else { wgpu::LoadOp::Load };
    wgpu::RenderPassColorAttachment {
        view: &texture.view,
        depth_slice: None,
        resolve_target: None,
        ops: wgpu::Operations { load, store: wgpu::StoreOp::Store },
    }
}

/// Begins a pass without depth.
fn begin<'e>(encoder: &'e mut wgpu::CommandEncoder, into: &Texture) -> wgpu::RenderPass<'e> {
    encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        color_attachments: &[Some(color(into, true))],
        ..wgpu::RenderPassDescriptor::default()
    })
}

/// Draws the triangle that covers everything.
fn everywhere(mut pass: wgpu::RenderPass<'_>, pipeline: &wgpu::RenderPipeline, bind: &wgpu::BindGroup) {
    pass.set_pipeline(pipeline);
    pass.set_bind_group(0, bind, &[]);
    pass.draw(0..3, 0..1);
}

struct Pipelines {
    faces: wgpu::RenderPipeline,
    ambient: wgpu::RenderPipeline,
    lamp: wgpu::RenderPipeline,
    counted_lamp: wgpu::RenderPipeline,
    resolve: wgpu::RenderPipeline,
}

fn shader() -> Shader {
    let vector = |v: Vec3| format!("vec3f({:?}, {:?}, {:?})", v.x, v.y, v.z);
    Shader::new("picture", &format!("{SOURCE}\n{}", include_str!("picture.wgsl")))
        .constant("AMBIENT", "f32", format_args!("{AMBIENT:?}"))
        .constant("AMBIENT_SLOPE", "f32", format_args!("{AMBIENT_SLOPE:?}"))
        .constant("MOST_FALLOFF", "f32", format_args!("{MOST_FALLOFF:?}"))
        .constant("SPECULAR", "f32", format_args!("{SPECULAR:?}"))
        .constant("SPECULAR_SQUARINGS", "u32", format_args!("{SPECULAR_SQUARINGS}u"))
        .constant("BELOW", "vec3f", vector(BELOW))
        .constant("ABOVE", "vec3f", vector(ABOVE))
        .constant("FADE_BEGINS", "f32", format_args!("{:?}", ground::FADE[0]))
        .constant("FADE_ENDS", "f32", format_args!("{:?}", ground::FADE[1]))
}

impl Pipelines {
    fn new(pass: &StencilPass) -> Result<Self, GpuError> {
        let gpu: &Gpu = pass.gpu();
        let module = shader().module(gpu)?;
        let keep = StencilFaceState::IGNORE;
        let build = |fragment, format, blend, depth_stencil| {
            let write_mask = wgpu::ColorWrites::ALL;
            let targets = &[Some(wgpu::ColorTargetState { format, blend, write_mask })];
            let (vertex, fragment) = ("everywhere", Some(fragment));
            Pipeline { vertex, fragment, targets, depth_stencil, layout: None }.build(gpu, &module)
        };
        let add = wgpu::BlendComponent {
            src_factor: wgpu::BlendFactor::One,
            dst_factor: wgpu::BlendFactor::One,
            operation: wgpu::BlendOperation::Add,
        };
        let add = Some(wgpu::BlendState { color: add, alpha: add });
        let when = |stencil| Some(depth_stencil(false, CompareFunction::Always, stencil, stencil));
        // The reference that is compared with is 0.
        let uncounted = StencilFaceState { compare: CompareFunction::Equal, ..keep };
        let faces = Pipeline {
            vertex: "receiver",
            fragment: Some(if pass.depth() == Depth::Plane { "face_of_plane" } else { "face" }),
            targets: &[Some(FACES.into())],
            depth_stencil: Some(depth_stencil(true, CompareFunction::Greater, keep, keep)),
            layout: Some(pass.layout()),
        };
        Ok(Self {
            faces: faces.build(gpu, &module)?,
            ambient: build("ambient", LIGHT, None, None)?,
            lamp: build("add_lamp", LIGHT, add, when(uncounted))?,
            counted_lamp: build("add_counted_lamp", LIGHT, add, when(keep))?,
            resolve: build("resolve", RESOLVED, None, None)?,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn picture_uniforms_stand_in_the_shader_as_they_do_here() {
        let module = naga::front::wgsl::parse_str(shader().source()).unwrap();
        let check = |name: &str, size: usize, here: &[(&str, usize)]| {
            let (_, kind) = module.types.iter().find(|(_, kind)| kind.name.as_deref() == Some(name)).unwrap();
            let naga::TypeInner::Struct { members, span } = &kind.inner else { panic!("a struct") };
            assert_eq!(*span as usize, size);
            let there = members.iter().map(|m| (m.name.as_deref().unwrap_or(""), m.offset as usize));
            assert_eq!(there.collect::<Vec<_>>(), here);
        };
        macro_rules! offsets {
            ($of:ident: $($field:ident),*) => { &[$((stringify!($field), std::mem::offset_of!($of, $field))),*] };
        }
        check(
            "Scene",
            size_of::<SceneUniform>(),
            offsets![SceneUniform: up, first_ground, ground_center, diagonals, samples],
        );
        check(
            "Lamp",
            size_of::<LampUniform>(),
            offsets![LampUniform: towards, approach, color, outer, spot, slope, per_full, per_range],
        );
    }
}
