//! From a request to pictures: visible points, the visibility of each lamp, the truth, lines.

use std::sync::OnceLock;
use std::time::Instant;

use umbrage::caster::CasterGroup;
use umbrage::facing::CasterFaces;
use umbrage::gpu::Gpu;
use umbrage::mesh::FaceId;
use umbrage::plan::{Budget, Costs, Scenery, ShadowPlan, Task, plan, run as run_tasks};
use umbrage::render::{CLAY, Ground, Knowledge, Picture, ShadedLight, View, render_samples};
use umbrage::scene::{Lamp, LampShape};
use umbrage::shadow::{Claim, Prepared, Request as Asked, Samples, Technique, Visibility};
use umbrage::verify::errors::{Errors, Made, Truth};
use umbrage::view::{Camera, Size};

use super::colors;
use super::defects::Defects;
use super::device::{self, Device};
use super::orbit;
use super::state::{Layer, Mode, OwnLamp, Request};
use super::strokes::{Canvas, Stroke};
use crate::cli::input::Source;
use crate::cli::plan::{as_drawn, known};
use crate::cli::render::colors as base_colors;
use crate::cli::{Failure, output};

/// What was asked for, drawn.
pub(super) struct Answer {
    pub(super) request: Request,
    pub(super) picture: Picture,
    /// The same with the truth, if it was asked for.
    pub(super) truth: Option<Picture>,
    pub(super) strokes: Vec<Stroke>,
    pub(super) spots: Vec<Stroke>,
    /// One for each lamp that is on.
    pub(super) lamps: Vec<Shown>,
    pub(super) plan: Option<Plan>,
    /// What was done, and how many milliseconds it took.
    pub(super) stages: Vec<(String, f64)>,
    /// What the colors of the picture mean.
    pub(super) legend: Option<String>,
}

/// What is known of the shadow of a lamp.
pub(super) struct Shown {
    /// The number of the lamp.
    pub(super) lamp: usize,
    pub(super) technique: String,
    pub(super) claim: Claim,
    /// The adapter, if the CPU did not do it.
    adapter: Option<String>,
    /// Against the truth, if that was asked for.
    pub(super) errors: Option<Errors>,
}

/// What the planner says.
pub(super) struct Plan {
    pub(super) rows: Vec<PlanRow>,
    pub(super) planning_ms: f64,
}

pub(super) struct PlanRow {
    pub(super) lamp: usize,
    pub(super) technique: String,
    pub(super) reason: String,
    /// Techniques that were not chosen, and why.
    pub(super) rejected: Vec<(String, String)>,
}

/// A scene with all that stays while only camera and lamps change.
pub(super) struct Stage<'a> {
    source: &'a Source,
    ground: Option<Ground>,
    /// Whether the lamps keep the ratio that the file gives them.
    is_balanced: bool,
    casters: &'a CasterGroup<'a>,
    colors: Vec<[f32; 3]>,
    device: Option<Device>,
    seen: Option<Seen>,
    prepared: Vec<(Lamp, Prepared<'a>)>,
    has_trees: bool,
}

/// The visible points of the last view.
struct Seen {
    camera: Camera,
    size: Size,
    per_side: u32,
    samples: Samples,
}

/// A clock of stages.
struct Clock {
    start: Instant,
    stages: Vec<(String, f64)>,
}

impl Clock {
    fn new() -> Self {
        Self { start: Instant::now(), stages: Vec::new() }
    }

    /// Ends a stage; how many milliseconds it took.
    fn stage(&mut self, name: impl Into<String>) -> f64 {
        let ms = self.start.elapsed().as_secs_f64() * 1e3;
        self.stages.push((name.into(), ms));
        self.start = Instant::now();
        ms
    }
}

/// The name of the stage that happens once for a scene, and not again for each picture.
pub(super) const ONCE: &str = "ray trees, once";

