//! Percentage-closer soft shadows: the technique `pcss`.
//!
//! (Randima Fernando, *Percentage-Closer Soft Shadows*, SIGGRAPH sketches 2005.) The mean depth of the
//! blockers in a search window gives the width of the penumbra, and with it the window of the filter. What
//! errs: blockers at different depths over one receiver are averaged into one.

use super::horizon::AboveHorizon;
use super::light_map::{LightMap, Receiver};
use super::window::Window;
use super::{PcssOptions, Taps};
use crate::caster::CasterGroup;
use crate::random::r2;
use crate::scene::{Lamp, concentric};
use crate::shadow::LampShadow;
use crate::shadow::map::{MapError, shift};
use crate::shadow::{Answer, Claim, Samples, Visibility};

#[derive(Debug)]
struct Pcss<'a> {
    map: LightMap<'a>,
    options: PcssOptions,
}

pub(in crate::shadow) fn pcss<'a>(
    casters: &'a CasterGroup<'a>,
    lamp: &Lamp,
    options: PcssOptions,
) -> Result<Box<dyn LampShadow + 'a>, MapError> {
    let map = LightMap::prepare(casters, lamp, options.size)?;
    Ok(Box::new(AboveHorizon::new(Pcss { map, options }, lamp)))
}

impl LampShadow for Pcss<'_> {
    fn shade(&self, samples: &Samples) -> Visibility {
        let PcssOptions { blockers, taps, .. } = self.options;
        Visibility::of(samples, self.map.lamp.light(), Claim::Approximate, |hit| {
            self.map.answer(hit, |receiver| receiver.filtered(blockers, taps))
        })
    }

    fn bytes(&self) -> usize {
        self.map.bytes()
    }

    fn texel_world(&self) -> Option<f64> {
        Some(self.map.texel_world())
    }

    fn bias_world(&self) -> Option<f64> {
        Some(self.map.bias_world())
    }
}

impl LightMap<'_> {
    /// The answer at a visible point: lit outside the map, and where the receiver is edge-on.
    pub(super) fn answer(
        &self,
        hit: &crate::oracle::PrimaryHit,
        value: impl Fn(&mut Receiver<'_>) -> f64,
    ) -> Answer {
        let Some(mut receiver) = self.receiver(hit) else {
            return Answer { is_outside: true, ..Answer::of(1.0) };
        };
        let value = if receiver.is_sound() { value(&mut receiver) } else { 1.0 };
        Answer { reads: receiver.reads, ..Answer::of(value.clamp(0.0, 1.0) as f32) }
    }
}

impl Receiver<'_> {
    /// The part of the filter's window that is lit.
    pub(super) fn filtered(&mut self, blockers: Taps, taps: Taps) -> f64 {
        match self.penumbra(blockers) {
            None => 1.0,
            Some(half) => {
                let found = self.gather(half, taps);
                // The areas of all texels add up to 1 but for rounding.
                if found.is_whole { 0.0 } else { 1.0 - found.share }
            }
        }
    }

    /// Half-widths of the mean blocker's penumbra, at least half a texel; `None` without blockers.
    pub(super) fn penumbra(&mut self, blockers: Taps) -> Option<[f64; 2]> {
        let half = self.search(self.k);
        let found = self.gather(half, blockers);
        let mean = found.depth / found.share;
        (found.share > 0.0).then(|| self.widths(mean).map(|width| width.max(0.5)))
    }

    /// The blockers in a window around the receiver.
    fn gather(&mut self, half: [f64; 2], taps: Taps) -> Blockers {
        let (mut share, mut depth, mut is_whole) = (0.0, 0.0, true);
        let mut add = |weight: f64, blocker: Option<f64>| match blocker {
            Some(blocker) => {
                share += weight;
                depth += weight * blocker;
            }
            None => is_whole = false,
        };
        match taps {
            Taps::All => {
                let window = Window { at: self.at, half, is_round: self.is_round };
                let (area, limits) = (window.area(), self.limits());
                window.for_each_texel(limits, |i, j, part| add(part / area, self.blocker(i, j)));
                if window.is_beyond(limits) {
                    add(0.0, None);
                }
            }
            Taps::Some(count) => {
                let [low, high] = self.limits();
                // A shift for each part of a texel: points of one sequence would make bands.
                let shift = shift(self.at[0], self.at[1]);
                for index in 0..count {
                    let even = r2(index);
                    let [x, y] = [0, 1].map(|axis| 2.0 * (even[axis] + shift[axis]).fract() - 1.0);
                    let [x, y] = if self.is_round { concentric(x, y) } else { [x, y] };
                    let at = [self.at[0] + half[0] * x, self.at[1] + half[1] * y];
                    let [i, j] = at.map(|t| t.floor() as i64);
                    let is_within = [i, j].iter().all(|t| (low..high).contains(t));
                    add(1.0 / f64::from(count), is_within.then(|| self.blocker(i, j)).flatten());
                }
            }
        }
        Blockers { share, depth, is_whole }
    }
}

/// Blockers in a window.
#[derive(Clone, Copy, Debug)]
struct Blockers {
    /// Their part of the window.
    share: f64,
    /// Their depths, each times its part.
    depth: f64,
    /// Whether nothing in the window is open.
    is_whole: bool,
}
