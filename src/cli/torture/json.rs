//! The document of `umbrage torture --json`.

use std::path::Path;

use serde_json::{Value, json};
use umbrage::testing::torture::{Outcomes, Torture};

use crate::cli::output::{number, number32};

/// The agreed keys first, then the others.
pub(super) fn document(found: &Torture, seed: u64, seconds: f64, case: Option<&Path>) -> Value {
    let total = found.total();
    let disagreements = found.disagreements.iter().map(|disagreement| {
        json!({
            "stratum": found.strata[disagreement.stratum].name,
            "round": disagreement.round,
            "query": disagreement.query,
            "light": disagreement.case.light.to_string(),
            "point": disagreement.case.point.map(number32),
            "said": disagreement.said,
        })
    });
    json!({
        "queries": total.queries,
        "disagree": total.wrong,
        "ties": total.ties,
        "bound_95": found.bound_95().map(number),
        "seconds": number(seconds),
        "strata": found.strata.iter().map(row).collect::<Vec<_>>(),
        "seed": seed,
        "rounds": total.rounds,
        "bound_95_rounds": found.bound_95_rounds().map(number),
        "queries_per_second": number(total.queries as f64 / seconds),
        "plain_f32_wrong": total.plain_f32_wrong,
        "faces": total.faces,
        "faces_wrong": total.faces_wrong,
        "plain_f32_faces_wrong": total.plain_f32_faces_wrong,
        "volumes": total.volumes,
        "open_volumes": total.open_volumes,
        "judged_by_whole_numbers": total.judged_by_whole_numbers,
        "grazing": total.grazing,
        "abstained": total.abstained,
        "disagreements": disagreements.collect::<Vec<_>>(),
        "case": case.map(|path| path.to_string_lossy()),
    })
}

fn row(row: &Outcomes) -> Value {
    json!({
        "name": row.name,
        "queries": row.queries,
        "wrong": row.wrong,
        "plain_f32_wrong": row.plain_f32_wrong,
        "ties": row.ties,
        "faces": row.faces,
        "faces_wrong": row.faces_wrong,
        "plain_f32_faces_wrong": row.plain_f32_faces_wrong,
        "volumes": row.volumes,
        "open_volumes": row.open_volumes,
        "judged_by_whole_numbers": row.judged_by_whole_numbers,
        "grazing": row.grazing,
        "abstained": row.abstained,
        "rounds": row.rounds,
    })
}
