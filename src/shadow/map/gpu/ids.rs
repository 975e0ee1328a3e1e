//! The technique `map-ids` on a device: the texels name faces, and the device tests them. Samples where
//! rounding might decide are marked, and answered by the exact ray cast of the processor.

use super::hybrid::source;
use super::{GpuMap, HybridPass, Marked, all_layers, draw, drawing, texture};
use crate::caster::GpuCaster;
use crate::gpu::raster::{GpuSamples, GpuVisibility};
use crate::gpu::{Gpu, GpuError, Shader, wgpu};
use crate::shadow::map::LightSpace;

const IDS: &str = include_str!("ids.wgsl");
const NAMES: wgpu::TextureFormat = wgpu::TextureFormat::R32Uint;

/// The compiled passes, for one device: [`IdPass::draw`], and then as of a [`HybridPass`].
#[derive(Clone, Debug)]
pub struct IdPass {
    gpu: Gpu,
    draw: wgpu::RenderPipeline,
    marking: HybridPass,
}

/// A shadow map on a device that names the face of each texel.
#[derive(Clone, Debug)]
pub struct GpuIdMap {
    map: GpuMap,
    names: wgpu::TextureView,
}

impl GpuIdMap {
    /// The depths.
    #[must_use]
    pub fn map(&self) -> &GpuMap {
        &self.map
    }

    /// Memory on the device, in bytes: as much for the names as for the depths.
    #[must_use]
    pub fn bytes(&self) -> usize {
        2 * self.map.bytes()
    }
}

