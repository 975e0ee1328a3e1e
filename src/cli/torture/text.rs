//! What `umbrage torture` prints for people.

use std::path::Path;

use umbrage::testing::torture::{Outcomes, Repro, Ruling, Torture};

use crate::cli::output::{Table, counted, plain, significant};

/// Meaning of the columns.
const LEGEND: &str = "ties: grazing (the shadow ray only touches a face, and either answer is right) or abstained (the point \
                      lies on the volume, and nothing is left to check the ray cast); plain f32: the same queries \
                      by an f32 triangle test without a bias (rate: of those that do not graze), and sides of \
                      faces by an f32 cross product; 3/n assumes independent queries, but those of a round share \
                      mesh and light, so the strict bound is that of rounds";

/// The table of strata, the other checks, each disagreement, the verdict, and a legend.
pub(super) fn report(found: &Torture, seed: u64, seconds: f64, case: Option<&Path>) -> String {
    let total = found.total();
    let mut table = Table::new(&[
        "queries",
        "judged",
        "ties",
        "grazing",
        "abstained",
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
        places += &format!("the first one, minimized: {}\n", plain(&path.to_string_lossy()));
    }
    let others = format!(
        "{} of {} sides of faces wrong; {} of {} volumes open; {} queries decided with big integers too",
        total.faces_wrong, total.faces, total.open_volumes, total.volumes, total.judged_by_whole_numbers
    );
    let verdict = match (found.bound_95(), found.bound_95_rounds()) {
        (Some(queries), Some(rounds)) => format!(
            "all methods agree: with 95 % confidence they disagree on less than {queries:.1e} of such queries, if \
             these were independent, and in less than {rounds:.1e} of such rounds"
        ),
        _ if found.agrees() => "all methods agree; every query was a tie".to_owned(),
        _ => format!(
            "{}, {}, {}",
            counted(total.wrong as usize, "disagreement", "disagreements"),
            counted(total.faces_wrong as usize, "wrong side", "wrong sides"),
            counted(total.open_volumes as usize, "open volume", "open volumes")
        ),
    };
    let rate = significant((total.queries as f64 / seconds).round());
    format!(
        "{} queries from seed {seed}, {seconds:.1} s, {rate} queries/s\n\n{table}\n\n{others}\n{places}verdict: \
         {verdict}\n{LEGEND}\n",
        total.queries
    )
}

fn cells(row: &Outcomes) -> Vec<String> {
    let rate = match row.queries - row.grazing {
        0 => "-".to_owned(),
        trials => format!("{:.2} %", 100.0 * row.plain_f32_wrong as f64 / trials as f64),
    };
    let faces = format!("{} of {}", row.plain_f32_faces_wrong, row.faces);
    let counts = [row.queries, row.ties, row.grazing, row.abstained, row.wrong, row.plain_f32_wrong];
    let counts = counts.map(|count| count.to_string());
    [row.name.to_owned()].into_iter().chain(counts).chain([rate, faces]).collect()
}

/// What each method answers for one case.
pub(super) fn replay(file: &Path, case: &Repro, ruling: &Ruling) -> String {
    let [x, y, z] = case.point;
    let faces = counted(case.mesh.face_count(), "face", "faces");
    let verdict = if ruling.agrees { "all methods agree" } else { "methods contradict each other" };
    let said: String = ruling.said.iter().map(|line| format!("  {line}\n")).collect();
    let file = plain(&file.to_string_lossy());
    format!("{file}: {faces}, {}, point {x},{y},{z}\n{said}verdict: {verdict}\n", case.light)
}
