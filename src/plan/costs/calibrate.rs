//! Calibration: each step is timed on generated scenes, and the coefficients are fitted.

use std::f64::consts::TAU;
use std::hint::black_box;
use std::time::{Duration, Instant};

use super::fit::fit;
use super::{CostKey, Costs, Step, Work};
use crate::caster::{Caster, CasterGroup};
use crate::light_grid::{Chain, GridVerdict, LightGrid};
use crate::mesh::Mesh;
use crate::oracle::Oracle;
use crate::plan::Evidence;
use crate::scene::Lamp;
use crate::shadow::{Request, Samples, Technique};
use crate::view::{Camera, Size, Up};

/// Time after which nothing new is measured: steps that are left keep their built-in costs.
const MOST: Duration = Duration::from_millis(1900);
/// Sizes of the views.
const SIZES: [[u32; 2]; 2] = [[96, 72], [224, 168]];
/// What each step is timed with, the cheapest first.
const TIMED: [(Step, &[&str]); 10] = [
    (Step::Plain, &["none"]),
    (Step::Rays, &["rays"]),
    (Step::Hybrid, &["hybrid:grid=64", "hybrid"]),
    (Step::AliasFree, &["alias-free"]),
    (Step::Map, &["map:size=256", "map", "pcf:size=512"]),
    (Step::Planar, &["planar"]),
    (Step::SoftMap, &["pcss:size=256", "vsm"]),
    (Step::Samples, &["samples:n=4", "samples:n=16"]),
    (Step::SoftHybrid, &["soft-hybrid:size=256"]),
    (Step::Counter, &["counter"]),
];

/// Scenes: a ring of 32, 1,600 and 20,480 faces over a floor.
fn scenes() -> [Mesh; 3] {
    [[4, 4], [40, 20], [160, 64]].map(|[rings, sides]| ring_over_floor(rings, sides))
}

/// A torus with radii 2 and 0.7 around the y axis, over a square.
fn ring_over_floor(rings: u32, sides: u32) -> Mesh {
    let turn = |i: u32, count: u32| (f64::from(i) * TAU / f64::from(count)).sin_cos();
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    for i in 0..rings {
        for j in 0..sides {
            let ((sin_u, cos_u), (sin_v, cos_v)) = (turn(i, rings), turn(j, sides));
            let out = 2.0 + 0.7 * cos_v;
            positions.push([out * sin_u, 0.7 * sin_v, out * cos_u].map(|x| x as f32));
            let [a, b] = [i, (i + 1) % rings].map(|ring| ring * sides);
            let next = (j + 1) % sides;
            triangles.extend([[a + j, b + j, b + next], [a + j, b + next, a + next]]);
        }
    }
    let first = rings * sides;
    positions.extend([[-6.0, -2.0, -6.0], [-6.0, -2.0, 6.0], [6.0, -2.0, 6.0], [6.0, -2.0, -6.0]]);
    triangles.extend([[0, 1, 2], [0, 2, 3]].map(|corners| corners.map(|corner| first + corner)));
    Mesh::new(positions, triangles).expect("a small mesh")
}

/// The least of three times of `work`, in nanoseconds.
fn least(mut work: impl FnMut()) -> f64 {
    let time = |()| {
        let start = Instant::now();
        work();
        start.elapsed().as_secs_f64() * 1e9
    };
    [(); 3].map(time).into_iter().fold(f64::INFINITY, f64::min)
}

/// The counts and times of each step.
#[derive(Default)]
struct Rows(Vec<Vec<(Vec<f64>, f64)>>);

impl Rows {
    fn add(&mut self, step: Step, work: &Work, threads: usize, time: f64) {
        self.0.resize_with(Step::ALL.len(), Vec::new);
        self.0[step as usize].push((step.counts(work, threads).collect(), time));
    }
}

impl Costs {
    /// Measures this machine, for about 2 s: the CPU techniques on three generated scenes and two sizes, each
    /// the least of three times, and fits what they cost. What was not reached in this time, and devices,
    /// keep the built-in costs.
    #[must_use]
    pub fn calibrate() -> Self {
        let (start, mut rows) = (Instant::now(), Rows::default());
        let key = CostKey::here();
        let built_in = Self::default();
        'all: for (index, [width, height]) in SIZES.into_iter().enumerate() {
            for mesh in scenes() {
                measure_parts(&mesh, &mut rows, key.threads);
                let caster = Caster::new(mesh);
                let casters = CasterGroup::new(vec![&caster]);
                let Some(samples) = view(&casters, width, height) else { continue };
                // The steps take turns in being left out where the time is short.
                for turn in 0..TIMED.len() {
                    let (step, techniques) = TIMED[(turn + index) % TIMED.len()];
                    for technique in techniques {
                        if start.elapsed() > MOST {
                            break 'all;
                        }
                        measure(step, technique, &casters, &samples, &mut rows, key.threads);
                    }
                }
            }
        }
        let mut coefficients = built_in.coefficients;
        for (step, of_step) in Step::ALL.into_iter().zip(&mut coefficients) {
            let rows = rows.0.get(step as usize).map_or(&[][..], Vec::as_slice);
            // Fewer rows than coefficients fit anything.
            if rows.len() >= of_step.len() {
                *of_step = fit(rows, of_step.len());
            }
        }
        Self { evidence: Evidence::Sampled, key, coefficients }
    }
}

