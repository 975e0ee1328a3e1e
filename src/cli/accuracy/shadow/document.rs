//! The table of `accuracy shadow` as JSON.

use serde_json::{Value, json};
use umbrage::accuracy::{ShadowAccuracy, ShadowRow};
use umbrage::shadow::{Claim, Technique};

use super::Measured;
use super::chosen::Chosen;
use crate::cli::lights;
use crate::cli::output::number;

impl Measured {
    pub(super) fn document(&self) -> Value {
        let lights = self.lights.iter().zip(&self.found).zip(&self.chosen).map(|((light, found), chosen)| {
            json!({
                "name": lights::lamp_label(light),
                "truth": truth(found),
                "rows": found.rows.iter().map(row_document).collect::<Vec<_>>(),
                "plan": chosen.as_ref().map(Chosen::document),
            })
        });
        json!({
            "file": self.file.to_string_lossy(),
            "samples": self.samples,
            "lights": lights.collect::<Vec<_>>(),
        })
    }
}

fn truth(found: &ShadowAccuracy) -> Value {
    match found.truth.bound() {
        None => json!({ "method": "exact ray cast", "bound": 0.0 }),
        Some(bound) => json!({ "method": "analytic visible fraction", "bound": number(bound) }),
    }
}

/// The options as an object, numbers as numbers; null for a technique without options.
pub(super) fn parameters(technique: Technique) -> Value {
    let parameters = technique.parameters();
    let value = |text: String| text.parse::<u32>().map_or(Value::String(text), Value::from);
    match parameters.is_empty() {
        true => Value::Null,
        false => parameters.into_iter().map(|(key, text)| (key.to_owned(), value(text))).collect(),
    }
}

/// What does not apply to a technique, or is not built yet, is null.
fn row_document(row: &ShadowRow) -> Value {
    let errors = &row.errors;
    let verdict = |count: u64| (!errors.is_soft).then_some(count);
    let of_texels = |count: u64| verdict(count).filter(|_| row.texel_world.is_some());
    let bound = match row.claim {
        Claim::Bounded(bound) => json!({ "name": row.claim.name(), "bound": bound }),
        _ => row.claim.name().into(),
    };
    json!({
        "technique": row.technique.name(),
        "parameters": parameters(row.technique),
        "device": row.device,
        "claim": bound,
        "judged": errors.judged,
        "wrong": verdict(errors.wrong),
        "acne": verdict(errors.acne),
        "leak": verdict(errors.leak),
        "alias_dark": of_texels(errors.alias_dark),
        "alias_lit": of_texels(errors.alias_lit),
        "outside": of_texels(errors.outside),
        "asked_exactly": row.asked_exactly,
        "mean_error": number(errors.mean),
        "mean_signed_error": number(errors.mean_signed),
        "p99_error": number(errors.p99),
        "max_error": number(errors.max),
        "penumbra_mean_error": errors.penumbra_mean.map(number),
        "reads": row.reads.map(number),
        "fragments": row.updates.map(|work| work.fragments),
        "updates": row.updates.map(|work| work.updates),
        "bias_world": row.bias_world.map(number),
        "texel_world": row.texel_world.map(number),
        "prepare_ms": number(row.prepare_ms),
        "frame_ms": number(row.frame_ms.median),
        "readback_ms": row.readback_ms.map(number),
        "bytes": row.bytes,
        "dominated_by": row.dominated_by.map(|by| by.name()),
    })
}
