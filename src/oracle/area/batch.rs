//! Many receivers of one light.

use super::{AreaLight, Receiver, Scratch, SoftOracle, Visible};
use crate::oracle::batch::Curve;

/// Receivers per run; each run has buffers of its own.
const RUN: usize = 64;

impl SoftOracle<'_> {
    /// Writes [`SoftOracle::visible`] of each receiver to `out`, bit by bit the same, on several threads if
    /// the feature `parallel` is on. Receivers are taken along a Morton curve, so that neighbors read the
    /// same faces.
    ///
    /// # Panics
    ///
    /// Panics if `out` and `receivers` differ in length, or if there are 2³² receivers or more.
    pub fn visible_into(&self, receivers: &[Receiver], light: &AreaLight, out: &mut [Option<Visible>]) {
        assert_eq!(receivers.len(), out.len(), "an answer for each receiver");
        assert!(u32::try_from(receivers.len()).is_ok(), "{} receivers; 2^32 are too many", receivers.len());
        let curve =
            Curve::in_box(&crate::geom::Aabb::around(receivers.iter().map(|receiver| receiver.point)));
        let mut order: Vec<(u32, u32)> =
            receivers.iter().zip(0..).map(|(receiver, index)| (curve.place(receiver.point), index)).collect();
        order.sort_unstable();
        let mut found = vec![None; order.len()];
        crate::parallel::rows(&mut found, RUN, |run, found| {
            let mut scratch = Scratch::default();
            for ((_, index), found) in order[run * RUN..].iter().zip(found) {
                *found = self.visible_with(receivers[*index as usize], light, &mut scratch);
            }
        });
        for ((_, index), found) in order.iter().zip(found) {
            out[*index as usize] = found;
        }
    }
}
