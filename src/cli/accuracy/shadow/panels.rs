//! Charts of the techniques: error against time, and against memory.

use umbrage::accuracy::{ShadowAccuracy, ShadowRow, Spread};
use umbrage::verify::Tally;
use umbrage::verify::errors::Errors;

use super::Measured;
use crate::cli::accuracy::chart::{self, Entry, NOTES_OF_COUNTS, Panel};
use crate::cli::chart::{number, significant};
use crate::cli::lights;

/// Mean errors below this are drawn here: half a step of eight-bit color is 0.002.
pub(super) const FLOOR: f64 = 1e-5;

const NOTES_OF_MAGNITUDES: &[&str] = &[
    "Height: mean of the difference to the visible fraction of the lamp, over all judged samples.",
    "Hollow: below 0.00001, and drawn there. Bars: the fastest and the slowest round.",
    "Thick line: what nothing else dominates, being as fast and as near to the truth.",
];

/// A chart of one lamp: error against the time of a frame.
pub(super) fn error_against_time(of_file: &Measured, found: &ShadowAccuracy) -> Panel {
    let titles = ["milliseconds a frame, median of the rounds", error_title(found)];
    panel(of_file, found, "Error against time: shadows of one light", titles, |row| (row.frame_ms, "ms"))
}

/// A chart of one lamp: error against what is held in memory.
pub(super) fn error_against_memory(of_file: &Measured, found: &ShadowAccuracy) -> Panel {
    let titles = ["KiB for the light and the visibility", error_title(found)];
    let mut panel = panel(of_file, found, "Error against memory: shadows of one light", titles, |row| {
        let kib = row.bytes as f64 / 1024.0;
        (Spread { median: kib, min: kib, max: kib }, "KiB")
    });
    // Rows know what dominates them in time.
    let costs: Vec<(f64, f64)> = panel.entries.iter().map(|entry| (entry.cost.median, entry.error)).collect();
    for (entry, own) in panel.entries.iter_mut().zip(&costs) {
        entry.dominated = costs.iter().any(|other| other.0 <= own.0 && other.1 <= own.1 && other != own);
    }
    panel
}

fn error_title(found: &ShadowAccuracy) -> &'static str {
    match found.truth.fractions() {
        Some(_) => "mean error",
        None => "wrong samples, of those judged",
    }
}

fn panel(
    of_file: &Measured,
    found: &ShadowAccuracy,
    heading: &str,
    titles: [&'static str; 2],
    cost: impl Fn(&ShadowRow) -> (Spread, &'static str),
) -> Panel {
    let file = of_file.file.file_name().unwrap_or(of_file.file.as_os_str()).to_string_lossy();
    Panel {
        heading: heading.to_owned(),
        second_line: format!(
            "{}, {} samples, {}",
            chart::shortened(&file),
            number(of_file.samples as f64),
            lights::lamp_label(&found.lamp)
        ),
        titles,
        notes: if found.truth.fractions().is_some() { NOTES_OF_MAGNITUDES } else { NOTES_OF_COUNTS },
        entries: found.rows.iter().map(|row| entry(row, cost(row))).collect(),
    }
}

fn entry(row: &ShadowRow, (cost, unit): (Spread, &'static str)) -> Entry {
    let Errors { judged, wrong, samples, excused, mean, has_fractions, .. } = row.errors;
    let tally = Tally { queries: samples, ties: excused, judged, wrong };
    let (said, error, is_hollow) = match has_fractions {
        true => {
            let error = if mean <= FLOOR { "below 0.00001".to_owned() } else { significant(mean) };
            let said = format!("{} {unit}, mean error {error}", significant(cost.median));
            (said, mean.max(FLOOR), mean <= FLOOR)
        }
        false => (chart::said(cost.median, unit, &tally), chart::height(&tally), wrong == 0),
    };
    Entry { name: label(row), said, cost, error, is_hollow, dominated: row.dominated_by.is_some() }
}

/// The technique with its options, and where it ran.
pub(super) fn label(row: &ShadowRow) -> String {
    format!("{}{}", row.technique, if row.device.is_some() { ", device" } else { "" })
}
