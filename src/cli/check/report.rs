//! The report of a file, and how it is made: one mesh at a time.

use std::path::{Path, PathBuf};

use umbrage::check::{
    Counts, CrackReport, Defect, DefectKind, NearMiss, Requirement, ShellReport, Standing, Verdict,
};
use umbrage::geom::Aabb;
use umbrage::glam::Mat4;
use umbrage::mesh::{FaceId, Mesh, Origin};
use umbrage::read::Format;
use umbrage::scene::OwnSpace;
use umbrage::topology::Topology;

use super::Args;
use super::frames::Frames;
use super::mark::{self, Marks};
use super::page::Page;
use super::picture::Sketch;
use crate::cli::Failure;
use crate::cli::load::{self, WeldedMesh};
use crate::cli::output;
use crate::cli::progress::Progress;

/// The report of one file.
pub(in crate::cli) struct FileReport {
    pub(super) file: PathBuf,
    pub(super) format: Option<Format>,
    pub(super) meshes: Vec<MeshReport>,
    /// What is required of every mesh.
    pub(super) requirements: Vec<Requirement>,
    /// Whether a larger `--scope` would join the meshes.
    pub(super) joinable: bool,
    /// How far rounding moved a coordinate that was judged; `None` if that is negligible.
    pub(super) rounding: Option<f64>,
    /// What other poses have; `None` if that was not asked for.
    pub(super) frames: Option<Frames>,
}

/// The report of one mesh; the mesh itself is not kept.
pub(super) struct MeshReport {
    pub(super) name: String,
    pub(super) vertices: usize,
    pub(super) welded_vertices: usize,
    pub(super) unreferenced_vertices: usize,
    pub(super) counts: Counts,
    /// At most [`SHELLS_LISTED`] of them, and the polygon of the first face of each.
    pub(super) shell_list: Vec<ShellReport>,
    pub(super) shell_origins: Vec<Origin>,
    pub(super) near_miss: Vec<NearMiss>,
    pub(super) defects: Vec<Found>,
    pub(super) nesting_complete: bool,
    pub(super) t_junctions_complete: bool,
    pub(super) verdict: Verdict,
}

/// The verdict on a mesh of which properties are required.
pub(super) fn verdict(requirements: &[Requirement], counts: &Counts) -> Verdict {
    let worst = requirements.iter().map(|requirement| requirement.standing(counts)).max();
    match worst.unwrap_or(Standing::Holds) {
        Standing::Holds => Verdict::Sound,
        Standing::Undecided => Verdict::NotProven,
        Standing::Fails if counts.is_empty() && requirements.contains(&Requirement::NotEmpty) => {
            Verdict::Empty
        }
        Standing::Fails => Verdict::Cracked,
    }
}

/// All defects of one kind.
pub(super) struct Found {
    pub(super) kind: DefectKind,
    pub(super) count: usize,
    /// Whether these are all; a search that stopped at a limit found at least this number.
    pub(super) complete: bool,
    pub(super) at: Vec<Place>,
}

/// The location of one defect.
pub(super) struct Place {
    pub(super) position: [f32; 3],
    pub(super) length: Option<f64>,
    /// At most [`FACES_LISTED`] of them.
    pub(super) faces: Vec<Listed>,
    pub(super) face_count: usize,
    /// The names of the parts that the listed faces belong to, or of the mesh.
    pub(super) name: String,
}

/// A face, and where its file has it.
pub(super) struct Listed {
    pub(super) face: FaceId,
    pub(super) origin: Origin,
    /// The part that it belongs to, or none.
    pub(super) part: String,
}

/// Bounds on lists: a mesh may fall apart into single faces, and a whole shell may be one defect.
const SHELLS_LISTED: usize = 1000;
const FACES_LISTED: usize = 64;

/// What is drawn of a file beside its report; each only where it was asked for.
#[derive(Default)]
pub(super) struct Drawings {
    pub(super) marks: Option<Marks>,
    pub(super) sketch: Option<Sketch>,
    pub(super) page: Option<Page>,
}

