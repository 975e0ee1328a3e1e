//! Certificates: how far a light may travel before faces may change sides.

use crate::facing::FacePlanes;
use crate::facing::planes::LocalLight;
use crate::geom::Facing;
use crate::mesh::{FaceId, Mesh};

/// Faces that share a certificate.
const RUN: usize = 32;
/// Runs per group: a step compares one number per group.
const GROUP: usize = 16;

/// The sides of all faces for some light, and how far it may travel until a run of 32 faces may change.
#[derive(Clone, Debug)]
pub(super) struct Certificates {
    /// Faces in the order in which they share certificates; in that order their planes and sides.
    faces: Vec<FaceId>,
    planes: Vec<Planes>,
    facing: Vec<Facing>,
    /// The reading of the odometer at which the certificate of a run expires; for a group, the earliest.
    pub(super) run_ends: Vec<f64>,
    pub(super) group_ends: Vec<f64>,
    odometer: f64,
}

/// Normals, offsets and errors of a run of faces. They lie together, since a step reads few runs.
#[derive(Clone, Debug)]
#[repr(align(64))]
struct Planes([[f32; RUN]; 5]);

impl Certificates {
    /// For faces in the order in which they will share certificates. All certificates are expired.
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
        // Rounded up, so that a difference of readings is never less than the distance travelled between
        // them.
        self.odometer = (self.odometer + length).next_up();
    }

    /// The side of the face at a slot, for the last light that was looked at.
    pub(super) fn side(&self, slot: usize) -> Facing {
        self.facing[slot]
    }

    /// Lists the runs whose certificates have expired, ascending; `false` as soon as they are more than
    /// `most`.
    pub(super) fn expired(&self, most: usize, expired: &mut Vec<usize>) -> bool {
        expired.clear();
        for (group, end) in self.group_ends.iter().enumerate() {
            if *end <= self.odometer {
                let first = group * GROUP;
                let runs = &self.run_ends[first..self.run_ends.len().min(first + GROUP)];
                expired.extend(
                    (first..).zip(runs).filter(|(_, end)| **end <= self.odometer).map(|(run, _)| run),
                );
                if expired.len() > most {
                    return false;
                }
            }
        }
        true
    }

    /// Evaluates runs again, ascending, and certifies them. Calls `turned` for each face that has changed
    /// sides, with its slot, the face, its side before and its side now.
    pub(super) fn look_again(
        &mut self,
        runs: &[usize],
        mesh: &Mesh,
        planes: &FacePlanes,
        light: &LocalLight,
        mut turned: impl FnMut(usize, FaceId, Facing, Facing),
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
                    turned(slot, self.faces[slot], before, side);
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

    /// Computes all sides and all certificates again.
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

    /// The sides of a run of faces, and the reading of the odometer at which their certificate expires.
    ///
    /// With `s` and `E` of [`FacePlanes`], `|s| − E` is at most the height of the light over the face's plane
    /// (for a directional light: of the tip of its direction). That height changes by at most the distance
    /// that the light travels. The difference and its sum with the odometer are rounded down. A face that
    /// only the predicate can decide has no certificate.
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
    /// If there are fewer faces than a run has slots, the first face fills the rest.
    fn of(planes: &FacePlanes, faces: &[FaceId]) -> Self {
        let mut all = [[0.0; RUN]; 5];
        for slot in 0..RUN {
            let face = faces.get(slot).unwrap_or(&faces[0]).index();
            let [x, y, z] = &planes.normal;
            let plane = [x[face], y[face], z[face], planes.offset[face], planes.error[face]];
            for (row, number) in all.iter_mut().zip(plane) {
                row[slot] = number;
            }
        }
        Self(all)
    }
}
