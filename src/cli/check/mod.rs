//! `umbrage check`: the crack report of each file.

mod fast;
mod json;
mod mark;
mod picture;
mod text;

use std::path::{Path, PathBuf};

use serde_json::Value;
use umbrage::check::{Counts, CrackReport, Defect, DefectKind, NearMiss, ShellReport, Verdict};
use umbrage::mesh::{FaceId, Mesh, Origin};
use umbrage::read::Format;
use umbrage::topology::Topology;
use umbrage::view::Up;
use umbrage::write::{self, Model};

use super::files;
use super::load::{self, MeshArgs, WeldedMesh};
use super::output::{self, Output};
use super::parsers::{refuse_overwriting, whole};
use super::progress::Progress;
use super::resources::ThreadArgs;
use super::{Failure, Outcome, render};
use mark::Marks;
use picture::Sketch;

/// Crack report: is a mesh closed, and if not, where and with what effect
///
/// A file is sound if every mesh in it is watertight (each edge has two faces, in opposite directions) and no
/// shell is inside out.
#[derive(Clone, Debug, clap::Args)]
pub(crate) struct Args {
    /// Mesh files, or folders of such, or - for standard input: obj, gltf, glb, stl, ply, md2, 3mf; also in
    /// gzip or ZIP; recognized by their content, then by their extension
    #[arg(required = true, value_name = "FILE")]
    files: Vec<PathBuf>,

    #[command(flatten)]
    mesh: MeshArgs,

    /// Require this of every mesh, instead of soundness [default: watertight, and no shell inside out]
    ///
    /// Name a weaker property when it is all that the next step needs.
    #[arg(long, value_enum)]
    require: Option<Require>,

    /// Only decide whether each mesh is balanced, as fast as it can be read
    ///
    /// Balanced: at every edge the two directions are used equally often. A mesh that is not balanced is
    /// reported as balanced with a probability below 1e-8, as long as no edge has more than two surplus faces
    /// in one direction.
    #[arg(long)]
    fast: bool,

    /// Also look for faces that intersect; about a microsecond per face
    #[arg(long)]
    self_intersections: bool,

    /// How many meshes, shells, and defects of each kind are listed
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = whole, allow_negative_numbers = true)]
    limit: usize,

    /// Print one JSON document instead of text
    ///
    /// A number that was not computed is null. The verdict is null if no file is cracked, but one could not
    /// be read or the nesting of its shells was not decided. At most 1000 shells per mesh and 64 faces per
    /// defect are listed. Faces are triangles, numbered from 0 in each mesh; `origins` names the polygon of the
    /// file that each was cut from, numbered from 0 in each mesh of the file whatever --only and --scope leave,
    /// its line (OBJ, and text STL and PLY) and its part.
    #[arg(long)]
    json: bool,

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
    /// small to see are marked by an octahedron 0.5 % of the diagonal in size.
    #[arg(long, value_name = "OUT.glb")]
    mark: Option<PathBuf>,
}

/// The property required of every mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum Require {
    /// Every edge has exactly two faces, in opposite directions
    Watertight,
    /// At every edge the two directions are used equally often; enough for stencil counting
    Balanced,
    /// Every edge is used an even number of times; enough for parity counting
    Even,
}

fn holds(require: Option<Require>, counts: &Counts) -> bool {
    match require {
        None => counts.sound(),
        Some(Require::Watertight) => counts.watertight,
        Some(Require::Balanced) => counts.balanced,
        Some(Require::Even) => counts.even,
    }
}

/// The report of one file.
struct FileReport {
    file: PathBuf,
    format: Option<Format>,
    meshes: Vec<MeshReport>,
    require: Option<Require>,
    /// Whether a larger `--scope` would join the meshes.
    joinable: bool,
}

/// The report of one mesh; the mesh itself is not kept.
struct MeshReport {
    name: String,
    vertices: usize,
    welded_vertices: usize,
    unreferenced_vertices: usize,
    counts: Counts,
    /// At most [`SHELLS_LISTED`] of them, and the polygon of the first face of each.
    shell_list: Vec<ShellReport>,
    shell_origins: Vec<Origin>,
    near_miss: Vec<NearMiss>,
    defects: Vec<Found>,
    nesting_complete: bool,
    t_junctions_complete: bool,
    verdict: Verdict,
}

