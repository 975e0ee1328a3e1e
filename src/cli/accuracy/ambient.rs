//! `umbrage accuracy ambient`: error against time of ambient occlusion.

use std::path::{Path, PathBuf};

use serde_json::{Value, json};
use umbrage::accuracy::{AmbientAccuracy, AmbientMethod, AmbientOptions, AmbientRow, Spread};
use umbrage::ambient::disks::LiteralForm;

use super::chart::{self, Entry, Panel};
use super::csv::cell;
use super::text::nanoseconds;
use super::{Args, save};
use crate::cli::chart::number;
use crate::cli::output::{self, Output, Table, counted, plain, significant};
use crate::cli::progress::Progress;
use crate::cli::{Failure, Outcome};

const HEADER: &str = "file,receivers,judged,method,mean_error,rms_error,p99_error,prepare_ms,ns_per_receiver,min_ns,max_ns,dominated_by\r\n";

/// Meaning of the columns.
const LEGEND: &str = "error: difference of openness, 0 to 1, to the analytic one; p99: 99 in 100 are at most this; \
                      us: microseconds per receiver, the median of the rounds, passes over all disks included; \
                      prepare: the trees; constant: the mean of the truth everywhere; literal: the formula of a tutorial \
                      of 2006; dominated: another method is as fast and as near to the truth";

const NOTES: &[&str] = &[
    "Height: mean of the difference to the analytic openness, over all judged receivers.",
    "Hollow: below 0.00001, and drawn there. Bars: the fastest and the slowest round.",
    "Thick line: what nothing else dominates, being as fast and as near to the truth.",
];

/// Mean errors below this are drawn here.
const FLOOR: f64 = 1e-5;

/// What was measured of one file.
struct Measured {
    file: PathBuf,
    faces: usize,
    found: AmbientAccuracy,
}

pub(super) fn run(args: &Args) -> Result<Outcome, Failure> {
    let usual = AmbientOptions::default();
    let receivers = args.queries_or(usual.receivers as u64)? as usize;
    let options = AmbientOptions { receivers, seed: args.seed, rounds: args.rounds };
    let mut out = Output::new();
    let mut outcome = Outcome::Sound;
    let (mut documents, mut all) = (Vec::new(), Vec::new());
    for (index, file) in args.files.iter().enumerate() {
        match measure(file, args, &options) {
            Ok(measured) => {
                if args.json {
                    documents.push(measured.document());
                } else {
                    out.text(format_args!("{}{}", if index > 0 { "\n" } else { "" }, measured.text()))?;
                    out.flush()?;
                }
                all.push(measured);
            }
            Err(failure) => {
                output::say(&failure);
                outcome = outcome.max(Outcome::Incomplete);
                documents.push(json!({ "file": file.to_string_lossy(), "error": failure.to_string() }));
            }
        }
    }
    if args.json {
        // One file is one document; several are a list of them.
        let document = if documents.len() == 1 { documents.remove(0) } else { Value::Array(documents) };
        out.json(&document)?;
    }
    out.flush()?;
    if !all.is_empty() {
        let rows = || all.iter().map(Measured::csv).collect::<String>();
        save(args.csv.as_deref(), || format!("{HEADER}{}", rows()))?;
        save(args.svg.as_deref(), || chart::svg(&all.iter().map(Measured::panel).collect::<Vec<_>>()))?;
    }
    Ok(outcome)
}

fn measure(file: &Path, args: &Args, options: &AmbientOptions) -> Result<Measured, Failure> {
    let mesh = args.source(file).load_caster()?;
    let methods = methods(&args.rays);
    let progress = Progress::bar(format!("measuring {}", file.display()), 1 + methods.len() as u64);
    let found = AmbientAccuracy::measure(&[&mesh], &methods, options, &|steps| progress.done(steps));
    drop(progress);
    let none = || Failure::new("there are no faces to ask about", "name a mesh that has some").in_file(file);
    Ok(Measured { file: file.to_owned(), faces: mesh.face_count(), found: found.ok_or_else(none)? })
}

/// The usual methods, with other numbers of rays if any are asked for.
fn methods(rays: &[u32]) -> Vec<AmbientMethod> {
    let mut methods = AmbientMethod::usual();
    if !rays.is_empty() {
        methods.retain(|method| !matches!(method, AmbientMethod::Rays { .. }));
        let pair = |&rays| [false, true].map(|ring| AmbientMethod::Rays { rays, ring });
        methods.splice(1..1, rays.iter().flat_map(pair));
    }
    methods
}

