//! The document of `umbrage accuracy --json`.

use serde_json::{Value, json};
use umbrage::accuracy::Accuracy;
use umbrage::scene::Lamp;

use super::{Asked, FileResult};
use crate::cli::lights;

pub(super) fn document(results: &[FileResult], asked: &Asked) -> Value {
    let files: Vec<Value> = results.iter().map(file).collect();
    json!({
        "what": asked.question,
        "queries": asked.options.queries,
        "seed": asked.options.seed,
        "rounds": asked.options.rounds,
        "files": files,
    })
}

/// Of a file that could not be measured everything but its name and the error is null.
fn file(result: &FileResult) -> Value {
    let measured = result.measured.as_ref().ok();
    let light = |light: &Lamp| json!({ "light": light.light(), "name": lights::name(&light.name) });
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
        "methods": found.map(|found| &found.methods),
    })
}
