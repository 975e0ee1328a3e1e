//! The crack report as SARIF 2.1.0, the form of results that code hosts and editors show.
//!
//! (OASIS, *Static Analysis Results Interchange Format (SARIF) Version 2.1.0*, 2020: section 3.14 runs, 3.27
//! results, 3.49 rules.)

use serde_json::{Map, Value, json};
use umbrage::check::{DefectKind, Severity};

use super::text::noun;

/// All files as one run, of the entries of their JSON.
pub(super) fn document(entries: &[Value]) -> Value {
    let mut results = Vec::new();
    let mut unread = Vec::new();
    for entry in entries {
        match entry["error"].as_str() {
            None => results.extend(of_file(entry)),
            Some(error) => unread.push(json!({
                "level": "error",
                "message": { "text": error },
                "locations": [{ "physicalLocation": { "artifactLocation": artifact(&entry["file"]) } }],
            })),
        }
    }
    json!({
        "$schema": "https://json.schemastore.org/sarif-2.1.0.json",
        "version": "2.1.0",
        "runs": [{
            "tool": { "driver": {
                "name": "umbrage",
                "version": env!("CARGO_PKG_VERSION"),
                "rules": DefectKind::ALL.map(rule),
            }},
            "invocations": [{
                "executionSuccessful": unread.is_empty(),
                "toolExecutionNotifications": unread,
            }],
            "results": results,
        }],
    })
}

fn rule(kind: DefectKind) -> Value {
    json!({
        "id": kind.code(),
        "name": kind.name(),
        "shortDescription": { "text": kind.name().replace('_', " ") },
        "fullDescription": { "text": format!("Effect on the shadow: {}.", kind.effect()) },
        "defaultConfiguration": { "level": level(kind) },
    })
}

fn level(kind: DefectKind) -> &'static str {
    match kind.severity() {
        Severity::Error => "error",
        Severity::Warning => "warning",
        Severity::Information => "note",
    }
}

/// One result for each listed defect; one without a position where none is listed.
fn of_file(entry: &Value) -> Vec<Value> {
    let list = |value: &Value| value.as_array().cloned().unwrap_or_default();
    let mut results = Vec::new();
    for (index, mesh) in list(&entry["meshes"]).iter().enumerate() {
        for found in &list(&mesh["defects"]) {
            let Some(kind) = DefectKind::ALL.into_iter().find(|kind| found["kind"] == kind.name()) else {
                continue;
            };
            let of = |at: Option<&Value>| result(&entry["file"], (index, mesh), (kind, found), at);
            match list(&found["at"]) {
                places if places.is_empty() => results.push(of(None)),
                places => results.extend(places.iter().map(|at| of(Some(at)))),
            }
        }
    }
    results
}

fn result(
    file: &Value,
    (index, mesh): (usize, &Value),
    (kind, found): (DefectKind, &Value),
    at: Option<&Value>,
) -> Value {
    let (least, count) = match found["count"].as_u64() {
        Some(count) => ("", count),
        None => ("at least ", found["at_least"].as_u64().unwrap_or(0)),
    };
    let words = kind.name().replace('_', " ");
    let noun = noun(kind, usize::try_from(count).unwrap_or(usize::MAX));
    let all = format!("{least}{count} {noun} in this mesh");
    let place = at.map_or_else(String::new, |at| {
        let [x, y, z] = [0, 1, 2].map(|axis| at["position"][axis].as_f64().unwrap_or(f64::NAN));
        format!(" at {x} {y} {z} ({})", at["name"].as_str().unwrap_or_default())
    });
    let mut physical = Map::from_iter([("artifactLocation".to_owned(), artifact(file))]);
    let origins = at.map(|at| at["origins"].as_array().map_or(&[][..], Vec::as_slice));
    if let Some(line) = origins.and_then(|origins| origins.first()?["line"].as_u64()) {
        physical.insert("region".to_owned(), json!({ "startLine": line }));
    }
    json!({
        "ruleId": kind.code(),
        "level": level(kind),
        "message": { "text": format!("{words}{place}; {all}; effect: {}", kind.effect()) },
        "locations": [{
            "physicalLocation": physical,
            "logicalLocations": [{
                "name": mesh["name"],
                "fullyQualifiedName": format!("/meshes/{index}"),
                "kind": "object",
            }],
        }],
        "properties": {
            "position": at.map(|at| &at["position"]),
            "polygons": origins.map(|origins| origins.iter().map(|face| &face["polygon"]).collect::<Vec<_>>()),
        },
    })
}

/// A file as a relative address: with slashes, and what a URI does not allow as percent and hexadecimal
/// digits.
fn artifact(file: &Value) -> Value {
    let path = file.as_str().unwrap_or_default().replace('\\', "/");
    let mut uri = String::with_capacity(path.len());
    for byte in path.bytes() {
        match byte {
            b'a'..=b'z' | b'A'..=b'Z' | b'0'..=b'9' | b'-' | b'.' | b'_' | b'~' | b'/' => {
                uri.push(byte.into());
            }
            _ => uri.push_str(&format!("%{byte:02X}")),
        }
    }
    if uri.starts_with('/') {
        uri.insert_str(0, "file://");
    }
    json!({ "uri": uri })
}
