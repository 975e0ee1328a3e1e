//! Render pipelines.

use wgpu::{CompareFunction, StencilFaceState};

use crate::gpu::{Gpu, GpuError, wgpu};

/// The depth and stencil of all passes; reversed, so that 0 is infinitely far.
pub(crate) const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Depth32FloatStencil8;

/// What a render pipeline is made of; the layout of its group 0 comes from the shader where none is given.
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
