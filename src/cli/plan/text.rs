//! A plan as text.

use std::fmt::Write;

use umbrage::plan::{Budget, GroupPlan, LampPlan, Prediction, Receivers};
use umbrage::shadow::Technique;

use super::Planned;
use crate::cli::lights;
use crate::cli::output::{Table, counted, plain, significant};

impl Planned<'_> {
    pub(super) fn text(&self) -> String {
        let plan = self.plan;
        let mut text = format!(
            "{}: plan for {} in a view of {}, {}, {} of them probed\nbudget: {}\n",
            plain(&self.file.to_string_lossy()),
            counted(plan.lamps.len(), "light", "lights"),
            self.size,
            counted(plan.samples, "sample", "samples"),
            plan.probed,
            budget(&plan.budget),
        );
        for lamp in &plan.lamps {
            text += &self.reasons(lamp);
        }
        if !plan.not_computed.is_empty() {
            text += "not computed:\n";
            for line in &plan.not_computed {
                let _ = writeln!(text, "  {line}");
            }
        }
        for lamp in &plan.lamps {
            text += &self.truths(lamp);
        }
        if let Some(every) = self.every {
            text += &every.text();
        }
        let _ = writeln!(
            text,
            "total: {}; planned in {}; the budget is {}",
            prediction(&plan.total),
            milliseconds(plan.planning.as_secs_f64() * 1e3),
            if plan.meets_budget { "met" } else { "not met" },
        );
        text
    }

    /// One line, and one for each reason.
    fn reasons(&self, lamp: &LampPlan) -> String {
        let label = lights::lamp_label(&self.lamps[lamp.lamp]);
        let techniques: Vec<String> = lamp.groups.iter().map(group).collect();
        let casters = match lamp.kept.len() {
            kept if kept == lamp.pieces => counted(kept, "caster", "casters"),
            kept => format!("{kept} of {}", counted(lamp.pieces, "caster", "casters")),
        };
        let mut text = format!(
            "light {}: {label}: {}; {casters}; {} of samples face it, {} of samples are in its shadow\n",
            lamp.lamp + 1,
            techniques.join(", "),
            percent(lamp.facing),
            percent(lamp.shadowed),
        );
        for group in &lamp.groups {
            let _ = writeln!(text, "  {}; {}", group.reason, prediction(&group.prediction));
        }
        text
    }

    /// The truth beside each prediction; nothing without `--all`.
    fn truths(&self, lamp: &LampPlan) -> String {
        let Some(every) = self.every else { return String::new() };
        let mut table =
            Table::new(&["technique", "error predicted", "at most", "true", "ms predicted", "measured"]);
        let mut whys = vec![String::new()];
        // Those that could not be predicted, by the reason.
        let mut others: Vec<(&str, Vec<String>)> = Vec::new();
        let chosen = lamp.groups.iter().map(|group| (group.technique, Some(&group.prediction), "chosen"));
        let rejected = lamp.groups.iter().flat_map(|group| &group.rejected);
        let rejected = rejected.map(|it| (it.technique, it.prediction.as_ref(), it.why.as_str()));
        let mut seen: Vec<Technique> = Vec::new();
        for (technique, predicted, why) in chosen.chain(rejected) {
            if seen.contains(&technique) {
                continue;
            }
            seen.push(technique);
            let (Some(predicted), Some(trial)) = (predicted, every.trial(lamp.lamp, technique)) else {
                match others.iter_mut().find(|(other, _)| *other == why) {
                    Some((_, names)) => names.push(technique.to_string()),
                    None => others.push((why, vec![technique.to_string()])),
                }
                continue;
            };
            table.row(vec![
                technique.to_string(),
                percent(predicted.error),
                percent(predicted.bound),
                percent(trial.error),
                bare_ms(predicted.time.as_secs_f64() * 1e3),
                bare_ms(trial.ms()),
            ]);
            whys.push(format!("  {why}"));
        }
        let mut text = format!("light {}, every technique:\n", lamp.lamp + 1);
        for (line, why) in table.to_string().lines().zip(whys) {
            let _ = writeln!(text, "{line}{why}");
        }
        for (why, names) in others {
            let _ = writeln!(text, "  {why}: {}", names.join(", "));
        }
        text
    }
}

fn budget(budget: &Budget) -> String {
    match *budget == Budget::default() {
        true => "exact, in the least time".to_owned(),
        false => budget.to_string(),
    }
}

fn group(group: &GroupPlan) -> String {
    match group.receivers {
        Receivers::Plane => format!("{} on the plane", group.technique),
        Receivers::Others => format!("{} elsewhere", group.technique),
        _ => group.technique.to_string(),
    }
}

fn prediction(prediction: &Prediction) -> String {
    let time = milliseconds(prediction.time.as_secs_f64() * 1e3);
    let time = format!("{time} ({})", prediction.time_evidence);
    match prediction.bound > 0.0 {
        true => format!("at most {} wrong ({}), {time}", percent(prediction.bound), prediction.evidence),
        false => format!("no error ({}), {time}", prediction.evidence),
    }
}

pub(super) fn percent(fraction: f64) -> String {
    match fraction * 100.0 {
        percent if percent == 0.0 || percent >= 0.001 => {
            format!("{} %", significant((percent * 1000.0).round() / 1000.0))
        }
        _ => "< 0.001 %".to_owned(),
    }
}

fn bare_ms(ms: f64) -> String {
    let decimals = if ms < 10.0 { 2 } else { usize::from(ms < 100.0) };
    format!("{ms:.decimals$}")
}

pub(super) fn milliseconds(ms: f64) -> String {
    format!("{} ms", bare_ms(ms))
}
