//! The options of `umbrage check`.

use std::path::{Path, PathBuf};
use std::time::Duration;

use clap::builder::{PossibleValuesParser, TypedValueParser};
use umbrage::check::Requirement;

use crate::cli::color::ColorChoice;
use crate::cli::load::MeshArgs;
use crate::cli::parsers::whole;
use crate::cli::pose::PoseArgs;
use crate::cli::resources::ThreadArgs;

/// Defects of each kind that are listed where nothing is said.
const LIMIT: usize = 5;

/// Crack report: is a mesh closed, and if not, where and with what effect
///
/// A file is sound if every mesh in it has faces, is watertight (each edge has two faces, in opposite
/// directions), and has no shell that is inside out.
#[derive(Clone, Debug, clap::Args)]
pub(crate) struct Args {
    /// Mesh files, or folders of such, or - for standard input: obj, gltf, glb, stl, ply, off, md2, 3mf; also
    /// in gzip or ZIP; recognized by their content, then by their extension
    #[arg(required = true, value_name = "FILE")]
    pub(super) files: Vec<PathBuf>,

    #[command(flatten)]
    pub(super) mesh: MeshArgs,

    #[command(flatten)]
    pub(super) pose: PoseArgs,

    /// Require this of every mesh, instead of soundness; a list, or repeated [default: sound]
    ///
    /// Sound: watertight, and no shell inside out. Watertight: every edge has exactly two faces, in opposite
    /// directions. Balanced: at every edge the two directions are used equally often; enough for stencil
    /// counting. Even: every edge is used an even number of times; enough for parity counting. Manifold: no
    /// edge has more than two faces, and no vertex more than one fan of them. What needs a search is searched
    /// for, and a search that does not finish does not pass.
    #[arg(long, value_name = "PROPERTY,...", value_delimiter = ',', value_parser = requirements())]
    pub(super) require: Vec<Requirement>,

    /// Let a mesh pass that has no faces, or none left after the weld
    #[arg(long)]
    pub(super) allow_empty: bool,

    /// Only decide whether each mesh is balanced, as fast as it can be read
    ///
    /// Balanced: at every edge the two directions are used equally often. A mesh that is not balanced is
    /// reported as balanced with a probability below 1e-8, as long as no edge has more than two surplus faces
    /// in one direction.
    #[arg(long)]
    pub(super) fast: bool,

    /// Also look for faces that intersect, and require that there are none; about a microsecond per face
    #[arg(long)]
    pub(super) self_intersections: bool,

    /// Check every pose: all keys of the clip, each frame at --fps if that is given, or all frames of md2
    ///
    /// Says which defects only some poses have, and which pose has each kind first; the rest of the report is
    /// of the first pose. The verdict is the worst of any pose. At most 10000 poses.
    #[arg(long, conflicts_with_all = ["time", "frame", "fast"])]
    pub(super) all_frames: bool,

    /// How many meshes, shells, and defects of each kind are listed
    #[arg(long, value_name = "N", default_value_t = LIMIT, value_parser = whole, allow_negative_numbers = true)]
    pub(super) limit: usize,

    /// Print one JSON document instead of text
    ///
    /// A number that was not computed, or whose search did not finish, is null. The verdict is null if no
    /// file is cracked, but one could not be read or a search did not finish. At most 1000 shells per mesh
    /// and 64 faces per defect are listed. Faces are triangles, numbered from 0 in each mesh; `origins` names
    /// the polygon of the file that each was cut from, numbered from 0 in each mesh of the file whatever
    /// --only and --scope leave, its line (OBJ, and text STL, PLY and OFF) and its part. The form is version
    /// 1 of data/check.schema.json.
    #[arg(long)]
    pub(super) json: bool,

    /// Print one JSON document a line, for each file as it ends, instead of one for all
    #[arg(long, conflicts_with = "json")]
    pub(super) json_lines: bool,

    /// Print one line a file: its verdict, its name, and the number of each kind of defect
    #[arg(long, conflicts_with_all = ["json", "json_lines"])]
    pub(super) summary: bool,

    /// Print nothing but errors: the exit code is the answer
    #[arg(long, conflicts_with_all = ["json", "json_lines", "summary"])]
    pub(super) quiet: bool,

    /// When the words of verdicts are colored
    #[arg(long, value_name = "WHEN", value_enum, default_value_t = ColorChoice::Auto)]
    pub(super) color: ColorChoice,

    /// Fail only on what is worse than in an earlier report, as --json printed it
    /// [default: on what --require asks]
    ///
    /// Files are matched by name, or where there is only one each, whatever its name; meshes by name and
    /// order. A kind of defect that a mesh has more of is new. For example, before and after an optimizer:
    /// umbrage check a.glb --json > a.json; umbrage check b.glb --baseline a.json.
    #[arg(long, value_name = "BEFORE.json")]
    pub(super) baseline: Option<PathBuf>,

