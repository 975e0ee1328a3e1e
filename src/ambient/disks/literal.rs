//! The disks as a tutorial of 2006 prints them (Gomila, *L'ambient occlusion*), for comparison: each receiver
//! sums over all vertices.
//!
//! The area of a disk is the mean of those of the faces around its vertex, and cancels in the form factor
//! A·cosE·cosR / (πr²·A): the result changes with the unit of length, and with how finely a surface is
//! divided. A disk is dropped if its distance is more than 100 times its area, a length against an area. The
//! sum x becomes exp(−x), which leaves 0.37 in a closed room. A receiver's own disk is left out: 0/0.

use std::f64::consts::PI;

use super::super::{Per, Receiver, Receivers};
use super::{Disk, face_areas, wide};
use crate::mesh::Mesh;

/// How literally.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum LiteralForm {
    /// As printed.
    AsPrinted,
    /// With the area that cancels put back: A·cosE·cosR / πr².
    AreaRestored,
}

/// The disks of the tutorial.
#[derive(Clone, Debug)]
pub struct Literal {
    pub(super) disks: Vec<Disk>,
    form: LiteralForm,
}

/// Receivers per run.
const RUN: usize = 4;

impl Literal {
    /// Makes the disks.
    ///
    /// # Panics
    ///
    /// As [`Receivers::of`].
    #[must_use]
    pub fn of(meshes: &[&Mesh], form: LiteralForm) -> Self {
        let receivers = Receivers::of(meshes, Per::Vertex);
        let mut sums = vec![(0.0, 0.0); receivers.list().len()];
        for (corners, area) in receivers.corners().iter().zip(face_areas(meshes)) {
            for &corner in corners {
                let (sum, faces) = &mut sums[corner as usize];
                (*sum, *faces) = (*sum + area, *faces + 1.0);
            }
        }
        let disk = |(receiver, (sum, faces)): (&Receiver, (f64, f64))| {
            let normal = wide(receiver.normal?);
            Some(Disk { center: wide(receiver.point), normal, area: sum / faces })
        };
        Self { disks: receivers.list().iter().zip(sums).filter_map(disk).collect(), form }
    }

    /// The first pass: exp(−x), x the sum over all disks. Receivers without a normal are open.
    #[must_use]
    pub fn openness(&self, receivers: &[Receiver]) -> Vec<f32> {
        let mut found = vec![1.0; receivers.len()];
        crate::parallel::rows(&mut found, RUN, |run, found| {
            for (receiver, found) in receivers[run * RUN..].iter().zip(found) {
                if let Some(normal) = receiver.normal {
                    let sum: f64 =
                        self.disks.iter().map(|disk| self.factor(disk, receiver.point, normal)).sum();
                    *found = (-sum).exp() as f32;
                }
            }
        });
        found
    }

    fn factor(&self, disk: &Disk, point: [f32; 3], normal: [f32; 3]) -> f64 {
        let across = disk.center - wide(point);
        let distance = across.length();
        if distance == 0.0 || distance > 100.0 * disk.area {
            return 0.0;
        }
        let towards = across / distance;
        let cosines = (-towards.dot(disk.normal)).max(0.0) * towards.dot(wide(normal)).max(0.0);
        let area = match self.form {
            LiteralForm::AsPrinted => 1.0,
            LiteralForm::AreaRestored => disk.area,
        };
        area * cosines / (PI * distance * distance)
    }
}