impl<'a> Stage<'a> {
    /// `casters` are those of `source`.
    pub(super) fn new(
        source: &'a Source,
        casters: &'a CasterGroup<'a>,
        ground: Option<Ground>,
        is_balanced: bool,
        gpu: Option<&Gpu>,
    ) -> Self {
        let colors = base_colors(source.seen().mesh(), &source.materials);
        let device = gpu.and_then(|gpu| match Device::new(gpu, source.seen()) {
            Ok(device) => Some(device),
            Err(error) => {
                output::say(format_args!("note: stencil passes are counted on the CPU: {error}"));
                None
            }
        });
        let prepared = Vec::new();
        Self { source, ground, is_balanced, casters, colors, device, seen: None, prepared, has_trees: false }
    }

    /// Draws a request; `None` as soon as it `is_stale`.
    pub(super) fn draw(
        &mut self,
        request: &Request,
        defects: &OnceLock<Defects>,
        is_stale: &dyn Fn() -> bool,
    ) -> Result<Option<Answer>, Failure> {
        let mut clock = Clock::new();
        if !self.has_trees {
            let _ = (self.casters.oracle(), self.casters.seen());
            self.has_trees = true;
            clock.stage(ONCE);
        }
        self.look(request)?;
        // Taken out, so that techniques can be kept meanwhile.
        let seen = self.seen.take().expect("it was just looked");
        let answer = self.draw_seen(request, &seen.samples, defects, is_stale, clock);
        self.seen = Some(seen);
        answer
    }

    /// The visible points of the request's view, unless it is the last one.
    fn look(&mut self, request: &Request) -> Result<(), Failure> {
        let (camera, size, per_side) = (request.camera, request.size, request.quality.per_side());
        let is_last = |seen: &Seen| seen.camera == camera && seen.size == size && seen.per_side == per_side;
        if self.seen.as_ref().is_some_and(is_last) {
            return Ok(());
        }
        let projection = camera.projection(size, camera.near([self.source.seen().mesh()], size));
        let last = self.seen.take().filter(|seen| seen.size == size && seen.per_side == per_side);
        let samples = match last {
            // Between two pictures of a movement, most points are of the same face.
            Some(last) => {
                let expected: Vec<Option<FaceId>> =
                    last.samples.hits().iter().map(|hit| hit.map(|hit| hit.face)).collect();
                Samples::of_view_expecting(self.casters, &projection, size, per_side, &expected)
            }
            None => Samples::of_view(self.casters, &projection, size, per_side),
        };
        let samples = samples.map_err(|error| Failure::new(error, "make the window smaller"))?;
        self.seen = Some(Seen { camera, size, per_side, samples });
        Ok(())
    }

