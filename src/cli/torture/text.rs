//! What `umbrage torture` prints for people.

use std::path::Path;

use umbrage::verify::torture::{Case, Ruling, Stratum, Torture};

use crate::cli::output::{Table, counted, plain, significant};

/// What the columns mean.
const LEGEND: &str = "ties: the way to the light only touches a face, or the point stands on the volume, and either \
                      answer is right; plain f32: the same queries by an f32 triangle test without a bias (rate: of \
                      those that are no ties), and sides of faces by an f32 cross product";

/// The table of strata, what was checked beside the queries, each disagreement, the verdict, and a legend.
pub(super) fn report(found: &Torture, seed: u64, seconds: f64, case: Option<&Path>) -> String {
    let total = found.total();
    let mut table = Table::new(&[
        "queries",
        "judged",
        "ties",
        "wrong",
        "plain f32 wrong",
        "rate",
        "plain f32 faces wrong",
    ]);
    for row in found.strata.iter().chain([&total]) {
        table.row(cells(row));
    }
    let mut places = String::new();
    for disagreement in &found.disagreements {
        let (name, case) = (found.strata[disagreement.stratum].name, &disagreement.case);
        let [x, y, z] = case.point;
        places += &format!(
            "disagreement: {name}, round {}, query {}, {} at {x},{y},{z}:\n",
            disagreement.round, disagreement.query, case.light
        );
        disagreement.said.iter().for_each(|line| places += &format!("  {line}\n"));
    }
    if let Some(path) = case {
        places += &format!("the first one, minimised: {}\n", plain(&path.to_string_lossy()));
    }
    let beside = format!(
        "{} of {} sides of faces wrong; {} of {} volumes open; {} queries judged in whole numbers too; a winding \
         judge abstained {} times",
        total.faces_wrong,
        total.faces,
        total.open_volumes,
        total.volumes,
        total.judged_by_whole_numbers,
        total.abstained
    );
    let verdict = match found.bound_95() {
        Some(bound) => format!(
            "all judges agree: with 95 % confidence less than {bound:.1e} of such queries are judged wrong"
        ),
        None if found.agrees() => "all judges agree; every query was a tie".to_owned(),
        None => format!(
            "{}, {}, {}",
            counted(total.wrong as usize, "disagreement", "disagreements"),
            counted(total.faces_wrong as usize, "wrong side", "wrong sides"),
            counted(total.open_volumes as usize, "open volume", "open volumes")
        ),
    };
    let rate = significant((total.queries as f64 / seconds).round());
    format!(
        "{} queries from seed {seed}, {seconds:.1} s, {rate} queries/s\n\n{table}\n\n{beside}\n{places}verdict: \
         {verdict}\n{LEGEND}\n",
        total.queries
    )
}

fn cells(row: &Stratum) -> Vec<String> {
    let rate = match row.queries - row.ties {
        0 => "-".to_owned(),
        trials => format!("{:.2} %", 100.0 * row.plain_f32_wrong as f64 / trials as f64),
    };
    let faces = format!("{} of {}", row.plain_f32_faces_wrong, row.faces);
    let [queries, ties, wrong, plain] =
        [row.queries, row.ties, row.wrong, row.plain_f32_wrong].map(|count| count.to_string());
    vec![row.name.to_owned(), queries, ties, wrong, plain, rate, faces]
}

/// What each judge says of one case.
pub(super) fn replay(file: &Path, case: &Case, ruling: &Ruling) -> String {
    let [x, y, z] = case.point;
    let faces = counted(case.mesh.face_count(), "face", "faces");
    let verdict = if ruling.agrees { "all judges agree" } else { "judges contradict each other" };
    let said: String = ruling.said.iter().map(|line| format!("  {line}\n")).collect();
    let file = plain(&file.to_string_lossy());
    format!("{file}: {faces}, {}, point {x},{y},{z}\n{said}verdict: {verdict}\n", case.light)
}