impl Drawings {
    fn any(&self) -> bool {
        self.marks.is_some() || self.sketch.is_some() || self.page.is_some()
    }
}

/// Reads a file and reports on it, one mesh at a time.
pub(super) fn examine(file: &Path, args: &Args, drawings: &mut Drawings) -> Result<FileReport, Failure> {
    let requirements = args.requirements();
    let whole = load::read_whole(file)?;
    let (whole, frames) = match args.all_frames {
        true => Frames::check(&whole, args, file, &requirements).map(|(first, all)| (first, Some(all)))?,
        false => (args.pose.apply(whole, file)?, None),
    };
    let scene = args.mesh.chosen(whole, file)?;
    let (format, rounding) = (scene.format, scene.judged_rounding(!args.mesh.is_below_scene()));
    let spaces = args.mesh.own_spaces(scene, file)?;
    let _progress = Progress::spinner(format!("checking {}", file.display()));
    let mut meshes = Vec::with_capacity(spaces.len());
    for OwnSpace { mesh, world_from_mesh } in spaces {
        let WeldedMesh { mesh, vertices, unreferenced } = args.mesh.weld(mesh);
        let topology = Topology::of(&mesh);
        let mut report = CrackReport::of(&mesh, &topology);
        for (complete, note) in [
            (report.nesting_complete, "the nesting of shells was not decided: too many overlap"),
            (
                report.t_junctions_complete,
                "the search for T-junctions was not finished: too many edges overlap",
            ),
        ] {
            if !complete {
                output::say(format_args!("note: {}: {note}", file.display()));
            }
        }
        if args.searches_self_intersections() {
            let keep = if drawings.any() { mark::PAIRS_MARKED } else { args.limit.min(mark::PAIRS_MARKED) };
            report.add_self_intersections(&mesh, &topology, keep);
            if let Some(found) = report.self_intersections.as_ref().filter(|found| !found.complete) {
                let (file, pairs) = (file.display(), found.pairs);
                let least = if pairs == 0 { "none".to_owned() } else { format!("at least {pairs}") };
                output::say(format_args!(
                    "note: {file}: the search for self-intersections was not finished: {least} found so far"
                ));
            }
        }
        // Positions, lengths and volumes are reported in world space.
        let placed = (world_from_mesh != Mat4::IDENTITY).then(|| OwnSpace::placed(&mesh, &world_from_mesh));
        let placed = placed.transpose().map_err(|error| load::too_far(&error, file))?;
        if let Some(placed) = &placed {
            tell_in_world(&mut report, placed, &topology, OwnSpace::volume_factor(&world_from_mesh));
        }
        let mesh = placed.as_ref().unwrap_or(&mesh);
        if let Some(marks) = &mut drawings.marks {
            marks.add(&report, mesh, &topology).map_err(|failure| failure.in_file(file))?;
        }
        if let Some(sketch) = &mut drawings.sketch {
            sketch.add(&report, mesh, &topology);
        }
        if let Some(page) = &mut drawings.page {
            page.add(&report, mesh, &topology);
        }
        let vertices = [vertices, unreferenced];
        meshes.push(MeshReport::of(report, mesh, &topology, vertices, &requirements, args.limit));
    }
    let total = |of: fn(&Counts) -> usize| meshes.iter().map(|mesh| of(&mesh.counts)).sum();
    load::note_none_left(file, total(|counts| counts.faces), total(|counts| counts.collapsed_faces));
    let joinable = args.mesh.is_below_scene() && meshes.len() > 1;
    Ok(FileReport { file: file.to_owned(), format, meshes, requirements, joinable, rounding, frames })
}

/// The report on meshes that are in memory, without places of defects.
pub(in crate::cli) fn report_on(
    file: &Path,
    format: Option<Format>,
    meshes: &[WeldedMesh],
    requirements: &[Requirement],
) -> FileReport {
    let of = |welded: &WeldedMesh| {
        let mesh = &welded.mesh;
        let topology = Topology::of(mesh);
        let mut report = CrackReport::of(mesh, &topology);
        if requirements.contains(&Requirement::NoSelfIntersections) {
            report.add_self_intersections(mesh, &topology, 0);
        }
        MeshReport::of(report, mesh, &topology, [welded.vertices, welded.unreferenced], requirements, 0)
    };
    FileReport {
        file: file.to_owned(),
        format,
        meshes: meshes.iter().map(of).collect(),
        requirements: requirements.to_vec(),
        joinable: false,
        rounding: None,
        frames: None,
    }
}

