//! A file in a line: alone, and in the table of all files with the verdict over them.

use std::fmt::{self, Display};
use std::path::Path;

use umbrage::check::{Counts, DefectKind, Verdict};

use super::FileReport;
use super::text::noun;
use crate::cli::Outcome;
use crate::cli::color::Painter;
use crate::cli::error::Failure;
use crate::cli::output::{Table, plain};

/// One file in one line: verdict, name, and what there is of each kind of defect.
pub(super) struct Summary<'a> {
    pub(super) file: &'a Path,
    pub(super) report: &'a Result<FileReport, Failure>,
    pub(super) painter: Painter,
}

impl Display for Summary<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let file = plain(&self.file.to_string_lossy());
        let Ok(report) = self.report else { return write!(f, "{}: {file}", self.painter.bad("error")) };
        let verdict = report.verdict();
        write!(f, "{}: {file}", self.painter.verdict(verdict, verdict.name()))?;
        let mut separator = ": ";
        for kind in DefectKind::ALL {
            let found =
                report.meshes.iter().flat_map(|mesh| &mesh.defects).filter(|found| found.kind == kind);
            let count: usize = found.map(|found| found.count).sum();
            if count > 0 {
                write!(f, "{separator}{count} {}", noun(kind, count))?;
                separator = ", ";
            }
        }
        Ok(())
    }
}

/// A file in the table of several.
pub(super) struct Row {
    /// `None` if it could not be checked.
    pub(super) verdict: Option<Verdict>,
    /// Faces, shells, boundary edges, non-manifold edges, misoriented edges, shells inside out.
    pub(super) numbers: Option<[usize; 6]>,
}

impl Row {
    pub(super) fn of(report: &Result<FileReport, Failure>) -> Self {
        let numbers = |total: Counts| {
            [
                total.faces,
                total.shells,
                total.boundary_edges,
                total.non_manifold_edges,
                total.misoriented_edges,
                total.inside_out_shells,
            ]
        };
        let report = report.as_ref().ok();
        Self {
            verdict: report.map(FileReport::verdict),
            numbers: report.map(|report| report.total().map_or([0; 6], numbers)),
        }
    }

    pub(super) fn outcome(&self) -> Outcome {
        match self.verdict {
            Some(Verdict::Sound) => Outcome::Sound,
            Some(_) => Outcome::Unsound,
            None => Outcome::Incomplete,
        }
    }
}

/// Several files in one table, and the verdict over all.
pub(super) struct Overview {
    table: Table,
    painter: Painter,
    files: usize,
    cracked: usize,
    empty: usize,
    not_proven: usize,
    unreadable: usize,
}

impl Overview {
    pub(super) fn new(painter: Painter) -> Self {
        let columns =
            ["faces", "shells", "boundary", "non-\nmanifold", "mis-\noriented", "inside\nout", "", "file"];
        let table = Table::new(&columns).name_last();
        Self { table, painter, files: 0, cracked: 0, empty: 0, not_proven: 0, unreadable: 0 }
    }

    pub(super) fn add(&mut self, file: &Path, row: &Row) {
        let numbers: Vec<String> = match row.numbers {
            Some(numbers) => numbers.iter().map(usize::to_string).collect(),
            None => vec!["-".to_owned(); 6],
        };
        self.files += 1;
        let state = match row.verdict {
            Some(verdict) => self.painter.verdict(verdict, verdict.name()),
            None => self.painter.bad("error"),
        };
        self.cracked += usize::from(row.verdict == Some(Verdict::Cracked));
        self.empty += usize::from(row.verdict == Some(Verdict::Empty));
        self.not_proven += usize::from(row.verdict == Some(Verdict::NotProven));
        self.unreadable += usize::from(row.verdict.is_none());
        let name = plain(&file.to_string_lossy());
        self.table.row(numbers.into_iter().chain([state, name]).collect());
    }
}

impl Display for Overview {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { table, painter: _, files, cracked, empty, not_proven, unreadable } = self;
        writeln!(f, "{table}")?;
        match (cracked, unreadable) {
            (0, 0) if *empty > 0 => writeln!(f, "verdict: {empty} of {files} files without faces to check"),
            (0, 0) if *not_proven > 0 => {
                writeln!(f, "verdict: none; {not_proven} of {files} files not proven sound")
            }
            (0, 0) => writeln!(f, "verdict: all {files} files are sound"),
            (0, _) => writeln!(f, "verdict: none; {unreadable} of {files} files could not be read"),
            (_, 0) => writeln!(f, "verdict: {cracked} of {files} files cracked"),
            _ => writeln!(f, "verdict: {cracked} of {files} files cracked, {unreadable} could not be read"),
        }
    }
}
