//! `umbrage check --fast`: whether each mesh is balanced, and nothing else.

use std::fmt::{self, Display};
use std::path::{Path, PathBuf};

use umbrage::check::{Requirement, Screen, Verdict};
use umbrage::read::Format;

use super::rules::Rules;
use super::{Args, json};
use crate::cli::color::Painter;
use crate::cli::output::{self, Output, counted, plain, short};
use crate::cli::progress::Progress;
use crate::cli::{Failure, Outcome, load};

/// The report of one file.
pub(super) struct Screened {
    file: PathBuf,
    pub(super) format: Option<Format>,
    pub(super) meshes: Vec<Mesh>,
    allow_empty: bool,
}

/// The report of one mesh.
pub(super) struct Mesh {
    pub(super) name: String,
    pub(super) vertices: usize,
    pub(super) faces: usize,
    pub(super) balanced: bool,
}

impl Screened {
    pub(super) fn balanced(&self) -> bool {
        self.meshes.iter().all(|mesh| mesh.balanced)
    }

    /// Whether there is a file without meshes, or a mesh without faces.
    fn is_empty(&self) -> bool {
        self.meshes.is_empty() || self.meshes.iter().any(|mesh| mesh.faces == 0)
    }

    pub(super) fn verdict(&self) -> Verdict {
        match (self.balanced(), self.is_empty() && !self.allow_empty) {
            (false, _) => Verdict::Cracked,
            (true, true) => Verdict::Empty,
            (true, false) => Verdict::Sound,
        }
    }
}

/// Refuses options that need more than the balance.
pub(super) fn refuse(args: &Args) -> Result<(), Failure> {
    let more = |&&asked: &&Requirement| ![Requirement::Balanced, Requirement::NotEmpty].contains(&asked);
    let asked = args.require.iter().find(more).map(|asked| format!("--require {asked}"));
    let within = args.mesh.welds_within().then(|| "--weld DIST".to_owned());
    let others = [
        (args.pose.asked().is_some(), "a pose"),
        (args.self_intersections, "--self-intersections"),
        (args.mark.is_some(), "--mark"),
        (args.picture.is_some(), "--picture"),
        (args.html.is_some(), "--html"),
        (args.baseline.is_some(), "--baseline"),
        (args.junit.is_some(), "--junit"),
        (args.sarif.is_some(), "--sarif"),
        (args.summary, "--summary"),
        (args.json_lines, "--json-lines"),
        (args.quiet, "--quiet"),
        (args.file_timeout.is_some(), "--file-timeout"),
    ];
    let mut others = others.into_iter().filter(|other| other.0).map(|other| other.1.to_owned());
    match within.or(asked).or_else(|| others.next()) {
        None => Ok(()),
        Some(option) => Err(Failure::new(
            format_args!("--fast only decides whether a mesh is balanced, and {option} needs more"),
            "leave one of them out",
        )),
    }
}

pub(super) fn run(args: &Args, rules: &Rules) -> Result<Outcome, Failure> {
    let mut out = Output::new();
    let mut outcome = Outcome::Sound;
    let mut reports = Vec::new();
    for file in &args.files {
        let of_file = rules.apply(args, file);
        let report =
            refuse(&of_file).map_err(|failure| failure.in_file(file)).and_then(|()| examine(file, &of_file));
        outcome = outcome.max(match &report {
            Ok(report) if report.verdict() == Verdict::Sound => Outcome::Sound,
            Ok(_) => Outcome::Unsound,
            Err(failure) => {
                output::say(failure);
                Outcome::Incomplete
            }
        });
        if let (Ok(report), false) = (&report, args.json) {
            out.text(Report { report, limit: args.limit, painter: args.color.painter() })?;
            out.flush()?;
        }
        reports.push(report);
    }
    if args.json {
        out.json(&json::screened(&args.files, &reports))?;
    } else {
        out.line(verdict(&reports))?;
    }
    out.flush()?;
    Ok(outcome)
}

fn examine(file: &Path, args: &Args) -> Result<Screened, Failure> {
    let baked = args.mesh.read(file)?;
    let _progress = Progress::spinner(format!("checking {}", file.display()));
    let meshes = baked.meshes.into_iter().map(|mesh| Mesh {
        vertices: mesh.vertex_count(),
        faces: mesh.face_count(),
        balanced: args.mesh.screen(&mesh).expect("a weld within a distance was refused"),
        name: mesh.name,
    });
    let meshes: Vec<Mesh> = meshes.collect();
    load::note_none_left(file, meshes.iter().map(|mesh| mesh.faces).sum(), usize::MAX);
    Ok(Screened { file: file.to_owned(), format: baked.format, meshes, allow_empty: args.allow_empty })
}

/// One file's report, for printing.
struct Report<'a> {
    report: &'a Screened,
    limit: usize,
    painter: Painter,
}

impl Display for Report<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Screened { file, format, meshes, .. } = self.report;
        let format = format.map_or("generated", |format| format.name());
        write!(f, "{} ({format}): ", plain(&file.to_string_lossy()))?;
        let open: Vec<&Mesh> = meshes.iter().filter(|mesh| !mesh.balanced).collect();
        let faces = counted(meshes.iter().map(|mesh| mesh.faces).sum(), "face", "faces");
        let [empty, balanced] = [(Verdict::Empty, "empty"), (Verdict::Sound, "balanced")]
            .map(|(verdict, word)| self.painter.verdict(verdict, word));
        let bad = self.painter.bad("not balanced");
        match (open.len(), meshes.len()) {
            (0, _) if self.report.verdict() == Verdict::Empty => writeln!(f, "{empty}: a mesh without faces"),
            (0, 0 | 1) => writeln!(f, "{balanced}, {faces}"),
            (0, all) => writeln!(f, "{balanced}, all {all} meshes, {faces}"),
            (_, 1) => writeln!(f, "{bad}, {faces}"),
            (open, all) => writeln!(f, "{bad}, {open} of {all} meshes, {faces}"),
        }?;
        for mesh in open.iter().filter(|mesh| !mesh.name.is_empty()).take(self.limit) {
            writeln!(f, "  not balanced: {}", short(&mesh.name))?;
        }
        Ok(())
    }
}

/// The last line: the verdict over all files, and the probability of error.
fn verdict(reports: &[Result<Screened, Failure>]) -> String {
    let files = counted(reports.len(), "file", "files");
    let unread = reports.iter().filter(|report| report.is_err()).count();
    let open = reports.iter().flatten().filter(|report| !report.balanced()).count();
    let error =
        format!("a mesh that is not balanced would pass with a probability below {:e}", Screen::ERROR);
    let empty = reports.iter().flatten().filter(|report| report.verdict() == Verdict::Empty).count();
    match (open, unread) {
        (0, 0) if empty > 0 => format!("verdict: {empty} of {files} without faces to check"),
        (0, 0) => format!("verdict: balanced; {error}"),
        (0, _) => format!("verdict: none; {unread} of {files} could not be read"),
        (_, 0) => format!("verdict: {open} of {files} not balanced; {error}"),
        _ => format!("verdict: {open} of {files} not balanced, {unread} could not be read; {error}"),
    }
}
