//! The technique `hybrid-3x3` on a device: the map decides where its texels agree. The other samples are
//! marked, one bit each, and answered by the exact ray cast of the processor.

use super::{GpuMap, SOURCE, bind};
use crate::gpu::raster::{self, GpuSamples, GpuVisibility, Pipeline, everywhere};
use crate::gpu::{Gpu, GpuError, Shader, wgpu};

const AGREEMENT: &str = include_str!("hybrid.wgsl");

/// What the shaders of both techniques with marks start with.
pub(super) fn source() -> String {
    format!("{}{SOURCE}{AGREEMENT}", raster::SOURCE)
}

/// The compiled passes, for one device.
///
/// [`HybridPass::mark`], [`Marked::download`], the exact answers, [`HybridPass::resolve`]: each step can be
/// timed on its own.
#[derive(Clone, Debug)]
pub struct HybridPass {
    gpu: Gpu,
    certain: wgpu::RenderPipeline,
    resolve: wgpu::RenderPipeline,
}

/// A visibility that is dark where the map could not decide, and marks that say where this is.
#[derive(Clone, Debug)]
pub struct Marked {
    visibility: GpuVisibility,
    marks: wgpu::Buffer,
    frame: wgpu::Buffer,
}

impl HybridPass {
    /// Compiles the shaders.
    ///
    /// # Errors
    ///
    /// [`GpuError::Lost`], [`GpuError::OutOfMemory`].
    pub fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        let module = Shader::new("hybrid of map and rays", &source()).module(gpu)?;
        Self::of(gpu, &module, "certain")
    }

    /// With another fragment shader that marks.
    pub(super) fn of(gpu: &Gpu, module: &wgpu::ShaderModule, certain: &str) -> Result<Self, GpuError> {
        let pipeline = |fragment| {
            let pipeline = Pipeline {
                vertex: "everywhere",
                fragment: Some(fragment),
                targets: &[Some(GpuVisibility::HARD.into())],
                depth_stencil: None,
                layout: None,
            };
            pipeline.build(gpu, module)
        };
        Ok(Self { gpu: gpu.clone(), certain: pipeline(certain)?, resolve: pipeline("resolve")? })
    }

    /// Asks the map: (2·`reach` + 1)² texels per sample, with `reach` of at most 16. Submits without waiting.
    ///
    /// Samples whose face turns away from the light are asked, too, and mostly marked: their exact answer
    /// needs no ray.
    ///
    /// # Errors
    ///
    /// [`GpuError::TooLarge`] if a bit per sample does not fit a buffer; [`GpuError::OutOfMemory`];
    /// [`GpuError::Lost`].
    pub fn mark(&self, samples: &GpuSamples, map: &GpuMap, reach: u32) -> Result<Marked, GpuError> {
        self.mark_with(samples, map, reach, None)
    }

    /// The same, with what else the shader reads.
    pub(super) fn mark_with(
        &self,
        samples: &GpuSamples,
        map: &GpuMap,
        reach: u32,
        more: Option<(u32, wgpu::BindingResource<'_>)>,
    ) -> Result<Marked, GpuError> {
        let light = self.gpu.uniform(&map.uniform.with_agreement(reach.min(16)))?;
        let words = samples.size().pixels().div_ceil(32);
        let marks = self.gpu.storage::<u32>("marks of samples", words)?;
        let visibility = GpuVisibility::hard(&self.gpu, samples.size())?;
        let shared = [
            (5, wgpu::BindingResource::TextureView(&samples.faces.view)),
            (6, light.as_entire_binding()),
            (7, wgpu::BindingResource::TextureView(&map.view)),
            (8, marks.as_entire_binding()),
        ];
        let more: Vec<_> = shared.into_iter().chain(more).collect();
        let group = bind(&self.gpu, &self.certain, &samples.receivers, &samples.uniform, &more)?;
        self.gpu.submit(|encoder| {
            everywhere(visibility.0.begin(encoder, true), &self.certain, Some(&group));
        })?;
        Ok(Marked { visibility, marks, frame: samples.uniform.clone() })
    }

    /// Draws the exact answers: for each sample of [`Marked::download`] whether it is in shadow. Submits
    /// without waiting.
    ///
    /// # Errors
    ///
    /// [`GpuError::OutOfMemory`], [`GpuError::Lost`].
    pub fn resolve(
        &self,
        marked: &Marked,
        asked: &[u32],
        is_dark: &[bool],
    ) -> Result<GpuVisibility, GpuError> {
        let mut words = vec![0_u32; marked.visibility.size().pixels().div_ceil(32)];
        for (&sample, _) in asked.iter().zip(is_dark).filter(|(_, is_dark)| **is_dark) {
            words[sample as usize / 32] |= 1 << (sample % 32);
        }
        let dark = self.gpu.upload("exact answers", &words)?;
        let layout = self.gpu.attempt(|| self.resolve.get_bind_group_layout(0))?;
        let group = self.gpu.bind_group(
            &layout,
            [
                (0, marked.frame.as_entire_binding()),
                (9, marked.marks.as_entire_binding()),
                (10, dark.as_entire_binding()),
            ],
        )?;
        self.gpu.submit(|encoder| {
            everywhere(marked.visibility.0.begin(encoder, false), &self.resolve, Some(&group));
        })?;
        Ok(marked.visibility.clone())
    }
}

