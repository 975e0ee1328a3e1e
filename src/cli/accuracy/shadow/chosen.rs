//! What the planner would choose for each light, beside what was measured.

use serde_json::{Value, json};
use umbrage::accuracy::{ShadowAccuracy, ShadowRow};
use umbrage::caster::CasterGroup;
use umbrage::plan::{Budget, Costs, Scenery, plan};
use umbrage::shadow::{Claim, Samples, Technique};

use super::text::milliseconds;
use crate::cli::output::{number, significant};

/// The choice of an exact plan for one light.
pub(super) struct Chosen {
    /// The technique of most samples.
    technique: Technique,
    reason: String,
    predicted_ms: f64,
    /// Time of the chosen technique, if it has a row.
    measured_ms: Option<f64>,
    /// The fastest exact row.
    best: Option<(Technique, f64)>,
}

/// Preparation and one frame: what one picture takes.
fn time(row: &ShadowRow) -> f64 {
    row.prepare_ms + row.frame_ms.median
}

impl Chosen {
    /// The plan of the light of `found` alone.
    pub(super) fn of(casters: &CasterGroup<'_>, samples: &Samples, found: &ShadowAccuracy) -> Option<Self> {
        let lamps = std::slice::from_ref(&found.lamp);
        let plan = plan(&Scenery::new(casters, lamps, samples), &Budget::default(), &Costs::default());
        let group = plan.lamps.first()?.groups.iter().max_by_key(|group| group.samples)?;
        let rows = || found.rows.iter().filter(|row| row.device.is_none());
        let is_exact = |row: &&ShadowRow| {
            // Of a lamp with extent the fraction is exact, and not the hard shadow.
            row.claim == Claim::Exact && row.technique.is_soft() == found.lamp.has_extent() && row.holds
        };
        let best = rows().filter(is_exact).min_by(|a, b| time(a).total_cmp(&time(b)));
        Some(Self {
            technique: group.technique,
            reason: group.reason.clone(),
            predicted_ms: plan.total.time.as_secs_f64() * 1e3,
            measured_ms: rows().find(|row| row.technique == group.technique).map(time),
            best: best.map(|row| (row.technique, time(row))),
        })
    }

    /// Time of the chosen technique over that of the best row.
    fn regret(&self) -> Option<f64> {
        let (_, best) = self.best?;
        self.measured_ms.map(|own| own / best).filter(|regret| regret.is_finite())
    }

    pub(super) fn document(&self) -> Value {
        json!({
            "technique": self.technique.name(),
            "parameters": super::document::parameters(self.technique),
            "reason": self.reason,
            "predicted_ms": number(self.predicted_ms),
            "measured_ms": self.measured_ms.map(number),
            "best": self.best.map(|(technique, _)| technique.name()),
            "best_ms": self.best.map(|(_, ms)| number(ms)),
            "regret": self.regret().map(number),
        })
    }

    /// One sentence.
    pub(super) fn text(&self) -> String {
        let mut text = format!("the planner chooses {} ({})", self.technique, self.reason);
        match (self.best, self.measured_ms, self.regret()) {
            (Some((best, _)), _, _) if best == self.technique => {
                text += ": the fastest exact row on the CPU, preparation included";
            }
            (Some((best, best_ms)), Some(own), Some(regret)) => {
                text += &format!(
                    ": {} ms, {} times the fastest exact row on the CPU, {best} with {} ms, preparation included",
                    milliseconds(own),
                    significant((100.0 * regret).round() / 100.0),
                    milliseconds(best_ms)
                );
            }
            (Some((best, ms)), ..) => {
                text += &format!(
                    ": no row of it; the fastest exact row on the CPU is {best} with {} ms",
                    milliseconds(ms)
                );
            }
            _ => text += ": there is no exact row to compare it with",
        }
        text
    }
}
