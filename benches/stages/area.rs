//! The visible fraction of an area light: analytic, and by exact rays.

use umbrage::mesh::{Mesh, Weld, weld};
use umbrage::oracle::area::{AreaLight, Receiver, SoftOracle};
use umbrage::scene::Scope;
use umbrage::testing::shapes;

use crate::measure::{Bench, Contender, Group, Scatter, Target, timed};

const STAGE: &str = "area light";

pub(crate) fn run(bench: &mut Bench<'_>) {
    if !bench.wants(STAGE) {
        return;
    }
    let mesh = bunny(bench.quick);
    let soft = SoftOracle::build(&mesh);
    let (bounds, size) = (soft.oracle().bounds(), soft.oracle().bounds().diagonal() as f32);
    let center = bounds.center();
    let light = |side: f32| {
        let corner = [center[0] + 0.4 * size, center[1] + 0.9 * size, center[2] + 0.6 * size];
        AreaLight::parallelogram(corner, [side * size, 0.0, 0.0], [0.0, 0.3 * side * size, -side * size])
            .expect("an area")
    };
    // A plane of points under the mesh, and what they see of the light.
    let mut scatter = Scatter(3);
    let count = if bench.quick { 300 } else { 20_000 };
    let plane: Vec<[f32; 3]> = (0..count)
        .map(|_| {
            let [x, _, z] = scatter.point(size);
            [center[0] + x, bounds.low[1], center[2] + z]
        })
        .collect();
    for (name, side, faces, target) in [
        ("about 130 faces", 0.1, 100..170, Target::Time(50_000.0)),
        ("about 1300 faces", 0.5, 1000..1600, Target::None),
    ] {
        let light = light(side);
        let seen: Vec<_> = plane.iter().map(|&p| soft.visible(p, &light).expect("below the light")).collect();
        let some = |wanted: &dyn Fn(usize) -> bool, most: usize| -> Vec<[f32; 3]> {
            (0..plane.len()).filter(|&i| wanted(i)).take(most).map(|i| plane[i]).collect()
        };
        let is_partly = |i: usize| seen[i].fraction > 0.02 && seen[i].fraction < 0.98;
        let penumbra = some(&|i| is_partly(i) && (bench.quick || faces.contains(&seen[i].faces)), 64);
        let lit = some(&|i| seen[i].faces == 0, 4096);
        let title = |kind: &str| format!("{} · {kind}", mesh.name);
        // The baseline errs by 5e-4; the analytic fraction by less than 1e-10.
        points(bench, title(&format!("penumbra, {name}")), &soft, &light, &penumbra, target);
        points(bench, title(&format!("fully lit, side {side}")), &soft, &light, &lit, Target::Time(300.0));
        batch(bench, title(&format!("plane, side {side}")), &soft, &light, &plane);
    }
}

/// A scanned bunny of 60 thousand triangles if the real meshes are available, otherwise a torus with as many.
fn bunny(quick: bool) -> Mesh {
    let folder = std::env::var("UMBRAGE_MESHES")
        .unwrap_or_else(|_| concat!(env!("CARGO_MANIFEST_DIR"), "/../shared/meshes").to_owned());
    let read = || {
        let scene = umbrage::read::read(format!("{folder}/bunny_hr.obj")).ok()?;
        let mesh = scene.bake(Scope::Mesh).ok()?.into_iter().next()?;
        Some(weld(&mesh, Weld::Exact).mesh.with_name("bunny"))
    };
    if quick {
        shapes::torus(40, 40, 2.0, 0.75)
    } else {
        read().unwrap_or_else(|| shapes::torus(173, 173, 2.0, 0.75))
    }
}

const RAYS: u32 = 4096;

fn points(
    bench: &mut Bench<'_>,
    mesh: String,
    soft: &SoftOracle<'_>,
    light: &AreaLight,
    points: &[[f32; 3]],
    target: Target,
) {
    if points.is_empty() {
        return;
    }
    // Six times the error of the rays.
    let noise = 6.0 * 0.4 * f64::from(RAYS).powf(-0.75);
    let truth: Vec<f64> =
        points.iter().map(|&p| soft.sampled(p, light, RAYS, 1).expect("below the light").fraction).collect();
    let apart = |found: &Vec<f64>| {
        let apart = found.iter().zip(&truth).filter(|(a, b)| (**a - **b).abs() > noise).count();
        format!("apart={apart}")
    };
    let contenders = vec![
        Contender::new("4096 exact rays", || {
            let cast = |&p: &[f32; 3]| soft.sampled(p, light, RAYS, 2).map_or(0.0, |found| found.fraction);
            timed(|| points.iter().map(cast).collect(), apart)
        })
        .expects("apart=0"),
        Contender::new("64 exact rays", || {
            let cast = |&p: &[f32; 3]| soft.sampled(p, light, 64, 2).map_or(0.0, |found| found.fraction);
            timed(|| points.iter().map(cast).collect::<Vec<f64>>(), |found| format!("points={}", found.len()))
        })
        .expects(format!("points={}", points.len())),
        Contender::new("SoftOracle::visible", || {
            let work = |&p: &[f32; 3]| soft.visible(p, light).map_or(0.0, |found| found.fraction);
            timed(|| points.iter().map(work).collect(), apart)
        })
        .expects("apart=0")
        .aims_at(target),
        Contender::new("the same, with the cosines", || {
            let facing = |p: [f32; 3]| Receiver::facing(p, [0.0, 1.0, 0.0]);
            let work = |&p: &[f32; 3]| soft.visible(facing(p), light).map_or(0.0, |found| found.fraction);
            timed(|| points.iter().map(work).collect(), apart)
        })
        .expects("apart=0"),
    ];
    bench.run(Group { stage: STAGE, mesh, units: points.len(), unit: "point", contenders });
}

fn batch(bench: &mut Bench<'_>, mesh: String, soft: &SoftOracle<'_>, light: &AreaLight, plane: &[[f32; 3]]) {
    let receivers: Vec<Receiver> = plane.iter().map(|&p| p.into()).collect();
    let single: Vec<_> = receivers.iter().map(|&receiver| soft.visible(receiver, light)).collect();
    let partly = single.iter().flatten().filter(|seen| seen.fraction > 0.0 && seen.fraction < 1.0).count();
    let same = |found: &Vec<_>| {
        assert!(*found == single, "an answer of many differs from that of one");
        format!("penumbra={partly}")
    };
    let contenders = vec![
        Contender::new("SoftOracle::visible", || {
            timed(|| receivers.iter().map(|&receiver| soft.visible(receiver, light)).collect(), same)
        }),
        Contender::new("SoftOracle::visible_into", || {
            let work = || {
                let mut found = vec![None; receivers.len()];
                soft.visible_into(&receivers, light, &mut found);
                found
            };
            timed(work, same)
        }),
    ];
    bench.run(Group { stage: STAGE, mesh, units: plane.len(), unit: "point", contenders });
}