    fn draw_seen(
        &mut self,
        request: &Request,
        samples: &Samples,
        defects: &OnceLock<Defects>,
        is_stale: &dyn Fn() -> bool,
        mut clock: Clock,
    ) -> Result<Option<Answer>, Failure> {
        clock.stage("visible points");
        if is_stale() {
            return Ok(None);
        }
        let on: Vec<usize> = (0..request.lamps.len()).filter(|&lamp| request.lamps[lamp].is_on).collect();
        let lamps: Vec<Lamp> = on.iter().map(|&lamp| request.lamps[lamp].lamp.clone()).collect();
        let mut shaded = match self.is_balanced {
            true => ShadedLight::balanced(&lamps, &self.source.bounds),
            false => ShadedLight::equal(&lamps),
        };
        let plan = self.plan(request, samples, &as_drawn(&lamps, &shaded), &on, &mut clock);
        if is_stale() {
            return Ok(None);
        }
        let mut shown: Vec<Shown> = Vec::new();
        let mut visibility = Vec::new();
        let mut texels = Vec::new();
        for (index, &lamp) in on.iter().enumerate() {
            let task = plan.as_ref().and_then(|(plan, _)| Task::of(plan).into_iter().nth(index));
            let asked = request.lamps[lamp].technique;
            let (found, texel, about) = self.shade(lamp, &lamps[index], asked, task, samples)?;
            let place = about.adapter.as_ref().map_or(String::new(), |name| format!(" on {name}"));
            clock.stage(format!("light {}: {}{place}", lamp + 1, about.technique));
            shaded[index].shadow = asked != Some(Technique::None);
            visibility.push(found);
            texels.push(texel);
            shown.push(about);
            if is_stale() {
                return Ok(None);
            }
        }
        let mut truths = Vec::new();
        if request.needs_truth() {
            for (index, lamp) in lamps.iter().enumerate() {
                let asked = Asked { casters: self.casters, lamp, samples };
                let truth = Truth::of(&asked);
                let is_soft = request.lamps[on[index]].technique.is_none_or(Technique::is_soft);
                let made = Made { texel: texels[index], is_soft, ..Made::default() };
                shown[index].errors = Some(Errors::of(&asked, &visibility[index], &truth, &made));
                truths.push(visibility_of(&truth, samples, lamp));
                clock.stage(format!("light {}: truth", on[index] + 1));
                if is_stale() {
                    return Ok(None);
                }
            }
        }
        let (picture, truth, legend) = self.pictures(request, samples, &shaded, &visibility, &truths, &on)?;
        clock.stage("shading");
        let mut canvas = Canvas::new(samples, orbit::size(&self.source.bounds));
        self.lines(request, &mut canvas, defects);
        let Canvas { strokes, spots, .. } = canvas;
        if !(strokes.is_empty() && spots.is_empty()) {
            clock.stage("lines");
        }
        Ok(Some(Answer {
            request: request.clone(),
            picture,
            truth,
            strokes,
            spots,
            lamps: shown,
            plan: plan.map(|(plan, planning_ms)| said(&plan, planning_ms, &on)),
            stages: clock.stages,
            legend,
        }))
    }

    /// What the planner chooses, where a lamp leaves it the choice, or the picture is fine enough to tell.
    fn plan(
        &self,
        request: &Request,
        samples: &Samples,
        lamps: &[Lamp],
        on: &[usize],
        clock: &mut Clock,
    ) -> Option<(ShadowPlan, f64)> {
        let is_left = on.iter().any(|&lamp| request.lamps[lamp].technique.is_none());
        let sees = samples.hits().iter().any(Option::is_some);
        if !sees || lamps.is_empty() || !(is_left || request.quality.is_fine()) {
            return None;
        }
        let mut scenery = Scenery::new(self.casters, lamps, samples);
        scenery.has_tree = true;
        let plan = plan(&scenery, &Budget::default(), &Costs::default());
        let ms = clock.stage("plan");
        Some((plan, ms))
    }

    /// The visibility of a lamp, the texel of its map, and what there is to say of it.
    fn shade(
        &mut self,
        number: usize,
        lamp: &Lamp,
        technique: Option<Technique>,
        task: Option<Task>,
        samples: &Samples,
    ) -> Result<(Visibility, Option<f64>, Shown), Failure> {
        let shown = |technique: String, adapter: Option<String>, visibility: &Visibility| Shown {
            lamp: number,
            technique,
            claim: visibility.claim(),
            adapter,
            errors: None,
        };
        let Some(technique) = technique else {
            // Where nothing is seen there is no plan.
            let task = task.unwrap_or_else(|| Task::new(Technique::Rays));
            let names: Vec<String> = task.groups.iter().map(|(_, technique)| technique.to_string()).collect();
            let runs = run_tasks(self.casters, std::slice::from_ref(lamp), samples, &[task])?;
            let run = runs.into_iter().next().expect("one run for one lamp");
            let about = shown(format!("auto: {}", names.join(" and ")), None, &run.visibility);
            return Ok((run.visibility, None, about));
        };
        let technique = crate::cli::search::on_cpu(technique);
        if let (Some(device), Some(method)) = (&self.device, device::method(technique)) {
            match device.visibility(self.casters, lamp, samples, method) {
                Ok(found) => {
                    let about = shown(technique.to_string(), Some(output::plain(&device.name())), &found);
                    return Ok((found, None, about));
                }
                Err(umbrage::gpu::GpuError::NotBuilt(_)) => {}
                Err(error) => return Err(error.into()),
            }
        }
        let at = (self.prepared.iter())
            .position(|(other, prepared)| other == lamp && prepared.technique() == technique);
        let at = match at {
            Some(at) => at,
            None => {
                // Those of the last pictures are kept: one for each lamp, while only the camera moves.
                let keep = KEPT.min(self.prepared.len());
                self.prepared.drain(..self.prepared.len() - keep);
                self.prepared.push((lamp.clone(), technique.prepare(self.casters, lamp)?));
                self.prepared.len() - 1
            }
        };
        let prepared = &self.prepared[at].1;
        let found = prepared.shade(samples);
        let about = shown(technique.to_string(), None, &found);
        Ok((found, prepared.texel_world(), about))
    }
}

