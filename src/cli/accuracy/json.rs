//! The document of `umbrage accuracy --json`.

use serde_json::{Value, json};
use umbrage::accuracy::{Accuracy, Method, Row};
use umbrage::scene::Lamp;

use super::{Asked, FileResult};
use crate::cli::lights;
use crate::cli::output::number;

pub(super) fn document(results: &[FileResult], asked: &Asked) -> Value {
    let files: Vec<Value> = results.iter().map(file).collect();
    json!({
        "what": asked.question.name(),
        "queries": asked.options.queries,
        "seed": asked.options.seed,
        "rounds": asked.options.rounds,
        "files": files,
    })
}

/// Of a file that could not be measured everything but its name and the error is null.
fn file(result: &FileResult) -> Value {
    let measured = result.measured.as_ref().ok();
    let light =
        |light: &Lamp| json!({ "light": light.light().to_string(), "name": lights::name(&light.name) });
    let lights = measured.map(|measured| measured.lights.iter().map(light).collect::<Vec<_>>());
    let found = measured.map(|measured| &measured.found);
    json!({
        "file": result.name(),
        "format": measured.and_then(|measured| measured.format),
        "error": result.measured.as_ref().err().map(ToString::to_string),
        "mesh": measured.map(|measured| json!({ "vertices": measured.vertices, "faces": measured.faces })),
        "lights": lights,
        "exact_is_right": found.map(Accuracy::exact_is_right),
        "judged_by_all_faces": found.and_then(|found| found.judged_by_all_faces),
        "methods": found.map(|found| found.methods.iter().map(method).collect::<Vec<_>>()),
    })
}

fn method(method: &Method) -> Value {
    let total = &method.total;
    json!({
        "name": method.name,
        "exact": method.exact,
        "ns_per_query": number(total.time.median),
        "min_ns": number(total.time.min),
        "max_ns": number(total.time.max),
        "ratio": number(method.ratio),
        "prepare_ns_per_face": method.prepare_ns.map(number),
        "wrong": total.wrong,
        "queries": total.queries,
        "ties": total.ties,
        "judged": total.judged,
        "bound_95": total.bound_95().map(number),
        "dominated": method.dominated,
        "strata": method.strata.iter().map(row).collect::<Vec<_>>(),
    })
}

fn row(row: &Row) -> Value {
    json!({
        "name": row.name,
        "queries": row.queries,
        "ties": row.ties,
        "judged": row.judged,
        "wrong": row.wrong,
        "bound_95": row.bound_95().map(number),
        "ns_per_query": number(row.time.median),
        "min_ns": number(row.time.min),
        "max_ns": number(row.time.max),
    })
}
