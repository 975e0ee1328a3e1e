//! `umbrage prepare`: a mesh file into one that casts better.

mod back;
mod buffers;
mod fill_limit;
mod json;
mod text;

use std::fs;
use std::path::{Path, PathBuf};

use umbrage::check::{Requirement, Standing};
use umbrage::mesh::{Mesh, Weld};
use umbrage::repair::{self, Fill, Options, Step};
use umbrage::write::{self, Layer, Model, Target, WriteError};

use super::check::{FileReport, report_on, requirements};
use super::load::{MeshArgs, WeldedMesh};
use super::output::{self, Output};
use super::parsers::{distance, refuse_overwriting, require_folder, whole};
use super::progress::Progress;
use super::resources::ThreadArgs;
use super::{Failure, Outcome};
use fill_limit::FillLimit;

/// A caster mesh: what can be repaired without moving or inventing a vertex, with every change listed
///
/// Without options nothing is invented and nothing moves: equal vertices become one, collapsed faces and
/// vertices without a face go, and of several faces with the same three vertices one stays, or none where
/// opposite ones are a wall inside a closed solid. So all shadows outside solids stay. The options below add
/// steps, taken in this order: orient, weld-within, stitch, split, fill; all but weld-within leave every
/// position as it is.
///
/// Vertices of one position that a skin or a morph target of a glTF moves differently stay apart: the report
/// says how many a skin parts, and --shadow-indices does not mix them.
///
/// Never done: removing self-intersections, deleting shells, remeshing, decimating. Manifold and MeshLib do
/// the first.
///
/// What is written is geometry alone, placed as the scene places it, in its first pose: no materials, no
/// animation. It is read again before it is written, and must be the same.
#[derive(Clone, Debug, clap::Args)]
#[command(after_help = "Examples:\n  \
    umbrage prepare scan.ply -o caster.glb --fill\n  \
    umbrage prepare part.stl -o part.glb --weld-within 1e-4 --stitch --orient --require watertight\n  \
    umbrage prepare level.obj -o level.glb --split --require manifold --json\n\n\
    Exit codes: 0 written; 1 --require is not met, or the file reads back otherwise: nothing is written; \
    2 could not run.")]
pub(crate) struct Args {
    /// A mesh file, or - for standard input: obj, gltf, glb, stl, ply, off, md2, 3mf; also in gzip or ZIP;
    /// recognized by its content, then by its extension
    file: PathBuf,

    /// The file to write (required); only .glb holds several meshes
    #[arg(short, long, value_name = "OUT.{glb,obj,ply,stl}")]
    output: PathBuf,

    #[command(flatten)]
    mesh: MeshArgs,

    /// Turn faces so that neighbors agree and closed shells face outwards, cavities inwards
    ///
    /// A surface without an orientation (a Möbius strip) is left and named; all others are done. An open
    /// shell is turned the way that changes fewer faces.
    #[arg(long)]
    orient: bool,

    /// Merge vertices at most this far apart, in mesh units; the report gives the largest move
    /// [default: nothing moves]
    #[arg(long, value_name = "D", value_parser = distance, allow_negative_numbers = true)]
    weld_within: Option<f32>,

    /// Cut faces where a vertex of the boundary lies exactly on their edge
    #[arg(long)]
    stitch: bool,

    /// Give each fan of faces at a vertex a vertex of its own, so that no edge has more than two faces
    ///
    /// At an edge with more, faces that bound solid between them stay together. The new vertices have the
    /// positions of the old ones, so that a later weld undoes it: read the result with --weld none. STL
    /// cannot keep it.
    #[arg(long)]
    split: bool,

    /// Close holes, all of them or those within LIMIT; no new vertices [default: none are closed]
    ///
    /// LIMIT is a number of edges, or `edges=N`, `length=D` (around the hole, in mesh units), or both with a
    /// comma: --fill=64, --fill=length=0.5, --fill=edges=64,length=0.5. A hole beyond either is left and
    /// named.
    ///
    /// Of all ways to cut a hole into triangles that with the least area is taken, and one that meets no
    /// other face if that does. A hole that has none is left and named. Before a file name write
    /// --fill=LIMIT, or --fill last.
    #[arg(long, value_name = "LIMIT", num_args = 0..=1, value_parser = FillLimit::parse)]
    fill: Option<Option<FillLimit>>,

    /// Also close holes whose patch meets other faces
    #[arg(long, requires = "fill")]
    fill_anyway: bool,

    /// Also write an index buffer into the vertices of the input, three u32 a face, little-endian: equal
    /// positions become one index, and faces that are dropped are left out; for one mesh
    /// [default: nothing is written]
    ///
    /// Vertices are numbered as they are read: those of an OBJ, PLY or OFF file, three a face of an STL,
    /// those of all primitives of a glTF mesh one after the other.
    #[arg(long, value_name = "OUT")]
    shadow_indices: Option<PathBuf>,