/// How many techniques stay prepared.
const KEPT: usize = 7;

impl Stage<'_> {
    /// The picture, that of the truth, and what the colors mean.
    fn pictures(
        &self,
        request: &Request,
        samples: &Samples,
        shaded: &[ShadedLight],
        visibility: &[Visibility],
        truths: &[Visibility],
        on: &[usize],
    ) -> Result<(Picture, Option<Picture>, Option<String>), Failure> {
        let paint = |face: FaceId| self.colors.get(face.index()).copied().unwrap_or(CLAY);
        let view = View {
            camera: request.camera,
            size: request.size,
            lamps: shaded,
            casters: None,
            up: self.source.up,
            ground: self.ground,
            paint: &paint,
            edge_samples: samples.per_side(),
            ambient: None,
        };
        let too_large = |error| Failure::new(error, "make the window smaller");
        let mut picture = render_samples(samples, &view, visibility).map_err(too_large)?;
        let mut truth = None;
        if request.shows(Layer::Truth) {
            // What is drawn without shadows has them in truth.
            let shaded: Vec<ShadedLight> =
                shaded.iter().map(|lamp| ShadedLight { shadow: true, ..*lamp }).collect();
            let view = View { lamps: &shaded, ..view };
            truth = Some(render_samples(samples, &view, truths).map_err(too_large)?);
        }
        let chosen = on.iter().position(|&lamp| lamp == request.chosen);
        let mut legend = None;
        match (request.mode, chosen) {
            (Mode::Difference, Some(index)) => {
                let own = &request.lamps[request.chosen];
                let is_hard = !own.lamp.has_extent();
                let pair = [&visibility[index], &truths[index]];
                colors::difference(&mut picture, samples, self.casters, own.lamp.light(), pair, is_hard);
                legend = Some(match is_hard {
                    true => {
                        "orange: falsely lit; blue: falsely dark; yellow: only grazed; gray: right".to_owned()
                    }
                    false => {
                        "orange: too much light; blue: too little; full color from a quarter of the light on"
                            .to_owned()
                    }
                });
            }
            (Mode::Grid, _) => {
                let lamps: Vec<Lamp> = on.iter().map(|&lamp| request.lamps[lamp].lamp.clone()).collect();
                let all = known(self.casters, &lamps, samples);
                colors::paint_known(&mut picture, samples, &all);
                legend = Some(words_of(&all));
            }
            _ => {}
        }
        // False colors have a meaning already.
        if let (true, Some(_)) = (request.shows(Layer::Caps) && request.mode == Mode::Picture, chosen) {
            let light = *request.lamps[request.chosen].lamp.light();
            colors::tint_caps(&mut picture, samples, &self.source.caster.facing(&light));
        }
        Ok((picture, truth, legend))
    }

    /// The lines of the layers that are shown.
    fn lines(&self, request: &Request, canvas: &mut Canvas<'_>, defects: &OnceLock<Defects>) {
        let caster = &self.source.caster;
        let lamp = request.lamps.get(request.chosen).filter(|own| own.is_on);
        if let Some(own) = lamp
            && (request.shows(Layer::Silhouette) || request.shows(Layer::Volume))
        {
            let light = own.lamp.light();
            let silhouette = caster.silhouette(light, CasterFaces::All);
            let (mesh, topology) = (caster.mesh(), caster.topology());
            if request.shows(Layer::Volume) {
                let diagonal = orbit::size(&self.source.bounds);
                canvas.volume(mesh, topology, &silhouette, light, diagonal);
            }
            if request.shows(Layer::Silhouette) {
                canvas.silhouette(mesh, topology, &silhouette);
            }
        }
        if let (true, Some(defects)) = (request.shows(Layer::Defects), defects.get()) {
            for &(ends, color) in &defects.lines {
                canvas.line(ends, color);
            }
            for &(at, color) in &defects.spots {
                canvas.spot(at, color);
            }
        }
    }
}

