//! Log of the parts built per mesh, so that tests can show that no command builds a part twice.

use crate::mesh::Mesh;

/// A structure that is built once per mesh and position set.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
#[cfg_attr(
    not(any(test, feature = "testing")),
    expect(unreachable_pub, reason = "public by `testing`, where that is compiled")
)]
pub enum Part {
    /// [`Topology`](crate::topology::Topology).
    Topology,
    /// [`CrackReport`](crate::check::CrackReport).
    Report,
    /// [`FacePlanes`](crate::facing::FacePlanes).
    Planes,
    /// [`ShellProof`](crate::caster::ShellProof)s.
    Proofs,
    /// [`ShellBoxes`](crate::caster::ShellBoxes).
    ShellBoxes,
    /// [`Oracle`](crate::oracle::Oracle).
    Oracle,
    /// [`GpuCaster`](crate::caster::GpuCaster).
    #[cfg(feature = "gpu")]
    Upload,
}

/// Logs that `part` is built for `mesh`.
#[inline]
pub(crate) fn note(part: Part, mesh: &Mesh) {
    note_lists(part, mesh.triangles(), mesh.positions());
}

/// Logs that the topology of `triangles` is built, whatever their positions.
#[inline]
pub(crate) fn note_topology(triangles: &[[u32; 3]]) {
    note_lists(Part::Topology, triangles, &[]);
}

#[cfg(not(any(test, feature = "testing")))]
#[inline]
fn note_lists(_: Part, _: &[[u32; 3]], _: &[[f32; 3]]) {}

#[cfg(any(test, feature = "testing"))]
use log::note_lists;
#[cfg(any(test, feature = "testing"))]
pub use log::record;

#[cfg(any(test, feature = "testing"))]
mod log {
    use std::cell::RefCell;

    use super::Part;

    thread_local! {
        static LOG: RefCell<Option<Vec<(Part, u64)>>> = const { RefCell::new(None) };
    }

    pub(super) fn note_lists(part: Part, triangles: &[[u32; 3]], positions: &[[f32; 3]]) {
        LOG.with_borrow_mut(|log| {
            if let Some(log) = log {
                log.push((part, fingerprint(triangles, positions)));
            }
        });
    }

    /// The parts that the calling thread builds while `work` runs, each with a fingerprint of its faces and
    /// positions. Parts built on other threads are not recorded.
    pub fn record<T>(work: impl FnOnce() -> T) -> (T, Vec<(Part, u64)>) {
        LOG.with_borrow_mut(|log| *log = Some(Vec::new()));
        let result = work();
        (result, LOG.take().unwrap_or_default())
    }

    /// FNV-1a hash over 32-bit words (Glenn Fowler, Landon Curt Noll, Phong Vo, 1991).
    fn fingerprint(triangles: &[[u32; 3]], positions: &[[f32; 3]]) -> u64 {
        let positions = positions.as_flattened().iter().map(|x| x.to_bits());
        let words = triangles.as_flattened().iter().copied().chain(positions);
        words.fold(0xcbf2_9ce4_8422_2325, |hash, word| (hash ^ u64::from(word)).wrapping_mul(0x100_0000_01b3))
    }
}
