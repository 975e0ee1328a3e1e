//! The crack report as JSON. Keys and their order are a contract.

use std::path::PathBuf;

use serde_json::{Map, Value, json};
use umbrage::check::{Counts, CrackReport, DefectKind, ShellReport};
use umbrage::read::Format;
use umbrage::topology::Topology;

use super::fast::Screened;
use super::{FileReport, Found, MeshReport, Place, Verdict};
use crate::cli::error::Failure;
use crate::cli::output::{number, number32};

/// All files, in the order they were named.
///
/// Each total lists up to `limit` places of a kind of defect.
pub(super) fn document(files: &[PathBuf], reports: &[Result<FileReport, Failure>], limit: usize) -> Value {
    let entry = |report: &FileReport| Entry {
        format: report.format,
        verdict: report.verdict(),
        meshes: report.meshes.iter().map(mesh).collect(),
        total: total(report, limit),
    };
    of_entries(files, reports.iter().map(|report| report.as_ref().map(entry)))
}

/// The same for files of which only the balance is known.
pub(super) fn screened(files: &[PathBuf], reports: &[Result<Screened, Failure>]) -> Value {
    let entry = |report: &Screened| Entry {
        format: report.format,
        verdict: if report.balanced() { Verdict::Sound } else { Verdict::Cracked },
        meshes: report
            .meshes
            .iter()
            .map(|mesh| balance(Some(&mesh.name), mesh.vertices, mesh.faces, mesh.balanced))
            .collect(),
        total: if report.meshes.is_empty() {
            Value::Null
        } else {
            let sum = |of: fn(&super::fast::Mesh) -> usize| report.meshes.iter().map(of).sum();
            balance(None, sum(|mesh| mesh.vertices), sum(|mesh| mesh.faces), report.balanced())
        },
    };
    of_entries(files, reports.iter().map(|report| report.as_ref().map(entry)))
}

/// What is said of a file.
struct Entry {
    format: Option<Format>,
    verdict: Verdict,
    meshes: Vec<Value>,
    total: Value,
}

fn of_entries<'a>(files: &[PathBuf], reports: impl Iterator<Item = Result<Entry, &'a Failure>>) -> Value {
    let (mut cracked, mut unknown) = (false, false);
    let entries: Vec<Value> = files
        .iter()
        .zip(reports)
        .map(|(file, report)| {
            cracked |= report.as_ref().is_ok_and(|entry| entry.verdict == Verdict::Cracked);
            unknown |= report.as_ref().map_or(true, |entry| entry.verdict == Verdict::NotProven);
            let (format, error) = match &report {
                Ok(entry) => (entry.format, None),
                Err(failure) => (failure.format, Some(failure.to_string())),
            };
            let (meshes, total) = report.map_or((vec![], Value::Null), |entry| (entry.meshes, entry.total));
            json!({
                "file": file.to_string_lossy(),
                "format": format.map(|format| format.name()),
                "error": error,
                "meshes": meshes,
                "total": total,
            })
        })
        .collect();
    let verdict = match (cracked, unknown) {
        (true, _) => Some("cracked"),
        (false, false) => Some("sound"),
        (false, true) => None,
    };
    json!({ "files": entries, "verdict": verdict })
}

/// A mesh of which nothing else is known: the same keys, null.
fn balance(name: Option<&str>, vertices: usize, faces: usize, balanced: bool) -> Value {
    // The keys are those of any mesh; here of one without faces.
    let empty = umbrage::mesh::Mesh::default();
    let mut numbers = CrackReport::of(&empty, &Topology::of(&empty)).counts;
    (numbers.faces, numbers.balanced) = (faces, balanced);
    let mut object = counts(name, [vertices, 0, 0], &numbers);
    for (key, value) in &mut object {
        if !["name", "vertices", "faces", "balanced"].contains(&key.as_str()) {
            *value = Value::Null;
        }
    }
    for key in ["shell_list", "defects", "nesting_complete", "t_junctions_complete"] {
        object.insert(key.into(), Value::Null);
    }
    Value::Object(object)
}

fn mesh(mesh: &MeshReport) -> Value {
    let vertices = [mesh.vertices, mesh.welded_vertices, mesh.unreferenced_vertices];
    let mut object = counts(Some(&mesh.name), vertices, &mesh.counts);
    object.insert("shell_list".into(), mesh.shell_list.iter().map(shell).collect());
    object.insert("defects".into(), mesh.defects.iter().map(defect).collect());
    completeness(&mut object, &mesh.counts, mesh.nesting_complete, mesh.t_junctions_complete);
    Value::Object(object)
}

