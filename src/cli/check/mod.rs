//! `umbrage check`: the crack report of each file.

mod baseline;
mod fast;
mod json;
mod junit;
mod mark;
mod picture;
mod report;
mod sarif;
mod text;

use std::path::{Path, PathBuf};

use clap::builder::{PossibleValuesParser, TypedValueParser};
use serde_json::Value;
use umbrage::check::Requirement;
use umbrage::read::Format;
use umbrage::view::Up;
use umbrage::write::{self, Model};

use super::files;
use super::load::MeshArgs;
use super::output::{self, Output};
use super::parsers::{refuse_overwriting, require_folder, whole};
use super::resources::ThreadArgs;
use super::{Failure, Outcome, render};
use baseline::Baseline;
use mark::Marks;
use picture::Sketch;
use report::{Found, MeshReport, Place, examine};

pub(super) use json::total;
pub(super) use report::{FileReport, report_on};

/// Crack report: is a mesh closed, and if not, where and with what effect
///
/// A file is sound if every mesh in it has faces, is watertight (each edge has two faces, in opposite
/// directions), and has no shell that is inside out.
#[derive(Clone, Debug, clap::Args)]
pub(crate) struct Args {
    /// Mesh files, or folders of such, or - for standard input: obj, gltf, glb, stl, ply, off, md2, 3mf; also
    /// in gzip or ZIP; recognized by their content, then by their extension
    #[arg(required = true, value_name = "FILE")]
    files: Vec<PathBuf>,

    #[command(flatten)]
    mesh: MeshArgs,

    /// Require this of every mesh, instead of soundness; a list, or repeated [default: sound]
    ///
    /// Sound: watertight, and no shell inside out. Watertight: every edge has exactly two faces, in opposite
    /// directions. Balanced: at every edge the two directions are used equally often; enough for stencil
    /// counting. Even: every edge is used an even number of times; enough for parity counting. Manifold: no
    /// edge has more than two faces, and no vertex more than one fan of them. What needs a search is searched
    /// for, and a search that does not finish does not pass.
    #[arg(long, value_name = "PROPERTY,...", value_delimiter = ',', value_parser = requirements())]
    require: Vec<Requirement>,

    /// Let a mesh pass that has no faces, or none left after the weld
    #[arg(long)]
    allow_empty: bool,

    /// Only decide whether each mesh is balanced, as fast as it can be read
    ///
    /// Balanced: at every edge the two directions are used equally often. A mesh that is not balanced is
    /// reported as balanced with a probability below 1e-8, as long as no edge has more than two surplus faces
    /// in one direction.
    #[arg(long)]
    fast: bool,

    /// Also look for faces that intersect, and require that there are none; about a microsecond per face
    #[arg(long)]
    self_intersections: bool,

    /// How many meshes, shells, and defects of each kind are listed
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = whole, allow_negative_numbers = true)]
    limit: usize,

    /// Print one JSON document instead of text
    ///
    /// A number that was not computed, or whose search did not finish, is null. The verdict is null if no
    /// file is cracked, but one could not be read or a search did not finish. At most 1000 shells per mesh
    /// and 64 faces per defect are listed. Faces are triangles, numbered from 0 in each mesh; `origins` names
    /// the polygon of the file that each was cut from, numbered from 0 in each mesh of the file whatever
    /// --only and --scope leave, its line (OBJ, and text STL, PLY and OFF) and its part.
    #[arg(long)]
    json: bool,

    /// Print one JSON document a line, for each file as it ends, instead of one for all
    #[arg(long, conflicts_with = "json")]
    json_lines: bool,

    /// Print one line a file: its verdict, its name, and the number of each kind of defect
    #[arg(long, conflicts_with_all = ["json", "json_lines"])]
    summary: bool,

    /// Print nothing but errors: the exit code is the answer
    #[arg(long, conflicts_with_all = ["json", "json_lines", "summary"])]
    quiet: bool,

    /// Fail only on what is worse than in an earlier report, as --json printed it
    /// [default: on what --require asks]
    ///
    /// Files are matched by name, or where there is only one each, whatever its name; meshes by name and
    /// order. A kind of defect that a mesh has more of is new. For example, before and after an optimizer:
    /// umbrage check a.glb --json > a.json; umbrage check b.glb --baseline a.json.
    #[arg(long, value_name = "BEFORE.json")]
    baseline: Option<PathBuf>,

    /// Write the report as JUnit XML, which build servers show: a suite a file, a case a mesh
    /// [default: nothing is written]
    #[arg(long, value_name = "OUT.xml")]
    junit: Option<PathBuf>,

    /// Write the report as SARIF 2.1.0, which code hosts and editors show: a result a defect, --limit of each
    /// kind [default: nothing is written]
    #[arg(long, value_name = "OUT.sarif")]
    sarif: Option<PathBuf>,

    #[command(flatten)]
    threads: ThreadArgs,

    /// Draw the mesh with its defects over it, 960x540 pixels; for one input file
    /// [default: nothing is drawn]
    ///
    /// Boundary edges are red, non-manifold edges magenta, misoriented edges yellow, dimmed where the mesh
    /// hides them; standard error explains the other colors.
    #[arg(long, value_name = "OUT.png")]
    picture: Option<PathBuf>,

    /// Write the mesh and its defects as colored geometry, for any glTF viewer; for one input file
    /// [default: nothing is written]
    ///
    /// Boundary edges are red, non-manifold edges magenta, misoriented edges yellow; vertices and faces too
    /// small to see are marked by an octahedron 0.5 % of the diagonal in size. The first --limit defects of
    /// each kind are nodes of their own, named by their faces and polygons as in the text; all others are one
    /// more.
    #[arg(long, value_name = "OUT.glb")]
    mark: Option<PathBuf>,
}

