//! Counting only the samples that a light grid leaves undecided: the device form of `hybrid`.
//!
//! One bit of the stencil says which samples these are, and the other seven count. (Eric Chan and Frédo
//! Durand, *An Efficient Hybrid Shadow Rendering Algorithm*, EGSR 2004; their mask comes from a shadow map,
//! and is wrong where that is.) Of a decided sample the grid's verdict holds, which is exact; an undecided
//! one has the count of the plain pass. A rasterizer that tests the stencil before it shades saves the
//! fragments of all other samples. Software rasterizers test it afterwards: there nothing is saved.

use wgpu::{CompareFunction, StencilFaceState, StencilOperation};

use super::pipelines::{Bits, Pipelines, module};
use super::{Draw, StencilPass, frame};
use crate::gpu::raster::{Depth, GpuVisibility, Pipeline, depth_stencil};
use crate::gpu::{Gpu, GpuError, wgpu};
use crate::light_grid::GridVerdict;
use crate::shadow::GpuSamples;

/// The bit of undecided samples.
const UNDECIDED: u32 = 0x80;

/// The compiled pass with a stencil mask, for one device.
#[derive(Clone, Debug)]
pub struct MaskedPass {
    pass: StencilPass,
    counting: Pipelines,
    mark: wgpu::RenderPipeline,
    lit: wgpu::RenderPipeline,
    proven_lit: wgpu::RenderPipeline,
}

impl MaskedPass {
    /// Counts must be below this number: they have seven bits.
    pub const LIMIT: u32 = UNDECIDED;

    /// Compiles the shaders.
    ///
    /// # Errors
    ///
    /// [`GpuError::Lost`], [`GpuError::OutOfMemory`].
    pub fn new(gpu: &Gpu, depth: Depth) -> Result<Self, GpuError> {
        Self::with_write_mask(gpu, depth, UNDECIDED - 1)
    }

    fn with_write_mask(gpu: &Gpu, depth: Depth, write: u32) -> Result<Self, GpuError> {
        let bits = Bits { compare: CompareFunction::Equal, read: UNDECIDED, write };
        let module = module(gpu)?;
        // Drawn infinitely far: less than the depth of whatever is seen.
        let build = |fragment, face: StencilFaceState, color| {
            let targets: &[_] = if color { &[Some(GpuVisibility::HARD.into())] } else { &[] };
            let depth_stencil = Some(depth_stencil(false, CompareFunction::Less, face, face));
            Pipeline { vertex: "everywhere", fragment: Some(fragment), targets, depth_stencil, layout: None }
                .build(gpu, &module)
        };
        let always = StencilFaceState { compare: CompareFunction::Always, ..StencilFaceState::IGNORE };
        let equal = StencilFaceState { compare: CompareFunction::Equal, ..StencilFaceState::IGNORE };
        Ok(Self {
            pass: StencilPass::new(gpu, depth)?,
            counting: Pipelines::in_bits(gpu, depth, bits)?,
            mark: build(
                "undecided",
                StencilFaceState { pass_op: StencilOperation::Replace, ..always },
                false,
            )?,
            lit: build("lit", equal, true)?,
            proven_lit: build("proven_lit", always, true)?,
        })
    }

