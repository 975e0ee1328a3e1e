//! `umbrage check`: the crack report of each file.

mod baseline;
mod drawn;
mod fast;
mod fragment;
mod frames;
mod json;
mod junit;
mod mark;
mod page;
mod picture;
mod report;
mod rules;
mod sarif;
mod text;
mod worker;

use std::path::{Path, PathBuf};
use std::time::Duration;

use clap::builder::{PossibleValuesParser, TypedValueParser};
use serde_json::Value;
use umbrage::check::Requirement;
use umbrage::read::Format;
use umbrage::view::Up;
use umbrage::write::{self, Model};

use super::color::{ColorChoice, Painter};
use super::files;
use super::load::MeshArgs;
use super::output::{self, Output};
use super::parsers::{refuse_overwriting, require_folder, whole};
use super::pose::PoseArgs;
use super::resources::ThreadArgs;
use super::{Failure, Outcome, render};
use baseline::Baseline;
use fragment::Fragment;
use mark::Marks;
use page::Page;
use picture::Sketch;
use report::{Drawings, Found, MeshReport, Place, examine};
use rules::Rules;

#[cfg(any(test, feature = "viewer"))]
pub(super) use drawn::{Drawn, color as defect_color};
pub(super) use json::total;
#[cfg(any(test, feature = "viewer"))]
pub(super) use page::{around, mean_normal};
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

    #[command(flatten)]
    pose: PoseArgs,

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

    /// Check every pose: all keys of the clip, each frame at --fps if that is given, or all frames of md2
    ///
    /// Says which defects only some poses have, and which pose has each kind first; the rest of the report is
    /// of the first pose. The verdict is the worst of any pose. At most 10000 poses.
    #[arg(long, conflicts_with_all = ["time", "frame", "fast"])]
    all_frames: bool,

    /// How many meshes, shells, and defects of each kind are listed
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = whole, allow_negative_numbers = true)]
    limit: usize,

    /// Print one JSON document instead of text
    ///
    /// A number that was not computed, or whose search did not finish, is null. The verdict is null if no
    /// file is cracked, but one could not be read or a search did not finish. At most 1000 shells per mesh
    /// and 64 faces per defect are listed. Faces are triangles, numbered from 0 in each mesh; `origins` names
    /// the polygon of the file that each was cut from, numbered from 0 in each mesh of the file whatever
    /// --only and --scope leave, its line (OBJ, and text STL, PLY and OFF) and its part. The form is version
    /// 1 of data/check.schema.json.
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

    /// When the words of verdicts are colored
    #[arg(long, value_name = "WHEN", value_enum, default_value_t = ColorChoice::Auto)]
    color: ColorChoice,

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

    /// Write a page with the counts, a view of the mesh and a list of defects that leads the view to each;
    /// for one input file [default: nothing is written]
    ///
    /// One file that needs no network; 500 defects of a kind are listed, whatever --limit says. Above 200,000
    /// triangles the view is coarser than the mesh. Browsers without WebGL 2 show six pictures.
    #[arg(long, value_name = "OUT.html")]
    html: Option<PathBuf>,

    /// Give each file this time, in seconds, in a process of its own: one that takes longer is reported as
    /// not finished, and the others go on [default: no limit]
    ///
    /// A file whose process crashes is reported as well, as one that could not be read. Not with --fast,
    /// --mark, --picture and --html.
    #[arg(long, value_name = "SECONDS", value_parser = seconds, allow_negative_numbers = true)]
    file_timeout: Option<Duration>,

    /// A file of rules: what is required of which files [default: umbrage.toml in the working folder, if
    /// there is one]
    ///
    /// Its tables [[rule]] have files (patterns of paths, or, without a slash, of names; `*` stands for any
    /// characters, `?` for one), and of require, allow-empty, self-intersections, weld and scope what differs
    /// from the defaults. The last rule for a file that has a key counts; the command line outranks it.
    #[arg(long, value_name = "RULES.toml")]
    config: Option<PathBuf>,

    /// The file that this process is to check for another one.
    #[arg(long, hide = true)]
    worker: Option<PathBuf>,

    /// Whether that one colors.
    #[arg(long, hide = true)]
    worker_colors: bool,
}

fn seconds(text: &str) -> Result<Duration, String> {
    let seconds = text.parse().ok().filter(|&seconds: &f64| seconds > 0.0);
    let duration = seconds.and_then(|seconds| Duration::try_from_secs_f64(seconds).ok());
    duration
        .filter(|duration| !duration.is_zero())
        .ok_or_else(|| "write a number of seconds above 0".to_owned())
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

    /// Whether standard output is the text of each report.
    fn prints_reports(&self) -> bool {
        !(self.json || self.json_lines || self.summary || self.quiet)
    }

    /// Whether a document of all files is made.
    fn wants_documents(&self) -> bool {
        self.json || self.junit.is_some() || self.sarif.is_some()
    }

    /// Whether the JSON of each file is needed.
    fn wants_entries(&self) -> bool {
        self.wants_documents() || self.json_lines || self.baseline.is_some()
    }

    fn searches_self_intersections(&self) -> bool {
        self.requirements().contains(&Requirement::NoSelfIntersections)
    }
}

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
    let mut overview = text::Overview::new(painter);
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
    let args = Args {
        files: vec![file.to_owned()],
        mesh: MeshArgs::default(),
        pose: PoseArgs::default(),
        require: Vec::new(),
        allow_empty: false,
        fast: false,
        self_intersections: true,
        all_frames: false,
        limit: 5,
        json: false,
        json_lines: false,
        summary: false,
        quiet: false,
        color: ColorChoice::default(),
        baseline: None,
        junit: None,
        sarif: None,
        threads: ThreadArgs::default(),
        picture: None,
        mark: None,
        html: None,
        file_timeout: None,
        config: None,
        worker: None,
        worker_colors: false,
    };
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
    use umbrage::check::{CrackReport, Verdict};
    use umbrage::topology::Topology;

    use super::report::verdict;
    use super::*;

    fn args(file: &Path) -> Args {
        Args {
            files: vec![file.to_owned()],
            mesh: MeshArgs::default(),
            pose: PoseArgs::default(),
            require: Vec::new(),
            allow_empty: false,
            fast: false,
            self_intersections: false,
            all_frames: false,
            limit: 5,
            json: false,
            json_lines: false,
            summary: false,
            quiet: false,
            color: ColorChoice::default(),
            baseline: None,
            junit: None,
            sarif: None,
            threads: ThreadArgs::default(),
            picture: None,
            mark: None,
            html: None,
            file_timeout: None,
            config: None,
            worker: None,
            worker_colors: false,
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
        let args = args(&file);
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
