//! What `umbrage accuracy` prints for people.

use std::path::Path;

use umbrage::accuracy::{Method, Row};

use super::{Asked, Measured};
use crate::cli::lights;
use crate::cli::output::{Table, counted, plain};

/// Meaning of the columns.
const LEGEND: &str = "ns: nanoseconds per query, the median of the rounds; of plain f32: the median of the ratios to it \
                      round by round; a tie has two right answers, of which a method that is not exact may give either; \
                      rate: wrong answers a query that is no tie, or after < what they are below with 95 % confidence \
                      if none was found and queries were independent; dominated: another method is as fast and as often \
                      right";

/// The methods, their times and wrong answers by stratum, the cost of exactness, the verdict, and a legend.
pub(super) fn report(file: &Path, measured: &Measured, asked: &Asked) -> String {
    let methods = &measured.found.methods;
    let lit: Vec<String> = measured.lights.iter().map(lights::lamp_label).collect();
    let rounds = counted(asked.options.rounds as usize, "round", "rounds");
    let truth = match measured.found.judged_by_all_faces {
        Some(all) => format!(
            "truth: every verdict in big integers, {all} of {} against all faces, the rest against the faces that \
             the tree returns",
            measured.baseline().total.queries
        ),
        None => "truth: every side in big integers".to_owned(),
    };
    let wrong: u64 = methods.iter().filter(|method| method.exact).map(|method| method.total.wrong).sum();
    let verdict = match wrong {
        0 => "no exact method was wrong".to_owned(),
        wrong => counted(wrong as usize, "wrong answer of an exact method", "wrong answers of exact methods"),
    };
    format!(
        "{}: {}, {} vertices, {} faces, seed {}, {rounds}\nlights: {}\n{truth}\n\n{}\n\n{}\n\n{}\n\n{}\nverdict: \
         {verdict}\n{LEGEND}\n",
        plain(&file.to_string_lossy()),
        asked.question.name(),
        measured.vertices,
        measured.faces,
        asked.options.seed,
        lit.join("  "),
        overview(methods),
        by_stratum("ns", methods, |row| nanoseconds(row.time.median)),
        by_stratum("wrong of queries", methods, |row| format!("{} of {}", row.wrong, row.queries)),
        cost(methods),
    )
}

/// A row for each method.
fn overview(methods: &[Method]) -> Table {
    let mut table = Table::new(&[
        "method",
        "ns",
        "min",
        "max",
        "of plain f32",
        "wrong",
        "queries",
        "rate",
        "prepare ns/face",
        "",
    ]);
    for method in methods {
        let Row { queries, wrong, time, .. } = method.total;
        let rate = match method.total.bound_95() {
            Some(bound) => format!("< {bound:.1e}"),
            None => format!("{:.1e}", method.total.error()),
        };
        table.row(vec![
            method.name.to_owned(),
            nanoseconds(time.median),
            nanoseconds(time.min),
            nanoseconds(time.max),
            format!("{:.2}x", method.ratio),
            wrong.to_string(),
            queries.to_string(),
            rate,
            method.prepare_ns.map_or("-".to_owned(), nanoseconds),
            if method.dominated { "dominated" } else { "" }.to_owned(),
        ]);
    }
    table
}

/// A row for each stratum and a column for each method.
fn by_stratum(what: &str, methods: &[Method], cell: impl Fn(&Row) -> String) -> Table {
    let names = methods.iter().map(|method| method.name);
    let mut table = Table::new(&[what, "ties"].into_iter().chain(names).collect::<Vec<_>>());
    let rows = |method: &Method| method.strata.iter().copied().chain([method.total]).collect::<Vec<Row>>();
    let columns: Vec<Vec<Row>> = methods.iter().map(rows).collect();
    for (index, row) in columns[0].iter().enumerate() {
        let ties = share(row.ties, row.queries);
        let cells = columns.iter().map(|column| cell(&column[index]));
        table.row([row.name.to_owned(), ties].into_iter().chain(cells).collect());
    }
    table
}

/// "exactness removes 812 wrong answers of plain f32 at 0.21x its time (filtered planes), …".
fn cost(methods: &[Method]) -> String {
    let wrong = counted(methods[0].total.wrong as usize, "wrong answer", "wrong answers");
    let exact: Vec<String> = methods
        .iter()
        .filter(|method| method.exact)
        .map(|method| format!("{:.2}x ({})", method.ratio, method.name))
        .collect();
    format!("exactness removes {wrong} of {}, at {} of its time", methods[0].name, exact.join(", "))
}

fn share(part: u64, of: u64) -> String {
    match part {
        0 => "0".to_owned(),
        _ => format!("{:.2} %", 100.0 * part as f64 / of.max(1) as f64),
    }
}

/// Three significant digits or all before the point.
pub(super) fn nanoseconds(ns: f64) -> String {
    let decimals = match ns {
        _ if ns < 10.0 => 2,
        _ if ns < 100.0 => 1,
        _ => 0,
    };
    format!("{ns:.decimals$}")
}
