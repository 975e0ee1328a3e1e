//! The page of `accuracy shadow --html`: charts, a table and pictures in one file that needs nothing else.

use maud::{Markup, PreEscaped, html};
use umbrage::accuracy::{ShadowAccuracy, ShadowRow};
use umbrage::scene::Lamp;
use umbrage::shadow::Claim;

use super::pictures::{self, Pictures, RowPictures};
use super::{Measured, panels, text, words};
use crate::cli::accuracy::chart;
use crate::cli::chart::number as grouped;
use crate::cli::lights;
use crate::cli::output::plain;
use crate::cli::page;

const STYLE: &str = include_str!("page.css");
const SCRIPT: &str = include_str!("page.js");

/// The page of several files. `command` is what made it.
pub(super) fn page(measured: &[Measured], command: &str) -> String {
    let title = "Accuracy of shadows";
    let body = html! {
        h1 { (title) ": error against time" }
        p.faint {
            "Made by " code { (command) } " (umbrage " (env!("CARGO_PKG_VERSION")) ", " (machine()) ")."
        }
        @for (file, of_file) in measured.iter().enumerate() {
            @for (index, found) in of_file.found.iter().enumerate() {
                (section(of_file, index, &format!("l{file}-{index}"), found))
            }
        }
    };
    page::document(title, STYLE, &body, SCRIPT)
}

fn machine() -> String {
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    format!("{} on {}, {threads} threads", std::env::consts::ARCH, std::env::consts::OS)
}

/// One lamp of one file.
fn section(of_file: &Measured, index: usize, id: &str, found: &ShadowAccuracy) -> Markup {
    let pictures = of_file.pictures.get(index);
    let chosen = of_file.chosen.get(index).and_then(Option::as_ref);
    let file = of_file.file.file_name().unwrap_or(of_file.file.as_os_str()).to_string_lossy();
    let lamp: &Lamp = &found.lamp;
    let judged = found.rows.first().map_or(0, |row| row.errors.judged);
    let truth_id = format!("{id}-truth");
    html! {
        h2 { (plain(&file)) ", " (lights::lamp_label(lamp)) }
        p {
            (grouped(of_file.samples as f64)) " samples in a view of " (of_file.size.to_string()) ", "
            (grouped(judged as f64)) " of them judged. The truth: " (truth(found)) "."
        }
        @if let Some(pictures) = pictures {
            figure.large {
                img id=(truth_id) src=(page::picture_url(&pictures.truth)) alt="the truth"
                    width=(pictures.truth.size.width()) height=(pictures.truth.size.height());
                figcaption { "What is true, lit by this lamp alone." }
            }
        }
        h3 { (verdict(found)) }
        @if let Some(chosen) = chosen {
            p { "By itself " (chosen.text()) "." }
        }
        div.charts {
            @for panel in [panels::error_against_time(of_file, found), panels::error_against_memory(of_file, found)] {
                (PreEscaped(chart::svg(&[panel])))
            }
        }
        (table(found))
        @for (index, row) in found.rows.iter().enumerate() {
            (technique(found, row, pictures.map(|pictures| (pictures, &pictures.rows[index])), &truth_id))
        }
    }
}

fn truth(found: &ShadowAccuracy) -> String {
    match found.truth.bound() {
        None => "one exact shadow ray per sample".to_owned(),
        Some(bound) => {
            format!("the visible fraction of the lamp, computed analytically, off by at most {bound:.1e}")
        }
    }
}

/// The cheapest exact technique against the cheapest of all, as a headline.
fn verdict(found: &ShadowAccuracy) -> String {
    let cheapest = |rows: &mut dyn Iterator<Item = &ShadowRow>| {
        rows.min_by(|a, b| a.frame_ms.median.total_cmp(&b.frame_ms.median))
            .map(|row| (panels::label(row), text::milliseconds(row.frame_ms.median)))
    };
    let is_right = |row: &&ShadowRow| match row.errors.has_fractions {
        true => row.errors.max <= panels::FLOOR,
        false => row.errors.wrong == 0,
    };
    match cheapest(&mut found.rows.iter().filter(is_right)) {
        None => format!("{} rows, and none is right at every sample", found.rows.len()),
        Some((name, ms)) => {
            format!(
                "{} rows: the fastest that is right at every sample is {name}, {ms} ms a frame",
                found.rows.len()
            )
        }
    }
}

fn milliseconds(ms: f64) -> String {
    format!("{ms:.2}")
}

fn table(found: &ShadowAccuracy) -> Markup {
    let soft = found.truth.fractions().is_some();
    html! {
        div.scroll {
            table {
                thead { tr {
                    th { "technique" } th.word { "on" } th.word { "claim" }
                    th { "wrong, of " (grouped(found.rows.first().map_or(0, |row| row.errors.judged) as f64)) }
                    th { "acne" } th { "leak" } th { "alias dark" } th { "alias lit" }
                    th { "mean error" } th { "p99" } th { "largest" }
                    @if soft { th { "mean in penumbrae" } }
                    th { "reads a sample" } th { "prepare, ms" } th { "frame, ms" } th { "KiB" }
                    th.word { "dominated by" }
                } }
                tbody {
                    @for row in &found.rows { (table_row(row, soft)) }
                }
            }
        }
    }
}

