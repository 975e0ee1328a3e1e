//! Frames of a shadow map of 1024 × 1024 on a graphics adapter, beside other techniques on the same samples of
//! 640 × 480 pixels; the parts of a hybrid of map and exact rays; and the search of single-sample soft shadows
//! on the processor and on the adapter.

use umbrage::caster::{Caster, CasterGroup, GpuCaster};
use umbrage::gpu::Gpu;
use umbrage::mesh::Mesh;
use umbrage::oracle::Verdict;
use umbrage::scene::Lamp;
use umbrage::shadow::map::gpu::{GpuMap, HybridPass, Lookup, MapPass};
use umbrage::shadow::map::{Bias, Filter, LightSpace};
use umbrage::shadow::soft::gpu::{PcssPass, SearchPass};
use umbrage::shadow::soft::{PcssOptions, SingleSampleOptions};
use umbrage::shadow::stencil::{StencilMethod, StencilPass};
use umbrage::shadow::{Depth, GpuVisibility, Request, Samples, Technique};
use umbrage::testing::shapes;
use umbrage::verify::errors::Truth;
use umbrage::view::{Camera, Size, Up};

use crate::gpu::wait;
use crate::measure::{Bench, Contender, Group, timed};

const STAGE: &str = "frames of a shadow map";
const HYBRID: &str = "parts of a map with exact rays";
const SOFT: &str = "frames of soft shadows from a map";

pub(crate) fn run(bench: &mut Bench<'_>) {
    if ![STAGE, HYBRID, SOFT].iter().any(|stage| bench.wants(stage)) {
        return;
    }
    let gpu = match Gpu::new(None) {
        Ok(gpu) => gpu,
        Err(error) => return eprintln!("skipped, no frames of a shadow map: {error}"),
    };
    let sponge = shapes::menger_sponge(if bench.quick { 1 } else { 3 });
    let [low, high] = sponge.bounds().expect("it has faces");
    let floor = shapes::scaled(&shapes::sheet(1), 4.0 * (high[0] - low[0]));
    let floor = shapes::translated(&floor, [low[0] - 2.0, low[1] - 2.0, low[2] - 0.01]);
    let mesh = Mesh::concat(&[sponge, floor]).expect("they fit").with_name("Menger sponge");
    let caster = Caster::new(mesh);
    if bench.wants(STAGE) {
        frames(bench, &gpu, &caster);
    }
    if bench.wants(HYBRID) {
        hybrid(bench, &gpu, &caster);
    }
    if bench.wants(SOFT) {
        soft(bench, &gpu, &caster);
    }
}

fn frames(bench: &mut Bench<'_>, gpu: &Gpu, caster: &Caster) {
    let (width, height, side) = if bench.quick { (64, 48, 128) } else { (640, 480, 1024) };
    let size = Size::new(width, height).expect("in range");
    let casters = CasterGroup::new(vec![caster]);
    let camera = Camera::fit(&casters.bounds(), Up::Z, size.aspect());
    let projection = camera.projection(size, camera.near([caster.mesh()], size));
    let lamp: Lamp = "directional:0.7,0.2,-1".parse().expect("a light");
    let samples = Samples::of_view(&casters, &projection, size, 1).expect("they fit");
    let request = Request { casters: &casters, lamp: &lamp, samples: &samples };
    let truth = Truth::of(&request);
    // Wrong samples in a thousand of those that face the lamp: what each row is asserted by.
    let wrong = |values: &[f32]| {
        let judged = truth
            .verdicts()
            .iter()
            .zip(values)
            .filter_map(|(verdict, value)| Some((verdict.as_ref()?, value)));
        let (mut count, mut wrong) = (0_u32, 0_u32);
        for (verdict, &value) in judged.filter(|(verdict, _)| **verdict != Verdict::Grazing) {
            count += 1;
            wrong += u32::from((value >= 0.5) != (*verdict == Verdict::Lit));
        }
        1000.0 * f64::from(wrong) / f64::from(count.max(1))
    };
    let at_most = |values: &[f32], most: f64| {
        let wrong = wrong(values);
        assert!(wrong <= most, "{wrong} in a thousand are wrong, not {most}");
        "right".to_owned()
    };
    let on_device = |visibility: &GpuVisibility| visibility.download(gpu).expect("it is there");

    let receivers = GpuCaster::upload(gpu, caster).expect("it fits");
    let draw_samples = || receivers.samples(&projection, size, Depth::Plane).expect("they fit");
    let drawn = draw_samples();
    let pass = MapPass::new(gpu).expect("it compiles");
    let space = LightSpace::of_scene(&casters, &lamp, side).expect("it fits");
    let kept = pass.draw(&receivers, &space).expect("it fits");
    let lookup = Lookup { filter: Filter::Box3, bias: Bias::Texel };
    let look = |map: &GpuMap| {
        let visibility = pass.visibility(&drawn, map, lookup).expect("it fits");
        wait(gpu);
        visibility
    };
    let counting = StencilPass::new(gpu, Depth::Plane).expect("it compiles");
    let volumes = caster.stencil_volumes(lamp.light(), &projection, None, Some(StencilMethod::ZFail));
    let uploaded = volumes.upload(gpu).expect("they fit");

    // Texels that are drawn into, and texels read: what the frame costs on any adapter.
    let texels = kept.download(gpu, 0).expect("it is there").iter().filter(|&&depth| depth > 0.0).count();
    let reads = Filter::Box3.reads() as usize * size.pixels();
    let work = format!("texels={texels} reads={reads}");
    let least = if bench.quick { 60.0 } else { 8.0 };
    let contenders = vec![
        Contender::new("samples alone: no shadows", || {
            let frame = || {
                let _ = draw_samples();
                wait(gpu);
            };
            timed(frame, |()| format!("samples={}", size.pixels()))
        })
        .expects(format!("samples={}", size.pixels())),
        Contender::new("map drawn, 3x3 lookups", || {
            let frame = || {
                let map = pass.draw(&receivers, &space).expect("it fits");
                look(&map)
            };
            timed(frame, |visibility| format!("{} {work}", at_most(&on_device(visibility), least)))
        })
        .expects(format!("right {work}")),
        Contender::new("map kept, 3x3 lookups", || {
            timed(|| look(&kept), |visibility| at_most(&on_device(visibility), least))
        })
        .expects("right"),
        Contender::new("z-fail", || {
            let frame = || {
                let visibility =
                    counting.visibility(&drawn, &uploaded.draws(), volumes.counting()).expect("it fits");
                wait(gpu);
                visibility
            };
            timed(frame, |visibility| at_most(&on_device(visibility), 1.0))
        })
        .expects("right"),
        Contender::new("exact rays, on the processor", || {
            let frame = || Technique::Rays.shade(&request).expect("it needs no memory");
            timed(frame, |visibility| at_most(visibility.values(), 0.0))
        })
        .expects("right"),
    ];
    let mesh = format!("{} of {} triangles · {}", caster.mesh().name, caster.mesh().face_count(), gpu.name());
    bench.run(Group { stage: STAGE, mesh: mesh.replace(',', " ·"), units: 1, unit: "frame", contenders });
}

