//! Compute shaders: compiled once, bound to buffers, dispatched over any number of invocations.

use std::fmt::{Display, Write as _};

use super::{Gpu, GpuError};

/// Invocations per workgroup.
pub(crate) const WORKGROUP: u32 = 64;

/// A WGSL source with the constants that it shares with Rust.
#[derive(Clone, Debug)]
pub(crate) struct Shader {
    label: &'static str,
    source: String,
}

impl Shader {
    /// `body` after what every shader may use: the constant `WORKGROUP`, and `linear_id`, the number of an
    /// invocation in a grid of one or two dimensions.
    pub(crate) fn new(label: &'static str, body: &str) -> Self {
        let source = format!(
            "const WORKGROUP: u32 = {WORKGROUP}u;\n\
             fn linear_id(global: vec3u, groups: vec3u) -> u32 {{ return global.y * groups.x * WORKGROUP + global.x; }}\n\
             {body}"
        );
        Self { label, source }
    }

    /// Enables an extension of WGSL. The line goes to the top of the shader.
    pub(crate) fn enabling(self, extension: &str) -> Self {
        Self { source: format!("enable {extension};\n{}", self.source), ..self }
    }

    /// Adds a constant, given its type and value in WGSL.
    pub(crate) fn constant(mut self, name: &str, kind: &str, value: impl Display) -> Self {
        writeln!(self.source, "const {name}: {kind} = {value};").expect("a string takes any text");
        self
    }

    /// The whole text.
    #[cfg(test)]
    pub(crate) fn source(&self) -> &str {
        &self.source
    }

    /// Compiles it.
    pub(crate) fn module(&self, gpu: &Gpu) -> Result<wgpu::ShaderModule, GpuError> {
        gpu.attempt(|| {
            gpu.device.create_shader_module(wgpu::ShaderModuleDescriptor {
                label: Some(self.label),
                source: wgpu::ShaderSource::Wgsl(self.source.as_str().into()),
            })
        })
    }
}

/// A compiled entry point of a compute shader. Its buffers are those of group 0 that it uses.
#[derive(Clone, Debug)]
pub(crate) struct Kernel {
    pipeline: wgpu::ComputePipeline,
    largest_grid: u32,
}

impl Kernel {
    /// Compiles `entry` of `module`.
    pub(crate) fn new(gpu: &Gpu, module: &wgpu::ShaderModule, entry: &str) -> Result<Self, GpuError> {
        let pipeline = gpu.attempt(|| {
            gpu.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                label: Some(entry),
                layout: None,
                module,
                entry_point: Some(entry),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                cache: None,
            })
        })?;
        Ok(Self { pipeline, largest_grid: gpu.limits.max_compute_workgroups_per_dimension })
    }

    /// The buffers at their bindings.
    pub(crate) fn bind(
        &self,
        gpu: &Gpu,
        buffers: &[(u32, &wgpu::Buffer)],
    ) -> Result<wgpu::BindGroup, GpuError> {
        self.bind_all(gpu, buffers.iter().map(|&(binding, buffer)| (binding, buffer.as_entire_binding())))
    }

    /// The same with textures, too.
    pub(crate) fn bind_all<'a>(
        &self,
        gpu: &Gpu,
        resources: impl IntoIterator<Item = (u32, wgpu::BindingResource<'a>)>,
    ) -> Result<wgpu::BindGroup, GpuError> {
        gpu.bind_group(&self.pipeline.get_bind_group_layout(0), resources)
    }

    /// Runs at least `invocations` invocations. The shader must return early in those beyond.
    pub(crate) fn record(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        buffers: &wgpu::BindGroup,
        invocations: usize,
    ) {
        if invocations == 0 {
            return;
        }
        let [x, y] = grid(invocations as u64, self.largest_grid);
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, buffers, &[]);
        pass.dispatch_workgroups(x, y, 1);
    }
}

/// Workgroups along x and y for `invocations`, of which neither exceeds `largest`.
fn grid(invocations: u64, largest: u32) -> [u32; 2] {
    let groups = invocations.div_ceil(u64::from(WORKGROUP));
    let y = groups.div_ceil(u64::from(largest));
    [groups.div_ceil(y) as u32, y as u32] // x is at most `largest`, and y at most x for 2³² invocations
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn grid_covers_all_invocations_within_the_limit() {
        for invocations in [1, 63, 64, 65, 64 * 65_535, 64 * 65_535 + 1, u64::from(u32::MAX)] {
            let [x, y] = grid(invocations, 65_535);
            assert!(x <= 65_535 && y <= 65_535);
            let covered = u64::from(x) * u64::from(y) * u64::from(WORKGROUP);
            assert!(covered >= invocations && covered < invocations + u64::from((y + 1) * WORKGROUP));
        }
    }
}
