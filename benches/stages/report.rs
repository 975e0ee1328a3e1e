//! Rows as an aligned table and as CSV.

use std::fmt::Write as _;
use std::io::{self, Write as _};
use std::path::Path;
use std::process::ExitCode;

use crate::measure::{Row, Target};

/// The table of a group, with its heading.
pub(crate) fn table(rows: &[Row]) -> String {
    let Some(first) = rows.first() else { return String::new() };
    let (stage, mesh, units, unit) = (first.stage, &first.mesh, first.units, first.unit);
    let mut text = format!("\n{stage} · {mesh} · {units} × {unit} · ns/{unit}\n");
    text += &format!(
        "  {:<34} {:>9} {:>21} {:>7} {:>7}  {:<13} answer\n",
        "", "median", "min .. max", "ratio", "limit", "target"
    );
    for row in rows {
        let spread = format!("{} .. {}", time(row.min), time(row.max));
        let ratio = row.ratio.map_or(String::new(), |ratio| {
            if ratio < 0.1 { format!("{ratio:.3}") } else { format!("{ratio:.2}") }
        });
        let limit = row.limit.map_or(String::new(), |limit| format!("{limit:.2}"));
        let target = match (row.target, row.meets_target()) {
            (Target::Time(most), met) => format!("<= {} {}", time(most), word(met)),
            (Target::Ratio(most), met) if most < 0.2 => format!("<= 1/{:.0}× {}", 1.0 / most, word(met)),
            (Target::Ratio(most), met) => format!("<= {most}× {}", word(met)),
            (Target::Best(most), met) => format!("<= {most}× best {}", word(met)),
            (Target::Limits(most), met) => format!("<= {most} limits {}", word(met)),
            (Target::None, _) => String::new(),
        };
        let (name, median, answer) = (row.name, time(row.median), &row.answer);
        text +=
            &format!("  {name:<34} {median:>9} {spread:>21} {ratio:>7} {limit:>7}  {target:<13} {answer}\n");
    }
    text
}

/// A time in nanoseconds, without decimals for a whole frame, where fractions mean nothing.
fn time(ns: f64) -> String {
    if ns < 1e5 { format!("{ns:.2}") } else { format!("{ns:.0}") }
}

fn word(met: Option<bool>) -> &'static str {
    if met == Some(true) { "met" } else { "MISSED" }
}

/// All rows as CSV, times in nanoseconds per unit.
pub(crate) fn csv(rows: &[Row]) -> String {
    let mut text = String::from(
        "stage,mesh,units,unit,contender,median_ns,min_ns,max_ns,ratio,limit_ns,target_ns,target_ratio,met,answer\n",
    );
    for row in rows {
        let number = |x: Option<f64>| x.map_or(String::new(), |x| format!("{x:.4}"));
        let (time, ratio) = match row.target {
            Target::None => (None, None),
            Target::Time(most) => (Some(most), None),
            Target::Ratio(most) | Target::Best(most) => (None, Some(most)),
            Target::Limits(most) => (row.limit.map(|limit| most * limit), None),
        };
        let cells = [
            row.stage.to_owned(),
            row.mesh.clone(),
            row.units.to_string(),
            row.unit.to_owned(),
            row.name.to_owned(),
            number(Some(row.median)),
            number(Some(row.min)),
            number(Some(row.max)),
            number(row.ratio),
            number(row.limit),
            number(time),
            number(ratio),
            row.meets_target().map_or(String::new(), |met| met.to_string()),
            row.answer.clone(),
        ];
        let _ = writeln!(text, "{}", cells.map(cell).join(",")); // writing to a String cannot fail
    }
    text
}

/// A CSV cell, quoted where needed (RFC 4180, section 2).
fn cell(text: String) -> String {
    if text.contains([',', '"', '\n']) { format!("\"{}\"", text.replace('"', "\"\"")) } else { text }
}

pub(crate) fn print(text: &str) -> io::Result<()> {
    let mut out = io::stdout().lock();
    out.write_all(text.as_bytes())?;
    out.flush()
}

/// Runs the given options, or prints the help. Errors are printed to standard error.
pub(crate) fn exit<T>(
    options: Result<Option<T>, String>,
    usage: &str,
    run: impl FnOnce(&T) -> Result<(), String>,
) -> ExitCode {
    let result = match options {
        Ok(Some(options)) => run(&options),
        Ok(None) => print(usage).map_err(|error| error.to_string()),
        Err(problem) => Err(format!("{problem}\n\n{usage}")),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(problem) => {
            eprintln!("{problem}");
            ExitCode::from(2)
        }
    }
}

/// Writes a file atomically.
pub(crate) fn save(path: &Path, text: &str) -> Result<(), String> {
    umbrage::write::write_atomic(path, |out| out.write_all(text.as_bytes()))
        .map_err(|error| error.to_string())
}
