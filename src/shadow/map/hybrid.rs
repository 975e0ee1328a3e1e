//! A map where its texels agree, the exact ray cast elsewhere: the techniques `hybrid-3x3` and `hybrid-2x2`.
//!
//! (Eric Chan and Frédo Durand, *An Efficient Hybrid Shadow Rendering Algorithm*, EGSR 2004; Pradeep Sen,
//! Mike Cammarano and Pat Hanrahan, *Shadow Silhouette Maps*, SIGGRAPH 2003.) What errs are occluders that
//! fall between texel centers: their shadows are lost. `hybrid-2x2` is the rule as published in 2004: the
//! four texels around a sample agree.

use super::neighborhood::{Around, Neighborhood, Seen};
use super::options::{ExactOptions, NearestOptions};
use super::space::wide;
use super::{MapError, ShadowMap};
use crate::caster::CasterGroup;
use crate::geom::Light;
use crate::oracle::{Oracle, Verdict};
use crate::scene::Lamp;
use crate::shadow::visibility::Answer;
use crate::shadow::{Claim, LampShadow, Samples, Visibility};

/// A map of one lamp, and the exact ray cast.
#[derive(Debug)]
pub struct HybridShadow<'a> {
    casters: &'a CasterGroup<'a>,
    oracle: &'a Oracle,
    light: Light,
    around: Around,
    map: ShadowMap<f32>,
}

impl<'a> HybridShadow<'a> {
    /// Draws the map of the scene, and builds the ray cast of the casters.
    ///
    /// # Errors
    ///
    /// [`MapError`] if an option is out of range, or the texels do not fit the memory.
    pub fn prepare(
        casters: &'a CasterGroup<'a>,
        lamp: &Lamp,
        options: &ExactOptions,
    ) -> Result<Self, MapError> {
        Self::prepare_around(casters, lamp, options.size, Around::Reach(options.checked_reach()?))
    }

    /// The same, where the four nearest texels decide.
    ///
    /// # Errors
    ///
    /// [`MapError`] if the size is out of range, or the texels do not fit the memory.
    pub fn prepare_nearest(
        casters: &'a CasterGroup<'a>,
        lamp: &Lamp,
        options: &NearestOptions,
    ) -> Result<Self, MapError> {
        Self::prepare_around(casters, lamp, options.size, Around::Nearest)
    }

    fn prepare_around(
        casters: &'a CasterGroup<'a>,
        lamp: &Lamp,
        size: u32,
        around: Around,
    ) -> Result<Self, MapError> {
        let map = ShadowMap::of_scene(casters, lamp, size)?;
        Ok(Self { casters, oracle: casters.oracle(), light: *lamp.light(), around, map })
    }

    /// 0 or 1 at each front-lit sample: what all texels agree on, otherwise the exact verdict. Outside the
    /// map of a spot the exact ray cast is asked. A grazing ray counts as lit.
    #[must_use]
    pub fn shade(&self, samples: &Samples) -> Visibility {
        self.shade_within(samples, self.around)
    }

    pub(super) fn shade_within(&self, samples: &Samples, around: Around) -> Visibility {
        Visibility::of(samples, &self.light, Claim::Approximate, |hit| {
            let around = Neighborhood::of(self.map.space(), hit, around);
            let seen = around.map_or(Seen::Mixed, |around| {
                around.look(|tap| self.map.texel(tap.layer, tap.i, tap.j).copied())
            });
            let is_dark = match seen {
                Seen::Blocked => true,
                Seen::Open => false,
                Seen::Mixed => self.oracle.verdict(hit.point, &self.light) == Verdict::Shadowed,
            };
            Answer {
                value: if is_dark { 0.0 } else { 1.0 },
                is_exact: seen == Seen::Mixed,
                reads: around.map_or(0, |around| around.reads()),
                is_outside: false,
            }
        })
    }

    /// Memory of the texels, in bytes.
    #[must_use]
    pub fn bytes(&self) -> usize {
        self.map.bytes()
    }

    /// Side of a texel in mesh units, in the middle of what is seen.
    #[must_use]
    pub fn texel_world(&self) -> f64 {
        self.map.space().texel_world(wide(self.casters.bounds().center()))
    }
}

impl LampShadow for HybridShadow<'_> {
    fn shade(&self, samples: &Samples) -> Visibility {
        self.shade(samples)
    }

    fn bytes(&self) -> usize {
        self.bytes()
    }

    fn texel_world(&self) -> Option<f64> {
        Some(self.texel_world())
    }
}
