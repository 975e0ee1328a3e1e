//! A plan as JSON. What was not worked out is null.

use serde_json::{Map, Value, json};
use umbrage::plan::relevance::{Dropped, Triple};
use umbrage::plan::{Budget, Effect, GridFigures, GroupPlan, LampPlan, Prediction, Receivers, Rejected};
use umbrage::shadow::Technique;

use super::{Planned, or_null};
use crate::cli::lights;
use crate::cli::output::number;

impl Planned<'_> {
    pub(super) fn document(&self) -> Value {
        let plan = self.plan;
        let lamps = plan.lamps.iter().map(|lamp| self.lamp(lamp));
        json!({
            "file": self.file.to_string_lossy(),
            "budget": budget(&plan.budget),
            "samples": plan.samples,
            "probe": { "samples": plan.probed, "ms": Value::Null },
            "lights": lamps.collect::<Vec<_>>(),
            "dropped": plan.dropped.iter().map(dropped).collect::<Vec<_>>(),
            "effects": plan.effects.iter().map(effect).collect::<Vec<_>>(),
            "total": {
                "error": number(plan.total.error),
                "evidence": plan.total.evidence.name(),
                "time_ms": milliseconds(&plan.total),
            },
            "not_computed": plan.not_computed,
            "planning_ms": number(plan.planning.as_secs_f64() * 1e3),
            "meets_budget": plan.meets_budget,
            "measured": or_null(self.every.map(|every| every.measured())),
        })
    }

    fn lamp(&self, lamp: &LampPlan) -> Value {
        let whole = match &lamp.groups[..] {
            [group] => Value::from(group.technique.name()),
            _ => Value::Null,
        };
        let groups = lamp.groups.iter().map(|group| self.group(lamp, group));
        json!({
            "light": lights::lamp_label(&self.lamps[lamp.lamp]),
            "name": lights::name(&lamp.name),
            "facing": number(lamp.facing),
            "shadowed": number(lamp.shadowed),
            "casters": lamp.pieces,
            "kept": lamp.kept.len(),
            "technique": whole,
            "groups": groups.collect::<Vec<_>>(),
            "grid": or_null(lamp.grid.as_ref().map(grid)),
        })
    }

    fn group(&self, lamp: &LampPlan, group: &GroupPlan) -> Value {
        let prediction = &group.prediction;
        let mut document = json!({
            "receivers": receivers(group.receivers),
            "samples": group.samples,
            "technique": group.technique.name(),
            "parameters": parameters(group.technique),
            "error": number(prediction.error),
            "evidence": prediction.evidence.name(),
            "bound_95": number(prediction.bound),
            "time_ms": milliseconds(prediction),
            "cost_evidence": prediction.time_evidence.name(),
            "reason": group.reason,
            "rejected": group.rejected.iter().map(|it| self.rejected(lamp, it)).collect::<Vec<_>>(),
        });
        self.add_truth(&mut document, lamp, group.technique);
        document
    }

    fn rejected(&self, lamp: &LampPlan, rejected: &Rejected) -> Value {
        let prediction = rejected.prediction.as_ref();
        let mut document = json!({
            "technique": rejected.technique.name(),
            "parameters": parameters(rejected.technique),
            "error": or_null(prediction.map(|prediction| number(prediction.error))),
            "evidence": or_null(prediction.map(|prediction| prediction.evidence.name())),
            "time_ms": or_null(prediction.map(milliseconds)),
            "why": rejected.why,
        });
        self.add_truth(&mut document, lamp, rejected.technique);
        document
    }

    /// What was measured, beside what was predicted; nothing without `--all`.
    fn add_truth(&self, document: &mut Value, lamp: &LampPlan, technique: Technique) {
        if let (Some(every), Some(document)) = (self.every, document.as_object_mut()) {
            let trial = every.trial(lamp.lamp, technique);
            document.insert("true_error".to_owned(), or_null(trial.map(|trial| number(trial.error))));
            document.insert("measured_ms".to_owned(), or_null(trial.map(|trial| number(trial.ms()))));
            let work = trial.and_then(|trial| trial.updates);
            document.insert("fragments".to_owned(), or_null(work.map(|work| work.fragments)));
            document.insert("updates".to_owned(), or_null(work.map(|work| work.updates)));
        }
    }
}

fn milliseconds(prediction: &Prediction) -> Value {
    number(prediction.time.as_secs_f64() * 1e3)
}

fn budget(budget: &Budget) -> Value {
    json!({
        "error": number(budget.error),
        "light": or_null(budget.light.map(number)),
        "level": number(budget.level),
        "time_ms": or_null(budget.time.map(|time| number(time.as_secs_f64() * 1e3))),
    })
}

pub(super) fn receivers(receivers: Receivers) -> &'static str {
    match receivers {
        Receivers::Plane => "plane",
        Receivers::Others => "others",
        _ => "all",
    }
}

/// The options as an object, numbers as numbers; null for a technique without options.
pub(super) fn parameters(technique: Technique) -> Value {
    let parameters = technique.parameters();
    let value = |text: String| text.parse::<u32>().map_or(Value::String(text), Value::from);
    let object: Map<String, Value> =
        parameters.into_iter().map(|(key, text)| (key.to_owned(), value(text))).collect();
    if object.is_empty() { Value::Null } else { Value::Object(object) }
}

fn grid(grid: &GridFigures) -> Value {
    json!({
        "side": grid.side,
        "undecided": number(grid.undecided),
        "maybe_penumbra": or_null(grid.maybe_penumbra.map(number)),
        "ms": number(grid.time.as_secs_f64() * 1e3),
    })
}

fn dropped(dropped: &Dropped) -> Value {
    let (caster, receiver, count) = match dropped.what {
        Triple::Piece(piece) => (piece.into(), Value::Null, 1),
        Triple::Samples(count) => (Value::Null, "samples".into(), count),
        _ => (Value::Null, Value::Null, 1),
    };
    json!({
        "light": dropped.lamp + 1,
        "caster": caster,
        "receiver": receiver,
        "test": dropped.test.name(),
        "class": dropped.test.equality().name(),
        "bound": number(dropped.bound),
        "count": count,
    })
}

fn effect(effect: &Effect) -> Value {
    json!({
        "effect": effect.name,
        "called": effect.called,
        "bound": number(effect.bound),
        "evidence": effect.evidence.name(),
        "reason": effect.reason,
    })
}
