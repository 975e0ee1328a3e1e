//! `umbrage check`: the crack report of each file.

mod args;
mod baseline;
mod drawn;
mod fast;
mod fragment;
mod frames;
mod json;
mod junit;
mod mark;
mod overview;
mod page;
mod picture;
mod report;
mod rules;
mod sarif;
mod text;
mod worker;

use std::path::Path;

use serde_json::Value;
use umbrage::read::Format;
use umbrage::view::Up;
use umbrage::write::{self, Model};

use super::color::Painter;
use super::files;
use super::output::{self, Output};
use super::parsers::{refuse_overwriting, require_folder};
use super::{Failure, Outcome, render};
use baseline::Baseline;
use fragment::Fragment;
use mark::Marks;
use overview::Overview;
use page::Page;
use picture::Sketch;
use report::{Drawings, Found, MeshReport, Place, examine};
use rules::Rules;

pub(crate) use args::Args;
pub(super) use args::requirements;
#[cfg(any(test, feature = "viewer"))]
pub(super) use drawn::{Drawn, color as defect_color};
pub(super) use json::total;
#[cfg(any(test, feature = "viewer"))]
pub(super) use page::{around, mean_normal};
pub(super) use report::{FileReport, report_on};

pub(crate) fn run(mut args: Args) -> Result<Outcome, Failure> {
    if let Some(file) = args.worker.take() {
        args.threads.apply()?;
        return worker::work(&file, &Rules::find(args.config.as_deref())?.apply(&args, &file));
    }
    args.files = files::expand(args.files);
    refuse(&args)?;
    let rules = Rules::find(args.config.as_deref())?;
    args.threads.apply()?;
    if args.fast {
        return fast::run(&args, &rules);
    }
    let mut drawings = Drawings {
        marks: args.mark.is_some().then(|| Marks::naming(args.limit)),
        sketch: args.picture.is_some().then(Sketch::default),
        page: args.html.is_some().then(Page::default),
    };
    let painter = args.color.painter();
    // One file is drawn at most.
    let mut drawn = None;
    let outcome = all(&args, painter, |file| match args.file_timeout {
        Some(limit) => worker::ask(file, limit, painter).unwrap_or_else(|failure| {
            output::say(&failure);
            Fragment::of(file, &Err(failure), &args, painter)
        }),
        None => {
            let report = examine(file, &rules.apply(&args, file), &mut drawings);
            if let Err(failure) = &report {
                output::say(failure);
            }
            let fragment = Fragment::of(file, &report, &args, painter);
            drawn = report.ok();
            fragment
        }
    })?;
    // Where it could not be read, there is nothing to draw.
    if let Some(report) = drawn {
        draw(&args, drawings, &report)?;
    }
    Ok(outcome)
}

/// Checks one file after the other, prints what is asked for of each, and then of all.
fn all(args: &Args, painter: Painter, mut check: impl FnMut(&Path) -> Fragment) -> Result<Outcome, Failure> {
    let baseline = args.baseline.as_deref().map(Baseline::read).transpose()?;
    let mut out = Output::new();
    let mut outcome = Outcome::Sound;
    let mut overview = Overview::new(painter);
    let (mut entries, mut verdicts) = (Vec::new(), Vec::new());
    for (index, file) in args.files.iter().enumerate() {
        let Fragment { row, entry, text } = check(file);
        outcome = outcome.max(match (&baseline, row.verdict) {
            (Some(baseline), Some(_)) => {
                let worse = baseline.worse(&entry, args.files.len() == 1);
                for line in &worse {
                    output::say(format_args!("new: {}: {line}", output::plain(&file.to_string_lossy())));
                }
                if worse.is_empty() { Outcome::Sound } else { Outcome::Unsound }
            }
            _ => row.outcome(),
        });
        overview.add(file, &row);
        if index > 0 && row.verdict.is_some() && args.prints_reports() {
            out.text("\n")?;
        }
        out.text(text)?;
        out.flush()?;
        verdicts.push(row.verdict);
        // All entries are kept for the documents alone.
        entries.extend(args.wants_documents().then_some(entry));
    }
    if args.prints_reports() && args.files.len() > 1 {
        out.text(format_args!("\n{overview}"))?;
        out.flush()?;
    }
    if let Some(path) = &args.junit {
        let bytes = junit::document(&entries).map_err(output::unwritable)?;
        write::write_atomic(path, |out| out.write_all(&bytes))?;
        output::wrote(path);
    }
    if let Some(path) = &args.sarif {
        let document = sarif::document(&entries);
        write::write_atomic(path, |out| writeln!(out, "{document:#}"))?;
        output::wrote(path);
    }
    if args.json {
        out.json(&json::joined(entries, &verdicts))?;
        out.flush()?;
    }
    Ok(outcome)
}

