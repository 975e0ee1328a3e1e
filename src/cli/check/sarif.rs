//! The crack report as SARIF 2.1.0, the form of results that code hosts and editors show.
//!
//! (OASIS, *Static Analysis Results Interchange Format (SARIF) Version 2.1.0*, 2020: section 3.14 runs, 3.27
//! results, 3.49 rules.)

use std::path::Path;

use serde_json::{Map, Value, json};
use umbrage::check::{DefectKind, Severity};

use super::report::{FileReport, Found, MeshReport, Place};
use super::text::noun;
use crate::cli::error::Failure;
use crate::cli::output::number32;

/// All files as one run.
pub(super) fn document(files: &[std::path::PathBuf], reports: &[Result<FileReport, Failure>]) -> Value {
    let mut results = Vec::new();
    let mut unread = Vec::new();
    for (file, report) in files.iter().zip(reports) {
        match report {
            Ok(report) => results.extend(of_file(report)),
            Err(failure) => unread.push(json!({
                "level": "error",
                "message": { "text": failure.to_string() },
                "locations": [{ "physicalLocation": { "artifactLocation": artifact(file) } }],
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
fn of_file(report: &FileReport) -> Vec<Value> {
    let mut results = Vec::new();
    for (index, mesh) in report.meshes.iter().enumerate() {
        for found in &mesh.defects {
            if found.at.is_empty() {
                results.push(result(report, index, mesh, found, None));
            }
            results.extend(found.at.iter().map(|at| result(report, index, mesh, found, Some(at))));
        }
    }
    results
}

fn result(report: &FileReport, index: usize, mesh: &MeshReport, found: &Found, at: Option<&Place>) -> Value {
    let kind = found.kind;
    let least = if found.complete { "" } else { "at least " };
    let words = kind.name().replace('_', " ");
    let all = format!("{least}{} {} in this mesh", found.count, noun(kind, found.count));
    let place = at.map_or_else(String::new, |at| {
        let [x, y, z] = at.position;
        format!(" at {x} {y} {z} ({})", at.name)
    });
    let mut physical = Map::from_iter([("artifactLocation".to_owned(), artifact(&report.file))]);
    let line = at.and_then(|at| at.faces.first()?.origin.line);
    if let Some(line) = line {
        physical.insert("region".to_owned(), json!({ "startLine": line }));
    }
    json!({
        "ruleId": kind.code(),
        "level": level(kind),
        "message": { "text": format!("{words}{place}; {all}; effect: {}", kind.effect()) },
        "locations": [{
            "physicalLocation": physical,
            "logicalLocations": [{
                "name": mesh.name,
                "fullyQualifiedName": format!("/meshes/{index}"),
                "kind": "object",
            }],
        }],
        "properties": {
            "position": at.map(|at| at.position.map(number32)),
            "polygons": at.map(|at| at.faces.iter().map(|face| face.origin.polygon).collect::<Vec<_>>()),
        },
    })
}

/// A file as a relative address: with slashes, and what a URI does not allow as percent and hexadecimal
/// digits.
fn artifact(file: &Path) -> Value {
    let path = file.to_string_lossy().replace('\\', "/");
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
