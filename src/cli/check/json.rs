//! The crack report as JSON. Keys and their order are a contract.

use std::path::PathBuf;

use serde_json::{Map, Value, json};
use umbrage::check::{Counts, CrackReport, DefectKind, Requirement, Standing, Verdict};
use umbrage::mesh::Origin;
use umbrage::read::Format;
use umbrage::topology::Topology;

use super::fast::Screened;
use super::frames::Frames;
use super::report::Listed;
use super::{FileReport, Found, MeshReport, Place};
use crate::cli::error::Failure;
use crate::cli::json::{append, insert_after, to_value};
use crate::cli::output::{number32, plain};

/// The version of the document: data/check.schema.json describes it. A new key does not raise it.
pub(super) const VERSION: u64 = 1;

/// A line of `--json-lines`: the entry of a file.
pub(super) fn line(entry: &Value) -> Value {
    let Value::Object(entry) = entry.clone() else { unreachable!("the entry is an object") };
    Value::Object(std::iter::once(("version".to_owned(), VERSION.into())).chain(entry).collect())
}

/// The entry of a file.
pub(super) fn entry(file: &PathBuf, report: &Result<FileReport, Failure>, limit: usize) -> Value {
    document(std::slice::from_ref(file), std::slice::from_ref(report), limit)["files"][0].take()
}

/// The document of these entries; a file that could not be checked has no verdict.
pub(super) fn joined(entries: Vec<Value>, verdicts: &[Option<Verdict>]) -> Value {
    let has = |verdict: Verdict| verdicts.contains(&Some(verdict));
    let unknown = verdicts.contains(&None) || has(Verdict::NotProven);
    let verdict = match (has(Verdict::Cracked), has(Verdict::Empty), unknown) {
        (true, ..) => Some(Verdict::Cracked.name()),
        (false, true, _) => Some(Verdict::Empty.name()),
        (false, false, false) => Some(Verdict::Sound.name()),
        (false, false, true) => None,
    };
    json!({ "version": VERSION, "files": entries, "verdict": verdict })
}

/// All files, in the order they were named.
///
/// Each total lists up to `limit` defects of each kind.
pub(super) fn document(files: &[PathBuf], reports: &[Result<FileReport, Failure>], limit: usize) -> Value {
    let entry = |report: &FileReport| Entry {
        format: report.format,
        verdict: report.verdict(),
        requirements: report.requirements.iter().map(|&asked| requirement(report, asked)).collect(),
        rounding: report.rounding,
        frames: report.frames.as_ref().map(Frames::to_json),
        meshes: report.meshes.iter().map(mesh).collect(),
        total: judged(total(report, limit), report.verdict()),
    };
    of_entries(files, reports.iter().map(|report| report.as_ref().map(entry)))
}

/// A total with its verdict.
fn judged(mut total: Value, verdict: Verdict) -> Value {
    if let Value::Object(total) = &mut total {
        total.insert("verdict".into(), verdict.name().into());
    }
    total
}

/// The same for `--fast`: only the balance is known.
pub(super) fn screened(files: &[PathBuf], reports: &[Result<Screened, Failure>]) -> Value {
    let entry = |report: &Screened| Entry {
        format: report.format,
        verdict: report.verdict(),
        requirements: Value::Null,
        rounding: None,
        frames: None,
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

/// The entry of a file.
struct Entry {
    format: Option<Format>,
    verdict: Verdict,
    requirements: Value,
    rounding: Option<f64>,
    /// There only if it was asked for.
    frames: Option<Value>,
    meshes: Vec<Value>,
    total: Value,
}

fn of_entries<'a>(files: &[PathBuf], reports: impl Iterator<Item = Result<Entry, &'a Failure>>) -> Value {
    let mut verdicts = Vec::with_capacity(files.len());
    let entries: Vec<Value> = files
        .iter()
        .zip(reports)
        .map(|(file, report)| {
            verdicts.push(report.as_ref().ok().map(|entry| entry.verdict));
            let (format, error) = match &report {
                Ok(entry) => (entry.format, None),
                Err(failure) => (failure.format, Some(failure.to_string())),
            };
            let rounding = report.as_ref().ok().and_then(|entry| entry.rounding);
            let verdict = report.as_ref().ok().map(|entry| entry.verdict.name());
            let frames = report.as_ref().ok().and_then(|entry| entry.frames.clone());
            let (meshes, total, requirements) = report.map_or((vec![], Value::Null, Value::Null), |entry| {
                (entry.meshes, entry.total, entry.requirements)
            });
            // A file without a mesh is not.
            let sound = match (&error, &total) {
                (None, Value::Null) => Value::Bool(false),
                _ => total["sound"].clone(),
            };
            let mut entry = json!({
                "file": file.to_string_lossy(),
                "format": format.map(|format| format.name()),
                "error": error,
                "meshes": meshes,
                "total": total,
                "requirements": requirements,
                "rounding": rounding,
                "sound": sound,
                "verdict": verdict,
            });
            if let Some(frames) = frames {
                entry["frames"] = frames;
            }
            entry
        })
        .collect();
    joined(entries, &verdicts)
}

/// The name of a mesh of an entry, or its number where it has none.
pub(super) fn name_of(mesh: &Value, index: usize) -> String {
    match mesh["name"].as_str() {
        None | Some("") => format!("mesh {index}"),
        Some(name) => plain(name),
    }
}

/// What was required, and whether every mesh has it; null if that was not decided.
fn requirement(report: &FileReport, asked: Requirement) -> Value {
    let holds = match report.standing(asked) {
        Standing::Holds => Some(true),
        Standing::Undecided => None,
        Standing::Fails => Some(false),
    };
    json!({ "name": asked.name(), "holds": holds })
}

/// A mesh of which only the balance is known: the same keys, the rest null.
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
    let lists = ["shell_list", "shell_origins", "defects"];
    let verdicts = ["nesting_complete", "t_junctions_complete", "sound", "verdict"];
    for key in lists.into_iter().chain(verdicts) {
        object.insert(key.into(), Value::Null);
    }
    Value::Object(object)
}

