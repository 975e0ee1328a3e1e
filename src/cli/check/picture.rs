//! The crack report as a picture.

use std::path::Path;

use umbrage::check::{CrackReport, DefectKind};
use umbrage::geom::bvh::Bvh;
use umbrage::geom::{Aabb, Segment};
use umbrage::mesh::{FaceId, Mesh};
use umbrage::oracle::Oracle;
use umbrage::render::{Line, Marker, Overlay};
use umbrage::topology::Topology;
use umbrage::view::{Camera, Size, Up};

use crate::cli::error::Failure;
use crate::cli::output;
use crate::cli::progress::Progress;

const WIDTH: u32 = 960;
const HEIGHT: u32 = 540;

/// The most lines, and the most markers, that are drawn: a million would hide the mesh, and take minutes.
const MOST_DRAWN: usize = 100_000;
/// The most faces that a ray may meet on the average up to the first one that it sees, so that a picture
/// takes seconds: where many lie in one plane, it meets them all.
const MOST_DEEP: usize = 64;
/// Rays along each side of the picture that are counted.
const SAMPLES: usize = 12;

/// Meshes and what is to be drawn over them.
#[derive(Default)]
pub(super) struct Sketch {
    meshes: Vec<Mesh>,
    faces: usize,
    overlay: Overlay,
    /// The number of lines, and of markers, that there are.
    lines: usize,
    spots: usize,
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
        (self.lines, self.spots) = (self.overlay.lines.len(), self.overlay.spots.len());
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
        for (what, drawn, all) in [
            ("lines", cut(&mut self.overlay.lines), self.lines),
            ("markers", cut(&mut self.overlay.spots), self.spots),
        ] {
            if drawn < all {
                output::say(format_args!("note: the picture shows {drawn} of {all} {what}"));
            }
        }
        let mut oracle = Oracle::build(&mesh);
        let step = thinning(&mesh, &oracle, up, size);
        if step > 1 {
            output::say(format_args!(
                "note: the faces lie too deep over each other to draw them all: the picture shows one of {step}"
            ));
            self.overlay.faces.retain(|(face, _)| face.index() % step == 0);
            self.overlay.faces.iter_mut().for_each(|(face, _)| *face = FaceId::new(face.index() / step));
            let triangles = mesh.triangles().iter().copied().step_by(step).collect();
            let fewer = Mesh::new(mesh.positions().to_vec(), triangles)
                .map_err(|error| Failure::new(error, "leave out --picture"))?;
            oracle = Oracle::build(&fewer);
        }
        let progress = Progress::bar("drawing", 2 * u64::from(HEIGHT));
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

/// Cuts a list to what is drawn of it; how much that is.
fn cut<T>(list: &mut Vec<T>) -> usize {
    list.truncate(MOST_DRAWN);
    list.len()
}

/// One of how many faces can be drawn, so that a ray meets at most [`MOST_DEEP`] of them on the average.
fn thinning(mesh: &Mesh, oracle: &Oracle, up: Up, size: Size) -> usize {
    if mesh.face_count() <= MOST_DEEP {
        return 1;
    }
    let boxes: Vec<Aabb> = mesh
        .triangles()
        .iter()
        .map(|corners| Aabb::around(corners.map(|corner| mesh.positions()[corner as usize])))
        .collect();
    let bvh = Bvh::build(&boxes);
    drop(boxes);
    let rays = Camera::fit(&bvh.bounds(), up, size.aspect()).rays(size);
    let mut met = 0;
    for i in 0..SAMPLES * SAMPLES {
        let at = |i: usize, pixels: u32| (i as f64 + 0.5) / SAMPLES as f64 * f64::from(pixels);
        let ray = rays.ray(at(i % SAMPLES, size.width()), at(i / SAMPLES, size.height()));
        let Some(hit) = oracle.first_hit(ray.origin, ray.direction) else { continue };
        // A little farther than the hit, so that rounding leaves nothing out that lies in one plane with it.
        let far = 1.001 * hit.t;
        let end = [0, 1, 2].map(|i| (f64::from(ray.origin[i]) + far * f64::from(ray.direction[i])) as f32);
        bvh.for_each_along(&Segment::between(ray.origin, end), |_| met += 1);
    }
    (met / (SAMPLES * SAMPLES)).div_ceil(MOST_DEEP).max(1)
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

#[cfg(test)]
mod tests {
    use super::*;
    use umbrage::testing::shapes;

    fn step(mesh: &Mesh) -> usize {
        let size = Size::new(WIDTH, HEIGHT).unwrap();
        thinning(mesh, &Oracle::build(mesh), Up::Y, size)
    }

    #[test]
    fn pictures_of_many_faces_in_one_plane_are_thinned_and_those_of_faces_behind_others_are_not() {
        let sheet = |z: f32| {
            let corners = vec![[-4.0, -4.0, z], [4.0, -4.0, z], [4.0, 4.0, z], [-4.0, 4.0, z]];
            Mesh::new(corners, vec![[0, 1, 2], [0, 2, 3]]).unwrap()
        };
        let stack = |gap: f32| {
            let sheets: Vec<Mesh> = (0..1000).map(|i| sheet(gap * i as f32)).collect();
            Mesh::concat(&sheets).unwrap()
        };
        // Most rays of a picture meet the sheets.
        assert!(step(&stack(0.0)) > 8, "{}", step(&stack(0.0)));
        assert_eq!(step(&stack(0.05)), 1);
        assert_eq!(step(&shapes::icosphere(4)), 1);
    }
}
