//! The render pipelines: which write depth, and which count.

use wgpu::{CompareFunction, StencilFaceState, StencilOperation};

use crate::gpu::raster::{
    self, Depth, Drawing, GpuVisibility, Pipeline, ReceiverDepth, counting_layout, depth_stencil,
};
use crate::gpu::{Gpu, GpuError, Shader, wgpu};

/// The pipelines of a pass, and the layouts of their bindings.
#[derive(Clone, Debug)]
pub(super) struct Pipelines {
    pub(super) receivers: ReceiverDepth,
    /// The layout of the receivers, with their depth and the counts.
    pub(super) counting_layout: wgpu::BindGroupLayout,
    zfail_sides: Drawing,
    zpass_sides: Drawing,
    /// With a depth test that always fails, so that every fragment counts.
    pub(super) caps: Drawing,
    count_all: Drawing,
    count_behind: Drawing,
    count_before: Drawing,
    /// 1 where the stencil is 0 and a receiver is seen.
    pub(super) lit: wgpu::RenderPipeline,
    /// 1 where the integer count is 0 and a receiver is seen.
    pub(super) lit_by_count: wgpu::RenderPipeline,
}

/// The state that counts fragments behind the visible point.
#[derive(Clone, Copy, Debug)]
pub(super) enum Behind {
    /// They fail the depth test.
    Fails,
    /// They pass its complement, `LessEqual` for sides and `Always` for caps. (William Bilodeau and Michael
    /// Songy, *Real Time Shadows*, 1999.)
    #[cfg(test)]
    Passes { sides: CompareFunction, caps: CompareFunction },
}

/// Which samples a stencil counts, and in which bits.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bits {
    pub(super) compare: CompareFunction,
    pub(super) read: u32,
    pub(super) write: u32,
}

impl Bits {
    /// All samples, in all bits.
    const ALL: Self = Self { compare: CompareFunction::Always, read: 0xff, write: 0xff };
}

const KEEP: StencilFaceState = StencilFaceState::IGNORE;

impl Pipelines {
    /// For z-pass sides, z-fail sides and caps, counted in the stencil.
    pub(super) fn stencil(&self) -> [&Drawing; 3] {
        [&self.zpass_sides, &self.zfail_sides, &self.caps]
    }

    /// The same, counted in 32-bit integers.
    pub(super) fn integer(&self) -> [&Drawing; 3] {
        [&self.count_before, &self.count_behind, &self.count_all]
    }

    pub(super) fn new(gpu: &Gpu, depth: Depth) -> Result<Self, GpuError> {
        Self::behind(gpu, depth, Behind::Fails, Bits::ALL)
    }

    /// Counted in the bits of a stencil that has others besides.
    pub(super) fn in_bits(gpu: &Gpu, depth: Depth, bits: Bits) -> Result<Self, GpuError> {
        Self::behind(gpu, depth, Behind::Fails, bits)
    }

    /// With a given state for what lies behind the visible point.
    #[cfg(test)]
    pub(super) fn behind_by(gpu: &Gpu, depth: Depth, behind: Behind) -> Result<Self, GpuError> {
        Self::behind(gpu, depth, behind, Bits::ALL)
    }

    fn behind(gpu: &Gpu, depth: Depth, behind: Behind, bits: Bits) -> Result<Self, GpuError> {
        use StencilOperation::{DecrementWrap, IncrementWrap};
        let module = module(gpu)?;
        let receivers = ReceiverDepth::new(gpu, depth)?;
        let counting_layout = counting_layout(gpu)?;
        let (side, of_side) = match depth {
            Depth::Plane => ("volume", Some("side_plane")),
            Depth::Interpolated => ("volume_vertex", None),
        };
        let fails = |operation| StencilFaceState { depth_fail_op: operation, compare: bits.compare, ..KEEP };
        let passes = |operation| StencilFaceState { pass_op: operation, compare: bits.compare, ..KEEP };
        let build = |vertex, fragment, compare, front, back| {
            let mut depth_stencil = depth_stencil(false, compare, front, back);
            (depth_stencil.stencil.read_mask, depth_stencil.stencil.write_mask) = (bits.read, bits.write);
            let depth_stencil = Some(depth_stencil);
            let layout = Some(&receivers.layout);
            Drawing::new(Pipeline { vertex, fragment, targets: &[], depth_stencil, layout }, gpu, &module)
        };
        let count = |vertex, fragment| {
            let depth_stencil = Some(depth_stencil(false, CompareFunction::Always, KEEP, KEEP));
            let (fragment, layout) = (Some(fragment), Some(&counting_layout));
            Drawing::new(Pipeline { vertex, fragment, targets: &[], depth_stencil, layout }, gpu, &module)
        };
        // Drawn infinitely far, at depth 0: less than the depth of whatever is seen.
        let lit = |fragment, compare| {
            let test = StencilFaceState { compare, ..KEEP };
            let depth_stencil = Some(depth_stencil(false, CompareFunction::Less, test, test));
            let (vertex, fragment, layout) = ("everywhere", Some(fragment), None);
            let targets = &[Some(GpuVisibility::HARD.into())];
            Pipeline { vertex, fragment, targets, depth_stencil, layout }.build(gpu, &module)
        };
        let greater = CompareFunction::Greater;
        // z-fail counts what is behind the visible point: −1 where a volume ends there, +1 where one begins.
        let ([out, into], sides, caps) = match behind {
            Behind::Fails => ([DecrementWrap, IncrementWrap].map(fails), greater, CompareFunction::Never),
            #[cfg(test)]
            Behind::Passes { sides, caps } => ([DecrementWrap, IncrementWrap].map(passes), sides, caps),
        };
        Ok(Self {
            zfail_sides: build(side, of_side, sides, out, into)?,
            zpass_sides: build(side, of_side, greater, passes(IncrementWrap), passes(DecrementWrap))?,
            caps: build("volume_vertex", None, caps, out, into)?,
            count_all: count("volume_vertex", "count_all")?,
            count_behind: count("volume", "count_behind")?,
            count_before: count("volume", "count_before")?,
            // The reference that is compared with is 0.
            lit: lit("lit", CompareFunction::Equal)?,
            lit_by_count: lit("lit_by_count", CompareFunction::Always)?,
            receivers,
            counting_layout,
        })
    }
}

/// The shaders.
pub(super) fn module(gpu: &Gpu) -> Result<wgpu::ShaderModule, GpuError> {
    let source = format!("{}\n{}", raster::SOURCE, include_str!("../stencil.wgsl"));
    Shader::new("stencil", &source).module(gpu)
}
