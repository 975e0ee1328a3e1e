//! The lit picture on a graphics device: ambient light everywhere, then the light of each lamp times its
//! visibility.
//!
//! The shading is that of the exact picture, constant for constant, so that the two can be compared. It
//! starts from the visible face of every sample, so that coinciding faces are not lit twice; every pass is
//! one triangle over the whole picture, and none knows how visibility is computed.

use bytemuck::{Pod, Zeroable};
use glam::{DVec3, Vec3};
use wgpu::{TextureAspect, TextureFormat};

use super::shade::{AMBIENT, AMBIENT_SLOPE, MOST_FALLOFF, SPECULAR, SPECULAR_SQUARINGS, cosines};
use super::{ABOVE, BELOW, Falloff, GROUND, Picture, ShadedLight, View, buffer, color, ground};
use crate::caster::{Caster, GpuCaster};
use crate::geom::{Facing, Light};
use crate::gpu::raster::{self, Depth, GpuSamples, GpuVisibility, Pipeline, everywhere};
use crate::gpu::{Gpu, GpuError, Shader, Texture, wgpu};
use crate::mesh::{FaceId, Mesh};
use crate::parallel;
use crate::view::{Projection, Size};

impl View<'_> {
    /// The samples of this picture on the device: `edge_samples`² per pixel of what `projection` sees of
    /// `caster`.
    ///
    /// # Errors
    ///
    /// [`GpuError::Picture`] or [`GpuError::TooLarge`] if the samples do not fit the device's limits, or are
    /// more than 2²⁶; [`GpuError::Subnormal`] if the mesh is too small to be drawn;
    /// [`GpuError::OutOfMemory`]; [`GpuError::Lost`].
    pub fn samples(
        &self,
        caster: &GpuCaster,
        projection: &Projection,
        depth: Depth,
    ) -> Result<GpuSamples, GpuError> {
        let samples = self.edge_samples.max(1);
        let [width, height] =
            [self.size.width(), self.size.height()].map(|side| side.saturating_mul(samples));
        let limit = caster.gpu().limits().max_texture_dimension_2d.min(Size::MOST);
        let size =
            Size::new(width, height).map_err(|_| GpuError::Picture { side: width.max(height), limit })?;
        let bytes = size.pixels() as u64 * SAMPLE_BYTES;
        if bytes > MOST_BYTES {
            let remedy = "use a smaller --size, fewer --samples, or --shadow rays";
            return Err(GpuError::TooLarge {
                what: "samples of a picture",
                bytes,
                limit: MOST_BYTES,
                remedy,
            });
        }
        caster.samples(projection, size, depth)
    }
}