    /// The visibility of every sample: that of its verdict, and by counting `volumes` where nothing is
    /// proven. A count of 128 passes for 0, so the counts must be proven to be below
    /// ([`max_depth_complexity`](super::super::max_depth_complexity) with [`MaskedPass::LIMIT`]).
    ///
    /// # Errors
    ///
    /// As [`StencilPass::visibility`].
    ///
    /// # Panics
    ///
    /// Panics if there is not one verdict per sample.
    pub fn visibility(
        &self,
        samples: &GpuSamples,
        volumes: &[Draw<'_>],
        verdicts: &[GridVerdict],
    ) -> Result<GpuVisibility, GpuError> {
        assert_eq!(verdicts.len(), samples.size().pixels(), "one verdict per sample");
        let (gpu, target) = (&self.pass.gpu, &samples.target);
        let visibility = GpuVisibility::hard(gpu, samples.size())?;
        let code = |verdict: &GridVerdict| match verdict {
            GridVerdict::Undecided => 0,
            GridVerdict::Lit => 1,
            GridVerdict::Dark => 2,
        };
        let proven: Vec<u32> = verdicts.iter().map(code).collect();
        let proven = gpu.upload("verdicts", &proven).map_err(GpuError::for_a_picture)?;
        let bind = |pipeline: &wgpu::RenderPipeline| {
            let resources = [(0, samples.uniform.as_entire_binding()), (6, proven.as_entire_binding())];
            gpu.bind_group(&pipeline.get_bind_group_layout(0), resources)
        };
        let [mark, proven_lit] = [bind(&self.mark)?, bind(&self.proven_lit)?];
        let bind = |draw: &Draw<'_>| {
            let frame = self.pass.volume_frame(&samples.projection, samples.size(), draw.volume)?;
            self.pass.bind_volume(&frame, draw.volume)
        };
        let bindings = volumes.iter().map(bind).collect::<Result<Vec<_>, GpuError>>()?;
        gpu.submit(|encoder| {
            let mut pass = target.begin_counting(encoder);
            pass.set_stencil_reference(UNDECIDED);
            pass.set_pipeline(&self.mark);
            pass.set_bind_group(0, &mark, &[]);
            pass.draw(0..3, 0..1);
            for (draw, bind) in volumes.iter().zip(&bindings) {
                frame::draw_volume(&mut pass, draw.method, bind, draw.volume, self.counting.stencil());
            }
            drop(pass);
            let mut pass = target.begin_read_only(encoder, &[Some(visibility.0.attachment(true))]);
            // Undecided, with a count of 0.
            pass.set_stencil_reference(UNDECIDED);
            pass.set_pipeline(&self.lit);
            pass.draw(0..3, 0..1);
            pass.set_pipeline(&self.proven_lit);
            pass.set_bind_group(0, &proven_lit, &[]);
            pass.draw(0..3, 0..1);
        })?;
        Ok(visibility)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::caster::{Caster, CasterGroup, GpuCaster};
    use crate::gpu::tests::gpu;
    use crate::light_grid::{Chain, LightGrid};
    use crate::mesh::Mesh;
    use crate::scene::Lamp;
    use crate::shadow::Samples;
    use crate::shadow::stencil::{StencilMethod, max_depth_complexity};
    use crate::testing::shapes;
    use crate::view::{Camera, Size, Up};

    /// Decided samples have the grid's verdict and undecided ones that of the plain pass, value for value.
    #[test]
    fn masked_visibility_is_the_grids_where_it_decides_and_the_plain_one_elsewhere() {
        let Some(gpu) = gpu() else { return };
        let masked = MaskedPass::new(&gpu, Depth::Plane).unwrap();
        // Fault injected: counting writes the bit of undecided samples, too.
        let all_bits = MaskedPass::with_write_mask(&gpu, Depth::Plane, 0xff).unwrap();
        let size = Size::new(80, 60).unwrap();
        let floor = shapes::cuboid([-6.0, -2.0, -6.0], [6.0, -1.0, 6.0]);
        let mut found = [0; 5];
        for solid in [shapes::torus(24, 12, 1.5, 0.5), shapes::open_cube()] {
            let caster = Caster::new(Mesh::concat(&[solid, floor.clone()]).unwrap());
            let group = CasterGroup::new(vec![&caster]);
            let camera = Camera::look_at([3.0, 4.0, 5.0], [0.0; 3], 1.0, Up::Y).unwrap();
            let projection = camera.projection(size, 0.1);
            let samples = Samples::of_view(&group, &projection, size, 1).unwrap();
            let receivers = GpuCaster::upload(&gpu, &caster).unwrap();
            let drawn = receivers.samples(&projection, size, Depth::Plane).unwrap();
            for lamp in ["point:1,6,2", "directional:0.3,-1,0.2"] {
                let lamp: Lamp = lamp.parse().unwrap();
                let light = lamp.light();
                let volumes = caster.stencil_volumes(light, &projection, None, Some(StencilMethod::ZFail));
                let layers = max_depth_complexity(caster.mesh(), &volumes.signs, light, MaskedPass::LIMIT);
                assert!(layers.is_below());
                let uploaded = volumes.upload(&gpu).unwrap();
                let chain = Chain::of(&group, light);
                let points = samples.hits().iter().flatten().map(|hit| hit.point);
                let grid = LightGrid::build(&chain, points, 128);
                let verdict =
                    |hit: &Option<_>| hit.as_ref().map_or(GridVerdict::Dark, |hit| grid.verdict(hit));
                let verdicts: Vec<GridVerdict> = samples.hits().iter().map(verdict).collect();
                let download = |visibility: GpuVisibility| visibility.download(&gpu).unwrap();
                let plain = masked.pass.visibility(&drawn, &uploaded.draws(), volumes.counting()).unwrap();
                let plain = download(plain);
                let expected = verdicts.iter().zip(&plain).map(|(verdict, &plain)| match verdict {
                    GridVerdict::Undecided => plain,
                    // A sample on the border may have no depth on the device.
                    GridVerdict::Lit => 1.0,
                    GridVerdict::Dark => 0.0,
                });
                let expected: Vec<f32> = expected.collect();
                let differ = |pass: &MaskedPass, verdicts: &[GridVerdict]| {
                    let values = pass.visibility(&drawn, &uploaded.draws(), verdicts).unwrap();
                    download(values).iter().zip(&expected).filter(|(a, b)| a != b).count()
                };
                found[0] += differ(&masked, &verdicts);
                found[1] += differ(&all_bits, &verdicts);
                // Fault injected: the verdicts of the neighbors.
                let mut turned = verdicts.clone();
                turned.rotate_left(1);
                found[2] += differ(&masked, &turned);
                found[3] += verdicts.iter().filter(|verdict| **verdict == GridVerdict::Undecided).count();
                found[4] += expected.iter().zip(&plain).filter(|(a, b)| a != b).count();
            }
        }
        eprintln!("{found:?}");
        let [wrong, all_bits, turned, undecided, unlike_plain] = found;
        assert!(wrong == 0 && all_bits > 50 && turned > 50, "{found:?}");
        // Where the grid decides, the plain pass is right but for the rasterizer's footprint.
        assert!(undecided > 300 && unlike_plain < 200, "{found:?}");
    }
}
