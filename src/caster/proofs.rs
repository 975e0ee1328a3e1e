//! Which shells are proven to cast the same shadow with half their faces, whatever the light.

use std::ops::ControlFlow;

use crate::built::{self, Part};
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
        Self::within(mesh, topology, shells, &CrackReport::of(mesh, topology), MOST_TESTS)
    }

    /// The same with the crack report of the mesh, which is there already.
    pub(crate) fn with_report(
        mesh: &Mesh,
        topology: &Topology,
        shells: &Shells,
        report: &CrackReport,
    ) -> Vec<Self> {
        Self::within(mesh, topology, shells, report, MOST_TESTS)
    }

    /// The same with `spare` tests for all shells together, beside those that go with the faces.
    pub(crate) fn within(
        mesh: &Mesh,
        topology: &Topology,
        shells: &Shells,
        report: &CrackReport,
        mut spare: u64,
    ) -> Vec<Self> {
        built::note(Part::Proofs, mesh);
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
        for faces in shells.faces_by_shell().iter() {
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
