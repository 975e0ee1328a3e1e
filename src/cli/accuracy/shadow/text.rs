//! The table of `accuracy shadow` as text and as CSV.

use umbrage::accuracy::{ShadowAccuracy, ShadowRow};
use umbrage::verify::errors::Errors;

use super::Measured;
use crate::cli::accuracy::csv::cell;
use crate::cli::lights;
use crate::cli::output::{Table, counted, plain, significant};

pub(super) const HEADER: &str = "file,light,technique,device,claim,judged,wrong,acne,leak,alias_dark,alias_lit,mean_error,prepare_ms,frame_ms,min_ms,max_ms,bytes,dominated_by\r\n";

/// Meaning of the columns.
const LEGEND: &str = "judged: samples that face the light and whose exact verdict is not grazing; wrong: contradicts \
                      the truth; acne: falsely dark, leak: falsely lit; by rays: samples that \
                      were passed to exact shadow rays; prepare: work that stays valid while the \
                      camera moves; frame: from given samples to their visibility, the median of the rounds; dominated: \
                      another technique is as fast and as often right";

/// A share in percent: "1 in 20,000" would make the reader divide.
fn percent(part: u64, of: u64) -> String {
    match part {
        0 => "0".to_owned(),
        _ => format!("{:.3} %", 100.0 * part as f64 / of.max(1) as f64),
    }
}

pub(super) fn milliseconds(ms: f64) -> String {
    let decimals = if ms < 10.0 { 2 } else { usize::from(ms < 100.0) };
    format!("{ms:.decimals$}")
}

impl Measured {
    pub(super) fn text(&self) -> String {
        let head = format!(
            "{}: shadows of {} in a view of {}, {}\n",
            plain(&self.file.to_string_lossy()),
            counted(self.found.len(), "light", "lights"),
            self.size,
            counted(self.samples, "sample", "samples"),
        );
        let tables = self.lights.iter().zip(&self.found).zip(&self.chosen).map(|((light, found), chosen)| {
            let name = lights::lamp_label(light);
            let judged = found.rows.first().map_or(0, |row| row.errors.judged);
            let chosen = chosen.as_ref().map_or_else(String::new, |chosen| format!("{}\n", chosen.text()));
            format!("\n{name}: {judged} samples judged\n{}\n{chosen}", Self::table(found))
        });
        let broken: Vec<&ShadowRow> =
            self.found.iter().flat_map(|found| &found.rows).filter(|row| !row.holds).collect();
        let verdict = match broken.first() {
            None => "every claim holds".to_owned(),
            Some(row) => format!("{} claims to be {}, and is not", row.technique, row.claim),
        };
        format!("{head}{}\nverdict: {verdict}\n{LEGEND}\n", tables.collect::<String>())
    }

    fn table(found: &ShadowAccuracy) -> Table {
        let mut table = Table::new(&[
            "technique",
            "on",
            "claim",
            "wrong",
            "acne",
            "leak",
            "mean error",
            "by rays",
            "prepare ms",
            "frame ms",
            "KiB",
            "",
        ]);
        for row in &found.rows {
            let errors = &row.errors;
            table.row(vec![
                row.technique.to_string(),
                if row.device.is_some() { "device" } else { "CPU" }.to_owned(),
                row.claim.name().to_owned(),
                verdicts(errors, || percent(errors.wrong, errors.judged)),
                verdicts(errors, || errors.acne.to_string()),
                verdicts(errors, || errors.leak.to_string()),
                significant(errors.mean),
                row.asked_exactly.map_or(String::new(), |count| count.to_string()),
                milliseconds(row.prepare_ms),
                milliseconds(row.frame_ms.median),
                row.bytes.div_ceil(1024).to_string(),
                row.dominated_by.map_or(String::new(), |by| format!("dominated by {by}")),
            ]);
        }
        table
    }

    pub(super) fn csv(&self) -> String {
        let file = self.file.to_string_lossy().into_owned();
        let rows = self.lights.iter().zip(&self.found).flat_map(|(light, found)| {
            let name = lights::lamp_label(light);
            let file = file.clone();
            found.rows.iter().map(move |row| {
                let errors = &row.errors;
                let count = |count: u64| if errors.is_soft { String::new() } else { count.to_string() };
                let cells = [
                    file.clone(),
                    name.clone(),
                    row.technique.to_string(),
                    row.device.clone().unwrap_or_default(),
                    row.claim.name().to_owned(),
                    errors.judged.to_string(),
                    count(errors.wrong),
                    count(errors.acne),
                    count(errors.leak),
                    count(errors.alias_dark),
                    count(errors.alias_lit),
                    format!("{:e}", errors.mean),
                    format!("{:.4}", row.prepare_ms),
                    format!("{:.4}", row.frame_ms.median),
                    format!("{:.4}", row.frame_ms.min),
                    format!("{:.4}", row.frame_ms.max),
                    row.bytes.to_string(),
                    row.dominated_by.map_or(String::new(), |by| by.name().to_owned()),
                ];
                cells.map(cell).join(",") + "\r\n"
            })
        });
        rows.collect()
    }
}

/// A count of wrong samples as text; a dash for soft shadows, whose errors are magnitudes.
fn verdicts(errors: &Errors, text: impl Fn() -> String) -> String {
    if errors.is_soft { "-".to_owned() } else { text() }
}
