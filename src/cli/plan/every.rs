//! Every technique that a plan considered, run and compared with the truth.

use std::fmt::Write;
use std::time::Duration;

use serde_json::{Value, json};
use umbrage::plan::{Check, Checked, Judgment, Run, Scenery, ShadowPlan, Task, check, count_wrong, run};
use umbrage::shadow::{Request, Technique, Updates};

use super::text::{milliseconds, percent};
use crate::cli::Failure;
use crate::cli::progress::Progress;

/// What running gave.
pub(super) struct Every {
    trials: Vec<Trial>,
    /// The plan itself, run and checked.
    time: Duration,
    checked: Vec<Checked>,
}

/// One technique under one lamp.
pub(super) struct Trial {
    lamp: usize,
    technique: Technique,
    /// The fraction of samples that are wrong.
    pub(super) error: f64,
    time: Duration,
    /// The work of a technique that rasterizes volumes on the CPU.
    pub(super) updates: Option<Updates>,
}

impl Trial {
    pub(super) fn ms(&self) -> f64 {
        self.time.as_secs_f64() * 1e3
    }
}

impl Every {
    /// Runs the plan with its check, and then every technique for all receivers of each lamp.
    pub(super) fn run(scenery: &Scenery<'_>, plan: &ShadowPlan) -> Result<Self, Failure> {
        let Scenery { casters, lamps, samples, .. } = *scenery;
        let tasks = Task::of(plan);
        let techniques = |lamp: usize| {
            let mut all: Vec<Technique> = Vec::new();
            for group in &plan.lamps[lamp].groups {
                // What is not applicable has no prediction.
                let rejected = group.rejected.iter().filter(|it| it.prediction.is_some());
                for technique in std::iter::once(group.technique).chain(rejected.map(|it| it.technique)) {
                    if !all.contains(&technique) {
                        all.push(technique);
                    }
                }
            }
            all
        };
        let of_lamps: Vec<Vec<Technique>> = (0..plan.lamps.len()).map(techniques).collect();
        let steps = 1 + of_lamps.iter().map(Vec::len).sum::<usize>();
        let progress = Progress::bar("running every technique", steps as u64);
        let mut runs = run(casters, lamps, samples, &tasks)?;
        let mut options = Check::default();
        options.physical_falloff = scenery.physical_falloff;
        let checked = check(casters, lamps, samples, &tasks, &mut runs, &plan.budget, &options)?;
        let time = runs.iter().map(|run| run.time).sum();
        progress.done(1);
        let seen = samples.hits().iter().flatten().count().max(1) as f64;
        let mut trials = Vec::new();
        for (lamp, techniques) in of_lamps.into_iter().enumerate() {
            let request = Request { casters, lamp: &lamps[lamp], samples };
            for technique in techniques {
                let mut task = Task::new(technique);
                task.kept.clone_from(&tasks[lamp].kept);
                let Run { visibility, time, .. } =
                    run(casters, &lamps[lamp..=lamp], samples, &[task])?.remove(0);
                let wrong = count_wrong(&request, &visibility, &plan.budget, scenery.physical_falloff);
                let updates = visibility.updates();
                trials.push(Trial { lamp, technique, error: wrong as f64 / seen, time, updates });
                progress.done(1);
            }
        }
        Ok(Self { trials, time, checked })
    }

    pub(super) fn trial(&self, lamp: usize, technique: Technique) -> Option<&Trial> {
        self.trials.iter().find(|trial| trial.lamp == lamp && trial.technique == technique)
    }

    /// Whether an exact technique was found wrong.
    pub(super) fn failed(&self) -> bool {
        self.checked.iter().any(|checked| checked.judgment == Judgment::Failed)
    }

    pub(super) fn measured(&self) -> Value {
        measured(self.time, &self.checked)
    }

    pub(super) fn text(&self) -> String {
        let mut text = format!("measured: {}\n", milliseconds(self.time.as_secs_f64() * 1e3));
        for (number, checked) in self.checked.iter().enumerate() {
            let _ = writeln!(text, "  light {}: {}", number + 1, words(checked));
        }
        text
    }
}

/// What a run gave, for JSON.
pub(crate) fn measured(time: Duration, checked: &[Checked]) -> Value {
    let fell_back = (1..).zip(checked).filter(|(_, it)| matches!(it.judgment, Judgment::FellBack(_)));
    json!({
        "time_ms": time.as_secs_f64() * 1e3,
        "checked": checked.iter().map(|checked| checked.drawn).sum::<u64>(),
        "wrong": checked.iter().map(|checked| checked.wrong).sum::<u64>(),
        "bound_99": checked.iter().map(|checked| checked.bound).sum::<f64>().min(1.0),
        "fell_back": fell_back.map(|(number, _)| number).collect::<Vec<u32>>(),
    })
}

/// What a check found, for a person.
pub(crate) fn words(checked: &Checked) -> String {
    let found = match checked.is_all {
        true => format!("all {} samples that face it compared, {} wrong", checked.drawn, checked.wrong),
        false => format!(
            "{} samples compared, {} wrong: at most {} of all, at 99 %",
            checked.drawn,
            checked.wrong,
            percent(checked.bound)
        ),
    };
    match checked.judgment {
        Judgment::FellBack(technique) => {
            format!("{found}; {} allowed, so {technique} took over", percent(checked.allowed))
        }
        Judgment::Failed => format!("{found}; {} allowed", percent(checked.allowed)),
        Judgment::Void => "adds nothing that counts, not checked".to_owned(),
        _ => found,
    }
}
