//! The render pipelines: who writes depth, who counts what.

use wgpu::{CompareFunction, StencilFaceState, StencilOperation};

use crate::gpu::raster::{Pipeline, depth_stencil};
use crate::gpu::{Gpu, GpuError, Shader, wgpu};
use crate::shadow::volume::{GpuVolume, Part};

/// The source of all that is drawn here, for shaders that go on with it.
pub(crate) const SOURCE: &str = include_str!("../stencil.wgsl");

/// A pipeline for triangles, and how its vertices are numbered.
#[derive(Clone, Debug)]
pub(super) struct Drawing {
    pipeline: wgpu::RenderPipeline,
    /// By the triangles' ids, so that a vertex is computed once for several of them; else corner by corner.
    indexed: bool,
}

impl Drawing {
    /// Draws all triangles of so many corners.
    pub(super) fn all(&self, pass: &mut wgpu::RenderPass<'_>, triangles: &wgpu::Buffer, corners: u32) {
        self.begin(pass, triangles);
        match self.indexed {
            true => pass.draw_indexed(0..corners, 0, 0..1),
            false => pass.draw(0..corners, 0..1),
        }
    }

    /// Draws a part of a volume whose bindings are set.
    pub(super) fn part(&self, pass: &mut wgpu::RenderPass<'_>, volume: &VolumeBuffers, part: Part) {
        self.begin(pass, &volume.triangles);
        match self.indexed {
            true => pass.draw_indexed_indirect(&volume.arguments, part.offset()),
            false => pass.draw_indirect(&volume.arguments, part.offset()),
        }
    }

    fn begin(&self, pass: &mut wgpu::RenderPass<'_>, triangles: &wgpu::Buffer) {
        pass.set_pipeline(&self.pipeline);
        if self.indexed {
            pass.set_index_buffer(triangles.slice(..), wgpu::IndexFormat::Uint32);
        }
    }
}

/// What is drawn of a volume.
#[derive(Clone, Debug)]
pub(super) struct VolumeBuffers {
    triangles: wgpu::Buffer,
    arguments: wgpu::Buffer,
}

impl From<&GpuVolume> for VolumeBuffers {
    fn from(volume: &GpuVolume) -> Self {
        Self { triangles: volume.triangles.clone(), arguments: volume.arguments.clone() }
    }
}

/// The pipelines of a pass, and the layouts of what they are given.
#[derive(Clone, Debug)]
pub(super) struct Pipelines {
    /// Frame, vertices, triangles, normals.
    pub(super) layout: wgpu::BindGroupLayout,
    /// The same, with counts and the receivers' depth.
    pub(super) counting_layout: wgpu::BindGroupLayout,
    pub(super) receivers: Drawing,
    pub(super) zfail_sides: Drawing,
    pub(super) zpass_sides: Drawing,
    /// Whatever is drawn with it fails the depth test, and so counts.
    pub(super) caps: Drawing,
    pub(super) count_all: Drawing,
    pub(super) count_behind: Drawing,
    pub(super) count_before: Drawing,
}

const KEEP: StencilFaceState = StencilFaceState::IGNORE;

impl Pipelines {
    /// For z-pass sides, z-fail sides and caps, counted in the stencil.
    pub(super) fn stencil(&self) -> [&Drawing; 3] {
        [&self.zpass_sides, &self.zfail_sides, &self.caps]
    }

    /// The same, counted in whole numbers.
    pub(super) fn integer(&self) -> [&Drawing; 3] {
        [&self.count_before, &self.count_behind, &self.count_all]
    }

    /// `plane`: fragments compute their depth from their plane; else it is interpolated.
    pub(super) fn new(gpu: &Gpu, plane: bool) -> Result<Self, GpuError> {
        use StencilOperation::{DecrementWrap, IncrementWrap};
        let module = Shader::new("stencil", SOURCE).module(gpu)?;
        let layout = layout(gpu, false)?;
        let counting_layout = self::layout(gpu, true)?;
        let (of_receiver, of_side) = (plane.then_some("plane"), plane.then_some("side_plane"));
        let (receiver, side) =
            if plane { ("receiver", "volume") } else { ("receiver_vertex", "volume_vertex") };
        let fails = |operation| StencilFaceState {
            depth_fail_op: operation,
            compare: CompareFunction::Always,
            ..KEEP
        };
        let passes =
            |operation| StencilFaceState { pass_op: operation, compare: CompareFunction::Always, ..KEEP };
        let drawing = |pipeline, vertex: &str| {
            Ok::<_, GpuError>(Drawing { pipeline, indexed: vertex.ends_with("_vertex") })
        };
        let build = |vertex, fragment, depth_write, compare, front, back| {
            let depth_stencil = Some(depth_stencil(depth_write, compare, front, back));
            let layout = Some(&layout);
            let pipeline = Pipeline { vertex, fragment, targets: &[], depth_stencil, layout };
            drawing(pipeline.build(gpu, &module)?, vertex)
        };
        let count = |vertex, fragment| {
            let depth_stencil = Some(depth_stencil(false, CompareFunction::Always, KEEP, KEEP));
            let (fragment, layout) = (Some(fragment), Some(&counting_layout));
            let pipeline = Pipeline { vertex, fragment, targets: &[], depth_stencil, layout };
            drawing(pipeline.build(gpu, &module)?, vertex)
        };
        let greater = CompareFunction::Greater;
        // z-fail counts what is behind the visible point: out where a volume ends there, in where it begins.
        let (out, into) = (fails(DecrementWrap), fails(IncrementWrap));
        Ok(Self {
            receivers: build(receiver, of_receiver, true, greater, KEEP, KEEP)?,
            zfail_sides: build(side, of_side, false, greater, out, into)?,
            zpass_sides: build(side, of_side, false, greater, passes(IncrementWrap), passes(DecrementWrap))?,
            caps: build("volume_vertex", None, false, CompareFunction::Never, out, into)?,
            count_all: count("volume_vertex", "count_all")?,
            count_behind: count("volume", "count_behind")?,
            count_before: count("volume", "count_before")?,
            layout,
            counting_layout,
        })
    }
}

/// What group 0 of stencil.wgsl holds.
fn layout(gpu: &Gpu, counting: bool) -> Result<wgpu::BindGroupLayout, GpuError> {
    use wgpu::ShaderStages;
    let entry = |binding, visibility, ty| wgpu::BindGroupLayoutEntry { binding, visibility, ty, count: None };
    let buffer = |ty| wgpu::BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None };
    let storage = |read_only| buffer(wgpu::BufferBindingType::Storage { read_only });
    let mut entries = vec![
        entry(0, ShaderStages::VERTEX_FRAGMENT, buffer(wgpu::BufferBindingType::Uniform)),
        entry(1, ShaderStages::VERTEX, storage(true)),
        entry(2, ShaderStages::VERTEX, storage(true)),
        entry(3, ShaderStages::VERTEX, storage(true)),
    ];
    if counting {
        let depth = wgpu::BindingType::Texture {
            sample_type: wgpu::TextureSampleType::Depth,
            view_dimension: wgpu::TextureViewDimension::D2,
            multisampled: false,
        };
        entries.push(entry(4, ShaderStages::FRAGMENT, storage(false)));
        entries.push(entry(5, ShaderStages::FRAGMENT, depth));
    }
    gpu.attempt(|| {
        gpu.device()
            .create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: None, entries: &entries })
    })
}
