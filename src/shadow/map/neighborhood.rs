//! The texels around a lookup, and whether they agree that something lies between a receiver and the light.

use super::receiver::{Receiver, Tap};
use super::space::{LightSpace, Spread, unit_normal, wide};
use crate::oracle::PrimaryHit;

/// A receiver with a square of texels around its lookup.
#[derive(Clone, Copy, Debug)]
pub(super) struct Neighborhood<'a> {
    receiver: Receiver<'a>,
    reach: i64,
}

/// What all texels of a neighborhood say.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Seen {
    /// All lie nearer to the light than the receiver's plane.
    Blocked,
    /// None does.
    Open,
    /// Some do, or some lie outside a map that does not show all casters.
    Mixed,
}

impl<'a> Neighborhood<'a> {
    /// `None` where the map has no position for the point, or rounding leaves the face no normal.
    pub(super) fn of(space: &'a LightSpace, hit: &PrimaryHit, reach: i64) -> Option<Self> {
        let receiver = Receiver::new(space, wide(hit.point), unit_normal(hit.corners)?)?;
        let [a, b] = receiver.slope();
        (a + b).is_finite().then_some(Self { receiver, reach })
    }

    /// Whether the lookup lies outside the map.
    pub(super) fn is_outside(&self) -> bool {
        !self.receiver.space().shows(self.receiver.lookup())
    }

    /// Number of texels.
    pub(super) fn reads(&self) -> u32 {
        let side = 2 * self.reach as u32 + 1; // at most 33
        side * side
    }

    /// Reads all texels; `depth` is `None` outside the map. A texel blocks if its depth is above the
    /// receiver's plane at its center by more than the plane changes over one texel, and rounding.
    pub(super) fn look(&self, mut depth: impl FnMut(&Tap) -> Option<f32>) -> Seen {
        let (mut blocked, mut open, mut outside) = (0, 0, 0);
        // Beside a directional light's map of the scene nothing casts a shadow.
        let shows_all_casters = matches!(self.receiver.space().spread(), Spread::Parallel { .. });
        let lookup = *self.receiver.lookup();
        let [left, top] = [lookup.tx, lookup.ty].map(|t| t.floor() as i64);
        for j in -self.reach..=self.reach {
            for i in -self.reach..=self.reach {
                let tap = self.receiver.tap(left.saturating_add(i), top.saturating_add(j));
                let stored = tap.and_then(|tap| Some((tap, f64::from(depth(&tap)?))));
                match stored {
                    Some((tap, stored)) if stored > self.threshold(&tap) => blocked += 1,
                    Some(_) => open += 1,
                    None if shows_all_casters => open += 1,
                    None => outside += 1,
                }
            }
        }
        match (blocked, open, outside) {
            (_, 0, 0) => Seen::Blocked,
            (0, _, 0) => Seen::Open,
            _ => Seen::Mixed,
        }
    }

    fn threshold(&self, tap: &Tap) -> f64 {
        tap.plane() + tap.slope[0].abs() + tap.slope[1].abs() + self.receiver.rounding(tap.d)
    }
}