/// The verdict on a mesh of which a property is asked.
fn verdict(require: Option<Require>, counts: &Counts) -> Verdict {
    match require {
        None => counts.verdict(),
        Some(_) if holds(require, counts) => Verdict::Sound,
        Some(_) => Verdict::Cracked,
    }
}

/// All defects of one kind.
struct Found {
    kind: DefectKind,
    count: usize,
    at: Vec<Place>,
}

/// The location of one defect.
struct Place {
    position: [f32; 3],
    length: Option<f64>,
    /// At most [`FACES_LISTED`] of them.
    faces: Vec<Listed>,
    face_count: usize,
    /// The names of the parts that the listed faces belong to, or of the mesh.
    name: String,
}

/// A face, and where its file has it.
struct Listed {
    face: FaceId,
    origin: Origin,
    /// The part that it belongs to, or none.
    part: String,
}

/// Bounds on lists: a mesh may fall apart into single faces, and a whole shell may be one defect.
const SHELLS_LISTED: usize = 1000;
const FACES_LISTED: usize = 64;

pub(crate) fn run(mut args: Args) -> Result<Outcome, Failure> {
    args.files = files::expand(args.files);
    refuse(&args)?;
    args.threads.apply()?;
    if args.fast {
        return fast::run(&args);
    }
    let mut out = Output::new();
    let mut outcome = Outcome::Sound;
    let mut documents = Vec::new();
    let mut overview = text::Overview::default();
    let mut marks = args.mark.is_some().then(Marks::default);
    let mut sketch = args.picture.is_some().then(Sketch::default);
    let mut up = Up::default();
    for (index, file) in args.files.iter().enumerate() {
        let report = examine(file, &args, marks.as_mut(), sketch.as_mut());
        up = report.as_ref().ok().and_then(|report| report.format).map_or(Up::Y, Format::up);
        outcome = outcome.max(match &report {
            Ok(report) if report.sound() => Outcome::Sound,
            Ok(_) => Outcome::Unsound,
            Err(failure) => {
                output::say(failure);
                Outcome::Incomplete
            }
        });
        overview.add(file, &report);
        if args.json {
            documents.push(report);
        } else if let Ok(report) = report {
            if index > 0 {
                out.text("\n")?;
            }
            out.text(text::Report { report: &report, limit: args.limit })?;
            out.flush()?;
        }
    }
    if args.json {
        out.json(&json::document(&args.files, &documents, args.limit))?;
    } else if args.files.len() > 1 {
        out.text(format_args!("\n{overview}"))?;
    }
    out.flush()?;
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
        require: None,
        fast: false,
        self_intersections: true,
        limit: 5,
        json: false,
        threads: ThreadArgs::default(),
        picture: None,
        mark: None,
    };
    let mut marks = Marks::default();
    let report = examine(file, &args, Some(&mut marks), None)?;
    let text = text::Report { report: &report, limit: args.limit }.to_string();
    Ok((text, json::document(&args.files, &[Ok(report)], args.limit), marks.into_model()))
}

