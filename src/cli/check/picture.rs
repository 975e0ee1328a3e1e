//! The crack report as a picture.

use std::path::Path;

use umbrage::check::{CrackReport, DefectKind};
use umbrage::geom::bvh::Bvh;
use umbrage::geom::{Aabb, Segment};
use umbrage::mesh::{FaceId, Mesh};
use umbrage::oracle::Oracle;
use umbrage::render::{Line, Marker, Overlay, Picture};
use umbrage::topology::Topology;
use umbrage::view::{Camera, Size, Up};

use super::drawn::{Drawn, color};
use super::text::noun;
use crate::cli::caption::{self, Key, captioned};
use crate::cli::error::Failure;
use crate::cli::output::{self, counted};
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
    pub(super) meshes: Vec<Mesh>,
    faces: usize,
    overlay: Overlay,
    /// The number of lines, and of markers, that there are.
    lines: usize,
    spots: usize,
    /// Kinds of defects found so far, and their number, mesh by mesh.
    kinds: Vec<(DefectKind, usize)>,
}

impl Sketch {
    /// Adds a mesh and all its defects.
    pub(super) fn add(&mut self, report: &CrackReport, mesh: &Mesh, topology: &Topology) {
        for kind in DefectKind::ALL {
            if report.count(kind).unwrap_or(0) == 0 {
                continue;
            }
            self.kinds.push((kind, report.count(kind).unwrap_or(0)));
            let (_, color) = color(kind);
            for defect in report.items(kind, mesh, topology, usize::MAX) {
                let drawn = Drawn::of(kind, &defect, mesh);
                self.overlay.lines.extend(drawn.lines.into_iter().map(|ends| Line { ends, color }));
                if drawn.spot {
                    self.overlay.spots.push(Marker { at: defect.position, color });
                }
                if drawn.faces {
                    let faces = defect.faces.iter().map(|face| face.index() + self.faces);
                    self.overlay.faces.extend(faces.map(|face| (FaceId::new(face), color)));
                }
            }
        }
        (self.lines, self.spots) = (self.overlay.lines.len(), self.overlay.spots.len());
        self.faces += mesh.face_count();
        self.meshes.push(mesh.clone());
    }

    /// Draws everything, writes it, and says what the colors mean.
    pub(super) fn write(self, title: &str, up: Up, path: &Path) -> Result<(), Failure> {
        let kinds = self.found();
        let keys: Vec<Key> = kinds
            .iter()
            .map(|&kind| {
                let count = self.kinds.iter().filter(|found| found.0 == kind).map(|found| found.1).sum();
                (color(kind).1, counted(count, &noun(kind, 1), &noun(kind, 2)))
            })
            .collect();
        // With its legend it is as large as is said.
        let height = HEIGHT.saturating_sub(caption::height(WIDTH, &[title], &keys)).max(HEIGHT / 2);
        let size = Size::new(WIDTH, height).expect("both are in range");
        let (oracle, overlay) = self.joined(up, size, "--picture")?;
        let progress = Progress::bar("drawing", 2 * u64::from(height));
        let picture = overlay.render(&oracle, up, size, &|steps| progress.done(steps));
        drop(progress);
        let picture = picture.map_err(|error| Failure::new(error, "leave out --picture"))?;
        captioned(picture, &[title], &keys).write_png(path)?;

        let legend: Vec<String> = kinds.iter().map(|&kind| format!("{} {kind}", color(kind).0)).collect();
        let legend = match legend.as_slice() {
            [] => "no defects".to_owned(),
            kinds => format!("{}; dimmed where hidden", kinds.join(", ")),
        };
        output::say(format_args!("wrote {}: {legend}", output::plain(&path.to_string_lossy())));
        Ok(())
    }

    /// Pictures from six sides: towards the eye, each as right, up, back.
    pub(super) fn six_sides(self, up: Up, size: Size, sides: [[f64; 3]; 6]) -> Result<[Picture; 6], Failure> {
        let (oracle, overlay) = self.joined(up, size, "--html")?;
        let progress = Progress::bar("drawing", 6 * 2 * u64::from(size.height()));
        let pictures = sides.map(|side| {
            let camera = Camera::fit_from(side, &oracle.bounds(), up, size.aspect());
            overlay.render_from(camera, &oracle, up, size, &|steps| progress.done(steps))
        });
        match pictures {
            [Ok(a), Ok(b), Ok(c), Ok(d), Ok(e), Ok(f)] => Ok([a, b, c, d, e, f]),
            pictures => {
                let error = pictures.into_iter().find_map(Result::err).expect("one of them failed");
                Err(Failure::new(error, "leave out --html"))
            }
        }
    }

    /// The kinds of defects there are, in the order of [`DefectKind::ALL`].
    fn found(&self) -> Vec<DefectKind> {
        DefectKind::ALL.into_iter().filter(|kind| self.kinds.iter().any(|found| found.0 == *kind)).collect()
    }

    /// The ray cast over all meshes as one, and what is drawn over it, both cut to what can be drawn.
    fn joined(mut self, up: Up, size: Size, option: &str) -> Result<(Oracle, Overlay), Failure> {
        let remedy = format!("leave out {option}");
        self.overlay.order = self.found().into_iter().map(|kind| color(kind).1).collect();
        let mesh = match self.meshes.len() {
            1 => self.meshes.remove(0),
            _ => Mesh::concat(&self.meshes).map_err(|error| Failure::new(error, &remedy))?,
        };
        for (what, drawn, all) in [
            ("lines", cut(&mut self.overlay.lines), self.lines),
            ("markers", cut(&mut self.overlay.spots), self.spots),
        ] {
            if drawn < all {
                output::say(format_args!("note: the picture shows {drawn} of {all} {what}"));
            }
        }
        let oracle = Oracle::build(&mesh);
        let step = thinning(&mesh, &oracle, up, size);
        if step == 1 {
            return Ok((oracle, self.overlay));
        }
        output::say(format_args!(
            "note: the faces lie too deep over each other to draw them all: the picture shows one of {step}"
        ));
        self.overlay.faces.retain(|(face, _)| face.index() % step == 0);
        self.overlay.faces.iter_mut().for_each(|(face, _)| *face = FaceId::new(face.index() / step));
        let triangles = mesh.triangles().iter().copied().step_by(step).collect();
        let fewer =
            Mesh::new(mesh.positions().to_vec(), triangles).map_err(|error| Failure::new(error, &remedy))?;
        Ok((Oracle::build(&fewer), self.overlay))
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