fn table_row(row: &ShadowRow, soft: bool) -> Markup {
    let errors = &row.errors;
    let count = |count: u64| (!errors.is_soft).then_some(count as f64);
    let texels = |found: u64| count(found).filter(|_| row.texel_world.is_some());
    html! {
        tr.dominated[row.dominated_by.is_some()] {
            td { (row.technique) }
            td.word { (row.device.as_deref().map_or("CPU", |_| "device")) }
            td.word { (row.claim.name()) @if !row.holds { " – false" } }
            (cell(count(errors.wrong), grouped))
            (cell(count(errors.acne), grouped))
            (cell(count(errors.leak), grouped))
            (cell(texels(errors.alias_dark), grouped))
            (cell(texels(errors.alias_lit), grouped))
            (cell(Some(errors.mean), error))
            (cell(Some(errors.p99), error))
            (cell(Some(errors.max), error))
            @if soft { (cell(errors.penumbra_mean, error)) }
            (cell(row.reads, |reads| format!("{reads:.1}")))
            (cell(Some(row.prepare_ms), milliseconds))
            (cell(Some(row.frame_ms.median), milliseconds))
            (cell(Some(row.bytes.div_ceil(1024) as f64), grouped))
            td.word { (row.dominated_by.map_or(String::new(), |by| by.to_string())) }
        }
    }
}

/// A number, sorted by its value; empty if it does not apply.
fn cell(value: Option<f64>, text: impl Fn(f64) -> String) -> Markup {
    match value {
        None => html! { td data-value="" {} },
        Some(value) => html! { td data-value=(value) { (text(value)) } },
    }
}

fn error(value: f64) -> String {
    if value == 0.0 { "0".to_owned() } else { format!("{value:.5}") }
}

/// What four decimals show as 0.
const NEGLIGIBLE: f64 = 5e-5;

/// A mean error in a sentence.
fn brief(value: f64) -> String {
    match value {
        x if x < NEGLIGIBLE => "less than 0.0001".to_owned(),
        x => format!("{x:.4}"),
    }
}

/// The section of one technique.
fn technique(
    found: &ShadowAccuracy,
    row: &ShadowRow,
    pictures: Option<(&Pictures, &RowPictures)>,
    truth: &str,
) -> Markup {
    html! {
        section.technique {
            h3 { (panels::label(row)) }
            p { (words::what(row.technique)) " " (went_wrong(row)) " " (words::when(row.technique)) }
            @if let Some((all, of_row)) = pictures {
                div.pictures {
                    figure {
                        div.compare data-truth=(format!("#{truth}")) {
                            img src=(page::picture_url(&of_row.shown)) alt=(format!("{} draws this", row.technique));
                        }
                        figcaption { "What " (row.technique) " draws." }
                    }
                    figure.large {
                        img src=(page::picture_url(&of_row.errors)) alt="where it errs";
                        figcaption { (legend(found)) }
                    }
                }
                (worst(all, of_row))
            }
        }
    }
}

fn legend(found: &ShadowAccuracy) -> Markup {
    let scale = pictures::full_scale(found);
    let full = if scale < 1.0 { format!(" Full color from an error of {scale} on.") } else { String::new() };
    html! {
        span.key style="background:#1e88e5" {} "too dark"
        span.key style="background:#ff8f00" {} "too light"
        @if found.truth.fractions().is_none() { span.key style="background:#fdd835" {} "a tie" }
        "." (full)
    }
}

/// The worst region, enlarged.
fn worst(all: &Pictures, of_row: &RowPictures) -> Markup {
    let Some(corner) = of_row.worst else { return html! {} };
    let crops = [(&all.truth, "truth"), (&of_row.shown, "technique"), (&of_row.errors, "error")];
    html! {
        div.pictures.worst {
            @for (picture, name) in crops {
                @if let Some(crop) = pictures::crop(picture, corner) {
                    figure {
                        img src=(page::picture_url(&crop)) alt=(name);
                        figcaption { (name) ", worst region" }
                    }
                }
            }
        }
    }
}

/// What a technique got wrong here, and why.
fn went_wrong(row: &ShadowRow) -> String {
    let errors = &row.errors;
    let claim = match row.claim {
        Claim::Exact | Claim::WithinFootprint if row.holds => " as it claims",
        _ if !row.holds => ", against its claim",
        _ => "",
    };
    if errors.has_fractions {
        let penumbra = errors
            .penumbra_mean
            .map_or(String::new(), |mean| format!(" and by {} inside penumbrae", brief(mean)));
        let sign = match errors.mean_signed {
            _ if errors.mean < NEGLIGIBLE => "",
            x if x > 0.0 => ", on the whole too light",
            x if x < 0.0 => ", on the whole too dark",
            _ => "",
        };
        return format!("Here it errs by {} on average{penumbra}{sign}.", brief(errors.mean));
    }
    if errors.wrong == 0 {
        return format!("Here it is right at all {} judged samples{claim}.", grouped(errors.judged as f64));
    }
    let kinds = [
        (errors.acne, "false shadows away from edges"),
        (errors.leak, "false light away from edges"),
        (errors.alias_dark + errors.alias_lit, "within two texels of an edge"),
        (errors.outside, "outside the map"),
    ];
    let kinds: Vec<String> = kinds
        .into_iter()
        .filter(|(count, _)| *count > 0)
        .map(|(count, kind)| format!("{} {kind}", grouped(count as f64)))
        .collect();
    format!(
        "Here it is wrong at {} of {} judged samples{claim}: {}.",
        grouped(errors.wrong as f64),
        grouped(errors.judged as f64),
        kinds.join(", ")
    )
}
