//! Which parts were built of which mesh: for tests that no command builds a part twice.

use crate::mesh::Mesh;

/// What is built of a mesh, once for its positions.
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

/// Notes that a part is built of a mesh.
#[inline]
pub(crate) fn note(part: Part, mesh: &Mesh) {
    note_lists(part, mesh.triangles(), mesh.positions());
}

/// Notes that a part is built of triangles, whatever their positions.
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

    /// What the calling thread builds while `work` runs: each part with a fingerprint of the faces and positions that it
    /// was built of. What other threads build is not seen.
    pub fn record<T>(work: impl FnOnce() -> T) -> (T, Vec<(Part, u64)>) {
        LOG.with_borrow_mut(|log| *log = Some(Vec::new()));
        let result = work();
        (result, LOG.take().unwrap_or_default())
    }

    /// FNV-1a over words (Glenn Fowler, Landon Curt Noll, Phong Vo, 1991).
    fn fingerprint(triangles: &[[u32; 3]], positions: &[[f32; 3]]) -> u64 {
        let positions = positions.as_flattened().iter().map(|x| x.to_bits());
        let words = triangles.as_flattened().iter().copied().chain(positions);
        words.fold(0xcbf2_9ce4_8422_2325, |hash, word| (hash ^ u64::from(word)).wrapping_mul(0x100_0000_01b3))
    }
}