/// The names of the requirements, and what they stand for.
pub(super) fn requirements() -> impl TypedValueParser<Value = Requirement> {
    PossibleValuesParser::new(Requirement::ALL.map(Requirement::name))
        .map(|name| name.parse().expect("the name of a requirement"))
}

impl Args {
    /// What is required of every mesh, in the order of a report.
    fn requirements(&self) -> Vec<Requirement> {
        let mut all = self.require.clone();
        if self.require.is_empty() {
            all.push(if self.fast { Requirement::Balanced } else { Requirement::Sound });
        }
        all.extend(self.self_intersections.then_some(Requirement::NoSelfIntersections));
        all.extend((!self.allow_empty).then_some(Requirement::NotEmpty));
        all.sort_unstable();
        all.dedup();
        all
    }

    fn searches_self_intersections(&self) -> bool {
        self.requirements().contains(&Requirement::NoSelfIntersections)
    }
}

pub(crate) fn run(mut args: Args) -> Result<Outcome, Failure> {
    args.files = files::expand(args.files);
    refuse(&args)?;
    args.threads.apply()?;
    if args.fast {
        return fast::run(&args);
    }
    let mut out = Output::new();
    let mut outcome = Outcome::Sound;
    let baseline = args.baseline.as_deref().map(Baseline::read).transpose()?;
    let mut reports = Vec::with_capacity(args.files.len());
    let mut overview = text::Overview::default();
    let mut marks = args.mark.is_some().then(|| Marks::naming(args.limit));
    let mut sketch = args.picture.is_some().then(Sketch::default);
    let mut up = Up::default();
    for (index, file) in args.files.iter().enumerate() {
        let report = examine(file, &args, marks.as_mut(), sketch.as_mut());
        up = report.as_ref().ok().and_then(|report| report.format).map_or(Up::Y, Format::up);
        outcome = outcome.max(match (&report, &baseline) {
            (Ok(report), Some(baseline)) => {
                let worse = baseline.worse(report, args.files.len() == 1);
                for line in &worse {
                    output::say(format_args!("new: {}: {line}", output::plain(&file.to_string_lossy())));
                }
                if worse.is_empty() { Outcome::Sound } else { Outcome::Unsound }
            }
            (Ok(report), None) if report.sound() => Outcome::Sound,
            (Ok(_), None) => Outcome::Unsound,
            (Err(failure), _) => {
                output::say(failure);
                Outcome::Incomplete
            }
        });
        overview.add(file, &report);
        match &report {
            _ if args.json || args.quiet => {}
            _ if args.json_lines => {
                let one = json::document(&[file.to_owned()], std::slice::from_ref(&report), args.limit);
                out.line(&one["files"][0])?;
            }
            _ if args.summary => out.line(text::Summary { file, report: &report })?,
            Ok(report) => {
                if index > 0 {
                    out.text("\n")?;
                }
                out.text(text::Report { report, limit: args.limit })?;
            }
            Err(_) => {}
        }
        out.flush()?;
        reports.push(report);
    }
    if args.json {
        out.json(&json::document(&args.files, &reports, args.limit))?;
    } else if args.files.len() > 1 && !args.json_lines && !args.quiet && !args.summary {
        out.text(format_args!("\n{overview}"))?;
    }
    out.flush()?;
    if let Some(path) = &args.junit {
        let bytes = junit::document(&args.files, &reports).map_err(output::unwritable)?;
        write::write_atomic(path, |out| out.write_all(&bytes))?;
        output::wrote(path);
    }
    if let Some(path) = &args.sarif {
        let document = sarif::document(&args.files, &reports);
        write::write_atomic(path, |out| writeln!(out, "{document:#}"))?;
        output::wrote(path);
    }
    if let (Some(path), Some(marks), Outcome::Sound | Outcome::Unsound) = (&args.mark, marks, outcome) {
        write::write(&marks.into_model(), path)?;
        output::wrote(path);
    }
    if let (Some(path), Some(sketch), Outcome::Sound | Outcome::Unsound) = (&args.picture, sketch, outcome) {
        sketch.write(up, path)?;
    }
    Ok(outcome)
}

