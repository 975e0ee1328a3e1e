//! The document of `umbrage verify --json`.

use serde_json::{Value, json};
use umbrage::oracle::Verdict;
use umbrage::scene::Lamp;
use umbrage::verify::pixels::{Mismatch, PixelVerdict};
use umbrage::verify::points::{Judge, Stratum, Verification};

use super::pixels::{Counts, LightPixels, Pass, Pixels};
use super::{judges, strata, summed, total};
use crate::cli::lights;
use crate::cli::output::{number, number32};

pub(super) fn document(
    file: &str,
    format: Option<&str>,
    lights: &[Lamp],
    results: &[Verification],
    pixels: Option<&Pixels>,
) -> Value {
    let judges = judges(results, pixels);
    let each =
        lights.iter().zip(results).zip(&judges).enumerate().map(|(index, ((light, result), judges))| {
            let pixels = pixels.map(|pixels| &pixels.lights[index]);
            let mut entry = json!({ "light": light.light().to_string(), "name": lights::name(&light.name) });
            append(&mut entry, counts(&result.strata, pixels.map(|pixels| pixels.counts), judges));
            let disagreements = result.disagreements.iter().map(|found| {
                json!({
                    "stratum": found.stratum,
                    "point": found.point.map(number32),
                    "verdict": verdict(found.verdict),
                    "what": found.what,
                })
            });
            let disagreements = disagreements.collect::<Vec<_>>();
            append(&mut entry, json!({ "disagreements": disagreements, "passes": pixels.map(passes) }));
            entry
        });
    let each: Vec<Value> = each.collect();
    let mut document = json!({ "file": file, "format": format });
    append(&mut document, counts(&strata(results), pixels.map(Pixels::counts), &summed(&judges)));
    append(&mut document, json!({ "lights": each, "stencil": pixels.map(stencil) }));
    document
}

fn counts(strata: &[Stratum], pixels: Option<Counts>, judges: &[Judge]) -> Value {
    let mut counts = row(&total(strata));
    let strata = strata.iter().map(|stratum| {
        let mut entry = json!({ "name": stratum.name });
        append(&mut entry, row(stratum));
        entry
    });
    let judges = judges.iter().map(|judge| {
        json!({
            "name": judge.name,
            "points": judge.points,
            "abstain": judge.abstain,
            "disagree": judge.disagree,
        })
    });
    let rest = json!({
        "strata": strata.collect::<Vec<_>>(),
        "pixels": pixels.map(Counts::pixels),
        "pixel_agree": pixels.map(Counts::agree),
        "pixel_grazing": pixels.map(Counts::grazing),
        "pixel_disagree": pixels.map(Counts::disagree),
        "judges": judges.collect::<Vec<_>>(),
    });
    append(&mut counts, rest);
    counts
}

fn row(stratum: &Stratum) -> Value {
    json!({
        "points": stratum.points,
        "agree": stratum.agree,
        "grazing": stratum.grazing,
        "disagree": stratum.disagree,
        "bound_95": stratum.bound_95().map(number),
    })
}

/// What all stencil passes share.
fn stencil(pixels: &Pixels) -> Value {
    let Pixels { adapter, size, projection, .. } = pixels;
    json!({
        "adapter": adapter,
        "width": size.width(),
        "height": size.height(),
        "eye": projection.eye.map(number32),
        "right": projection.right.map(number32),
        "up": projection.up.map(number32),
        "forward": projection.forward.map(number32),
        "near": number32(projection.near),
    })
}

fn passes(light: &LightPixels) -> Vec<Value> {
    light.passes.iter().map(pass).collect()
}

fn pass(pass: &Pass) -> Value {
    let mut entry = json!({
        "asked": pass.asked,
        "method": pass.method,
        "reason": pass.reason,
        "counting": pass.counting,
        "counting_reason": pass.counting_reason,
    });
    for verdict in PixelVerdict::ALL {
        entry[verdict.name()] = pass.counts.of(verdict).into();
    }
    entry["mismatches"] = pass.mismatches.iter().map(mismatch).collect();
    entry
}

fn mismatch(found: &Mismatch) -> Value {
    json!({
        "pixel": [found.x, found.y],
        "point": found.point.map(|point| point.map(number32)),
        "exact": found.exact,
        "counted": found.counted,
    })
}

/// Adds the keys of one object to another, in order.
fn append(object: &mut Value, more: Value) {
    if let (Some(object), Value::Object(more)) = (object.as_object_mut(), more) {
        object.extend(more);
    }
}

fn verdict(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Lit => "lit",
        Verdict::Shadowed => "shadowed",
        Verdict::Grazing => "grazing",
    }
}