/// Volumes and boxes in the world of a report on a mesh in its own space; `mesh` is the placed one.
fn tell_in_world(report: &mut CrackReport, mesh: &Mesh, topology: &Topology, factor: f64) {
    report.counts.signed_volume *= factor;
    for shell in &mut report.shell_list {
        shell.signed_volume *= factor;
        shell.bounds = Aabb::EMPTY;
    }
    for (face, shell) in topology.faces().zip(topology.shells().of_face) {
        if let Some(shell) = shell {
            let bounds = &mut report.shell_list[shell as usize].bounds;
            *bounds = bounds.join(&Aabb::around(mesh.corners(face)));
        }
    }
}

/// Every kind of defect that there is one of.
fn defects(report: &CrackReport, mesh: &Mesh, topology: &Topology, limit: usize) -> Vec<Found> {
    let found = |kind| match report.count(kind) {
        None | Some(0) => None,
        Some(count) => {
            let items = report.items(kind, mesh, topology, limit);
            let complete = report.counts.is_complete(kind);
            Some(Found {
                kind,
                count,
                complete,
                at: items.into_iter().map(|item| Place::of(item, mesh)).collect(),
            })
        }
    };
    DefectKind::ALL.into_iter().filter_map(found).collect()
}

impl MeshReport {
    /// `vertices`: of the mesh before its weld; `unreferenced_vertices`: those among them that no face uses.
    fn of(
        report: CrackReport,
        mesh: &Mesh,
        topology: &Topology,
        [vertices, unreferenced_vertices]: [usize; 2],
        requirements: &[Requirement],
        limit: usize,
    ) -> Self {
        let defects = defects(&report, mesh, topology, limit);
        let CrackReport { counts, mut shell_list, near_miss, nesting_complete, t_junctions_complete, .. } =
            report;
        shell_list.truncate(SHELLS_LISTED);
        Self {
            name: mesh.name.clone(),
            vertices,
            welded_vertices: mesh.vertex_count(),
            unreferenced_vertices,
            shell_origins: shell_list.iter().map(|shell| mesh.origin(shell.first_face)).collect(),
            counts,
            shell_list,
            near_miss,
            defects,
            nesting_complete,
            t_junctions_complete,
            verdict: verdict(requirements, &counts),
        }
    }

    pub(super) fn sound(&self) -> bool {
        self.verdict == Verdict::Sound
    }
}

impl Place {
    pub(super) fn of(defect: Defect, mesh: &Mesh) -> Self {
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
    /// The worst of any mesh and pose; a file without a mesh is empty.
    pub(in crate::cli) fn verdict(&self) -> Verdict {
        let empty = self.requirements.contains(&Requirement::NotEmpty);
        let nothing = if empty { Verdict::Empty } else { Verdict::Sound };
        let of_meshes = self.meshes.iter().map(|mesh| mesh.verdict).max().unwrap_or(nothing);
        self.frames.as_ref().map_or(of_meshes, |frames| of_meshes.max(frames.verdict()))
    }

    /// `None` if there is no mesh.
    pub(in crate::cli) fn total(&self) -> Option<Counts> {
        Counts::total(self.meshes.iter().map(|mesh| mesh.counts))
    }

    /// The worst standing of any mesh.
    pub(in crate::cli) fn standing(&self, asked: Requirement) -> Standing {
        let none = if asked == Requirement::NotEmpty { Standing::Fails } else { Standing::Holds };
        self.meshes.iter().map(|mesh| asked.standing(&mesh.counts)).max().unwrap_or(none)
    }

    pub(super) fn sum(&self, of: impl Fn(&MeshReport) -> usize) -> usize {
        self.meshes.iter().map(of).sum()
    }
}
