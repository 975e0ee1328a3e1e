//! Proofs that half of a shell's faces cast the same shadow, for any light.

use std::ops::ControlFlow;

use crate::built::{self, Part};
use crate::check::{CrackReport, for_each_intersection_among, is_star};
use crate::geom::predicate::Sign;
use crate::mesh::{FaceId, Mesh};
use crate::topology::{Shells, Topology};

/// Proof about a shell that holds for any light, or the reason that there is none.
///
/// ```
/// use umbrage::caster::{Caster, ShellProof};
/// use umbrage::testing::shapes;
/// assert_eq!(Caster::new(shapes::cube()).proofs(), [ShellProof::Outward]);
/// assert_eq!(Caster::new(shapes::open_cube()).proofs(), [ShellProof::NotWatertight]);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum ShellProof {
    /// Winding numbers are 0 and +1: the shell is watertight, does not intersect itself, and its volume is
    /// positive.
    Outward,
    /// Winding numbers are 0 and −1: as `Outward`, with a negative volume.
    Inward,
    /// An edge does not have exactly two faces in opposite directions.
    NotWatertight,
    /// A face has zero area.
    ZeroAreaFace,
    /// Two faces intersect where they should not.
    MeetsItself,
    /// Undecided: the search for self-intersections gave up, because too many faces overlap in one region.
    Unsettled,
    /// The signed volume is zero.
    NoVolume,
}

impl ShellProof {
    /// Proofs of all shells, one per shell, in shell order. Cost: a search for self-intersections, some
    /// microseconds per face, unless no shell gets that far. If nearly all faces of the shells overlap in one
    /// region, the search gives up after some seconds for all shells together: [`ShellProof::Unsettled`].
    ///
    /// Memory: at its peak 129 bytes per face, or the peak of [`CrackReport::of`] if that is higher.
    #[must_use]
    pub fn of(mesh: &Mesh, topology: &Topology, shells: &Shells) -> Vec<Self> {
        Self::within(mesh, topology, shells, &CrackReport::of(mesh, topology), MOST_TESTS)
    }

    /// As [`ShellProof::of`], with an existing crack report of the mesh.
    pub(crate) fn with_report(
        mesh: &Mesh,
        topology: &Topology,
        shells: &Shells,
        report: &CrackReport,
    ) -> Vec<Self> {
        Self::within(mesh, topology, shells, report, MOST_TESTS)
    }

    /// As [`ShellProof::of`], with a budget: `spare` face-pair tests for all shells together, in addition to
    /// the 256 tests per face that each shell has.
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
        // Each shell is searched separately: two shells may intersect each other, because each keeps its own
        // winding number.
        for faces in shells.faces_by_shell().iter() {
            let Some(shell) = faces.first().and_then(|&face| of_face(face)) else { continue };
            if proofs[shell].is_sound() && !is_star(mesh, faces) {
                let own = 256 * faces.len() as u64;
                let mut tests = spare + own;
                let (mut meets, stop) = (false, ControlFlow::Break(()));
                let end = for_each_intersection_among(mesh, faces, &mut tests, |_| {
                    meets = true;
                    stop
                });
                spare = spare.min(tests); // a shell's own tests are used up first
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

/// Face-pair tests in all shells together, in addition to 256 per face, after which proofs are given up: some
/// seconds.
const MOST_TESTS: u64 = 1 << 24;
