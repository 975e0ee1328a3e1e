//! The crack report as a picture.

use std::path::Path;

use umbrage::check::{CrackReport, DefectKind};
use umbrage::mesh::{FaceId, Mesh};
use umbrage::oracle::Oracle;
use umbrage::render::{Line, Marker, Overlay};
use umbrage::topology::Topology;
use umbrage::view::{Size, Up};

use crate::cli::error::Failure;
use crate::cli::output;
use crate::cli::progress::Progress;

const WIDTH: u32 = 960;
const HEIGHT: u32 = 540;

/// Meshes and what is to be drawn over them.
#[derive(Default)]
pub(super) struct Sketch {
    meshes: Vec<Mesh>,
    faces: usize,
    overlay: Overlay,
    /// Kinds of defects found so far, in the order of [`DefectKind::ALL`].
    kinds: Vec<DefectKind>,
}

impl Sketch {
    /// Adds a mesh and all its defects.
    pub(super) fn add(&mut self, report: &CrackReport, mesh: &Mesh, topology: &Topology) {
        for kind in DefectKind::ALL {
            if report.count(kind).unwrap_or(0) == 0 {
                continue;
            }
            self.kinds.push(kind);
            let (_, color) = color(kind);
            for defect in report.items(kind, mesh, topology, usize::MAX) {
                let line = |ends| Line { ends, color };
                self.overlay.lines.extend(defect.segments.iter().map(|&ends| line(ends)));
                match kind {
                    DefectKind::NonManifoldVertex | DefectKind::TJunction => {
                        self.overlay.spots.push(Marker { at: defect.position, color });
                    }
                    // A face without area is invisible.
                    DefectKind::CollapsedFace | DefectKind::ZeroAreaFace => {
                        for &face in &defect.faces {
                            let [a, b, c] = mesh.corners(face);
                            self.overlay.lines.extend([line([a, b]), line([b, c])]);
                        }
                        self.overlay.spots.push(Marker { at: defect.position, color });
                    }
                    DefectKind::DuplicateFace | DefectKind::InsideOutShell | DefectKind::SelfIntersection => {
                        let faces = defect.faces.iter().map(|face| face.index() + self.faces);
                        self.overlay.faces.extend(faces.map(|face| (FaceId::new(face), color)));
                    }
                    _ => {}
                }
            }
        }
        self.faces += mesh.face_count();
        self.meshes.push(mesh.clone());
    }

    /// Draws everything, writes it, and says what the colors mean.
    pub(super) fn write(mut self, up: Up, path: &Path) -> Result<(), Failure> {
        let mesh = match self.meshes.len() {
            1 => self.meshes.remove(0),
            _ => Mesh::concat(&self.meshes).map_err(|error| Failure::new(error, "leave out --picture"))?,
        };
        self.kinds.sort_by_key(|kind| DefectKind::ALL.iter().position(|other| other == kind));
        self.kinds.dedup();
        self.overlay.legend = self.kinds.iter().map(|&kind| color(kind).1).collect();

        let size = Size::new(WIDTH, HEIGHT).expect("both are in range");
        let progress = Progress::bar("drawing", 2 * u64::from(HEIGHT));
        let oracle = Oracle::build(&mesh);
        let picture = self.overlay.render(&oracle, up, size, &|steps| progress.done(steps));
        drop(progress);
        let picture = picture.map_err(|error| Failure::new(error, "leave out --picture"))?;
        picture.write_png(path)?;

        let legend: Vec<String> =
            self.kinds.iter().map(|&kind| format!("{} {kind}", color(kind).0)).collect();
        let legend = match legend.as_slice() {
            [] => "no defects".to_owned(),
            kinds => format!("{}; dimmed where hidden", kinds.join(", ")),
        };
        output::say(format_args!("wrote {}: {legend}", output::plain(&path.to_string_lossy())));
        Ok(())
    }
}

/// A color's name and its sRGB bytes.
fn color(kind: DefectKind) -> (&'static str, [u8; 3]) {
    match kind {
        DefectKind::BoundaryLoop => ("red", [230, 25, 25]),
        DefectKind::NonManifoldEdge => ("magenta", [225, 20, 225]),
        DefectKind::MisorientedEdge => ("yellow", [245, 215, 20]),
        DefectKind::NonManifoldVertex => ("cyan", [20, 200, 225]),
        DefectKind::CollapsedFace => ("white", [255, 255, 255]),
        DefectKind::ZeroAreaFace => ("orange", [250, 140, 20]),
        DefectKind::DuplicateFace => ("blue", [40, 90, 240]),
        DefectKind::NearMissSeam => ("green", [30, 190, 60]),
        DefectKind::TJunction => ("dark green", [10, 110, 60]),
        DefectKind::InsideOutShell => ("violet", [150, 90, 235]),
        DefectKind::SelfIntersection => ("pink", [250, 120, 150]),
        // The list of kinds may grow.
        _ => ("black", [0, 0, 0]),
    }
}