/// What a frame with exact answers for the unsure samples consists of.
fn hybrid(bench: &mut Bench<'_>, gpu: &Gpu, caster: &Caster) {
    let (width, height, side) = if bench.quick { (64, 48, 128) } else { (640, 480, 1024) };
    let size = Size::new(width, height).expect("in range");
    let casters = CasterGroup::new(vec![caster]);
    let camera = Camera::fit(&casters.bounds(), Up::Z, size.aspect());
    let projection = camera.projection(size, camera.near([caster.mesh()], size));
    let lamp: Lamp = "directional:0.7,0.2,-1".parse().expect("a light");
    let samples = Samples::of_view(&casters, &projection, size, 1).expect("they fit");
    let truth = Truth::of(&Request { casters: &casters, lamp: &lamp, samples: &samples });
    let receivers = GpuCaster::upload(gpu, caster).expect("it fits");
    let drawn = receivers.samples(&projection, size, Depth::Plane).expect("they fit");
    let space = LightSpace::of_scene(&casters, &lamp, side).expect("it fits");
    let map = MapPass::new(gpu).and_then(|pass| pass.draw(&receivers, &space)).expect("it fits");
    let pass = HybridPass::new(gpu).expect("it compiles");
    let mark = || {
        let marked = pass.mark(&drawn, &map, 1).expect("it fits");
        wait(gpu);
        marked
    };
    // Only samples that face the lamp have a verdict to ask for.
    let ask = |marked: &[u32]| -> Vec<bool> {
        let is_dark = |&sample: &u32| {
            let hit = samples.hits()[sample as usize].as_ref();
            let hit = hit.filter(|_| truth.verdicts()[sample as usize].is_some());
            hit.is_some_and(|hit| casters.oracle().verdict(hit.point, lamp.light()) == Verdict::Shadowed)
        };
        marked.iter().map(is_dark).collect()
    };
    let marked = mark();
    let asked = marked.download(gpu).expect("it is there");
    let answers = ask(&asked);
    let count = format!("marked={}", asked.len());
    let quick = bench.quick;
    let wrong = |values: &[f32]| {
        let judged = truth.verdicts().iter().zip(values);
        let wrong = judged.filter(|(verdict, value)| {
            verdict.is_some_and(|verdict| {
                verdict != Verdict::Grazing && (**value >= 0.5) != (verdict == Verdict::Lit)
            })
        });
        let (wrong, most) = (wrong.count(), samples.len() / if quick { 50 } else { 500 });
        assert!(wrong <= most, "{wrong} samples are wrong, not {most}");
        "right".to_owned()
    };
    let contenders = vec![
        Contender::new("map asked, marks", || {
            timed(mark, |marked| format!("marked={}", marked.download(gpu).expect("it is there").len()))
        })
        .expects(count.clone()),
        Contender::new("marks read back", || {
            timed(|| marked.download(gpu).expect("it is there"), |found| format!("marked={}", found.len()))
        })
        .expects(count),
        Contender::new("exact rays of the marked, one thread", || {
            timed(
                || ask(&asked),
                |found| if *found == answers { "equal".to_owned() } else { "other".to_owned() },
            )
        })
        .expects("equal"),
        Contender::new("exact answers drawn", || {
            let frame = || {
                let visibility = pass.resolve(&marked, &asked, &answers).expect("it fits");
                wait(gpu);
                visibility
            };
            timed(frame, |visibility| wrong(&visibility.download(gpu).expect("it is there")))
        })
        .expects("right"),
    ];
    let mesh = format!("{} of {} triangles · {}", caster.mesh().name, caster.mesh().face_count(), gpu.name());
    bench.run(Group { stage: HYBRID, mesh: mesh.replace(',', " ·"), units: 1, unit: "frame", contenders });
}

