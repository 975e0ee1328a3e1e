//! A scene of 80 objects and a light that moves in every frame: without shadows, with the volumes of everything,
//! and with what the planner picks; on one graphics adapter, which the rows name. And what the planner leaves out
//! in a city.
//!
//! The scene is that of Zerari, *Volume d'ombre en rendu temps réel*, 2011: 200,000 triangles in all.

use std::cell::Cell;
use std::fmt::Write;
use std::time::Duration;

use umbrage::caster::{Caster, CasterGroup, GpuCaster};
use umbrage::facing::CasterFaces;
use umbrage::gpu::Gpu;
use umbrage::mesh::Mesh;
use umbrage::plan::{Budget, Costs, Scenery, ShadowPlan, Task, plan, run as run_tasks};
use umbrage::scene::Lamp;
use umbrage::shadow::stencil::{
    Counting, ReceiverTiles, ShadowMask, StencilMethod, StencilPass, StencilVolumes,
};
use umbrage::shadow::{Depth, Request, Samples, Technique};
use umbrage::testing::scenes::{City, Place, city};
use umbrage::testing::shapes;
use umbrage::view::{Camera, Projection, Size, Up};

use crate::measure::{Bench, Contender, Group, timed};

/// Objects, in rows of ten.
const OBJECTS: u16 = 80;

/// Positions through which the light moves: the frames of one run.
const PLACES: u8 = 4;

pub(crate) fn run(bench: &mut Bench<'_>) {
    if bench.wants("80 objects") {
        match Gpu::new(None) {
            Ok(gpu) => objects(bench, &gpu),
            Err(error) => eprintln!("SKIPPED, stage 80 objects: {error}"),
        }
    }
    if bench.wants("plans of a city") {
        plans(bench);
    }
}

/// 80 closed objects, 2500 triangles each or 100, on a floor.
fn scene(quick: bool) -> Mesh {
    let object = |i: u16| {
        let [x, z] = [i % 10, i / 10].map(|at| 3.0 * f32::from(at));
        let mesh = match (i % 2, quick) {
            (0, false) => shapes::torus(50, 25, 1.0, 0.4),
            (_, false) => shapes::torus_knot(2, 3, 125, 10, 0.2),
            (0, true) => shapes::torus(10, 5, 1.0, 0.4),
            (_, true) => shapes::torus_knot(2, 3, 25, 2 + 1, 0.2),
        };
        shapes::translated(&mesh, [x - 13.5, 1.0 + 0.1 * f32::from(i % 7), z - 10.5])
    };
    let floor = shapes::cuboid([-20.0, -2.5, -16.0], [20.0, -2.0, 16.0]);
    Mesh::concat(&(0..OBJECTS).map(object).chain([floor]).collect::<Vec<_>>()).expect("they fit")
}

/// One picture of the scene, and what it is drawn with.
struct Stage<'a> {
    caster: &'a Caster,
    casters: CasterGroup<'a>,
    receivers: GpuCaster,
    pass: StencilPass,
    projection: Projection,
    size: Size,
    samples: Samples,
    lamps: Vec<Lamp>,
    /// Whether each sample is dark by exact rays, for each lamp; `None` where nothing faces it.
    truth: Vec<Vec<Option<bool>>>,
}

impl<'a> Stage<'a> {
    fn new(gpu: &Gpu, caster: &'a Caster, quick: bool) -> Self {
        let casters = CasterGroup::new(vec![caster]);
        let size = if quick { Size::new(96, 64) } else { Size::new(640, 480) }.expect("in range");
        let camera = Camera::look_at([18.0, 12.0, 22.0], [0.0, -1.0, 0.0], 0.8, Up::Y).expect("apart");
        let projection = camera.projection(size, camera.near([caster.mesh()], size));
        let samples = Samples::of_view(&casters, &projection, size, 1).expect("they fit");
        let lamp = |place: u8| format!("point:{},14,{}", 3.0 * f32::from(place) - 4.0, 6 - place);
        let lamps: Vec<Lamp> = (0..PLACES).map(|place| lamp(place).parse().expect("a light")).collect();
        let truth = lamps.iter().map(|lamp| {
            let request = Request { casters: &casters, lamp, samples: &samples };
            let rays = Technique::Rays.shade(&request).expect("it needs no memory");
            let pairs = rays.values().iter().zip(rays.asked());
            pairs.map(|(&value, &asked)| asked.then_some(value == 0.0)).collect()
        });
        Self {
            truth: truth.collect(),
            receivers: GpuCaster::upload(gpu, caster).expect("it fits"),
            pass: StencilPass::new(gpu, Depth::Plane).expect("it compiles"),
            caster,
            projection,
            size,
            samples,
            lamps,
            casters,
        }
    }