/// Writes what is drawn of a file.
fn draw(args: &Args, drawings: Drawings, report: &FileReport) -> Result<(), Failure> {
    let up = report.format.map_or(Up::Y, Format::up);
    if let (Some(path), Some(marks)) = (&args.mark, drawings.marks) {
        write::write(&marks.into_model(), path)?;
        output::wrote(path);
    }
    if let (Some(path), Some(sketch)) = (&args.picture, drawings.sketch) {
        let name = output::plain(&report.file.file_name().unwrap_or_default().to_string_lossy());
        let dimmed =
            if report.total().is_some_and(|total| total.sound()) { "" } else { "; dimmed where hidden" };
        sketch.write(&format!("{name}: {}{dimmed}", report.verdict().name()), up, path)?;
    }
    if let (Some(path), Some(page)) = (&args.html, drawings.page) {
        let html = page.write(report, up)?;
        write::write_atomic(path, |out| out.write_all(html.as_bytes()))?;
        output::wrote(path);
    }
    Ok(())
}

/// The report of one file as text, as JSON, and as a marked mesh, self-intersections included.
pub(super) fn full(file: &Path) -> Result<(String, Value, Model), Failure> {
    let args = Args { self_intersections: true, ..Args::of(file) };
    let mut drawings = Drawings { marks: Some(Marks::naming(args.limit)), ..Drawings::default() };
    let report = examine(file, &args, &mut drawings)?;
    let marks = drawings.marks.take().expect("it is asked for");
    let text = text::Report { report: &report, limit: args.limit, painter: Painter::default() }.to_string();
    Ok((text, json::document(&args.files, &[Ok(report)], args.limit), marks.into_model()))
}