/// Soft shadows from a map that is kept, on the processor and on the adapter. A search on the processor in a
/// map of the adapter has to read that back first.
fn soft(bench: &mut Bench<'_>, gpu: &Gpu, caster: &Caster) {
    let (width, height, side) = if bench.quick { (64, 48, 128) } else { (320, 240, 1024) };
    let size = Size::new(width, height).expect("in range");
    let casters = CasterGroup::new(vec![caster]);
    let camera = Camera::fit(&casters.bounds(), Up::Z, size.aspect());
    let projection = camera.projection(size, camera.near([caster.mesh()], size));
    let lamp: Lamp = "directional:0.7,0.2,-1,angle=2".parse().expect("a light");
    let samples = Samples::of_view(&casters, &projection, size, 1).expect("they fit");
    let receivers = GpuCaster::upload(gpu, caster).expect("it fits");
    let drawn = receivers.samples(&projection, size, Depth::Plane).expect("they fit");
    let space = LightSpace::of_scene(&casters, &lamp, side).expect("it fits");
    let map = MapPass::new(gpu).and_then(|pass| pass.draw(&receivers, &space)).expect("it fits");
    let (search, pcss) =
        (SearchPass::new(gpu).expect("it compiles"), PcssPass::new(gpu).expect("it compiles"));
    let prepared = search.prepare(&map, &lamp).expect("it fits");
    let single = SingleSampleOptions { size: side, ..SingleSampleOptions::DEFAULT };
    let closer = PcssOptions { size: side, ..PcssOptions::DEFAULT };
    let [single_on_cpu, closer_on_cpu] = [Technique::SingleSample(single), Technique::Pcss(closer)]
        .map(|technique| technique.prepare(&casters, &lamp).expect("it fits"));
    let [single_values, closer_values] =
        [&single_on_cpu, &closer_on_cpu].map(|prepared| prepared.shade(&samples));
    let quick = bench.quick;
    // At nearly all samples that face the lamp the same as on the processor.
    let right = |values: &[f32], own: &umbrage::shadow::Visibility| {
        let lit = own.values().iter().zip(values).zip(own.asked()).filter(|(_, asked)| **asked);
        let off = lit.clone().filter(|((own, value), _)| (*own - *value).abs() > 1.0 / 256.0).count();
        let all = lit.count();
        assert!(off * if quick { 10 } else { 50 } < all, "{off} of {all} samples are another value");
        "right".to_owned()
    };
    let depths = map.download(gpu, 0).expect("it is there").len();
    let contenders = vec![
        Contender::new("single-sample, on the processor", || {
            timed(|| single_on_cpu.shade(&samples), |found| right(found.values(), &single_values))
        })
        .expects("right"),
        Contender::new("single-sample, on the adapter", || {
            let frame = || {
                let visibility = search.visibility(&drawn, &map, &prepared).expect("it fits");
                wait(gpu);
                visibility
            };
            timed(frame, |found| right(&found.download(gpu).expect("it is there"), &single_values))
        })
        .expects("right"),
        Contender::new("map read back for the processor", || {
            timed(|| map.download(gpu, 0).expect("it is there"), |found| format!("depths={}", found.len()))
        })
        .expects(format!("depths={depths}")),
        Contender::new("pcss, on the processor", || {
            timed(|| closer_on_cpu.shade(&samples), |found| right(found.values(), &closer_values))
        })
        .expects("right"),
        Contender::new("pcss, on the adapter", || {
            let frame = || {
                let visibility = pcss.visibility(&drawn, &map, &prepared, &closer).expect("it fits");
                wait(gpu);
                visibility
            };
            timed(frame, |found| right(&found.download(gpu).expect("it is there"), &closer_values))
        })
        .expects("right"),
    ];
    let mesh = format!("{} of {} triangles · {}", caster.mesh().name, caster.mesh().face_count(), gpu.name());
    bench.run(Group { stage: SOFT, mesh: mesh.replace(',', " ·"), units: 1, unit: "frame", contenders });
}