    /// Also write the written mesh's triangles with adjacency, six u32 a face, little-endian, as
    /// GL_TRIANGLES_ADJACENCY takes them; for one mesh [default: nothing is written]
    ///
    /// After each corner comes the vertex across the edge that begins there: the third corner of the other
    /// face, or, at an open edge, of the face itself. An edge of more than two faces is refused: add --split.
    #[arg(long, value_name = "OUT")]
    adjacency: Option<PathBuf>,

    /// Also write the written mesh's edges: of each its vertices a < b, its faces, and its multiplicity,
    /// which is the faces that run from a to b minus those that run from b to a; for one mesh
    /// [default: nothing is written]
    ///
    /// A .json file holds `{"edges":[{"a","b","faces","multiplicity"}]}`. Any other holds 32-bit integers,
    /// little-endian: the number of edges, then for each edge a, b, multiplicity, the number of its faces,
    /// and these.
    #[arg(long, value_name = "OUT")]
    edges: Option<PathBuf>,

    /// Also write where the vertices and faces of the input are in the written mesh; for one mesh
    /// [default: nothing is written]
    ///
    /// A .json file holds `{"vertices":[[…]],"faces":[[…]]}`: of each old index the new ones; none if it was
    /// dropped, several if it was split or cut. Any other holds u32, little-endian, twice, for the vertices
    /// and for the faces: the number n of old indices; n + 1 offsets into the list; the list, as long as the
    /// last offset says. Old ones are numbered as --shadow-indices says, and faces as `check` numbers them.
    #[arg(long, value_name = "OUT")]
    map: Option<PathBuf>,

    /// Write only if every mesh is then like this; a list, or repeated [default: nothing is required]
    #[arg(long, value_name = "PROPERTY,...", value_delimiter = ',', value_parser = requirements())]
    require: Vec<Requirement>,

    /// How many changes of each step are listed in text
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = whole, allow_negative_numbers = true)]
    limit: usize,

    /// Print one JSON document instead of text: `file`, `before`, `after`, `steps`, `written`, `verified`
    ///
    /// `before` and `after` are totals as `check` prints them. At most 1000 changes of each step are listed;
    /// their indices are those of the mesh that the step before left.
    #[arg(long)]
    json: bool,

    #[command(flatten)]
    threads: ThreadArgs,
}

/// What was done to a file.
struct Report {
    file: PathBuf,
    before: FileReport,
    after: FileReport,
    /// The name of each mesh, and its steps.
    steps: Vec<(String, Vec<Step>)>,
    written: Option<PathBuf>,
    /// Whether the bytes read back as the meshes that were meant; `None` if nothing was to be written.
    verified: Option<bool>,
}

pub(crate) fn run(args: Args) -> Result<Outcome, Failure> {
    let target = target(&args)?;
    args.threads.apply()?;
    let baked = args.mesh.read(&args.file)?;
    if target != Target::Glb && baked.meshes.len() > 1 {
        let problem = format!("{target} holds one mesh, and there are {}", baked.meshes.len());
        return Err(
            Failure::new(problem, "name a .glb file, or join them with --scope scene").in_file(&args.output)
        );
    }
    if baked.meshes.iter().any(|mesh| !mesh.frames().is_empty()) {
        output::say(format_args!("note: {}: the first frame is written, no other", args.file.display()));
    }
    let original = buffers::original(&args, &baked.meshes)?;
    let progress = Progress::spinner(format!("preparing {}", args.file.display()));
    let (mut before, mut after, mut steps, mut map) = (Vec::new(), Vec::new(), Vec::new(), None);
    let options = args.options();
    for mesh in baked.meshes {
        before.push(args.mesh.weld(mesh.clone()));
        let name = mesh.name.clone();
        let prepared = repair::prepare(mesh, &options)
            .map_err(|error| Failure::new(error, "split the file").in_file(&args.file))?;
        after.push(as_it_is(prepared.mesh));
        steps.push((name, prepared.steps));
        map = prepared.map; // of one mesh, if at all
    }
    let by_skin = steps.iter().any(|(_, steps)| steps.iter().any(keeps_apart));
    let apart = match (args.split, by_skin) {
        (true, _) => Some(text::Apart::Split),
        (false, true) => Some(text::Apart::Skin),
        (false, false) => None,
    };
    let report = |meshes: &[WeldedMesh]| report_on(&args.file, baked.format, meshes, &args.require);
    let mut report = Report {
        file: args.file.clone(),
        before: report(&before),
        after: report(&after),
        steps,
        written: None,
        verified: None,
    };
    drop(before);
    let unmet: Vec<Requirement> = args
        .require
        .iter()
        .copied()
        .filter(|&asked| report.after.standing(asked) != Standing::Holds)
        .collect();
    if unmet.is_empty() {
        let meshes: Vec<&Mesh> = after.iter().map(|welded| &welded.mesh).collect();
        let buffers = buffers::of(&args, original.as_ref(), map.as_ref(), &meshes)?;
        report.written = write_verified(&args, target, apart.is_some(), &meshes, &report.after)?;
        report.verified = Some(report.written.is_some());
        if report.written.is_some() {
            buffers::write(buffers)?;
        }
    }
    drop(progress);
    let mut out = Output::new();
    if args.json {
        out.json(&json::document(&report))?;
    } else {
        out.text(text::Text { report: &report, limit: args.limit, apart })?;
    }
    out.flush()?;
    for asked in &unmet {
        let reasons = report.after.total().map(|total| asked.reasons(&total)).unwrap_or_default();
        output::say(text::not_written(*asked, &reasons));
    }
    match &report.written {
        Some(path) => output::wrote(path),
        None if unmet.is_empty() => {
            let problem = "nothing was written: the file would read back otherwise";
            output::say(Failure::new(problem, "write another format, such as .glb").in_file(&args.output));
        }
        None => {}
    }
    Ok(if report.written.is_some() { Outcome::Sound } else { Outcome::Unsound })
}