fn mesh(mesh: &MeshReport) -> Value {
    let vertices = [mesh.vertices, mesh.welded_vertices, mesh.unreferenced_vertices];
    let mut object = counts(Some(&mesh.name), vertices, &mesh.counts);
    object.insert("shell_list".into(), to_value(&mesh.shell_list));
    object.insert("shell_origins".into(), mesh.shell_origins.iter().map(polygon).collect());
    object.insert("defects".into(), mesh.defects.iter().map(defect).collect());
    completeness(&mut object, mesh.nesting_complete, mesh.t_junctions_complete);
    object.insert("sound".into(), sound(&mesh.counts));
    object.insert("verdict".into(), mesh.verdict.name().into());
    Value::Object(object)
}

/// The sum over the meshes. Shells are listed with the meshes, so their list is null here; each defect names
/// its mesh.
pub(in crate::cli) fn total(report: &FileReport, limit: usize) -> Value {
    let Some(sum) = report.total() else { return Value::Null };
    let vertices = [
        report.sum(|mesh| mesh.vertices),
        report.sum(|mesh| mesh.welded_vertices),
        report.sum(|mesh| mesh.unreferenced_vertices),
    ];
    let mut object = counts(None, vertices, &sum);
    object.insert("shell_list".into(), Value::Null);
    object.insert("shell_origins".into(), Value::Null);
    let defects = DefectKind::ALL.into_iter().filter_map(|kind| defect_of_all(report, kind, limit));
    object.insert("defects".into(), defects.collect());
    let all = |of: fn(&MeshReport) -> bool| report.meshes.iter().all(of);
    completeness(&mut object, all(|mesh| mesh.nesting_complete), all(|mesh| mesh.t_junctions_complete));
    object.insert("sound".into(), sound(&sum));
    Value::Object(object)
}

/// Whether a mesh that is not empty is sound, whatever is required; null if that was not decided.
fn sound(counts: &Counts) -> Value {
    let decided = counts.sound() || !counts.may_be_sound();
    decided.then_some(counts.sound() && !counts.is_empty()).into()
}

/// Which searches were completed. A count of T-junctions that was not completed is null.
fn completeness(object: &mut Map<String, Value>, nesting: bool, t_junctions: bool) {
    if !t_junctions {
        object["t_junctions"] = Value::Null;
    }
    object.insert("nesting_complete".into(), nesting.into());
    object.insert("t_junctions_complete".into(), t_junctions.into());
}

/// What comes before the numbers, and the numbers; vertices that no face uses are among them.
fn counts(
    name: Option<&str>,
    [vertices, welded, unreferenced]: [usize; 3],
    counts: &Counts,
) -> Map<String, Value> {
    let mut object = Map::from_iter([
        ("name".to_owned(), name.into()),
        ("vertices".to_owned(), vertices.into()),
        ("welded_vertices".to_owned(), welded.into()),
    ]);
    append(&mut object, counts);
    insert_after(&mut object, "duplicate_faces", "unreferenced_vertices", unreferenced);
    object
}

fn defect(found: &Found) -> Value {
    defects(found.kind, found.count, found.complete, found.at.iter().map(place).collect())
}

/// All defects of one kind.
fn defects(kind: DefectKind, count: usize, complete: bool, at: Vec<Value>) -> Value {
    json!({
        "kind": kind,
        "count": complete.then_some(count),
        "at_least": (!complete).then_some(count),
        "effect": kind.effect(),
        "at": at,
        "code": kind.code(),
        "severity": kind.severity().name(),
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
    let count: usize = with.iter().map(|(_, found)| found.count).sum();
    let complete = with.iter().all(|(_, found)| found.complete);
    (!with.is_empty()).then(|| defects(kind, count, complete, at.collect()))
}

pub(super) fn place(place: &Place) -> Value {
    json!({
        "position": place.position.map(number32),
        "name": place.name,
        "faces": place.faces.iter().map(|listed| listed.face).collect::<Vec<_>>(),
        "origins": place.faces.iter().map(origin).collect::<Vec<_>>(),
    })
}

/// A listed face.
fn origin(listed: &Listed) -> Value {
    let mut object = Map::from_iter([("face".to_owned(), to_value(&listed.face))]);
    append_polygon(&mut object, &listed.origin);
    object.insert("part".into(), listed.part.as_str().into());
    Value::Object(object)
}

/// The polygon of the first face of a shell.
fn polygon(origin: &Origin) -> Value {
    let mut object = Map::new();
    append_polygon(&mut object, origin);
    Value::Object(object)
}

fn append_polygon(object: &mut Map<String, Value>, origin: &Origin) {
    object.insert("polygon".into(), origin.polygon.into());
    object.insert("line".into(), origin.line.into());
}