impl Marked {
    /// The marked samples, ascending: rows from the top. Waits for the work that marks them.
    ///
    /// # Errors
    ///
    /// [`GpuError::OutOfMemory`], [`GpuError::Lost`].
    pub fn download(&self, gpu: &Gpu) -> Result<Vec<u32>, GpuError> {
        let count = self.visibility.size().pixels().div_ceil(32);
        let words: Vec<u32> = gpu.download(&self.marks, count)?;
        let bits = |(index, word): (usize, u32)| {
            (0..32).filter(move |bit| word >> bit & 1 == 1).map(move |bit| 32 * index as u32 + bit)
        };
        Ok(words.into_iter().enumerate().flat_map(bits).collect()) // at most 2²⁸ samples
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::caster::Caster;
    use crate::gpu::tests::gpu;
    use crate::oracle::Verdict;
    use crate::shadow::map::HybridShadow;
    use crate::shadow::map::gpu::MapPass;
    use crate::shadow::map::gpu::test_support::{OPTIONS, Twins, casters};

    /// Front-lit samples, those that are answered otherwise by the CPU form, those that are wrong in truth,
    /// and those asked exactly.
    #[derive(Debug, Default)]
    struct Count {
        front_lit: usize,
        other: usize,
        wrong: usize,
        wrong_on_cpu: usize,
        asked: usize,
        asked_on_cpu: usize,
    }

    fn count(gpu: &Gpu, caster: &Caster, lamp: &str, reach: u32) -> Count {
        let Twins { casters, lamp, samples, on_device, drawn, space } =
            Twins::new(gpu, caster, lamp, [193, 145]);
        let cpu = HybridShadow::prepare(&casters, &lamp, &OPTIONS).unwrap().shade(&samples);
        let map = MapPass::new(gpu).unwrap().draw(&on_device, &space).unwrap();
        let pass = HybridPass::new(gpu).unwrap();
        let marked = pass.mark(&drawn, &map, reach).unwrap();
        let asked = marked.download(gpu).unwrap();
        assert!(asked.windows(2).all(|pair| pair[0] < pair[1]));
        let truth: Vec<Option<Verdict>> = (samples.hits().iter().zip(cpu.asked()))
            .map(|(hit, asked)| {
                Some(casters.oracle().verdict(hit.as_ref().filter(|_| *asked)?.point, lamp.light()))
            })
            .collect();
        let is_dark: Vec<bool> =
            asked.iter().map(|&index| truth[index as usize] == Some(Verdict::Shadowed)).collect();
        let values = pass.resolve(&marked, &asked, &is_dark).unwrap().download(gpu).unwrap();
        let mut found = Count { asked_on_cpu: cpu.asked_exactly() as usize, ..Count::default() };
        found.asked = asked.iter().filter(|&&index| cpu.asked()[index as usize]).count();
        for (index, (&value, &on_cpu)) in values.iter().zip(cpu.values()).enumerate() {
            assert!(value == 0.0 || value == 1.0, "{value}");
            let Some(verdict) = truth[index] else { continue };
            let is_wrong =
                |value: f32| verdict != Verdict::Grazing && (value == 1.0) != (verdict == Verdict::Lit);
            found.front_lit += 1;
            found.other += usize::from(value != on_cpu);
            found.wrong += usize::from(is_wrong(value));
            found.wrong_on_cpu += usize::from(is_wrong(on_cpu));
        }
        found
    }

    #[test]
    fn hybrid_on_a_device_answers_as_the_cpu_form_and_one_texel_is_not_sure() {
        let Some(gpu) = gpu() else { return };
        let [ring, knot] = casters();
        for (caster, lamp) in [
            (&ring, "directional:0.4,0.2,-1"),
            (&knot, "spot:3,4,9:-0.3,-0.4,-0.9:35"),
            (&ring, "point:0.5,0.25,3"),
            (&knot, "directional:-0.3,0.5,-1"),
        ] {
            let found = count(&gpu, caster, lamp, 1);
            // Both twins are exact where they ask, and they agree where both are sure, but for texels whose
            // coverage or comparison turns by rounding.
            assert!(found.front_lit > 2000, "{lamp} {found:?}");
            assert!(found.other * 1000 < found.front_lit, "{lamp} {found:?}");
            assert!(found.wrong <= found.wrong_on_cpu + found.front_lit / 2000, "{lamp} {found:?}");
            assert!(found.asked > 50 && found.asked * 2 < found.front_lit, "{lamp} {found:?}");
            assert!(found.asked.abs_diff(found.asked_on_cpu) * 10 < found.asked, "{lamp} {found:?}");
            // Fault injected: one texel is taken to be sure.
            let sure = count(&gpu, caster, lamp, 0);
            assert!(sure.other * 500 > sure.front_lit, "{lamp} {sure:?}");
            assert!(sure.wrong > sure.wrong_on_cpu + sure.front_lit / 500, "{lamp} {sure:?}");
        }
    }
}
