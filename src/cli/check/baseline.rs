//! `--baseline`: what is worse than in an earlier report.

use std::path::Path;

use serde_json::Value;
use umbrage::check::DefectKind;

use super::json::{VERSION, name_of};
use super::text::noun;
use crate::cli::error::Failure;

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
    fn of(&self, file: &Value, is_alone: bool) -> Option<&Value> {
        let files = self.document["files"].as_array()?;
        let named = files.iter().find(|entry| entry["file"] == *file);
        named.or_else(|| files.first().filter(|_| is_alone && files.len() == 1))
    }

    /// What is worse in the entry of a file, in words; empty if nothing is. Without an earlier entry
    /// everything is new.
    pub(super) fn worse(&self, entry: &Value, is_alone: bool) -> Vec<String> {
        let before = self.of(&entry["file"], is_alone);
        let earlier: &[Value] = before.map_or(&[], |before| meshes(before));
        let now = meshes(entry);
        let mut lines = Vec::new();
        for (index, mesh) in now.iter().enumerate() {
            let before = match_mesh(earlier, now, index);
            lines.extend(DefectKind::ALL.into_iter().filter_map(|kind| worse(mesh, before, kind, index)));
        }
        if now.is_empty() && !earlier.is_empty() {
            lines.push("no mesh is left".to_owned());
        }
        lines
    }
}

fn meshes(entry: &Value) -> &[Value] {
    entry["meshes"].as_array().map_or(&[], Vec::as_slice)
}

/// The earlier mesh: by its name, and among those of one name by their order.
fn match_mesh<'a>(before: &'a [Value], now: &[Value], index: usize) -> Option<&'a Value> {
    let name = &now[index]["name"];
    let nth = now[..index].iter().filter(|mesh| mesh["name"] == *name).count();
    before.iter().filter(|mesh| mesh["name"] == *name).nth(nth)
}

/// One kind of defect that a mesh has more of than before.
fn worse(mesh: &Value, before: Option<&Value>, kind: DefectKind, index: usize) -> Option<String> {
    let found = |mesh: &Value| {
        let defects = mesh["defects"].as_array()?;
        let entry = defects.iter().find(|entry| entry["kind"] == kind.name())?;
        entry["count"].as_u64().or_else(|| entry["at_least"].as_u64())
    };
    let now = found(mesh)?;
    let earlier = before.and_then(found);
    let then = earlier.unwrap_or(0);
    // What nobody searched for is not known to be new.
    let was_searched = kind != DefectKind::SelfIntersection
        || earlier.is_some()
        || before.is_none_or(|before| before["self_intersections"].is_u64());
    if now <= then || !was_searched {
        return None;
    }
    let name = name_of(mesh, index);
    let noun = noun(kind, usize::try_from(now).unwrap_or(usize::MAX));
    Some(format!("{}: {now} {noun} ({then} before): {name}", kind.code()))
}