/// The truth as values at the samples.
fn visibility_of(truth: &Truth, samples: &Samples, lamp: &Lamp) -> Visibility {
    use umbrage::oracle::Verdict;
    let value = |index: usize, verdict: &Option<Verdict>| match (verdict, truth.fractions()) {
        (None, _) => 0.0,
        (Some(_), Some(fractions)) => fractions[index].visible.clamp(0.0, 1.0) as f32,
        (Some(Verdict::Shadowed), None) => 0.0,
        (Some(_), None) => 1.0,
    };
    let values = truth.verdicts().iter().enumerate().map(|(index, verdict)| value(index, verdict)).collect();
    Visibility::from_values(samples, lamp.light(), values, Claim::Exact)
}

/// A plan in words; `on` are the numbers of its lamps.
fn said(plan: &ShadowPlan, planning_ms: f64, on: &[usize]) -> Plan {
    let rows = plan.lamps.iter().flat_map(|lamp| {
        lamp.groups.iter().map(|group| PlanRow {
            lamp: on[lamp.lamp],
            technique: group.technique.to_string(),
            reason: group.reason.clone(),
            rejected: group.rejected.iter().map(|it| (it.technique.to_string(), it.why.clone())).collect(),
        })
    });
    Plan { rows: rows.collect(), planning_ms }
}

/// What the colors mean, and the share of the samples that has each.
fn words_of(all: &[Knowledge]) -> String {
    let words = |known: &Knowledge| {
        let count = all.iter().filter(|other| *other == known).count();
        let percent = 100.0 * count as f64 / all.len() as f64;
        (count > 0).then(|| format!("{}: {} ({percent:.1} %)", known.color().0, known.name()))
    };
    Knowledge::ALL.iter().filter_map(words).collect::<Vec<_>>().join("; ")
}