    /// Write the report as JUnit XML, which build servers show: a suite a file, a case a mesh
    /// [default: nothing is written]
    #[arg(long, value_name = "OUT.xml")]
    pub(super) junit: Option<PathBuf>,

    /// Write the report as SARIF 2.1.0, which code hosts and editors show: a result a defect, --limit of each
    /// kind [default: nothing is written]
    #[arg(long, value_name = "OUT.sarif")]
    pub(super) sarif: Option<PathBuf>,

    #[command(flatten)]
    pub(super) threads: ThreadArgs,

    /// Draw the mesh with its defects over it, 960x540 pixels; for one input file
    /// [default: nothing is drawn]
    ///
    /// Boundary edges are red, non-manifold edges magenta, misoriented edges yellow, dimmed where the mesh
    /// hides them; standard error explains the other colors.
    #[arg(long, value_name = "OUT.png")]
    pub(super) picture: Option<PathBuf>,

    /// Write the mesh and its defects as colored geometry, for any glTF viewer; for one input file
    /// [default: nothing is written]
    ///
    /// Boundary edges are red, non-manifold edges magenta, misoriented edges yellow; vertices and faces too
    /// small to see are marked by an octahedron 0.5 % of the diagonal in size. The first --limit defects of
    /// each kind are nodes of their own, named by their faces and polygons as in the text; all others are one
    /// more.
    #[arg(long, value_name = "OUT.glb")]
    pub(super) mark: Option<PathBuf>,

    /// Write a page with the counts, a view of the mesh and a list of defects that leads the view to each;
    /// for one input file [default: nothing is written]
    ///
    /// One file that needs no network; 500 defects of a kind are listed, whatever --limit says. Above 200,000
    /// triangles the view is coarser than the mesh. Browsers without WebGL 2 show six pictures.
    #[arg(long, value_name = "OUT.html")]
    pub(super) html: Option<PathBuf>,

    /// Give each file this time, in seconds, in a process of its own: one that takes longer is reported as
    /// not finished, and the others go on [default: no limit]
    ///
    /// A file whose process crashes is reported as well, as one that could not be read. Not with --fast,
    /// --mark, --picture and --html.
    #[arg(long, value_name = "SECONDS", value_parser = seconds, allow_negative_numbers = true)]
    pub(super) file_timeout: Option<Duration>,

    /// A file of rules: what is required of which files [default: umbrage.toml in the working folder, if
    /// there is one]
    ///
    /// Its tables [[rule]] have files (patterns of paths, or, without a slash, of names; `*` stands for any
    /// characters, `?` for one), and of require, allow-empty, self-intersections, weld and scope what differs
    /// from the defaults. The last rule for a file that has a key counts; the command line outranks it.
    #[arg(long, value_name = "RULES.toml")]
    pub(super) config: Option<PathBuf>,

    /// The file that this process is to check for another one.
    #[arg(long, hide = true)]
    pub(super) worker: Option<PathBuf>,

    /// Whether that one colors.
    #[arg(long, hide = true)]
    pub(super) worker_colors: bool,
}

fn seconds(text: &str) -> Result<Duration, String> {
    let seconds = text.parse().ok().filter(|&seconds: &f64| seconds > 0.0);
    let duration = seconds.and_then(|seconds| Duration::try_from_secs_f64(seconds).ok());
    duration
        .filter(|duration| !duration.is_zero())
        .ok_or_else(|| "write a number of seconds above 0".to_owned())
}

/// The names of the requirements, and what they stand for.
pub(in crate::cli) fn requirements() -> impl TypedValueParser<Value = Requirement> {
    PossibleValuesParser::new(Requirement::ALL.map(Requirement::name))
        .map(|name| name.parse().expect("the name of a requirement"))
}

impl Args {
    /// The defaults, for one file.
    pub(super) fn of(file: &Path) -> Self {
        Self {
            files: vec![file.to_owned()],
            mesh: MeshArgs::default(),
            pose: PoseArgs::default(),
            require: Vec::new(),
            allow_empty: false,
            fast: false,
            self_intersections: false,
            all_frames: false,
            limit: LIMIT,
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

    /// What is required of every mesh, in the order of a report.
    pub(super) fn requirements(&self) -> Vec<Requirement> {
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
    pub(super) fn prints_reports(&self) -> bool {
        !(self.json || self.json_lines || self.summary || self.quiet)
    }

    /// Whether a document of all files is made.
    pub(super) fn wants_documents(&self) -> bool {
        self.json || self.junit.is_some() || self.sarif.is_some()
    }

    /// Whether the JSON of each file is needed.
    pub(super) fn wants_entries(&self) -> bool {
        self.wants_documents() || self.json_lines || self.baseline.is_some()
    }

    pub(super) fn searches_self_intersections(&self) -> bool {
        self.requirements().contains(&Requirement::NoSelfIntersections)
    }
}