/// The report of one file as text, as JSON, and as a marked mesh, self-intersections included.
pub(super) fn full(file: &Path) -> Result<(String, Value, Model), Failure> {
    let args = Args {
        files: vec![file.to_owned()],
        mesh: MeshArgs::default(),
        require: Vec::new(),
        allow_empty: false,
        fast: false,
        self_intersections: true,
        limit: 5,
        json: false,
        json_lines: false,
        summary: false,
        quiet: false,
        baseline: None,
        junit: None,
        sarif: None,
        threads: ThreadArgs::default(),
        picture: None,
        mark: None,
    };
    let mut marks = Marks::naming(args.limit);
    let report = examine(file, &args, Some(&mut marks), None)?;
    let text = text::Report { report: &report, limit: args.limit }.to_string();
    Ok((text, json::document(&args.files, &[Ok(report)], args.limit), marks.into_model()))
}

/// Refuses bad arguments before any work is done.
fn refuse(args: &Args) -> Result<(), Failure> {
    if args.fast {
        fast::refuse(args)?;
    }
    for (option, path) in [("--junit", &args.junit), ("--sarif", &args.sarif)] {
        for file in &args.files {
            refuse_overwriting(option, path.as_deref(), file)?;
        }
        path.as_deref().map_or(Ok(()), require_folder)?;
    }
    for (option, path) in [("--mark", &args.mark), ("--picture", &args.picture)] {
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
    Ok(())
}

#[cfg(test)]
mod tests {
    use umbrage::check::{CrackReport, Verdict};
    use umbrage::topology::Topology;

    use super::report::verdict;
    use super::*;

    fn args(file: &Path) -> Args {
        Args {
            files: vec![file.to_owned()],
            mesh: MeshArgs::default(),
            require: Vec::new(),
            allow_empty: false,
            fast: false,
            self_intersections: false,
            limit: 5,
            json: false,
            json_lines: false,
            summary: false,
            quiet: false,
            baseline: None,
            junit: None,
            sarif: None,
            threads: ThreadArgs::default(),
            picture: None,
            mark: None,
        }
    }

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
            let args = args(&file);
            let report = examine(&file, &args, None, None).ok().unwrap();
            let printed = text::Report { report: &report, limit: 5 }.to_string();
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
        let args = args(&file);
        // As if the searches had given up before the cavity and before the last T-junction.
        let mut report = examine(&file, &args, None, None).ok().unwrap();
        assert_eq!(report.verdict(), Verdict::Sound);
        let mesh = &mut report.meshes[0];
        let cavity = mesh.shell_list.iter_mut().find(|shell| shell.depth == 1).unwrap();
        (cavity.depth, cavity.parent, cavity.depth_known) = (0, None, false);
        mesh.counts.undecided_shells = 1;
        (mesh.nesting_complete, mesh.t_junctions_complete) = (false, false);
        mesh.verdict = verdict(&[Requirement::Sound], &mesh.counts);
        assert_eq!(mesh.verdict, Verdict::NotProven);
        assert_eq!(verdict(&[Requirement::Watertight], &mesh.counts), Verdict::Sound);
        let text = text::Report { report: &report, limit: 5 }.to_string();
        let line = "not proven sound: the mesh is watertight, but nesting not decided within the limit: 1 shell \
                    may be inside out";
        assert!(text.lines().any(|text| text.trim() == line), "{text}");
        assert!(!text.contains("cracked") && !report.sound(), "{text}");

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