/// Renders `caster` as [`render`](super::render) does, with the visibility of each lamp that a technique
/// computed.
///
/// `samples` are those of [`View::samples`] for the same caster, and `visibility` is asked once for each
/// lamp, by its index. What it returns is dropped before the next lamp. Faces that turn away from a lamp are
/// dark, whatever their visibility. Every pixel is the mean of its samples. What is nearer than the near
/// plane is not seen.
///
/// Compiling the shaders takes some tens of milliseconds. On the device a sample takes 20 bytes with its
/// depth and face, and 1 or 2 more for a hard or soft visibility; a pixel takes 16.
///
/// # Errors
///
/// Those of `visibility`; [`GpuError::TooLarge`] if the picture or a color per face do not fit the device's
/// limits; [`GpuError::OutOfMemory`], of the host too; [`GpuError::Lost`].
///
/// # Panics
///
/// Panics if `samples` or a visibility are of another size, or `samples` are of a mesh with another number of
/// faces.
pub fn render_visibility(
    samples: &GpuSamples,
    caster: &Caster,
    view: &View<'_>,
    mut visibility: impl FnMut(usize) -> Result<GpuVisibility, GpuError>,
) -> Result<Picture, GpuError> {
    let (mesh, planes) = (caster.mesh(), caster.planes());
    let per_side = view.edge_samples.max(1);
    let sides_of_picture = [view.size.width(), view.size.height()].map(|side| side.saturating_mul(per_side));
    assert_eq!(
        [samples.size().width(), samples.size().height()],
        sides_of_picture,
        "samples of another view"
    );
    assert_eq!(samples.receivers.corners as usize, 3 * mesh.face_count(), "samples of another mesh");
    let gpu = &samples.gpu;
    let stage = Stage::new(samples, mesh, view)?;
    let eye = Light::point(samples.projection.eye).expect("cameras are finite");
    let from_eye: Vec<i32> = planes.classify(mesh, &eye).into_iter().map(side).collect();
    stage.begin(&gpu.upload("sides of faces", &from_eye)?)?;
    let mut facing = Vec::new();
    for (index, lamp) in view.lamps.iter().enumerate() {
        planes.classify_into(mesh, &lamp.light, &mut facing);
        let lit = |(&eye, &lamp): (&i32, &Facing)| if side(lamp) == eye { eye } else { 0 };
        let sides: Vec<i32> = from_eye.iter().zip(&facing).map(lit).collect();
        let visibility = visibility(index)?;
        assert_eq!(visibility.size(), samples.size(), "a visibility of another size");
        stage.add(lamp, &visibility, &gpu.upload("sides of faces", &sides)?)?;
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
            // Then neither the distance of the lamp nor that of the farthest point is more than 1.
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

/// The samples that are shaded, and the light that they have so far.
struct Stage<'a> {
    samples: &'a GpuSamples,
    pipelines: Pipelines,
    light: Texture,
    scene: wgpu::Buffer,
    paint: wgpu::Buffer,
}

/// Depth and stencil, face, light.
const SAMPLE_BYTES: u64 = 8 + 4 + 8;

/// The most that a picture may take on the device, but for one visibility: a software device takes it from
/// the host.
const MOST_BYTES: u64 = SAMPLE_BYTES << 26;

const LIGHT: TextureFormat = TextureFormat::Rgba16Float;
const RESOLVED: TextureFormat = TextureFormat::Rgba32Float;

impl<'a> Stage<'a> {
    fn new(samples: &'a GpuSamples, mesh: &Mesh, view: &View<'_>) -> Result<Self, GpuError> {
        let gpu = &samples.gpu;
        let ground = view.ground.map_or(FaceId(u32::MAX), |ground| ground.first_face);
        let color = |face| if face < ground { (view.paint)(face) } else { GROUND.to_array() };
        let paint: Vec<[f32; 3]> = (0..mesh.face_count()).map(|face| color(FaceId::new(face))).collect();
        Ok(Self {
            pipelines: Pipelines::new(gpu)?,
            light: gpu.texture("light", samples.size(), LIGHT)?,
            scene: gpu.uniform(&SceneUniform::new(view, &samples.projection, samples.frame.scale))?,
            paint: gpu.upload("colors of faces", &paint)?,
            samples,
        })
    }

    /// The light that needs no lamp.
    fn begin(&self, sides: &wgpu::Buffer) -> Result<(), GpuError> {
        let bind = self.bind(&self.pipelines.ambient, sides, &[])?;
        self.samples.gpu.submit(|encoder| {
            everywhere(self.light.begin(encoder, true), &self.pipelines.ambient, Some(&bind));
        })
    }

    /// Adds the light of one lamp.
    fn add(
        &self,
        lamp: &ShadedLight,
        visibility: &GpuVisibility,
        sides: &wgpu::Buffer,
    ) -> Result<(), GpuError> {
        let samples = self.samples;
        let lamp = samples.gpu.uniform(&LampUniform::new(lamp, &samples.projection, samples.frame.scale))?;
        let more =
            [(9, lamp.as_entire_binding()), (10, wgpu::BindingResource::TextureView(visibility.view()))];
        let bind = self.bind(&self.pipelines.lamp, sides, &more)?;
        samples.gpu.submit(|encoder| {
            everywhere(self.light.begin(encoder, false), &self.pipelines.lamp, Some(&bind));
        })
    }

    /// The mean of the samples, as bytes.
    fn finish(&self, size: Size) -> Result<Picture, GpuError> {
        const PIXEL: usize = 16;
        let gpu = &self.samples.gpu;
        let resolved = gpu.texture("picture", size, RESOLVED)?;
        let back = gpu.staging_for(&resolved, PIXEL as u32)?;
        let resources =
            [(6, self.scene.as_entire_binding()), (11, wgpu::BindingResource::TextureView(&self.light.view))];
        let bind = gpu.bind_group(&self.pipelines.resolve.get_bind_group_layout(0), resources)?;
        let mut pixels = buffer(size, [0; 4]).map_err(|_| GpuError::OutOfMemory)?;
        gpu.submit(|encoder| {
            everywhere(resolved.begin(encoder, true), &self.pipelines.resolve, Some(&bind));
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

    /// What every sample is shaded from, and more.
    fn bind(
        &self,
        pipeline: &wgpu::RenderPipeline,
        sides: &wgpu::Buffer,
        more: &[(u32, wgpu::BindingResource<'_>)],
    ) -> Result<wgpu::BindGroup, GpuError> {
        let samples = self.samples;
        let resources = [
            (4, wgpu::BindingResource::TextureView(&samples.depth)),
            (5, wgpu::BindingResource::TextureView(&samples.faces.view)),
            (6, self.scene.as_entire_binding()),
            (7, sides.as_entire_binding()),
            (8, self.paint.as_entire_binding()),
        ];
        let all = samples.receivers.bindings(&samples.uniform).into_iter().chain(resources);
        samples.gpu.bind_group(&pipeline.get_bind_group_layout(0), all.chain(more.iter().cloned()))
    }
}

struct Pipelines {
    ambient: wgpu::RenderPipeline,
    lamp: wgpu::RenderPipeline,
    resolve: wgpu::RenderPipeline,
}

fn shader() -> Shader {
    let vector = |v: Vec3| format!("vec3f({:?}, {:?}, {:?})", v.x, v.y, v.z);
    Shader::new("picture", &format!("{}\n{}", raster::SOURCE, include_str!("picture.wgsl")))
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
    fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        let module = shader().module(gpu)?;
        let build = |fragment, format, blend| {
            let write_mask = wgpu::ColorWrites::ALL;
            let targets = &[Some(wgpu::ColorTargetState { format, blend, write_mask })];
            let (vertex, fragment) = ("everywhere", Some(fragment));
            Pipeline { vertex, fragment, targets, depth_stencil: None, layout: None }.build(gpu, &module)
        };
        let add = wgpu::BlendComponent {
            src_factor: wgpu::BlendFactor::One,
            dst_factor: wgpu::BlendFactor::One,
            operation: wgpu::BlendOperation::Add,
        };
        Ok(Self {
            ambient: build("ambient", LIGHT, None)?,
            lamp: build("add_lamp", LIGHT, Some(wgpu::BlendState { color: add, alpha: add }))?,
            resolve: build("resolve", RESOLVED, None)?,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gpu::layout::{assert_layout, members};

    #[test]
    fn picture_uniforms_have_one_layout_in_rust_and_wgsl() {
        let shader = shader();
        assert_layout!(shader.source(), "Lamp", LampUniform: towards, approach, color, outer, spot, slope, per_full, per_range);
        // Rust writes the padding out.
        macro_rules! offsets {
            ($($field:ident),*) => { vec![$((stringify!($field).to_owned(), std::mem::offset_of!(SceneUniform, $field))),*] };
        }
        let here = offsets![up, first_ground, ground_center, diagonals, samples];
        assert_eq!(members(shader.source(), "Scene"), (here, size_of::<SceneUniform>()));
    }
}
