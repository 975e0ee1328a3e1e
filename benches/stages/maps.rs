//! Frames of a shadow map of 1024 × 1024 on a graphics adapter, beside other techniques on the same samples of
//! 640 × 480 pixels.

use umbrage::caster::{Caster, CasterGroup, GpuCaster};
use umbrage::gpu::Gpu;
use umbrage::mesh::Mesh;
use umbrage::oracle::Verdict;
use umbrage::scene::Lamp;
use umbrage::shadow::map::gpu::{GpuMap, Lookup, MapPass};
use umbrage::shadow::map::{Bias, Filter, LightSpace};
use umbrage::shadow::stencil::{StencilMethod, StencilPass};
use umbrage::shadow::{Depth, GpuVisibility, Request, Samples, Technique};
use umbrage::testing::shapes;
use umbrage::verify::errors::Truth;
use umbrage::view::{Camera, Size, Up};

use crate::gpu::wait;
use crate::measure::{Bench, Contender, Group, timed};

const STAGE: &str = "frames of a shadow map";

pub(crate) fn run(bench: &mut Bench<'_>) {
    if !bench.wants(STAGE) {
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
    frames(bench, &gpu, &Caster::new(mesh));
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
