//! The compiled passes.

use crate::facing::gpu::EVALUATION;
use crate::gpu::{Gpu, GpuError, Kernel, Scan, Shader};

/// Edges that one invocation counts and lists.
pub(super) const RUN: usize = 64;
/// Edges whose multiplicity one invocation computes.
pub(super) const EDGES: usize = 4;

/// The bindings of the shader.
pub(super) mod slot {
    pub(in super::super) const LIGHT: u32 = 0;
    pub(in super::super) const PLANES: u32 = 1;
    pub(in super::super) const FACING: u32 = 2;
    pub(in super::super) const UNSURE: u32 = 3;
    pub(in super::super) const TRIANGLES: u32 = 4;
    pub(in super::super) const VERTICES: u32 = 5;
    pub(in super::super) const PATCHES: u32 = 6;
    pub(in super::super) const MASKS: u32 = 7;
    pub(in super::super) const SIGNS: u32 = 8;
    pub(in super::super) const OFFSETS: u32 = 9;
    pub(in super::super) const ENTRIES: u32 = 10;
    pub(in super::super) const MULTIPLICITIES: u32 = 11;
    pub(in super::super) const RUNS: u32 = 12;
    pub(in super::super) const FOUND: u32 = 13;
    pub(in super::super) const QUADS: u32 = 14;
    pub(in super::super) const SIZE: u32 = 15;
}

/// The compiled shaders for silhouettes, for one device. Cheap to clone.
#[derive(Clone, Debug)]
pub struct SilhouetteShaders {
    pub(super) facing_by_planes: Kernel,
    pub(super) facing_by_positions: Kernel,
    pub(super) settle: Kernel,
    pub(super) drop_collapsed: Kernel,
    pub(super) choose_casters: Kernel,
    pub(super) multiply: Kernel,
    pub(super) count_runs: Kernel,
    pub(super) list_runs: Kernel,
    pub(super) scan: Scan,
}

impl SilhouetteShaders {
    /// Compiles the shaders, which takes some tens of milliseconds.
    ///
    /// # Errors
    ///
    /// [`GpuError::OutOfMemory`], [`GpuError::Lost`].
    pub fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        Self::compiled(gpu, &shader())
    }

    pub(super) fn compiled(gpu: &Gpu, shader: &Shader) -> Result<Self, GpuError> {
        let module = shader.module(gpu)?;
        let kernel = |entry| Kernel::new(gpu, &module, entry);
        Ok(Self {
            facing_by_planes: kernel("facing_by_planes")?,
            facing_by_positions: kernel("facing_by_positions")?,
            settle: kernel("settle")?,
            drop_collapsed: kernel("drop_collapsed")?,
            choose_casters: kernel("choose_casters")?,
            multiply: kernel("multiply")?,
            count_runs: kernel("count_runs")?,
            list_runs: kernel("list_runs")?,
            scan: Scan::new(gpu)?,
        })
    }
}

pub(super) fn shader() -> Shader {
    with_body(include_str!("../silhouette.wgsl"))
}

pub(super) fn with_body(body: &str) -> Shader {
    Shader::new("silhouette", body).constant("RUN", "u32", RUN).constant("EDGES", "u32", EDGES).constant(
        "EVALUATION",
        "f32",
        format_args!("{EVALUATION:e}"),
    )
}