/// The sum over the meshes. Shells are listed with the meshes, so their list is null here; a defect's place names the
/// mesh.
fn total(report: &FileReport, limit: usize) -> Value {
    let Some(sum) = report.total() else { return Value::Null };
    let vertices = [
        report.sum(|mesh| mesh.vertices),
        report.sum(|mesh| mesh.welded_vertices),
        report.sum(|mesh| mesh.unreferenced_vertices),
    ];
    let mut object = counts(None, vertices, &sum);
    object.insert("shell_list".into(), Value::Null);
    let defects = DefectKind::ALL.into_iter().filter_map(|kind| defect_of_all(report, kind, limit));
    object.insert("defects".into(), defects.collect());
    let all = |of: fn(&MeshReport) -> bool| report.meshes.iter().all(of);
    completeness(&mut object, &sum, all(|mesh| mesh.nesting_complete), all(|mesh| mesh.t_junctions_complete));
    Value::Object(object)
}

/// Which searches came to their ends; what was counted in the others is less than there may be, hence null.
fn completeness(object: &mut Map<String, Value>, counts: &Counts, nesting: bool, t_junctions: bool) {
    if counts.undecided_shells > 0 {
        object["inside_out_shells"] = Value::Null;
    }
    if !t_junctions {
        object["t_junctions"] = Value::Null;
    }
    object.insert("nesting_complete".into(), nesting.into());
    object.insert("t_junctions_complete".into(), t_junctions.into());
}

fn counts(
    name: Option<&str>,
    [vertices, welded, unreferenced]: [usize; 3],
    counts: &Counts,
) -> Map<String, Value> {
    let Value::Object(object) = json!({
        "name": name,
        "vertices": vertices,
        "welded_vertices": welded,
        "faces": counts.faces,
        "edges": counts.edges,
        "shells": counts.shells,
        "closed_shells": counts.closed_shells,
        "euler_characteristic": counts.euler_characteristic,
        "boundary_edges": counts.boundary_edges,
        "boundary_loops": counts.boundary_loops,
        "non_manifold_edges": counts.non_manifold_edges,
        "max_faces_per_edge": counts.max_faces_per_edge,
        "misoriented_edges": counts.misoriented_edges,
        "non_manifold_vertices": counts.non_manifold_vertices,
        "collapsed_faces": counts.collapsed_faces,
        "zero_area_faces": counts.zero_area_faces,
        "duplicate_faces": counts.duplicate_faces,
        "unreferenced_vertices": unreferenced,
        "near_miss_edges": counts.near_miss_edges,
        "t_junctions": counts.t_junctions,
        "inside_out_shells": counts.inside_out_shells,
        "self_intersections": counts.self_intersections,
        "signed_volume": number(counts.signed_volume),
        "watertight": counts.watertight,
        "balanced": counts.balanced,
        "even": counts.even,
    }) else {
        unreachable!("the macro above makes an object")
    };
    object
}

fn shell(shell: &ShellReport) -> Value {
    json!({
        "first_face": shell.first_face.index(),
        "faces": shell.faces,
        "edges": shell.edges,
        "vertices": shell.vertices,
        "euler_characteristic": shell.euler_characteristic,
        "genus": shell.genus,
        "signed_volume": number(shell.signed_volume),
        "watertight": shell.watertight,
        "balanced": shell.balanced,
        "inside_out": (!shell.undecided()).then_some(shell.inside_out),
        "depth": shell.depth_known.then_some(shell.depth),
        "parent": shell.parent,
        "bounds": [shell.bounds.low.map(number32), shell.bounds.high.map(number32)],
    })
}

fn defect(found: &Found) -> Value {
    json!({
        "kind": found.kind.name(),
        "count": found.count,
        "effect": found.kind.effect(),
        "at": found.at.iter().map(place).collect::<Vec<_>>(),
    })
}

/// One kind of defect over all meshes; `None` where there is none.
fn defect_of_all(report: &FileReport, kind: DefectKind, limit: usize) -> Option<Value> {
    let found = |mesh: &MeshReport| mesh.defects.iter().position(|found| found.kind == kind);
    let with: Vec<(&MeshReport, &Found)> =
        report.meshes.iter().filter_map(|mesh| Some((mesh, &mesh.defects[found(mesh)?]))).collect();
    let places = with.iter().flat_map(|(mesh, found)| found.at.iter().map(|at| (&mesh.name, at)));
    let at = places.take(limit).map(|(mesh, at)| {
        let mut entry = place(at);
        entry["mesh"] = mesh.as_str().into();
        entry
    });
    (!with.is_empty()).then(|| {
        json!({
            "kind": kind.name(),
            "count": with.iter().map(|(_, found)| found.count).sum::<usize>(),
            "effect": kind.effect(),
            "at": at.collect::<Vec<_>>(),
        })
    })
}

fn place(place: &Place) -> Value {
    json!({
        "position": place.position.map(number32),
        "name": place.name,
        "faces": place.faces.iter().map(|face| face.index()).collect::<Vec<_>>(),
    })
}
