//! Pictures whose shadows a plan chooses.

use std::path::Path;

use umbrage::ambient::PointRays;
use umbrage::mesh::FaceId;
use umbrage::plan::{Check, Costs, Judgment, Scenery, Task, check, plan, run as run_tasks};
use umbrage::render::{CLAY, Ground, Picture, View, render_samples};
use umbrage::shadow::{Samples, Technique, Visibility};
use umbrage::view::Camera;

use super::{AMBIENT_RAYS, Args, STENCIL_SAMPLES, colors, shining_lamps};
use crate::cli::input::Source;
use crate::cli::plan::{FalloffArg, Identity, Saved, as_drawn, check_words, require_faces, shaded};
use crate::cli::progress::Progress;
use crate::cli::{Failure, Outcome, lights, output};

/// Draws the lamps that are left to the planner by its plan, and the others by the technique that they ask
/// for.
///
/// All of it is checked, and what is found wrong falls back to exact shadows. Exit code 1: the budget is not
/// met, or an exact technique was wrong.
pub(super) fn run(
    args: &Args,
    source: &Source,
    camera: Camera,
    ground: Option<Ground>,
    techniques: &[Option<Technique>],
    saved: Option<(&Path, Saved)>,
) -> Result<(Picture, Outcome), Failure> {
    require_faces(source, &args.source.file)?;
    let physical = args.falloff == FalloffArg::Physical;
    if let Some((path, saved)) = &saved {
        saved.require(&Identity::of(source, &camera, args.size, args.falloff), path)?;
    }
    let progress = Progress::spinner("rendering");
    let casters = source.group();
    let projection = camera.projection(args.size, camera.near([source.seen().mesh()], args.size));
    let samples = Samples::of_view(&casters, &projection, args.size, args.samples.unwrap_or(STENCIL_SAMPLES))
        .map_err(|error| Failure::new(error, "choose a smaller --size"))?;
    let lamps = as_drawn(&source.lights, &shaded(source, args.source.lights.were_asked_for(), physical));
    let mut budget = args.budget.unwrap_or_default();
    let mut meets_budget = true;
    let mut tasks = match saved {
        Some((_, saved)) => {
            budget = args.budget.unwrap_or(saved.budget);
            saved.tasks
        }
        None => {
            let mut scenery = Scenery::new(&casters, &lamps, &samples);
            scenery.physical_falloff = physical;
            let plan = plan(&scenery, &budget, &Costs::default());
            meets_budget = plan.meets_budget;
            Task::of(&plan)
        }
    };
    for (task, technique) in tasks.iter_mut().zip(techniques) {
        if let Some(technique) = *technique {
            *task = asked(technique);
        }
    }
    let mut runs = run_tasks(&casters, &lamps, &samples, &tasks)?;
    let checked = match args.check {
        Some(0) => None,
        first => {
            let mut options = Check::default();
            options.first = first.unwrap_or(options.first);
            options.physical_falloff = physical;
            Some(check(&casters, &lamps, &samples, &tasks, &mut runs, &budget, &options)?)
        }
    };
    drop(progress);
    for (number, task) in tasks.iter().enumerate() {
        let names: Vec<String> = task.groups.iter().map(|(_, technique)| technique.to_string()).collect();
        let found =
            checked.as_ref().map_or_else(|| "not checked".to_owned(), |all| check_words(&all[number]));
        let label = lights::lamp_label(&source.lights[number]);
        let ms = runs[number].time.as_secs_f64() * 1e3;
        output::say(format_args!("note: {label}: {}, {ms:.1} ms; {found}", names.join(" and ")));
    }
    let failed = checked.iter().flatten().any(|checked| checked.judgment == Judgment::Failed);
    if !meets_budget {
        output::say("note: the plan does not meet the budget");
    }

    let shining = shining_lamps(args, source, techniques);
    let lit = runs.into_iter().zip(techniques).filter(|(_, technique)| **technique != Some(Technique::Dark));
    let visibility: Vec<Visibility> = lit.map(|(run, _)| run.visibility).collect();
    let colors = colors(source.seen().mesh(), &source.materials);
    let paint = |face: FaceId| colors.get(face.index()).copied().unwrap_or(CLAY);
    let rays = args.ambient.then(|| PointRays::new(AMBIENT_RAYS));
    let open =
        |point, normal| rays.as_ref().map_or(1.0, |rays| rays.openness(casters.oracle(), point, normal));
    let view = View {
        camera,
        size: args.size,
        lamps: &shining,
        casters: None,
        up: source.up,
        ground,
        paint: &paint,
        edge_samples: samples.per_side(),
        ambient: rays.as_ref().map(|_| &open as _),
    };
    let progress = Progress::spinner("rendering");
    let picture = render_samples(&samples, &view, &visibility);
    drop(progress);
    let picture = picture.map_err(|error| Failure::new(error, "choose a smaller --size"))?;
    Ok((picture, if meets_budget && !failed { Outcome::Sound } else { Outcome::Unsound }))
}

/// A technique that was asked for by name: it may exceed the budget, and is not replaced.
fn asked(technique: Technique) -> Task {
    let mut task = Task::new(technique);
    task.bound = 1.0;
    task
}