    /// Of the samples that face a lamp, those that are not what exact rays say.
    fn wrong(&self, lamp: usize, dark: impl Fn(usize) -> bool) -> usize {
        let samples = self.truth[lamp].iter().enumerate();
        samples.filter(|&(index, truth)| truth.is_some_and(|truth| truth != dark(index))).count()
    }

    fn wrong_in(&self, lamp: usize, mask: &ShadowMask) -> usize {
        self.wrong(lamp, |index| mask.raw()[index] != 0)
    }

    /// The depth of what is seen, and nothing else.
    fn depth_alone(&self) -> ShadowMask {
        let mask = self.pass.mask(&self.projection, self.size, &self.receivers, &[], Counting::Stencil);
        mask.expect("it draws")
    }

    fn volumes(&self, lamp: usize, method: Option<StencilMethod>) -> StencilVolumes {
        let (light, faces) = (self.lamps[lamp].light(), Some(CasterFaces::All));
        self.caster.stencil_volumes(light, &self.projection, faces, method)
    }

    /// The volumes of everything by z-fail.
    fn brute(&self, lamp: usize) -> ShadowMask {
        let volumes = self.volumes(lamp, Some(StencilMethod::ZFail));
        let uploaded = volumes.upload(self.pass.gpu()).expect("it fits");
        let (draws, counting) = (uploaded.draws(), volumes.counting());
        let mask = self.pass.mask(&self.projection, self.size, &self.receivers, &draws, counting);
        mask.expect("it draws")
    }

    /// Each object by the method that suits it, where it may count.
    fn scissored(&self, lamp: usize) -> ShadowMask {
        let volumes = self.volumes(lamp, None);
        let uploaded = volumes.upload_in_pieces(self.pass.gpu(), self.caster).expect("it fits");
        let pass = self.pass.within(ReceiverTiles::facing(&self.samples, self.lamps[lamp].light()));
        let (draws, counting) = (uploaded.draws(), volumes.counting());
        pass.mask(&self.projection, self.size, &self.receivers, &draws, counting).expect("it draws")
    }

    /// The plan of one lamp, run; and the number of wrong samples.
    fn planned(&self, lamp: usize, costs: &Costs, name: &str) -> (ShadowPlan, usize) {
        let lamps = &self.lamps[lamp..=lamp];
        let mut scenery = Scenery::new(&self.casters, lamps, &self.samples);
        (scenery.device, scenery.frames) = (Some(name), PLACES.into());
        let found = plan(&scenery, &Budget::default(), costs);
        let group = &found.lamps[0].groups[0];
        if group.on_device {
            let mask = self.scissored(lamp);
            return (found, self.wrong_in(lamp, &mask));
        }
        let _ = self.depth_alone();
        let runs = run_tasks(&self.casters, lamps, &self.samples, &Task::of(&found)).expect("it fits");
        let values = runs[0].visibility.values();
        let wrong = self.wrong(lamp, |index| values[index] == 0.0);
        (found, wrong)
    }
}

fn objects(bench: &mut Bench<'_>, gpu: &Gpu) {
    let caster = Caster::new(scene(bench.quick));
    let stage = Stage::new(gpu, &caster, bench.quick);
    let costs = if bench.quick { Costs::default() } else { Costs::calibrate() };
    let all = || 0..usize::from(PLACES);
    let dark: usize = stage.truth.iter().flatten().filter(|truth| **truth == Some(true)).count();
    let answer = |wrong: &usize| format!("{wrong} off");
    let picked = Cell::new("");
    let name = gpu.name();
    let contenders = vec![
        Contender::new("no shadows", || {
            timed(|| all().map(|lamp| stage.wrong_in(lamp, &stage.depth_alone())).sum(), answer)
        })
        .expects(answer(&dark)),
        Contender::new("the volumes of everything", || {
            timed(|| all().map(|lamp| stage.wrong_in(lamp, &stage.brute(lamp))).sum(), answer)
        }),
        Contender::new("each object where it may count", || {
            timed(|| all().map(|lamp| stage.wrong_in(lamp, &stage.scissored(lamp))).sum(), answer)
        }),
        Contender::new("what the planner picks", || {
            let frame = |lamp: usize| {
                let (found, wrong) = stage.planned(lamp, &costs, &name);
                picked.set(found.lamps[0].groups[0].technique.name());
                wrong
            };
            timed(|| all().map(frame).sum(), answer)
        }),
    ];
    let faces = caster.mesh().face_count() - 12;
    let mesh = format!("{faces} triangles, {name}");
    let first = bench.rows.len();
    bench.run(Group { stage: "80 objects", mesh, units: PLACES.into(), unit: "frame", contenders });
    let rows = &bench.rows[first..];
    let off = |row: usize| rows[row].answer.split(' ').next().and_then(|off| off.parse::<usize>().ok());
    // Every exact technique is right; a rasterizer may be off by its footprint, along edges.
    assert!(dark > 0 && off(0) == Some(dark), "{dark}");
    for row in 1..rows.len() {
        assert!(
            off(row).is_some_and(|off| 20 * off < dark),
            "{}: {} of {dark}",
            rows[row].name,
            rows[row].answer
        );
    }
    let mut text = format!("\nframes per second on {name} ({dark} dark samples in {PLACES} frames):\n");
    for row in rows {
        let _ = writeln!(text, "  {:32} {:8.2}  {}", row.name, 1e9 / row.median, row.answer);
    }
    let _ = writeln!(text, "  the planner picked {}", picked.get());
    let _ = crate::report::print(&text);
}

