//! How far a light may travel before faces may be on another side of it.

use crate::facing::FacePlanes;
use crate::facing::planes::LocalLight;
use crate::geom::Facing;
use crate::mesh::{FaceId, Mesh};

/// Faces that share a certificate.
const RUN: usize = 32;
/// Runs whose earliest certificate is looked up together.
const GROUP: usize = 16;

/// The sides of faces at some light, and for runs of 32 of them how far it may travel until one may change.
#[derive(Clone, Debug)]
pub(super) struct Certificates {
    /// Faces in the order in which they share certificates; in that order their planes and sides.
    faces: Vec<FaceId>,
    planes: Vec<Planes>,
    facing: Vec<Facing>,
    /// Where the odometer will stand when the certificate of a run has run out; of a group the earliest.
    pub(super) run_ends: Vec<f64>,
    pub(super) group_ends: Vec<f64>,
    odometer: f64,
}

/// Normals, offsets and errors of a run of faces. They lie together, since a step reads few runs.
#[derive(Clone, Debug)]
#[repr(align(64))]
struct Planes([[f32; RUN]; 5]);

impl Certificates {
    /// Of faces in the order in which they will share certificates. All have run out.
    pub(super) fn new(planes: &FacePlanes, faces: Vec<FaceId>) -> Self {
        let runs = faces.len().div_ceil(RUN);
        Self {
            planes: faces.chunks(RUN).map(|faces| Planes::of(planes, faces)).collect(),
            facing: vec![Facing::EdgeOn; faces.len()],
            faces,
            run_ends: vec![0.0; runs],
            group_ends: vec![0.0; runs.div_ceil(GROUP)],
            odometer: 0.0,
        }
    }

    /// How many runs there are.
    pub(super) fn runs(&self) -> usize {
        self.run_ends.len()
    }

    /// The light travels.
    pub(super) fn advance(&mut self, length: f64) {
        // Rounded up, so that the odometer never shows less than the way since any earlier reading.
        self.odometer = (self.odometer + length).next_up();
    }

    /// The runs whose certificates have run out, ascending, unless they are more than `most`.
    pub(super) fn expired(&self, most: usize) -> Option<Vec<usize>> {
        let mut expired = Vec::new();
        for (group, end) in self.group_ends.iter().enumerate() {
            if *end <= self.odometer {
                let first = group * GROUP;
                let runs = &self.run_ends[first..self.run_ends.len().min(first + GROUP)];
                expired.extend(
                    (first..).zip(runs).filter(|(_, end)| **end <= self.odometer).map(|(run, _)| run),
                );
                if expired.len() > most {
                    return None;
                }
            }
        }
        Some(expired)
    }

    /// Looks at runs again, ascending, and certifies them anew; calls `turned` with the slot of each face whose side has
    /// changed, its side before and its side now.
    pub(super) fn look_again(
        &mut self,
        runs: &[usize],
        mesh: &Mesh,
        planes: &FacePlanes,
        light: &LocalLight,
        mut turned: impl FnMut(usize, Facing, Facing),
    ) {
        for &run in runs {
            let mut sides = [Facing::EdgeOn; RUN];
            self.run_ends[run] = self.certify(run, &mut sides, mesh, planes, light);
            let slots = run * RUN..self.faces.len().min((run + 1) * RUN);
            let pairs = self.facing[slots.clone()].iter().zip(&sides);
            if pairs.fold(0, |turned, (before, side)| turned | (before.sign() ^ side.sign())) == 0 {
                continue; // as nearly always
            }
            for (slot, side) in slots.zip(sides) {
                let before = std::mem::replace(&mut self.facing[slot], side);
                if before != side {
                    turned(slot, before, side);
                }
            }
        }
        let mut last = usize::MAX;
        for group in runs.iter().map(|run| run / GROUP) {
            if group != last {
                self.renew_group(group);
                last = group;
            }
        }
    }

    /// Finds all sides and makes all certificates anew.
    pub(super) fn renew(&mut self, mesh: &Mesh, planes: &FacePlanes, light: &LocalLight) {
        self.odometer = 0.0;
        for run in 0..self.run_ends.len() {
            let mut sides = [Facing::EdgeOn; RUN];
            self.run_ends[run] = self.certify(run, &mut sides, mesh, planes, light);
            let facing = &mut self.facing[run * RUN..];
            let count = facing.len().min(RUN);
            facing[..count].copy_from_slice(&sides[..count]);
        }
        for group in 0..self.group_ends.len() {
            self.renew_group(group);
        }
    }

    /// The sides of a run of faces, and where the odometer stands when their certificate has run out.
    ///
    /// With `s` and `E` of [`FacePlanes`], `|s| − E` is at most the height of the light over the face's plane (for a
    /// directional light: of the tip of its direction), which the way of the light bounds the change of. The difference
    /// and its sum with the odometer are rounded down. A face that only the predicate can decide has no certificate.
    #[inline]
    fn certify(
        &self,
        run: usize,
        sides: &mut [Facing; RUN],
        mesh: &Mesh,
        planes: &FacePlanes,
        light: &LocalLight,
    ) -> f64 {
        let Planes([x, y, z, d, e]) = &self.planes[run];
        let mut heights = [0.0; RUN];
        let slack = light.heights([x, y, z, d, e], &mut heights);
        for (side, height) in sides.iter_mut().zip(heights) {
            *side = if height > 0.0 {
                Facing::Front
            } else if height < 0.0 {
                Facing::Back
            } else {
                Facing::EdgeOn
            };
        }
        if slack > 0.0 {
            return (self.odometer + f64::from(slack.next_down())).next_down();
        }
        for (face, side) in self.faces[run * RUN..].iter().zip(sides) {
            if *side == Facing::EdgeOn {
                *side = planes.side(mesh, face.index(), light).0;
            }
        }
        f64::NEG_INFINITY
    }

    fn renew_group(&mut self, group: usize) {
        let first = group * GROUP;
        let runs = &self.run_ends[first..self.run_ends.len().min(first + GROUP)];
        self.group_ends[group] =
            runs.iter().fold(f64::INFINITY, |least, &end| if end < least { end } else { least });
    }
}

impl Planes {
    /// Of fewer faces than a run has, the first one fills what is left.
    fn of(planes: &FacePlanes, faces: &[FaceId]) -> Self {
        let mut all = [[0.0; RUN]; 5];
        for place in 0..RUN {
            let face = faces.get(place).unwrap_or(&faces[0]).index();
            let [x, y, z] = &planes.normal;
            let plane = [x[face], y[face], z[face], planes.offset[face], planes.error[face]];
            for (row, number) in all.iter_mut().zip(plane) {
                row[place] = number;
            }
        }
        Self(all)
    }
}
