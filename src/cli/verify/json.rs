//! The document of `umbrage verify --json`.

use serde_json::{Map, Value, json};
use umbrage::scene::Lamp;
use umbrage::verify::pixels::PixelCounts;
use umbrage::verify::points::{Judge, Stratum, Verification};

use super::pixels::{Pass, Pixels};
use super::{judges, strata, summed, total};
use crate::cli::json::append;
use crate::cli::lights;
use crate::cli::output::number32;

pub(super) fn document(
    file: &str,
    format: Option<&str>,
    lights: &[Lamp],
    results: &[Verification],
    pixels: Option<&Pixels>,
) -> Value {
    let judges = judges(results, pixels);
    let each = lights.iter().zip(results).zip(&judges).enumerate();
    let each = each.map(|(index, ((light, result), judges))| {
        let pixels = pixels.map(|pixels| &pixels.lights[index]);
        let mut entry = Map::new();
        append(&mut entry, &json!({ "light": light.light(), "name": lights::name(&light.name) }));
        entry.extend(counts(&result.strata, pixels.map(|pixels| pixels.counts), judges));
        let passes = pixels.map(|pixels| pixels.passes.iter().map(pass).collect::<Vec<_>>());
        append(&mut entry, &json!({ "disagreements": result.disagreements, "passes": passes }));
        entry
    });
    let each: Vec<_> = each.collect();
    let mut document = Map::new();
    append(&mut document, &json!({ "file": file, "format": format }));
    document.extend(counts(&strata(results), pixels.map(Pixels::counts), &summed(&judges)));
    append(&mut document, &json!({ "lights": each, "stencil": pixels.map(stencil) }));
    Value::Object(document)
}

fn counts(strata: &[Stratum], pixels: Option<PixelCounts>, judges: &[Judge]) -> Map<String, Value> {
    let mut counts = Map::new();
    append(&mut counts, &total(strata));
    counts.shift_remove("name");
    let rest = json!({
        "strata": strata,
        "pixels": pixels.map(PixelCounts::pixels),
        "pixel_agree": pixels.map(PixelCounts::agree),
        "pixel_grazing": pixels.map(PixelCounts::grazing),
        "pixel_disagree": pixels.map(PixelCounts::disagree),
        "judges": judges,
    });
    append(&mut counts, &rest);
    counts
}

/// What all stencil passes share.
fn stencil(pixels: &Pixels) -> Value {
    let Pixels { adapter, size, projection, near_asked, .. } = pixels;
    json!({
        "adapter": adapter,
        "width": size.width(),
        "height": size.height(),
        "eye": projection.eye.map(number32),
        "right": projection.right.map(number32),
        "up": projection.up.map(number32),
        "forward": projection.forward.map(number32),
        "near": number32(projection.near),
        "near_asked": near_asked,
    })
}

fn pass(pass: &Pass) -> Map<String, Value> {
    let mut entry = Map::new();
    let choices = json!({
        "asked": pass.asked,
        "method": pass.method,
        "reason": pass.reason,
        "counting": pass.counting,
        "counting_reason": pass.counting_reason,
    });
    append(&mut entry, &choices);
    append(&mut entry, &pass.counts);
    append(&mut entry, &json!({ "mismatches": pass.mismatches }));
    entry
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn verify_json_of_a_pass_has_the_agreed_keys_in_order() {
        let pass = pass(&Pass {
            asked: "zfail",
            method: "zfail",
            reason: String::new(),
            counting: "stencil",
            counting_reason: String::new(),
            counts: PixelCounts::default(),
            mismatches: Vec::new(),
        });
        let keys: Vec<&str> = pass.keys().map(String::as_str).collect();
        assert_eq!(
            keys.join(" "),
            "asked method reason counting counting_reason sky lit shadowed grazing unsure overflow real mismatches"
        );
    }
}