impl IdPass {
    /// Compiles the shaders.
    ///
    /// # Errors
    ///
    /// [`GpuError::Lost`], [`GpuError::OutOfMemory`].
    pub fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        Self::of(gpu, &format!("{}{IDS}", source()))
    }

    /// The passes with one text of their shaders replaced, for the injected faults of tests.
    #[cfg(test)]
    pub(crate) fn with_fault(gpu: &Gpu, text: &str, fault: &str) -> Self {
        assert!(IDS.contains(text), "{text}");
        Self::of(gpu, &format!("{}{}", source(), IDS.replace(text, fault))).expect("it compiles")
    }

    fn of(gpu: &Gpu, source: &str) -> Result<Self, GpuError> {
        let module = Shader::new("map of face numbers", source).module(gpu)?;
        let draw = drawing(gpu, &module, "caster_named", &[Some(NAMES.into())])?;
        Ok(Self { gpu: gpu.clone(), draw, marking: HybridPass::of(gpu, &module, "tested")? })
    }

    /// Draws the map of a caster in a light's space: one pass per layer. Submits without waiting.
    ///
    /// # Errors
    ///
    /// As [`MapPass::draw`](super::MapPass::draw).
    pub fn draw(&self, caster: &GpuCaster, space: &LightSpace) -> Result<GpuIdMap, GpuError> {
        let names = texture(&self.gpu, space, NAMES)?;
        let map = draw(&self.gpu, &self.draw, caster, space, Some(&names))?;
        Ok(GpuIdMap { map, names: all_layers(&self.gpu, &names)? })
    }

    /// Tests the faces that (2·`reach` + 1)² texels name, with `reach` of at most 16, and marks what is not
    /// sure. Submits without waiting.
    ///
    /// # Errors
    ///
    /// As [`HybridPass::mark`].
    pub fn mark(&self, samples: &GpuSamples, map: &GpuIdMap, reach: u32) -> Result<Marked, GpuError> {
        let names = (11, wgpu::BindingResource::TextureView(&map.names));
        self.marking.mark_with(samples, &map.map, reach, Some(names))
    }

    /// Draws the exact answers, as [`HybridPass::resolve`].
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
        self.marking.resolve(marked, asked, is_dark)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::caster::Caster;
    use crate::gpu::tests::gpu;
    use crate::oracle::Verdict;
    use crate::shadow::is_front_lit;
    use crate::shadow::map::IdShadow;
    use crate::shadow::map::gpu::test_support::{OPTIONS, Twins, casters};

    /// Front-lit samples; those whose value the CPU form does not have; those falsely dark, and falsely lit;
    /// the falsely lit ones of the CPU form; and those asked exactly.
    #[derive(Debug, Default)]
    struct Count {
        front_lit: usize,
        other: usize,
        dark: usize,
        lit: usize,
        lit_on_cpu: usize,
        asked: usize,
    }

    fn count(gpu: &Gpu, pass: &IdPass, caster: &Caster, lamp: &str) -> Count {
        let Twins { casters, lamp, samples, on_device, drawn, space } =
            Twins::new(gpu, caster, lamp, [129, 97]);
        let cpu = IdShadow::prepare(&casters, &lamp, &OPTIONS).unwrap().shade(&samples);
        let map = pass.draw(&on_device, &space).unwrap();
        assert_eq!(map.bytes(), 2 * map.map().bytes());
        let marked = pass.mark(&drawn, &map, 1).unwrap();
        let asked = marked.download(gpu).unwrap();
        let verdicts: Vec<Option<Verdict>> = (samples.hits().iter())
            .map(|hit| {
                let hit = hit.as_ref().filter(|hit| is_front_lit(hit, lamp.light()))?;
                Some(casters.oracle().verdict(hit.point, lamp.light()))
            })
            .collect();
        let is_dark: Vec<bool> =
            asked.iter().map(|&index| verdicts[index as usize] == Some(Verdict::Shadowed)).collect();
        let values = pass.resolve(&marked, &asked, &is_dark).unwrap().download(gpu).unwrap();
        let front_lit = asked.iter().filter(|&&index| verdicts[index as usize].is_some());
        let mut found = Count { asked: front_lit.count(), ..Count::default() };
        for ((&value, &on_cpu), verdict) in values.iter().zip(cpu.values()).zip(verdicts) {
            assert!(value == 0.0 || value == 1.0, "{value}");
            found.front_lit += usize::from(verdict.is_some());
            found.other += usize::from(verdict.is_some() && value != on_cpu);
            found.dark += usize::from(verdict == Some(Verdict::Lit) && value == 0.0);
            found.lit += usize::from(verdict == Some(Verdict::Shadowed) && value == 1.0);
            found.lit_on_cpu += usize::from(verdict == Some(Verdict::Shadowed) && on_cpu == 1.0);
        }
        found
    }

    /// Both twins test the same faces, but where the coverage of a texel turns by rounding, and where a
    /// device asks the ray cast, which knows more faces than the texels name.
    #[test]
    fn ids_on_a_device_answer_as_the_cpu_form_and_faults_are_found() {
        let Some(gpu) = gpu() else { return };
        let [ring, knot] = casters();
        let pass = IdPass::new(&gpu).unwrap();
        let faults = [
            // All that is named counts as crossed.
            ("let crossing = crossed(receiver.q, name - 1u);", "let crossing = CROSSED;"),
            // Nothing is.
            ("return select(UNSURE, CROSSED,", "return select(UNSURE, MISSED,"),
            // Away from the light.
            ("{ towards = -q; }", "{ towards = q; }"),
            // What lies behind the receiver counts.
            ("if way < -bound { return MISSED; }", "if way < -bound { return CROSSED; }"),
            // The face beside the one that is drawn.
            ("Named(drawn_depth(corner), corner.face + 1u)", "Named(drawn_depth(corner), corner.face + 2u)"),
        ];
        let faulty = faults.map(|(text, fault)| IdPass::with_fault(&gpu, text, fault));
        for (caster, lamp) in [
            (&ring, "directional:0.4,0.2,-1"),
            (&knot, "spot:3,4,9:-0.3,-0.4,-0.9:35"),
            (&ring, "point:0.5,0.25,3"),
        ] {
            let found = count(&gpu, &pass, caster, lamp);
            assert!(found.front_lit > 1500 && found.asked * 10 < found.front_lit, "{lamp} {found:?}");
            assert!(found.other * 200 < found.front_lit, "{lamp} {found:?}");
            assert!(found.dark * 1000 < found.front_lit, "{lamp} {found:?}");
            assert!(found.lit <= found.lit_on_cpu + found.front_lit / 1000, "{lamp} {found:?}");
            if !lamp.starts_with("directional") {
                for (faulty, (_, fault)) in faulty.iter().zip(faults) {
                    let wrong = count(&gpu, faulty, caster, lamp);
                    assert!(wrong.other * 200 > wrong.front_lit, "{lamp} {fault} {wrong:?}");
                }
            }
        }
    }
}
