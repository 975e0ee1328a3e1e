//! `umbrage accuracy shadow`: error against time of every technique, for each light and one view.

use std::path::{Path, PathBuf};

use serde_json::{Value, json};
use umbrage::accuracy::{ShadowAccuracy, ShadowRow};
use umbrage::caster::CasterGroup;
use umbrage::scene::Lamp;
use umbrage::shadow::{Claim, Samples, Technique};
use umbrage::verify::Tally;
use umbrage::verify::errors::Errors;
use umbrage::view::{Projection, Size};

use super::Args;
use super::chart::{self, Entry, Panel};
use super::csv::cell;
use crate::cli::chart::number as number_text;
use crate::cli::input::Source;
use crate::cli::output::{self, Output, Table, counted, number, plain, significant};
use crate::cli::progress::Progress;
use crate::cli::{Failure, Outcome, lights};

/// The default size of the view.
const SIZE: (u32, u32) = (480, 270);

/// What was measured of one file.
struct Measured {
    file: PathBuf,
    size: Size,
    samples: usize,
    lights: Vec<Lamp>,
    found: Vec<ShadowAccuracy>,
}

pub(super) fn run(args: &Args) -> Result<Outcome, Failure> {
    let mut out = Output::new();
    let mut outcome = Outcome::Sound;
    let mut documents = Vec::new();
    let mut table = HEADER.to_owned();
    let mut panels = Vec::new();
    for (index, file) in args.files.iter().enumerate() {
        match measure(file, args) {
            Ok(measured) => {
                if !measured.found.iter().all(ShadowAccuracy::claims_hold) {
                    outcome = outcome.max(Outcome::Unsound);
                }
                table += &measured.csv();
                panels.extend(measured.panels());
                if args.json {
                    documents.push(measured.document());
                } else {
                    out.text(format_args!("{}{}", if index > 0 { "\n" } else { "" }, measured.text()))?;
                    out.flush()?;
                }
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
    super::save(args.csv.as_deref(), || table)?;
    super::save(args.svg.as_deref(), || chart::svg(&panels))?;
    Ok(outcome)
}

fn measure(file: &Path, args: &Args) -> Result<Measured, Failure> {
    let source = args.source(file).load()?;
    let Source { up, ref caster, bounds, ref lights, ref cameras, .. } = source;
    if caster.mesh().face_count() == 0 {
        let problem = "there are no faces to cast or to receive a shadow";
        return Err(Failure::new(problem, "name a mesh that has some").in_file(file));
    }
    let size = args.size.unwrap_or(Size::new(SIZE.0, SIZE.1).expect("in range"));
    let camera = args.view.choose(cameras, file, &bounds, up, size)?;
    let projection: Projection = camera.projection(size, camera.near([source.seen().mesh()], size));
    let steps = ShadowAccuracy::STEPS * lights.len() as u64;
    let progress = Progress::bar(format!("measuring {}", file.display()), steps);
    let casters = source.group();
    let view = |casters: &CasterGroup<'_>| {
        Samples::of_view(casters, &projection, size, args.samples.unwrap_or(1))
            .map_err(|error| Failure::new(error, "use a smaller --size").in_file(file))
    };
    let done = |steps| progress.done(steps);
    let (samples, mut found) = ShadowAccuracy::measure(&casters, lights, view, args.rounds, &done)?;
    drop(progress);
    add_device(args, &casters, &samples, &mut found)?;
    Ok(Measured { file: file.to_owned(), size, samples: samples.len(), lights: lights.clone(), found })
}

/// Adds the rows of a graphics adapter, where there is one.
#[cfg(feature = "gpu")]
fn add_device(
    args: &Args,
    casters: &CasterGroup<'_>,
    samples: &Samples,
    found: &mut [ShadowAccuracy],
) -> Result<(), Failure> {
    let gpu = match args.adapter.find()? {
        Ok(gpu) => gpu,
        Err(error) => {
            output::say(format_args!("note: no rows of a graphics adapter: {error}"));
            return Ok(());
        }
    };
    if samples.per_side() > 1 {
        output::say("note: no rows of a graphics adapter: they need --samples 1");
        return Ok(());
    }
    let progress = Progress::spinner(format!("measuring on {}", gpu.name()));
    for light in found {
        if let Err(error) = light.add_device(&gpu, casters, samples, args.rounds) {
            drop(progress);
            output::say(format_args!("note: no rows of a graphics adapter: {error}"));
            break;
        }
    }
    Ok(())
}

#[cfg(not(feature = "gpu"))]
fn add_device(
    args: &Args,
    _: &CasterGroup<'_>,
    _: &Samples,
    _: &mut [ShadowAccuracy],
) -> Result<(), Failure> {
    args.adapter.refuse()
}

/// A share in percent: "1 in 20,000" would make the reader divide.
fn percent(part: u64, of: u64) -> String {
    match part {
        0 => "0".to_owned(),
        _ => format!("{:.3} %", 100.0 * part as f64 / of.max(1) as f64),
    }
}

fn milliseconds(ms: f64) -> String {
    let decimals = if ms < 10.0 { 2 } else { usize::from(ms < 100.0) };
    format!("{ms:.decimals$}")
}

impl Measured {
    fn text(&self) -> String {
        let head = format!(
            "{}: shadows of {} in a view of {}, {}\n",
            plain(&self.file.to_string_lossy()),
            counted(self.found.len(), "light", "lights"),
            self.size,
            counted(self.samples, "sample", "samples"),
        );
        let tables = self.lights.iter().zip(&self.found).map(|(light, found)| {
            let name = lights::lamp_label(light);
            let judged = found.rows.first().map_or(0, |row| row.errors.judged);
            format!("\n{name}: {judged} samples judged\n{}\n", Self::table(found))
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
                milliseconds(row.prepare_ms),
                milliseconds(row.frame_ms.median),
                row.bytes.div_ceil(1024).to_string(),
                row.dominated_by.map_or(String::new(), |by| format!("dominated by {by}")),
            ]);
        }
        table
    }

    fn document(&self) -> Value {
        let lights = self.lights.iter().zip(&self.found).map(|(light, found)| {
            json!({
                "name": lights::lamp_label(light),
                "truth": { "method": "exact ray cast", "bound": 0.0 },
                "rows": found.rows.iter().map(row_document).collect::<Vec<_>>(),
            })
        });
        json!({
            "file": self.file.to_string_lossy(),
            "samples": self.samples,
            "lights": lights.collect::<Vec<_>>(),
        })
    }

    /// A chart for each light.
    fn panels(&self) -> Vec<Panel> {
        let file = self.file.file_name().unwrap_or(self.file.as_os_str()).to_string_lossy();
        let panel = |(light, found): (&Lamp, &ShadowAccuracy)| Panel {
            heading: "Error against time: shadows of one light".to_owned(),
            second_line: format!(
                "{}, {} samples, {}",
                chart::shortened(&file),
                number_text(self.samples as f64),
                lights::label(light.light(), &light.name)
            ),
            titles: ["milliseconds a frame, median of the rounds", "wrong samples, of those judged"],
            entries: found.rows.iter().map(entry).collect(),
        };
        self.lights.iter().zip(&self.found).map(panel).collect()
    }

    fn csv(&self) -> String {
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

const HEADER: &str = "file,light,technique,device,claim,judged,wrong,acne,leak,alias_dark,alias_lit,mean_error,prepare_ms,frame_ms,min_ms,max_ms,bytes,dominated_by\r\n";

/// Meaning of the columns.
const LEGEND: &str = "judged: samples that face the light and whose exact verdict is not grazing; wrong: contradicts \
                      the truth; acne: falsely dark, leak: falsely lit; prepare: work that stays valid while the \
                      camera moves; frame: from given samples to their visibility, the median of the rounds; dominated: \
                      another technique is as fast and as often right";

fn entry(row: &ShadowRow) -> Entry {
    let Errors { judged, wrong, samples, excused, .. } = row.errors;
    let tally = Tally { queries: samples, ties: excused, judged, wrong };
    let device = if row.device.is_some() { ", device" } else { "" };
    Entry {
        name: format!("{}{device}", row.technique),
        said: chart::said(row.frame_ms.median, "ms", &tally),
        time: row.frame_ms,
        tally,
        dominated: row.dominated_by.is_some(),
    }
}

/// What is told of verdicts; nothing where magnitudes count.
fn verdicts(errors: &Errors, text: impl Fn() -> String) -> String {
    if errors.is_soft { "-".to_owned() } else { text() }
}

/// The options as an object, numbers as numbers; null for a technique without options.
fn parameters(technique: Technique) -> Value {
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
        "bias_world": row.bias_world.map(number),
        "texel_world": row.texel_world.map(number),
        "prepare_ms": number(row.prepare_ms),
        "frame_ms": number(row.frame_ms.median),
        "readback_ms": row.readback_ms.map(number),
        "bytes": row.bytes,
        "dominated_by": row.dominated_by.map(|by| by.name()),
    })
}
