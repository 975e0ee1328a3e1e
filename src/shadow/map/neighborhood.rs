//! The texels around a lookup, and whether they agree that something lies between a receiver and the light.

use super::receiver::{Receiver, Tap};
use super::space::{LightSpace, Spread, unit_normal, wide};
use crate::oracle::PrimaryHit;

/// Which texels around a lookup are read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Around {
    /// The texel of the lookup, and this many more in each direction.
    Reach(i64),
    /// The four texels whose centers are nearest.
    Nearest,
}

impl Around {
    /// Texels along each side of the square.
    fn side(self) -> i64 {
        match self {
            Self::Reach(reach) => 2 * reach + 1, // at most 33
            Self::Nearest => 2,
        }
    }

    /// The first column or row of the square around a position.
    fn first(self, at: f64) -> i64 {
        match self {
            Self::Reach(reach) => (at.floor() as i64).saturating_sub(reach),
            // Centers lie at ½.
            Self::Nearest => (at - 0.5).floor() as i64,
        }
    }
}

/// A receiver with a square of texels around its lookup.
#[derive(Clone, Copy, Debug)]
pub(super) struct Neighborhood<'a> {
    receiver: Receiver<'a>,
    around: Around,
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
    pub(super) fn of(space: &'a LightSpace, hit: &PrimaryHit, around: Around) -> Option<Self> {
        let receiver = Receiver::new(space, wide(hit.point), unit_normal(hit.corners)?)?;
        let [a, b] = receiver.slope();
        (a + b).is_finite().then_some(Self { receiver, around })
    }

    /// Whether the lookup lies outside the map.
    pub(super) fn is_outside(&self) -> bool {
        !self.receiver.space().shows(self.receiver.lookup())
    }

    /// Number of texels.
    pub(super) fn reads(&self) -> u32 {
        self.around.side().pow(2) as u32
    }

    /// Reads all texels; `depth` is `None` outside the map. A texel blocks if its depth is above the
    /// receiver's plane at its center by more than the plane changes over one texel, and rounding.
    pub(super) fn look(&self, mut depth: impl FnMut(&Tap) -> Option<f32>) -> Seen {
        let (mut blocked, mut open, mut outside) = (0, 0, 0);
        // Beside a directional light's map of the scene nothing casts a shadow.
        let shows_all_casters = matches!(self.receiver.space().spread(), Spread::Parallel { .. });
        let lookup = *self.receiver.lookup();
        let [left, top] = [lookup.tx, lookup.ty].map(|at| self.around.first(at));
        for j in 0..self.around.side() {
            for i in 0..self.around.side() {
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
