//! What `umbrage verify` prints for people.

use std::path::Path;

use umbrage::scene::Lamp;
use umbrage::verify::pixels::{Mismatch, PixelVerdict};
use umbrage::verify::points::Verification;

use super::pixels::Pixels;
use super::{judges, strata, summed, total};
use crate::cli::lights;
use crate::cli::output::{Table, counted, plain};

/// Meaning of two columns.
const LEGEND: &str = "grazing: the shadow ray only touches a face, and either answer is right; rate below: \
                      with 95 % confidence, methods disagree on at most this part of such points, if the points \
                      were independent";

/// Meaning of the columns of pixels.
const PIXEL_LEGEND: &str = "grazing pixel: the counts differ, and the exact one changes within the step that a \
                            rasterizer may be off; unsure: a side was left to f32; overflow: eight bits have \
                            wrapped; real: nothing explains it";

/// The tables of strata and judges, each disagreement, the verdict, and a legend.
pub(in crate::cli) fn text(file: &Path, lights: &[Lamp], results: &[Verification]) -> String {
    report(file, lights, results, None)
}

/// The same, with the pixels.
pub(super) fn report(
    file: &Path,
    lights: &[Lamp],
    results: &[Verification],
    pixels: Option<&Pixels>,
) -> String {
    let strata = strata(results);
    let lit: Vec<String> = lights.iter().map(lights::lamp_label).collect();
    let mut points = Table::new(&["points", "judged", "agree", "grazing", "disagree", "rate below (95 %)"]);
    for row in strata.iter().chain([&total(&strata)]) {
        let bound = row.bound_95().map_or("-".to_owned(), |bound| format!("{bound:.1e}"));
        let counts = [row.points, row.agree, row.grazing, row.disagree].map(|count| count.to_string());
        points.row([row.name.to_owned()].into_iter().chain(counts).chain([bound]).collect());
    }
    let mut asked = Table::new(&["method", "asked", "abstained", "contradicts the ray cast"]);
    for judge in &summed(&judges(results, pixels)) {
        let counts = [judge.points, judge.abstain, judge.disagree].map(|count| count.to_string());
        asked.row([judge.name.to_owned()].into_iter().chain(counts).collect());
    }
    let mut places = String::new();
    for (light, result) in lit.iter().zip(results) {
        for found in &result.disagreements {
            let [x, y, z] = found.point;
            places += &format!("disagreement: {light} at {x},{y},{z} ({}): {}\n", found.stratum, found.what);
        }
    }
    let wrong_pixels = pixels.map_or(0, |pixels| pixels.counts().disagree());
    let verdict = match (total(&strata).disagree as usize, wrong_pixels) {
        (0, 0) => "all methods agree".to_owned(),
        (points, 0) => counted(points, "disagreement", "disagreements"),
        (0, pixels) => counted(pixels, "wrong pixel", "wrong pixels"),
        (points, pixels) => format!(
            "{}, {}",
            counted(points, "disagreement", "disagreements"),
            counted(pixels, "wrong pixel", "wrong pixels")
        ),
    };
    let file = plain(&file.to_string_lossy());
    let (drawn, legend) = match pixels {
        None => (String::new(), LEGEND.to_owned()),
        Some(pixels) => (drawn(&lit, pixels), format!("{LEGEND}\n{PIXEL_LEGEND}")),
    };
    let lit = lit.join("  ");
    format!("{file}\nlights: {lit}\n\n{points}\n\n{asked}\n\n{drawn}{places}verdict: {verdict}\n{legend}\n")
}

/// The table of pixels, why each pass was drawn as it was, and each mismatch.
fn drawn(lit: &[String], pixels: &Pixels) -> String {
    let header: Vec<&str> = ["pixels", "pass", "method", "counting", "judged"]
        .into_iter()
        .chain(PixelVerdict::ALL.map(PixelVerdict::name))
        .collect();
    let mut table = Table::new(&header);
    let (mut reasons, mut mismatches) = (String::new(), String::new());
    for (label, light) in lit.iter().zip(&pixels.lights) {
        for pass in &light.passes {
            let counts = PixelVerdict::ALL.map(|verdict| pass.counts.of(verdict).to_string());
            let words = [label.as_str(), pass.asked, pass.method, pass.counting].map(str::to_owned);
            table.row(words.into_iter().chain([pass.counts.pixels().to_string()]).chain(counts).collect());
            let (method, counting) = (&pass.reason, &pass.counting_reason);
            let method = if method.is_empty() { "no shells" } else { method };
            reasons += &format!(
                "{label}, {}: {method}; counted in the {}: {counting}\n",
                pass.asked,
                place(pass.counting)
            );
            for found in &pass.mismatches {
                mismatches += &format!("mismatch: {label}, {}: {}\n", pass.asked, mismatch(found));
            }
        }
    }
    let [x, y, z] = pixels.projection.eye;
    let Pixels { adapter, size, projection, .. } = pixels;
    let near = match pixels.near_asked {
        true => format!("near plane {} away, as asked for: nothing nearer is compared", projection.near),
        false => format!("near plane {} away, before everything that is seen", projection.near),
    };
    format!(
        "{table}\n\n{reasons}picture: {size} from {x},{y},{z}, {near}, on {}\n{mismatches}\n",
        plain(adapter)
    )
}

/// Where counts are kept, in words.
fn place(counting: &str) -> &'static str {
    match counting {
        "stencil" => "stencil's 8 bits",
        _ => "32 bits of memory",
    }
}

fn mismatch(found: &Mismatch) -> String {
    let Mismatch { x, y, .. } = found;
    let counted = found.counted.map_or("no surface drawn".to_owned(), |count| format!("{count} counted"));
    let counted = if found.cut { format!("cut away by the near plane, {counted}") } else { counted };
    match (found.point, found.exact) {
        (Some([px, py, pz]), Some(exact)) => {
            format!("pixel {x},{y} sees {px},{py},{pz}: {exact} between it and the light, {counted}")
        }
        _ => format!("pixel {x},{y} sees nothing, {counted}"),
    }
}
