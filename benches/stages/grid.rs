//! The light grid: its build, and hard shadows by grid and exact rays.

use std::hint::black_box;

use umbrage::caster::{Caster, CasterGroup};
use umbrage::light_grid::{Chain, GridVerdict, LightGrid};
use umbrage::mesh::{Mesh, Weld, weld};
use umbrage::oracle::{Oracle, Verdict};
use umbrage::scene::{Lamp, Scope};
use umbrage::shadow::{Request, Samples, Technique};
use umbrage::testing::shapes;
use umbrage::view::{Camera, Size, Up};

use crate::measure::{Bench, Contender, Group, timed};

const STAGE: &str = "light grid";

pub(crate) fn run(bench: &mut Bench<'_>) {
    if !bench.wants(STAGE) {
        return;
    }
    let torus = |n: u32| move || shapes::torus(n, n, 2.0, 0.75);
    let mut scenes = vec![on_slab(real("igea.glb"), torus(366)), on_slab(real("bunny_hr.obj"), torus(173))];
    scenes.push(on_slab(real("truck_shrec.obj"), || shapes::menger_sponge(3)));
    if bench.quick {
        scenes = vec![on_slab(None, torus(20)), on_slab(None, || shapes::menger_sponge(1))];
    }
    for mesh in scenes {
        scene(bench, &Caster::new(mesh));
    }
}

/// One of the real meshes, if they are available.
fn real(file: &str) -> Option<Mesh> {
    let folder = std::env::var("UMBRAGE_MESHES")
        .unwrap_or_else(|_| concat!(env!("CARGO_MANIFEST_DIR"), "/../shared/meshes").to_owned());
    let meshes = umbrage::read::read(format!("{folder}/{file}")).ok()?.bake(Scope::Mesh).ok()?;
    let mesh = Mesh::concat(&meshes).ok()?;
    Some(weld(&mesh, Weld::Exact).mesh.with_name(file))
}

/// A mesh on a slab five times as wide.
fn on_slab(mesh: Option<Mesh>, otherwise: impl Fn() -> Mesh) -> Mesh {
    let mesh = mesh.unwrap_or_else(otherwise);
    let [low, high] = mesh.bounds().expect("it has faces");
    let wide = (0..3).map(|i| high[i] - low[i]).fold(0.0, f32::max);
    let name = mesh.name.clone();
    let cube = shapes::cube();
    let slab = cube.positions().iter().map(|&[x, y, z]| {
        let [mid_x, mid_z] = [0, 2].map(|i| 0.5 * (low[i] + high[i]));
        [mid_x + 2.5 * wide * x, low[1] + 0.05 * wide * (y - 1.0), mid_z + 2.5 * wide * z]
    });
    let slab = Mesh::new(slab.collect(), cube.triangles().to_vec()).expect("finite");
    Mesh::concat(&[mesh, slab]).expect("they fit").with_name(name)
}

fn scene(bench: &mut Bench<'_>, caster: &Caster) {
    let size = if bench.quick { Size::new(64, 36) } else { Size::new(480, 270) }.expect("in range");
    let casters = CasterGroup::new(vec![caster]);
    let camera = Camera::fit(&casters.bounds(), Up::Y, size.aspect());
    let projection = camera.projection(size, camera.near([caster.mesh()], size));
    let samples = Samples::of_view(&casters, &projection, size, 1).expect("they fit");
    let lamp: Lamp = "directional:0.4,-1,0.3".parse().expect("a light");
    let request = Request { casters: &casters, lamp: &lamp, samples: &samples };
    let chain = Chain::of(&casters, lamp.light());
    let rays = Technique::Rays.shade(&request).expect("it needs no memory");
    let asked: Vec<usize> = (0..samples.len()).filter(|&index| rays.asked()[index]).collect();
    let hits = || asked.iter().filter_map(|&index| samples.hits()[index].as_ref());
    let grazes: Vec<bool> =
        hits().map(|hit| casters.oracle().verdict(hit.point, lamp.light()) == Verdict::Grazing).collect();
    let wrong = |values: &[f32]| {
        let differs = |(&index, grazes): (&usize, &bool)| !grazes && values[index] != rays.values()[index];
        let wrong = asked.iter().zip(&grazes).filter(|pair| differs(*pair)).count();
        format!("{wrong} wrong of {}", asked.len())
    };
    for side in [256, 1024] {
        let build = || LightGrid::build(&chain, hits().map(|hit| hit.point), side);
        let grid = build();
        let undecided = hits().filter(|hit| grid.verdict(hit) == GridVerdict::Undecided).count();
        let share = 100.0 * undecided as f64 / asked.len() as f64;
        let mesh = format!("{} · grid {side} · {share:.2} % undecided", caster.mesh().name);
        let pairs = format!("{} pairs", grid.pair_count());
        let contenders = vec![
            Contender::new("grid", || timed(build, |grid| format!("{} pairs", grid.pair_count())))
                .expects(pairs),
        ];
        let faces = caster.mesh().face_count();
        bench.run(Group { stage: STAGE, mesh: mesh.clone(), units: faces, unit: "face", contenders });
        let right = format!("0 wrong of {}", asked.len());
        let sorted: Technique = format!("alias-free:grid={side}").parse().expect("a technique");
        let sorted = sorted.prepare(&casters, &lamp).expect("it fits");
        let with_tree = || {
            black_box(Oracle::build(caster.mesh()));
            Technique::Rays.shade(&request).expect("as above")
        };
        let hybrid: Technique = format!("hybrid:grid={side}").parse().expect("a technique");
        let prepared = hybrid.prepare(&casters, &lamp).expect("it fits");
        let decide = || hits().filter(|hit| grid.verdict(hit) == GridVerdict::Undecided).count();
        let contenders = vec![
            Contender::new("exact rays", || {
                timed(|| Technique::Rays.shade(&request).expect("as above"), |found| wrong(found.values()))
            })
            .expects(right.clone()),
            Contender::new("hybrid: grid and exact rays", || {
                timed(|| prepared.shade(&samples), |found| wrong(found.values()))
            })
            .expects(right.clone()),
            Contender::new("exact rays with their tree", || timed(with_tree, |found| wrong(found.values())))
                .expects(right.clone()),
            Contender::new("alias-free: no tree", || {
                timed(|| sorted.shade(&samples), |found| wrong(found.values()))
            })
            .expects(right),
            Contender::new("verdicts of the grid alone", || {
                timed(decide, |count| format!("{count} undecided"))
            })
            .expects(format!("{undecided} undecided")),
        ];
        bench.run(Group { stage: STAGE, mesh, units: asked.len(), unit: "point", contenders });
    }
}