impl Args {
    fn options(&self) -> Options {
        let mut options = Options::default();
        options.weld = self.mesh.weld_rule();
        options.orient = self.orient;
        options.weld_within = self.weld_within;
        options.stitch = self.stitch;
        options.split = self.split;
        options.fill = self.fill.map(|limit| {
            let limit = limit.unwrap_or_default();
            let mut fill = Fill::default();
            (fill.most_edges, fill.most_length) = (limit.edges, limit.length);
            fill.anyway = self.fill_anyway;
            fill
        });
        options.map = self.map.is_some();
        options
    }

    /// The files beside the mesh that are asked for, by their options.
    fn beside(&self) -> impl Iterator<Item = (&'static str, &Path)> {
        let all = [
            ("--shadow-indices", &self.shadow_indices),
            ("--adjacency", &self.adjacency),
            ("--edges", &self.edges),
            ("--map", &self.map),
        ];
        all.into_iter().filter_map(|(option, path)| Some((option, path.as_deref()?)))
    }

    /// How the written file is to be read: equal positions may have to stay apart.
    fn reads_back_by(&self) -> Weld {
        if self.split || self.mesh.weld_rule() == Weld::None { Weld::None } else { Weld::Exact }
    }
}

/// The format to write; refuses bad arguments before any work is done.
fn target(args: &Args) -> Result<Target, Failure> {
    let path = &args.output;
    let is_stl = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("stl"));
    let target = match is_stl {
        true => Target::Stl,
        false => Target::from_path(path)
            .map_err(|error| WriteError { remedy: "use .glb, .obj, .ply or .stl".to_owned(), ..error })?,
    };
    if target == Target::Stl && args.reads_back_by() == Weld::None {
        let option = if args.split { "--split" } else { "--weld none" };
        let problem = format!("{option}: STL cannot keep vertices of one position apart");
        return Err(Failure::new(problem, "name a .glb, .obj or .ply file").in_file(path));
    }
    let mut named: Vec<&Path> = Vec::new();
    for (option, path) in [("--output", path.as_path())].into_iter().chain(args.beside()) {
        refuse_overwriting(option, Some(path), &args.file)?;
        require_folder(path)?;
        if named.contains(&path) {
            let problem = format!("{option} names a file that another option writes");
            return Err(Failure::new(problem, "name another file").in_file(path));
        }
        named.push(path);
    }
    Ok(target)
}

/// Whether a step left vertices of one position apart: a weld leaves nothing else.
fn keeps_apart(step: &Step) -> bool {
    step.name.starts_with("weld") && step.left > 0
}

/// A mesh that nothing is to be merged in.
fn as_it_is(mesh: Mesh) -> WeldedMesh {
    WeldedMesh { vertices: mesh.vertex_count(), unreferenced: 0, mesh }
}

/// Writes the meshes if their bytes read back as the same; the file that was written.
fn write_verified(
    args: &Args,
    target: Target,
    apart: bool,
    meshes: &[&Mesh],
    after: &FileReport,
) -> Result<Option<PathBuf>, Failure> {
    let path: &Path = &args.output;
    let model = Model { layers: meshes.iter().map(|&mesh| Layer::from(mesh)).collect() };
    let bytes = write::to_bytes(&model, target).map_err(|error| error.in_file(path))?;
    drop(model);
    let how = if apart { Weld::None } else { args.reads_back_by() };
    if !back::is_same(&bytes, path, how, meshes, after)? {
        return Ok(None);
    }
    write::write_atomic(path, |writer| writer.write_all(&bytes))?;
    // The disk has the last word.
    let failed =
        |error| Failure::new(format!("cannot be read again: {error}"), "check the disk").in_file(path);
    if fs::read(path).map_err(failed)? != bytes {
        return Err(Failure::new("was written, but other bytes are read", "check the disk").in_file(path));
    }
    Ok(Some(path.to_owned()))
}