fn view(casters: &CasterGroup<'_>, width: u32, height: u32) -> Option<Samples> {
    let size = Size::new(width, height).ok()?;
    let camera = Camera::fit(&casters.bounds(), Up::Y, size.aspect());
    let near = camera.near(casters.casters().iter().map(|caster| caster.mesh()), size);
    Samples::of_view(casters, &camera.projection(size, near), size, 1).ok()
}

fn measure_parts(mesh: &Mesh, rows: &mut Rows, threads: usize) {
    let work = Work { faces: mesh.face_count() as f64, ..Work::default() };
    rows.add(Step::Tree, &work, threads, least(|| drop(black_box(Oracle::build(mesh)))));
    let proofs = || {
        black_box(Caster::new(mesh.clone()).proofs().len());
    };
    rows.add(Step::Proofs, &work, threads, least(proofs));
}

fn measure(
    step: Step,
    technique: &str,
    casters: &CasterGroup<'_>,
    samples: &Samples,
    rows: &mut Rows,
    threads: usize,
) {
    let Ok(technique) = technique.parse::<Technique>() else { return };
    let lamp = if technique.is_soft() { "point:4,9,3,radius=0.3" } else { "point:4,9,3" };
    let Ok(lamp) = lamp.parse::<Lamp>() else { return };
    let request = Request { casters, lamp: &lamp, samples };
    // A first run, which also builds what is shared.
    let Ok(visibility) = technique.shade(&request) else { return };
    let parameter = |name: &str| -> Option<f64> {
        let parameters = technique.parameters();
        parameters.iter().find(|(key, _)| *key == name)?.1.parse().ok()
    };
    let facing = visibility.asked().iter().filter(|asked| **asked).count() as f64;
    let faces = casters.casters().iter().map(|caster| caster.mesh().face_count() as f64).sum();
    let side = parameter("grid").or_else(|| parameter("size")).unwrap_or(256.0);
    let unsure = match technique {
        Technique::Hybrid(options) => undecided(casters, &lamp, samples, options.grid),
        _ => visibility.asked_exactly() as f64,
    };
    let each = match technique {
        Technique::Samples(options) => f64::from(options.n),
        Technique::SoftHybrid(options) => f64::from(options.rays),
        _ => visibility.reads() as f64 / facing.max(1.0),
    };
    let work = Work { samples: samples.len() as f64, facing, faces, unsure, side, each };
    let time = least(|| drop(black_box(technique.shade(&request))));
    rows.add(step, &work, threads, time);
}

fn undecided(casters: &CasterGroup<'_>, lamp: &Lamp, samples: &Samples, side: u32) -> f64 {
    let chain = Chain::of(casters, lamp.light());
    let facing = || {
        let hits = samples.hits().iter().flatten();
        hits.filter(|hit| crate::shadow::is_front_lit(hit, lamp.light()))
    };
    let grid = LightGrid::build(&chain, facing().map(|hit| hit.point), side);
    facing().filter(|hit| grid.verdict(hit) == GridVerdict::Undecided).count() as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rings_of_the_calibration_are_closed_over_an_open_floor() {
        for mesh in scenes() {
            let caster = Caster::new(mesh);
            let counts = &caster.report().counts;
            // The floor has a boundary of four edges; nothing else has one.
            assert_eq!((counts.shells, counts.boundary_edges, counts.misoriented_edges), (2, 4, 0));
        }
    }

    #[test]
    #[ignore = "takes 2 s, and prints the table; cargo test --release --lib calibration -- --ignored --nocapture"]
    fn calibration_takes_two_seconds_and_gives_nothing_negative() {
        let start = Instant::now();
        let costs = Costs::calibrate();
        let seconds = start.elapsed().as_secs_f64();
        for step in Step::ALL {
            let coefficients = costs.coefficients(step);
            assert!(coefficients.iter().all(|ns| ns.is_finite() && *ns >= 0.0), "{}", step.name());
            let of_step = step.features().iter().zip(coefficients);
            let of_step: Vec<String> = of_step.map(|(name, ns)| format!("{name} {ns:.3}")).collect();
            eprintln!("{}: {}", step.name(), of_step.join(", "));
        }
        assert_eq!(costs.evidence, Evidence::Sampled);
        assert!(seconds < 10.0, "{seconds}");
    }
}
