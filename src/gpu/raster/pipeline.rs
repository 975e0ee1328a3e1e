//! Render pipelines.

use wgpu::{CompareFunction, StencilFaceState};

use crate::gpu::{Gpu, GpuError, wgpu};

/// The depth and stencil of all passes; reversed, so that 0 is infinitely far.
pub(crate) const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Depth32FloatStencil8;

/// A description of a render pipeline. The layout of its group 0 comes from the shader where none is given.
pub(crate) struct Pipeline<'a> {
    pub(crate) vertex: &'a str,
    pub(crate) fragment: Option<&'a str>,
    pub(crate) targets: &'a [Option<wgpu::ColorTargetState>],
    pub(crate) depth_stencil: Option<wgpu::DepthStencilState>,
    pub(crate) layout: Option<&'a wgpu::BindGroupLayout>,
}

impl Pipeline<'_> {
    pub(crate) fn build(
        self,
        gpu: &Gpu,
        module: &wgpu::ShaderModule,
    ) -> Result<wgpu::RenderPipeline, GpuError> {
        let compilation_options = wgpu::PipelineCompilationOptions::default;
        gpu.attempt(|| {
            let layout = self.layout.map(|layout| {
                gpu.device().create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                    label: None,
                    bind_group_layouts: &[Some(layout)],
                    immediate_size: 0,
                })
            });
            gpu.device().create_render_pipeline(&wgpu::RenderPipelineDescriptor {
                label: Some(self.vertex),
                layout: layout.as_ref(),
                vertex: wgpu::VertexState {
                    module,
                    entry_point: Some(self.vertex),
                    compilation_options: compilation_options(),
                    buffers: &[],
                },
                fragment: self.fragment.map(|entry| wgpu::FragmentState {
                    module,
                    entry_point: Some(entry),
                    compilation_options: compilation_options(),
                    targets: self.targets,
                }),
                // Two-sided: both sides of a receiver are seen, both sides of a volume counted.
                primitive: wgpu::PrimitiveState { cull_mode: None, ..Default::default() },
                depth_stencil: self.depth_stencil,
                multisample: wgpu::MultisampleState::default(),
                multiview_mask: None,
                cache: None,
            })
        })
    }
}

/// A pipeline for triangles, and how their vertices are numbered.
#[derive(Clone, Debug)]
pub(crate) struct Drawing {
    pipeline: wgpu::RenderPipeline,
    /// By vertex id, so that a vertex is computed once for several triangles; otherwise corner by corner.
    indexed: bool,
}

impl Drawing {
    /// Builds a pipeline. Vertex shaders whose name ends in `_vertex` are indexed.
    pub(crate) fn new(
        pipeline: Pipeline<'_>,
        gpu: &Gpu,
        module: &wgpu::ShaderModule,
    ) -> Result<Self, GpuError> {
        let indexed = pipeline.vertex.ends_with("_vertex");
        Ok(Self { pipeline: pipeline.build(gpu, module)?, indexed })
    }

    /// Draws the first `corners` corners of a triangle list.
    pub(crate) fn all(&self, pass: &mut wgpu::RenderPass<'_>, triangles: &wgpu::Buffer, corners: u32) {
        self.some(pass, triangles, 0..corners);
    }

    /// Draws some corners of a triangle list.
    pub(crate) fn some(
        &self,
        pass: &mut wgpu::RenderPass<'_>,
        triangles: &wgpu::Buffer,
        corners: std::ops::Range<u32>,
    ) {
        self.begin(pass, triangles);
        match self.indexed {
            true => pass.draw_indexed(corners, 0, 0..1),
            false => pass.draw(corners, 0..1),
        }
    }

    /// Draws what the arguments at an offset say of a triangle list.
    pub(crate) fn indirect(
        &self,
        pass: &mut wgpu::RenderPass<'_>,
        triangles: &wgpu::Buffer,
        arguments: &wgpu::Buffer,
        offset: u64,
    ) {
        self.begin(pass, triangles);
        match self.indexed {
            true => pass.draw_indexed_indirect(arguments, offset),
            false => pass.draw_indirect(arguments, offset),
        }
    }

    fn begin(&self, pass: &mut wgpu::RenderPass<'_>, triangles: &wgpu::Buffer) {
        pass.set_pipeline(&self.pipeline);
        if self.indexed {
            pass.set_index_buffer(triangles.slice(..), wgpu::IndexFormat::Uint32);
        }
    }
}

/// Draws the triangle that covers the whole target.
pub(crate) fn everywhere(
    mut pass: wgpu::RenderPass<'_>,
    pipeline: &wgpu::RenderPipeline,
    bind: Option<&wgpu::BindGroup>,
) {
    pass.set_pipeline(pipeline);
    if let Some(bind) = bind {
        pass.set_bind_group(0, bind, &[]);
    }
    pass.draw(0..3, 0..1);
}

/// The layout of group 0 for triangles: frame, vertices, triangles, planes.
pub(crate) fn layout(gpu: &Gpu) -> Result<wgpu::BindGroupLayout, GpuError> {
    layout_of(gpu, false)
}

/// The same, with the receivers' depth and a buffer that fragments write, at the bindings 4 and 5.
pub(crate) fn counting_layout(gpu: &Gpu) -> Result<wgpu::BindGroupLayout, GpuError> {
    layout_of(gpu, true)
}

fn layout_of(gpu: &Gpu, counting: bool) -> Result<wgpu::BindGroupLayout, GpuError> {
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
        entries.push(entry(4, ShaderStages::FRAGMENT, depth));
        entries.push(entry(5, ShaderStages::FRAGMENT, storage(false)));
    }
    gpu.attempt(|| {
        gpu.device()
            .create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: None, entries: &entries })
    })
}

/// A test of depth and stencil; all bits of the stencil count.
pub(crate) fn depth_stencil(
    depth_write: bool,
    compare: CompareFunction,
    front: StencilFaceState,
    back: StencilFaceState,
) -> wgpu::DepthStencilState {
    wgpu::DepthStencilState {
        format: FORMAT,
        depth_write_enabled: Some(depth_write),
        depth_compare: Some(compare),
        stencil: wgpu::StencilState { front, back, read_mask: 0xff, write_mask: 0xff },
        bias: wgpu::DepthBiasState::default(),
    }
}