impl Measured {
    fn document(&self) -> Value {
        let mut document = json!({ "file": self.file.to_string_lossy() });
        let found = serde_json::to_value(&self.found).expect("numbers and text");
        if let (Some(document), Value::Object(found)) = (document.as_object_mut(), found) {
            document.extend(found);
        }
        document
    }

    fn text(&self) -> String {
        let AmbientAccuracy { receivers, judged, truth, rows, .. } = &self.found;
        let mut table = Table::new(&[
            "method",
            "mean error",
            "rms error",
            "p99 error",
            "prepare ms",
            "us",
            "min",
            "max",
            "",
        ]);
        for row in rows {
            let time = row.ns_per_receiver;
            let micro = |ns: f64| nanoseconds(1e-3 * ns);
            table.row(vec![
                row.method.to_string(),
                error(row.mean_error),
                error(row.rms_error),
                error(row.p99_error),
                nanoseconds(row.prepare_ms),
                micro(time.median),
                micro(time.min),
                micro(time.max),
                row.dominated_by.map_or(String::new(), |by| format!("dominated by {by}")),
            ]);
        }
        format!(
            "{}: ambient occlusion, {} faces, {judged} of {} judged\ntruth: analytic, off by at most {:.1e}\n\n{table}\n\
             {LEGEND}\n",
            plain(&self.file.to_string_lossy()),
            self.faces,
            counted(*receivers, "receiver", "receivers"),
            truth.bound,
        )
    }

    fn csv(&self) -> String {
        let AmbientAccuracy { receivers, judged, rows, .. } = &self.found;
        let line = |row: &AmbientRow| {
            let time = row.ns_per_receiver;
            let cells = [
                self.file.to_string_lossy().into_owned(),
                receivers.to_string(),
                judged.to_string(),
                row.method.to_string(),
                format!("{:e}", row.mean_error),
                format!("{:e}", row.rms_error),
                format!("{:e}", row.p99_error),
                format!("{:.4}", row.prepare_ms),
                format!("{:.4}", time.median),
                format!("{:.4}", time.min),
                format!("{:.4}", time.max),
                row.dominated_by.map_or(String::new(), |by| by.to_string()),
            ];
            cells.map(cell).join(",") + "\r\n"
        };
        rows.iter().map(line).collect()
    }

    /// A chart of error against time. The constant takes none, and is left out.
    fn panel(&self) -> Panel {
        let name = self.file.file_name().unwrap_or(self.file.as_os_str()).to_string_lossy();
        let rows = self.found.rows.iter().filter(|row| row.method != AmbientMethod::Constant);
        let [faces, receivers] = [self.faces, self.found.judged].map(|count| number(count as f64));
        Panel {
            heading: "Error against time: ambient occlusion".to_owned(),
            second_line: format!("{}, {faces} faces, {receivers} receivers", chart::shortened(&name)),
            titles: ["microseconds a receiver, median of the rounds", "mean error"],
            notes: NOTES,
            entries: rows.map(entry).collect(),
        }
    }
}

/// A short name for the chart: of all rows of a kind, only what tells one from another.
fn label(method: AmbientMethod) -> String {
    match method {
        AmbientMethod::Rays { rays, ring } => format!("{rays} rays{}", if ring { ", ring" } else { "" }),
        AmbientMethod::Disks(passes, _) => {
            format!("disks, {}", counted(passes.passes as usize, "pass", "passes"))
        }
        AmbientMethod::Literal(LiteralForm::AsPrinted) => "literal".to_owned(),
        AmbientMethod::Literal(LiteralForm::AreaRestored) => "literal, area restored".to_owned(),
        _ => method.to_string(),
    }
}

fn entry(row: &AmbientRow) -> Entry {
    let (Spread { median, min, max }, mean) = (row.ns_per_receiver, row.mean_error);
    let cost = Spread { median: median / 1e3, min: min / 1e3, max: max / 1e3 };
    let error = if mean <= FLOOR { "below 0.00001".to_owned() } else { significant(mean) };
    Entry {
        name: label(row.method),
        said: format!("{} us, mean error {error}", nanoseconds(cost.median)),
        cost,
        error: mean.max(FLOOR),
        is_hollow: mean <= FLOOR,
        dominated: row.dominated_by.is_some(),
    }
}

/// Errors to four decimals: their own noise is not below.
fn error(error: f64) -> String {
    format!("{error:.4}")
}
