//! `umbrage check --html`: the report of a file as a page with a view of the mesh.
//!
//! The list of defects, the counts and six pictures are in the HTML; the script adds the view, which is drawn
//! from data in the same page.

mod coarse;
mod document;
mod geometry;
mod thinned;

use umbrage::check::{CrackReport, Defect, DefectKind, Severity};
use umbrage::mesh::Mesh;
use umbrage::topology::Topology;
use umbrage::view::Up;

use super::drawn::Drawn;
use super::picture::Sketch;
use super::report::{FileReport, Place};
use crate::cli::Failure;
use thinned::Thinned;

/// Bounds on what a page holds, which a browser has to keep up with: rows, lines and dots of each kind of
/// defect, and triangles.
const ROWS: usize = 500;
const LINES: usize = 20_000;
const SPOTS: usize = 20_000;
const TRIANGLES: usize = 200_000;

/// Faces of a defect whose direction and size are looked at: a whole shell may be one defect.
const FACES_SEEN: usize = 1000;

/// What the page of a file is made of, added mesh by mesh.
#[derive(Default)]
pub(super) struct Page {
    /// The meshes, and the pictures for browsers without WebGL.
    sketch: Sketch,
    faces: usize,
    meshes: usize,
    /// In the order of [`DefectKind::ALL`].
    kinds: [OfKind; DefectKind::ALL.len()],
}

/// The defects of one kind.
#[derive(Default)]
struct OfKind {
    count: usize,
    /// Whether no search for them stopped at a limit.
    complete: bool,
    /// At most [`LINES`] and [`SPOTS`], and how many there are.
    lines: Thinned<[[f32; 3]; 2]>,
    line_count: usize,
    spots: Thinned<[f32; 3]>,
    spot_count: usize,
    /// Indices of colored faces among those of all meshes.
    faces: Vec<u32>,
    /// At most [`ROWS`].
    rows: Vec<Row>,
}

/// A defect in the list.
struct Row {
    mesh: usize,
    place: Place,
    /// Where the view looks to, and how far around it there is something of the defect; in world space.
    target: [f64; 3],
    reach: f64,
    /// The mean direction of its faces, not normalized.
    normal: [f64; 3],
    /// Its lines among those of its kind, as far as they are drawn: the first, and how many.
    lines: [usize; 2],
}

impl Page {
    /// Adds a mesh and all its defects.
    pub(super) fn add(&mut self, report: &CrackReport, mesh: &Mesh, topology: &Topology) {
        self.sketch.add(report, mesh, topology);
        for (kind, of_kind) in DefectKind::ALL.into_iter().zip(&mut self.kinds) {
            let count = report.count(kind).unwrap_or(0);
            if count == 0 {
                continue;
            }
            of_kind.complete = (of_kind.count == 0 || of_kind.complete) && report.counts.is_complete(kind);
            of_kind.count += count;
            for defect in report.items(kind, mesh, topology, usize::MAX) {
                of_kind.add(kind, defect, mesh, [self.meshes, self.faces]);
            }
        }
        self.faces += mesh.face_count();
        self.meshes += 1;
    }

    /// The page as HTML. `report` is that of the file whose meshes were added.
    pub(super) fn write(self, report: &FileReport, up: Up) -> Result<String, Failure> {
        document::write(self, report, up)
    }

    /// The kinds that there are defects of, worst effect first.
    fn found(&self) -> Vec<(DefectKind, &OfKind)> {
        let mut found: Vec<(DefectKind, &OfKind)> =
            DefectKind::ALL.into_iter().zip(&self.kinds).filter(|(_, of_kind)| of_kind.count > 0).collect();
        found.sort_by_key(|(kind, _)| std::cmp::Reverse(kind.severity()));
        found
    }
}

impl OfKind {
    /// `mesh_index` and `first_face`: of the mesh among all.
    fn add(&mut self, kind: DefectKind, defect: Defect, mesh: &Mesh, [mesh_index, first_face]: [usize; 2]) {
        let drawn = Drawn::of(kind, &defect, mesh);
        self.line_count += drawn.lines.len();
        self.spot_count += usize::from(drawn.spot);
        let spot = drawn.spot.then_some(defect.position);
        if drawn.faces {
            // Below the number of all faces, which a joined mesh keeps below 2³².
            self.faces.extend(defect.faces.iter().map(|face| (face.index() + first_face) as u32));
        }
        if self.rows.len() == ROWS {
            self.spots.spread(spot, SPOTS);
            self.lines.spread(drawn.lines, LINES);
            return;
        }
        self.spots.fix(spot, SPOTS);
        let lines = self.lines.fix(drawn.lines.iter().copied(), LINES);
        let (target, reach) = around(kind, &defect, &drawn, mesh);
        self.rows.push(Row {
            mesh: mesh_index,
            target,
            reach,
            normal: mean_normal(&defect, mesh),
            lines,
            place: Place::of(defect, mesh),
        });
    }
}

/// The middle of what is drawn of a defect, and the distance to its farthest point.
pub(crate) fn around(kind: DefectKind, defect: &Defect, drawn: &Drawn, mesh: &Mesh) -> ([f64; 3], f64) {
    let corners = || defect.faces.iter().take(FACES_SEEN).flat_map(|&face| mesh.corners(face));
    let points: Vec<[f64; 3]> = match drawn.lines.is_empty() {
        true => corners().map(|point| point.map(f64::from)).collect(),
        false => drawn.lines.iter().flatten().map(|point| point.map(f64::from)).collect(),
    };
    let position = defect.position.map(f64::from);
    let is_point = matches!(kind, DefectKind::NonManifoldVertex | DefectKind::TJunction);
    let target = if is_point || points.is_empty() {
        position
    } else {
        [0, 1, 2].map(|axis| {
            let of = points.iter().map(|point| point[axis]);
            let (low, high) =
                of.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)));
            0.5 * (low + high)
        })
    };
    let distance = |point: &[f64; 3]| {
        [0, 1, 2].map(|axis| point[axis] - target[axis]).iter().map(|x| x * x).sum::<f64>()
    };
    (target, points.iter().map(distance).fold(0.0, f64::max).sqrt())
}

/// The sum of the unit normals of the faces; zero where they cancel.
pub(crate) fn mean_normal(defect: &Defect, mesh: &Mesh) -> [f64; 3] {
    let mut sum = [0.0; 3];
    for &face in defect.faces.iter().take(FACES_SEEN) {
        let [a, b, c] = mesh.corners(face).map(|corner| corner.map(f64::from));
        let [u, v] = [b, c].map(|end| [0, 1, 2].map(|axis| end[axis] - a[axis]));
        let cross = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
        let length = cross.iter().map(|x| x * x).sum::<f64>().sqrt();
        if length > 0.0 && length.is_finite() {
            for axis in 0..3 {
                sum[axis] += cross[axis] / length;
            }
        }
    }
    sum
}

/// The word for how much a kind of defect matters.
fn severity(kind: DefectKind) -> &'static str {
    match kind.severity() {
        Severity::Error => "error",
        Severity::Warning => "warning",
        Severity::Information => "information",
    }
}