/// Refuses bad arguments before any work is done.
fn refuse(args: &Args) -> Result<(), Failure> {
    if args.fast {
        fast::refuse(args)?;
    }
    if args.file_timeout.is_some() {
        let others = [
            ("--mark", args.mark.is_some()),
            ("--picture", args.picture.is_some()),
            ("--html", args.html.is_some()),
        ];
        if let Some((option, _)) = others.into_iter().find(|(_, is_asked)| *is_asked) {
            let problem = format!(
                "--file-timeout has each file checked by another process, and {option} needs it in this one"
            );
            return Err(Failure::new(problem, "leave one of them out"));
        }
    }
    for (option, path) in [("--junit", &args.junit), ("--sarif", &args.sarif)] {
        for file in &args.files {
            refuse_overwriting(option, path.as_deref(), file)?;
        }
        path.as_deref().map_or(Ok(()), require_folder)?;
    }
    for (option, path) in [("--mark", &args.mark), ("--picture", &args.picture), ("--html", &args.html)] {
        if path.is_some() && args.files.len() > 1 {
            let problem = format!("{option} writes one file, and there are {} to check", args.files.len());
            return Err(Failure::new(problem, "check one file at a time"));
        }
        refuse_overwriting(option, path.as_deref(), &args.files[0])?;
    }
    if let Some(path) = &args.mark {
        write::Target::from_path(path)?;
    }
    if let Some(path) = &args.picture {
        render::require_png(path)?;
    }
    if let Some(path) = &args.html {
        if path.extension().is_none_or(|found| !found.eq_ignore_ascii_case("html")) {
            let problem = "--html writes another format";
            return Err(Failure::new(problem, "name a file that ends in .html").in_file(path));
        }
        require_folder(path)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use umbrage::check::{CrackReport, Requirement, Verdict};
    use umbrage::topology::Topology;

    use super::report::verdict;
    use super::*;

    #[test]
    fn check_prints_every_line_of_the_librarys_report_in_its_order() {
        for name in [
            "closed/cube",
            "seam/seam_1",
            "open/t_junction",
            "non_manifold/book_5",
            "non_manifold/double_sheet",
            "winding/inside_out_cube",
            "winding/mobius_12",
            "degenerate/collinear_face",
        ] {
            let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("data").join(format!("{name}.obj"));
            let args = Args::of(&file);
            let report = examine(&file, &args, &mut Drawings::default()).ok().unwrap();
            let printed = text::Report { report: &report, limit: 5, painter: Painter::default() }.to_string();
            let mesh = args.mesh.read(&file).ok().unwrap().meshes.remove(0);
            let mesh = args.mesh.weld(mesh).mesh;
            let of_library = CrackReport::of(&mesh, &Topology::of(&mesh)).to_string();
            let comes_in_order = |report: &str| {
                let mut lines = printed.lines();
                report.lines().all(|line| lines.any(|printed| printed == line))
            };
            assert!(comes_in_order(&of_library), "{name}:\n{of_library}\n{printed}");
            // Fault injected: one letter.
            assert!(!comes_in_order(&of_library.replacen('e', "E", 1)), "{name}");
        }
    }

    #[test]
    fn check_that_did_not_decide_the_nesting_proves_nothing_and_says_so() {
        let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/nested/hollow_cube.obj");
        let args = Args::of(&file);
        // As if the searches had given up before the cavity and before the last T-junction.
        let mut report = examine(&file, &args, &mut Drawings::default()).ok().unwrap();
        assert_eq!(report.verdict(), Verdict::Sound);
        let mesh = &mut report.meshes[0];
        let cavity = mesh.shell_list.iter_mut().find(|shell| shell.depth == 1).unwrap();
        (cavity.depth, cavity.parent, cavity.depth_known) = (0, None, false);
        mesh.counts.undecided_shells = 1;
        (mesh.nesting_complete, mesh.t_junctions_complete) = (false, false);
        mesh.verdict = verdict(&[Requirement::Sound], &mesh.counts);
        assert_eq!(mesh.verdict, Verdict::NotProven);
        assert_eq!(verdict(&[Requirement::Watertight], &mesh.counts), Verdict::Sound);
        let text = text::Report { report: &report, limit: 5, painter: Painter::default() }.to_string();
        let line = "not proven sound: the mesh is watertight, but nesting not decided within the limit: 1 shell \
                    may be inside out";
        assert!(text.lines().any(|text| text.trim() == line), "{text}");
        assert!(!text.contains("cracked") && report.verdict() != Verdict::Sound, "{text}");

        let document = json::document(&args.files, &[Ok(report)], 5);
        let mesh = &document["files"][0]["meshes"][0];
        for of in [mesh, &document["files"][0]["total"]] {
            for key in ["nesting_complete", "t_junctions_complete"] {
                assert_eq!(of[key], false, "{key}");
            }
            assert_eq!((&of["inside_out_shells"], &of["t_junctions"]), (&Value::Null, &Value::Null));
        }
        let unknown =
            |shell: &&Value| ["inside_out", "depth", "parent"].iter().all(|&key| shell[key].is_null());
        assert_eq!(mesh["shell_list"].as_array().unwrap().iter().filter(unknown).count(), 1);
        assert_eq!(document["verdict"], Value::Null, "neither cracked nor sound");
    }
}
