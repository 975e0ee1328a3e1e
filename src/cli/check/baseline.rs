//! `--baseline`: what is worse than in an earlier report.

use std::path::Path;

use serde_json::Value;
use umbrage::check::DefectKind;

use super::json::VERSION;
use super::report::{FileReport, MeshReport};
use super::text::noun;
use crate::cli::error::Failure;
use crate::cli::output::plain;

/// The earlier report.
pub(super) struct Baseline {
    document: Value,
}

impl Baseline {
    /// Reads what `umbrage check --json` printed.
    pub(super) fn read(path: &Path) -> Result<Self, Failure> {
        let remedy = "write one by umbrage check FILE --json > BEFORE.json";
        let failed = |problem: String| Failure::new(problem, remedy).in_file(path);
        let bytes = std::fs::read(path).map_err(|error| failed(format!("cannot be read: {error}")))?;
        let document: Value =
            serde_json::from_slice(&bytes).map_err(|error| failed(format!("is no JSON: {error}")))?;
        if !document["files"].is_array() {
            return Err(failed("is no report of umbrage check: it has no list `files`".to_owned()));
        }
        // The first reports had no version.
        match document.get("version") {
            Some(version) if *version != VERSION => Err(failed(format!(
                "is a report of version {version}, and this program knows version {VERSION}"
            ))),
            _ => Ok(Self { document }),
        }
    }

    /// The earlier entry of a file: of the same name, or the only one where only one is checked.
    fn of(&self, file: &Path, is_alone: bool) -> Option<&Value> {
        let files = self.document["files"].as_array()?;
        let named = files.iter().find(|entry| entry["file"].as_str() == Some(&*file.to_string_lossy()));
        named.or_else(|| files.first().filter(|_| is_alone && files.len() == 1))
    }

    /// What is worse in a file, in words; empty if nothing is. Without an earlier entry everything is new.
    pub(super) fn worse(&self, report: &FileReport, is_alone: bool) -> Vec<String> {
        let before = self.of(&report.file, is_alone);
        let meshes: &[Value] =
            before.and_then(|before| before["meshes"].as_array()).map_or(&[], Vec::as_slice);
        let mut lines = Vec::new();
        for (index, mesh) in report.meshes.iter().enumerate() {
            let before = match_mesh(meshes, report, index);
            lines.extend(DefectKind::ALL.into_iter().filter_map(|kind| worse(mesh, before, kind, index)));
        }
        if before.is_some_and(|before| before["meshes"] != Value::Array(Vec::new()))
            && report.meshes.is_empty()
        {
            lines.push("no mesh is left".to_owned());
        }
        lines
    }
}

/// The earlier mesh: by its name, and among those of one name by their order.
fn match_mesh<'a>(before: &'a [Value], report: &FileReport, index: usize) -> Option<&'a Value> {
    let name = &report.meshes[index].name;
    let nth = report.meshes[..index].iter().filter(|mesh| mesh.name == *name).count();
    before.iter().filter(|mesh| mesh["name"].as_str() == Some(name)).nth(nth)
}

/// One kind of defect that a mesh has more of than before.
fn worse(mesh: &MeshReport, before: Option<&Value>, kind: DefectKind, index: usize) -> Option<String> {
    let now = mesh.defects.iter().find(|found| found.kind == kind)?.count;
    let entries = before.and_then(|before| before["defects"].as_array());
    let earlier = entries.and_then(|entries| entries.iter().find(|entry| entry["kind"] == kind.name()));
    let count = |entry: &Value| entry["count"].as_u64().or_else(|| entry["at_least"].as_u64());
    let then = earlier.and_then(count).unwrap_or(0);
    // What nobody searched for is not known to be new.
    let was_searched = kind != DefectKind::SelfIntersection
        || earlier.is_some()
        || before.is_none_or(|before| before["self_intersections"].is_u64());
    if now as u64 <= then || !was_searched {
        return None;
    }
    let name = match mesh.name.as_str() {
        "" => format!("mesh {index}"),
        name => plain(name),
    };
    Some(format!("{}: {now} {} ({then} before): {name}", kind.code(), noun(kind, now)))
}