/// Plans of a city of 565 casters: what they leave out, and the processor's time.
fn plans(bench: &mut Bench<'_>) {
    let city = city(7, 565);
    let caster = Caster::new(city.scene());
    let casters = CasterGroup::new(vec![&caster]);
    let size = if bench.quick { Size::new(96, 54) } else { Size::new(960, 540) }.expect("in range");
    let mut text = format!(
        "\nplans of a city of {} casters, {}×{}:\n  {:7} {:11} {:>7} {:>14} {:>12}  technique\n",
        city.casters.len(),
        size.width(),
        size.height(),
        "from",
        "lamp",
        "dropped",
        "processor ms",
        "wrong",
    );
    for place in Place::ALL {
        for (lamp, name) in city.lamps().iter().zip(["high sun", "low sun", "street lamp"]) {
            text += &row_of(bench, &city, &casters, size, place, (lamp, name));
        }
    }
    let _ = crate::report::print(&text);
}

fn row_of(
    bench: &mut Bench<'_>,
    city: &City,
    casters: &CasterGroup<'_>,
    size: Size,
    place: Place,
    (lamp, name): (&Lamp, &str),
) -> String {
    let camera = city.camera(place);
    let projection = camera.projection(size, camera.near([casters.casters()[0].mesh()], size));
    let samples = Samples::of_view(casters, &projection, size, 1).expect("they fit");
    let lamps = std::slice::from_ref(lamp);
    let mut scenery = Scenery::new(casters, lamps, &samples);
    scenery.thorough = true;
    let before = processor_time();
    let found = plan(&scenery, &Budget::default(), &Costs::default());
    let time = before.zip(processor_time()).map(|(before, after)| after.saturating_sub(before));
    let runs = run_tasks(casters, lamps, &samples, &Task::of(&found)).expect("it fits");
    let request = Request { casters, lamp, samples: &samples };
    let truth = Technique::Rays.shade(&request).expect("it needs no memory");
    let pairs = truth.values().iter().zip(runs[0].visibility.values());
    let wrong = pairs.filter(|(truth, value)| truth != value).count();
    assert_eq!(wrong, 0, "{} {name}", place.name());
    let lamp_plan = &found.lamps[0];
    let dropped = lamp_plan.pieces - lamp_plan.kept.len();
    assert!(place != Place::Street || 2 * dropped > lamp_plan.pieces, "{dropped} of {}", lamp_plan.pieces);
    let answer = |plan: &ShadowPlan| format!("{} dropped", plan.lamps[0].pieces - plan.lamps[0].kept.len());
    let again = || timed(|| plan(&scenery, &Budget::default(), &Costs::default()), answer);
    let contenders = vec![Contender::new("plan", again).expects(format!("{dropped} dropped"))];
    let mesh = format!("{}, {name}", place.name());
    bench.run(Group { stage: "plans of a city", mesh, units: 1, unit: "plan", contenders });
    let time = time.map_or("not known".to_owned(), |time| format!("{:.1}", 1e3 * time.as_secs_f64()));
    let technique = lamp_plan.groups[0].technique;
    format!("  {:7} {name:11} {dropped:>7} {time:>14} {wrong:>12}  {technique}\n", place.name())
}

/// What all threads have had of the processor, where the system tells it.
fn processor_time() -> Option<Duration> {
    let tasks = std::fs::read_dir("/proc/self/task").ok()?;
    let of = |task: std::io::Result<std::fs::DirEntry>| {
        let text = std::fs::read_to_string(task.ok()?.path().join("schedstat")).ok()?;
        text.split(' ').next()?.parse::<u64>().ok()
    };
    Some(Duration::from_nanos(tasks.filter_map(of).sum()))
}
