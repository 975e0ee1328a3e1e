//! The report as JSON. Keys and their order are a contract.

use serde_json::{Map, Value, json};

use super::Report;
use crate::cli::check::total;
use crate::cli::json::{append, insert_after};

pub(super) fn document(report: &Report) -> Value {
    let steps = report.steps.iter().flat_map(|(mesh, steps)| {
        steps.iter().map(move |step| {
            let mut object = Map::new();
            append(&mut object, step);
            insert_after(&mut object, "name", "mesh", mesh.as_str());
            Value::Object(object)
        })
    });
    json!({
        "file": report.file.to_string_lossy(),
        "before": total(&report.before, 0),
        "after": total(&report.after, 0),
        "steps": steps.collect::<Vec<_>>(),
        "written": report.written.as_ref().map(|path| path.to_string_lossy()),
        "verified": report.verified,
    })
}
