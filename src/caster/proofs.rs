//! Which shells are proven to cast the same shadow with half their faces, whatever the light.

use std::ops::ControlFlow;

use crate::check::{CrackReport, for_each_intersection_among};
use crate::geom::predicate::Sign;
use crate::mesh::{FaceId, Mesh};
use crate::topology::{Shells, Topology};

/// What is known of a shell, whatever the light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum ShellProof {
    /// Winding numbers are 0 and +1: watertight, does not meet itself, positive volume.
    Outward,
    /// Winding numbers are 0 and −1: the same with a negative volume.
    Inward,
    /// An edge does not have exactly two faces in opposite directions.
    NotWatertight,
    /// A face has no area.
    ZeroAreaFace,
    /// Two faces meet where they should not.
    MeetsItself,
    /// So many faces reach into one place that whether two of them meet was not found out.
    Unsettled,
    /// The volume is zero.
    NoVolume,
}

impl ShellProof {
    /// Looks at every shell: one proof a shell, in their order. Searches for self-intersections, which costs some
    /// microseconds a face, unless no shell gets that far. Where the faces of shells nearly all reach into one place
    /// the search gives up after some seconds for all shells together: [`ShellProof::Unsettled`].
    ///
    /// Memory: at its peak 129 bytes a face, or what [`CrackReport::of`] takes.
    #[must_use]
    pub fn of(mesh: &Mesh, topology: &Topology, shells: &Shells) -> Vec<Self> {
        Self::within(mesh, topology, shells, MOST_TESTS)
    }

    /// The same with `spare` tests for all shells together, beside those that go with the faces.
    pub(crate) fn within(mesh: &Mesh, topology: &Topology, shells: &Shells, mut spare: u64) -> Vec<Self> {
        let report = CrackReport::of(mesh, topology);
        let mut proofs: Vec<Self> = report
            .shell_list
            .iter()
            .map(|shell| match shell {
                shell if !shell.watertight => Self::NotWatertight,
                shell => match shell.volume_sign {
                    Sign::Positive => Self::Outward,
                    Sign::Negative => Self::Inward,
                    Sign::Zero => Self::NoVolume,
                },
            })
            .collect();
        let of_face = |face: FaceId| shells.of_face[face.index()].map(|shell| shell as usize);
        for face in topology.faces().filter(|&face| !topology.is_collapsed(face)) {
            let Some(shell) = of_face(face) else { continue };
            let [a, b, c] = mesh.corners(face);
            if proofs[shell].is_sound() && crate::geom::predicate::collinear(a, b, c) {
                proofs[shell] = Self::ZeroAreaFace;
            }
        }
        // Shell by shell: two of them may well meet each other, for each keeps its own count.
        for faces in faces_by_shell(shells).iter() {
            let Some(shell) = faces.first().and_then(|&face| of_face(face)) else { continue };
            if proofs[shell].is_sound() {
                let own = 256 * faces.len() as u64;
                let mut tests = spare + own;
                let (mut meets, stop) = (false, ControlFlow::Break(()));
                let end = for_each_intersection_among(mesh, faces, &mut tests, |_| {
                    meets = true;
                    stop
                });
                spare = spare.min(tests); // its own go first
                if end == stop {
                    proofs[shell] = if meets { Self::MeetsItself } else { Self::Unsettled };
                }
            }
        }
        proofs
    }

    pub(crate) fn is_sound(self) -> bool {
        matches!(self, Self::Outward | Self::Inward)
    }
}

/// After so many tests of two faces of one shell, in all shells together, and 256 more a face, proofs are given up:
/// some seconds.
const MOST_TESTS: u64 = 1 << 24;

/// The faces of each shell, ascending: one list, and where it ends for each shell.
struct FacesByShell {
    faces: Vec<FaceId>,
    ends: Vec<usize>,
}

impl FacesByShell {
    fn iter(&self) -> impl Iterator<Item = &[FaceId]> {
        let starts = std::iter::once(0).chain(self.ends.iter().copied());
        starts.zip(&self.ends).map(|(start, &end)| &self.faces[start..end])
    }
}

/// A counting sort.
fn faces_by_shell(shells: &Shells) -> FacesByShell {
    let mut ends = vec![0; shells.count];
    shells.of_face.iter().flatten().for_each(|&shell| ends[shell as usize] += 1);
    let mut sum = 0;
    for end in &mut ends {
        (sum, *end) = (sum + *end, sum);
    }
    let mut faces = vec![FaceId::new(0); sum];
    for (face, shell) in shells.of_face.iter().enumerate() {
        if let Some(shell) = shell {
            let place = &mut ends[*shell as usize];
            faces[*place] = FaceId::new(face);
            *place += 1;
        }
    }
    FacesByShell { faces, ends }
}