/// A lamp as the panel names it: its kind, its name, and its technique.
pub(super) fn label(own: &OwnLamp) -> String {
    let lamp = &own.lamp;
    let kind = match (&lamp.shape, lamp.cone) {
        (LampShape::Rectangle(_), _) => "rectangle",
        (_, Some(_)) => "spot",
        _ if lamp.light().is_directional() => "directional",
        _ => "point",
    };
    let name = if lamp.name.is_empty() { String::new() } else { format!(" {}", output::short(&lamp.name)) };
    let technique = own.technique.map_or("auto", Technique::name);
    format!("{kind}{name}: {technique}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::window::pace::{Pace, Quality};
    use crate::cli::window::state::State;
    use umbrage::caster::Caster;
    use umbrage::geom::Aabb;
    use umbrage::mesh::Mesh;
    use umbrage::testing::shapes;
    use umbrage::view::Up;

    fn source() -> Source {
        let floor = shapes::translated(&shapes::scaled(&shapes::sheet(1), 8.0), [-4.0, -4.0, -1.5]);
        let mesh = Mesh::concat(&[shapes::cube(), floor]).unwrap();
        let bounds = Aabb::around(mesh.positions().iter().copied());
        Source {
            format: None,
            up: Up::Z,
            caster: Caster::new(mesh),
            seen: None,
            bounds,
            lights: Vec::new(),
            cameras: Default::default(),
            materials: Vec::new(),
        }
    }

    fn request(technique: &str, layers: &[Layer], mode: Mode) -> Request {
        let source = source();
        let size = Size::new(60, 40).unwrap();
        let lamp = OwnLamp {
            lamp: "point:3,-4,6".parse().unwrap(),
            technique: (technique != "auto").then(|| technique.parse().unwrap()),
            is_on: true,
        };
        let camera = Camera::fit(&source.bounds, source.up, size.aspect());
        let mut state = State::new(source.bounds, source.up, &camera, vec![lamp]);
        (state.layers, state.mode) = (layers.to_vec(), mode);
        // The finest that a known pace admits.
        let mut pace = Pace::default();
        pace.took(Quality::default(), size, 1e-9);
        state.pace = pace;
        state.next(size, false, true).unwrap()
    }

    fn answers(requests: &[Request]) -> Vec<Answer> {
        let source = source();
        let casters = source.group();
        let mut stage = Stage::new(&source, &casters, None, false, None);
        let defects = OnceLock::from(Defects::of(&source.caster, usize::MAX));
        requests.iter().map(|it| stage.draw(it, &defects, &|| false).unwrap().unwrap()).collect()
    }

    #[test]
    fn exact_techniques_show_the_truth_and_others_are_told_from_it() {
        let of = |technique: &str| request(technique, &[Layer::Truth], Mode::Picture);
        let all = answers(&["rays", "zfail", "auto", "none", "map:size=16"].map(of));
        for exact in &all[..3] {
            let errors = exact.lamps[0].errors.unwrap();
            assert!(errors.wrong == 0 && errors.judged > 100, "{}", exact.lamps[0].technique);
            assert_eq!(Some(&exact.picture), exact.truth.as_ref(), "{}", exact.lamps[0].technique);
        }
        assert!(all[2].plan.as_ref().unwrap().rows[0].reason.contains("ms"));
        for wrong in &all[3..] {
            assert!(wrong.lamps[0].errors.unwrap().wrong > 0);
            assert_ne!(Some(&wrong.picture), wrong.truth.as_ref());
        }
        assert_eq!(all[3].truth, all[0].truth);
    }

    #[test]
    fn layers_and_false_colors_are_drawn_when_asked_for() {
        let lines = |layer| answers(&[request("rays", &[layer], Mode::Picture)])[0].strokes.len();
        assert_eq!(lines(Layer::Lights), 0);
        assert!(lines(Layer::Silhouette) > 0 && lines(Layer::Volume) > 0);
        assert!(lines(Layer::Defects) > 0, "the floor has an edge");
        let plain = answers(&[request("dark", &[], Mode::Picture)]).remove(0).picture;
        for mode in [Mode::Difference, Mode::Grid] {
            let colored = answers(&[request("dark", &[], mode)]).remove(0);
            assert!(colored.picture != plain && colored.legend.is_some());
        }
        assert_ne!(answers(&[request("dark", &[Layer::Caps], Mode::Picture)])[0].picture, plain);
    }

    #[test]
    fn what_does_not_change_is_not_found_again() {
        let mut stages = answers(&[request("map", &[], Mode::Picture), request("map", &[], Mode::Picture)]);
        let second = stages.remove(1);
        assert!(second.stages.iter().all(|(name, _)| name != ONCE));
        let first = stages.remove(0);
        assert!(first.stages.iter().any(|(name, _)| name == ONCE));
        assert_eq!(first.picture, second.picture);
    }

    #[test]
    fn stale_request_is_given_up() {
        let source = source();
        let casters = source.group();
        let mut stage = Stage::new(&source, &casters, None, false, None);
        let request = request("rays", &[], Mode::Picture);
        assert!(stage.draw(&request, &OnceLock::new(), &|| true).unwrap().is_none());
    }
}