/// Refuses bad arguments before any work is done.
fn refuse(args: &Args) -> Result<(), Failure> {
    if args.fast {
        fast::refuse(args)?;
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

/// Reads a file and reports on it, one mesh at a time.
fn examine(
    file: &Path,
    args: &Args,
    mut marks: Option<&mut Marks>,
    mut sketch: Option<&mut Sketch>,
) -> Result<FileReport, Failure> {
    let baked = args.mesh.read(file)?;
    let _progress = Progress::spinner(format!("checking {}", file.display()));
    let mut meshes = Vec::with_capacity(baked.meshes.len());
    for mesh in baked.meshes {
        let WeldedMesh { mesh, vertices, unreferenced } = args.mesh.weld(mesh);
        let topology = Topology::of(&mesh);
        let mut report = CrackReport::of(&mesh, &topology);
        for (complete, note) in [
            (report.nesting_complete, "the nesting of shells was not decided: too many overlap"),
            (report.t_junctions_complete, "the search for T-junctions gave up: too many edges overlap"),
        ] {
            if !complete {
                output::say(format_args!("note: {}: {note}", file.display()));
            }
        }
        if args.self_intersections {
            let all = marks.is_some() || sketch.is_some();
            let keep = if all { mark::PAIRS_MARKED } else { args.limit.min(mark::PAIRS_MARKED) };
            report.add_self_intersections(&mesh, &topology, keep);
            if let Some(found) = report.self_intersections.as_ref().filter(|found| !found.complete) {
                let (file, pairs) = (file.display(), found.pairs);
                output::say(format_args!("note: {file}: counting self-intersections stopped at {pairs}"));
            }
        }
        if let Some(marks) = &mut marks {
            marks.add(&report, &mesh, &topology).map_err(|failure| failure.in_file(file))?;
        }
        if let Some(sketch) = &mut sketch {
            sketch.add(&report, &mesh, &topology);
        }
        let defects = defects(&report, &mesh, &topology, args.limit);
        let CrackReport { counts, mut shell_list, near_miss, nesting_complete, t_junctions_complete, .. } =
            report;
        shell_list.truncate(SHELLS_LISTED);
        let shell_origins = shell_list.iter().map(|shell| mesh.origin(shell.first_face)).collect();
        meshes.push(MeshReport {
            name: mesh.name.clone(),
            vertices,
            welded_vertices: mesh.vertex_count(),
            unreferenced_vertices: unreferenced,
            counts,
            shell_list,
            shell_origins,
            near_miss,
            defects,
            nesting_complete,
            t_junctions_complete,
            verdict: verdict(args.require, &counts),
        });
    }
    let total = |of: fn(&Counts) -> usize| meshes.iter().map(|mesh| of(&mesh.counts)).sum();
    load::note_none_left(file, total(|counts| counts.faces), total(|counts| counts.collapsed_faces));
    let joinable = args.mesh.is_below_scene() && meshes.len() > 1;
    Ok(FileReport { file: file.to_owned(), format: baked.format, meshes, require: args.require, joinable })
}

/// Every kind of defect that there is one of.
fn defects(report: &CrackReport, mesh: &Mesh, topology: &Topology, limit: usize) -> Vec<Found> {
    let found = |kind| match report.count(kind) {
        None | Some(0) => None,
        Some(count) => {
            let items = report.items(kind, mesh, topology, limit);
            Some(Found { kind, count, at: items.into_iter().map(|item| Place::of(item, mesh)).collect() })
        }
    };
    DefectKind::ALL.into_iter().filter_map(found).collect()
}

impl MeshReport {
    fn sound(&self) -> bool {
        self.verdict == Verdict::Sound
    }
}

impl Place {
    fn of(defect: Defect, mesh: &Mesh) -> Self {
        let face_count = defect.faces.len();
        let listed = |face: FaceId| Listed {
            face,
            origin: mesh.origin(face),
            part: mesh.part_name(face).unwrap_or_default().to_owned(),
        };
        let faces: Vec<Listed> = defect.faces.into_iter().take(FACES_LISTED).map(listed).collect();
        let mut names: Vec<&str> = Vec::new();
        for name in faces.iter().map(|listed| listed.part.as_str()).filter(|name| !name.is_empty()) {
            if !names.contains(&name) {
                names.push(name);
            }
        }
        let name = if names.is_empty() { mesh.name.clone() } else { names.join(", ") };
        Self { position: defect.position, length: defect.length, faces, face_count, name }
    }
}

impl FileReport {
    fn sound(&self) -> bool {
        self.verdict() == Verdict::Sound
    }

    /// The worst of any mesh.
    fn verdict(&self) -> Verdict {
        self.meshes.iter().map(|mesh| mesh.verdict).max().unwrap_or(Verdict::Sound)
    }

    /// `None` if there is no mesh.
    fn total(&self) -> Option<Counts> {
        Counts::total(self.meshes.iter().map(|mesh| mesh.counts))
    }

    fn sum(&self, of: impl Fn(&MeshReport) -> usize) -> usize {
        self.meshes.iter().map(of).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn args(file: &Path) -> Args {
        Args {
            files: vec![file.to_owned()],
            mesh: MeshArgs::default(),
            require: None,
            fast: false,
            self_intersections: false,
            limit: 5,
            json: false,
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
        mesh.verdict = verdict(None, &mesh.counts);
        assert_eq!(mesh.verdict, Verdict::NotProven);
        assert_eq!(verdict(Some(Require::Watertight), &mesh.counts), Verdict::Sound);
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
