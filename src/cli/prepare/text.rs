//! The report as text: before, each step with its first changes, after.

use std::fmt::{self, Display};

use umbrage::check::{Counts, Requirement};
use umbrage::repair::{Change, ChangeKind, Patch, Step};

use super::Report;
use crate::cli::check::FileReport;
use crate::cli::output::{counted, plain, short, significant};

/// What is printed.
pub(super) struct Text<'a> {
    pub(super) report: &'a Report,
    /// How many changes of each step are listed.
    pub(super) limit: usize,
    /// Why it has vertices of one position that are to stay apart.
    pub(super) apart: Option<Apart>,
}

/// What keeps vertices of one position apart.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Apart {
    Split,
    Skin,
}

impl Display for Text<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let report = self.report;
        writeln!(f, "{}", plain(&report.file.to_string_lossy()))?;
        state(f, "before", &report.before)?;
        for (mesh, steps) in &report.steps {
            let did_something = |step: &&Step| step.count + step.left > 0;
            if report.steps.len() > 1 && steps.iter().any(|step| did_something(&step)) {
                writeln!(f, "  mesh {}", short(mesh))?;
            }
            for step in steps.iter().filter(did_something) {
                self.step(f, step)?;
            }
        }
        if report.steps.iter().flat_map(|(_, steps)| steps).all(|step| step.count + step.left == 0) {
            writeln!(f, "  nothing to change")?;
        }
        state(f, "after", &report.after)?;
        match (&report.written, report.verified) {
            (Some(path), _) => {
                writeln!(f, "  written and read again, the same: {}", plain(&path.to_string_lossy()))?;
                match self.apart {
                    Some(Apart::Split) => writeln!(f, "  read it with --weld none: a weld undoes --split")?,
                    Some(Apart::Skin) => {
                        writeln!(f, "  read it with --weld none: a weld joins what the skin parts")?;
                    }
                    None => {}
                }
                Ok(())
            }
            (None, Some(_)) => writeln!(f, "  not written: it would read back otherwise"),
            (None, None) => writeln!(f, "  not written: what is required is not met"),
        }
    }
}

impl Text<'_> {
    fn step(&self, f: &mut fmt::Formatter<'_>, step: &Step) -> fmt::Result {
        let (one, many) = counted_as(step.name);
        write!(f, "  {}: {}", step.name, counted(step.count, one, many))?;
        if step.left > 0 {
            write!(f, ", {} left", step.left)?;
        }
        if step.largest_move > 0.0 {
            write!(f, ", moved by {} at most", significant(step.largest_move))?;
        }
        writeln!(f)?;
        // First what the step left: that remains to be done.
        let mut changes: Vec<&Change> = step.changes.iter().collect();
        changes.sort_by_key(|change| change.kind.is_change());
        for change in changes.iter().take(self.limit) {
            line(f, change)?;
        }
        let hidden = (step.count + step.left).saturating_sub(self.limit);
        if hidden > 0 && self.limit > 0 {
            writeln!(f, "    {hidden} more")?;
        }
        Ok(())
    }
}

/// What a step counts.
fn counted_as(name: &str) -> (&'static str, &'static str) {
    match name {
        "weld" | "weld-within" => ("vertex merged or dropped", "vertices merged or dropped"),
        "unreferenced" => ("vertex dropped", "vertices dropped"),
        "orient" => ("face turned", "faces turned"),
        "stitch" => ("T-junction stitched", "T-junctions stitched"),
        "split" => ("vertex added for a fan", "vertices added for fans"),
        "fill" => ("hole closed", "holes closed"),
        _ => ("face dropped", "faces dropped"),
    }
}

/// The numbers of all meshes, and what keeps them from being sound.
fn state(f: &mut fmt::Formatter<'_>, when: &str, report: &FileReport) -> fmt::Result {
    let total: Counts = report.total().unwrap_or_default();
    let reasons = total.reasons();
    write!(
        f,
        "  {when}: {}, {}: ",
        counted(total.faces, "face", "faces"),
        counted(total.shells, "shell", "shells")
    )?;
    match reasons.as_str() {
        "" => writeln!(f, "{}", total.verdict()),
        reasons => writeln!(f, "{}: {reasons}", total.verdict()),
    }
}

fn line(f: &mut fmt::Formatter<'_>, change: &Change) -> fmt::Result {
    let [x, y, z] = change.at;
    let what = match change.kind {
        ChangeKind::VertexMerged => "vertex merged",
        ChangeKind::KeptApart => {
            "left: a skin moves it differently than another vertex at its position: vertex"
        }
        ChangeKind::VertexDropped => "vertex dropped",
        ChangeKind::CollapsedDropped => "collapsed face dropped",
        ChangeKind::DuplicateDropped => "duplicate face dropped",
        ChangeKind::OppositeCancelled => "face cancelled with an opposite one",
        ChangeKind::OppositeKept => "left: opposite faces that are no wall inside a solid: face",
        ChangeKind::FaceTurned => "face turned",
        ChangeKind::ShellLeft => "left: no orientation (a Möbius strip): the surface of face",
        ChangeKind::FaceCut => "face cut at a vertex",
        ChangeKind::TJunctionLeft => "left: T-junction, there are too many: vertex",
        ChangeKind::VertexSplit => "vertex copied",
        ChangeKind::EdgeLeft => "left: edge of more than two faces whose fans are one at both ends",
        ChangeKind::HoleFilled => "hole closed",
        ChangeKind::HoleLeft => "left: hole",
        _ => change.kind.name(),
    };
    write!(f, "    {what}")?;
    match (change.old, change.new) {
        (Some(old), Some(new)) if old != new => write!(f, " {old} -> {new}")?,
        (Some(index), _) => write!(f, " {index}")?,
        _ => {}
    }
    write!(f, " at ({x}, {y}, {z})")?;
    if let Some(patch) = &change.patch {
        hole(f, patch)?;
    }
    writeln!(f)
}

fn hole(f: &mut fmt::Formatter<'_>, patch: &Patch) -> fmt::Result {
    write!(f, ", {}, length {}", counted(patch.edges, "edge", "edges"), significant(patch.length))?;
    if let Some(area) = patch.area {
        write!(f, ", area {}", significant(area))?;
    }
    write!(f, ", off its plane by {}", significant(patch.off_plane))?;
    match (patch.left, patch.meets) {
        (Some(left), _) => write!(f, ": {}", left.name()),
        (None, Some(true)) => write!(f, ", meets other faces"),
        (None, _) => Ok(()),
    }
}

/// Why nothing was written.
pub(super) fn not_written(asked: Requirement, reasons: &str) -> String {
    let why = if reasons.is_empty() { String::new() } else { format!(" ({reasons})") };
    format!(
        "nothing was written: not {}{why}; add a step, or leave out --require {}",
        asked.property(),
        asked.name()
    )
}
