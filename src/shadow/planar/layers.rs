//! The mean of several planar shadows, from points spread over the lamp: the technique `planar-layers`.
//!
//! (Paul Heckbert and Michael Herf, *Simulating Soft Shadows with Graphics Hardware*, 1997.) Each shadow is
//! exact; values have n + 1 levels, and the mean error inside a penumbra falls with about `n^(−3/4)`. A disk
//! that faces the point it lights is taken as facing the middle of the plane's samples.

use super::coverage::Coverage;
use super::options::LayersOptions;
use super::rays::LampRays;
use crate::caster::CasterGroup;
use crate::geom::Light;
use crate::oracle::PrimaryHit;
use crate::scene::Lamp;
use crate::shadow::LampShadow;
use crate::shadow::{Answer, Claim, Samples, Visibility};

#[derive(Debug)]
struct Layers<'a> {
    casters: &'a CasterGroup<'a>,
    lamp: Lamp,
    options: LayersOptions,
    rays: LampRays<'a>,
}

pub(in crate::shadow) fn planar_layers<'a>(
    casters: &'a CasterGroup<'a>,
    lamp: &Lamp,
    options: LayersOptions,
) -> Box<dyn LampShadow + 'a> {
    let rays = LampRays::soft(casters, lamp, options.n.max(1));
    Box::new(Layers { casters, lamp: lamp.clone(), options, rays })
}

/// The shadow from one point of the lamp.
type Layer = (Light, Option<Coverage>);

impl Layers<'_> {
    fn answer(&self, hit: &PrimaryHit, layers: &[Layer]) -> Answer {
        let (mut lit, mut is_exact) = (0_u32, false);
        for (light, coverage) in layers {
            let covered = coverage.as_ref().and_then(|coverage| coverage.covers(hit.point));
            is_exact |= covered.is_none();
            lit += u32::from(covered.map_or_else(|| self.rays.reaches(hit.point, light), |dark| !dark));
        }
        Answer { is_exact, ..Answer::of(lit as f32 / layers.len() as f32) }
    }
}

impl LampShadow for Layers<'_> {
    fn shade(&self, samples: &Samples) -> Visibility {
        let center = self.lamp.light();
        let plane = self.options.plane.plane(samples, center);
        let layers: Vec<Layer> = plane.map_or_else(Vec::new, |plane| {
            let lights = self.rays.lights(plane.middle(samples, center));
            let layer = |light: Light| (light, Coverage::new(self.casters, &plane, &light));
            lights.into_iter().map(layer).collect()
        });
        // A single ray to a lamp without extent is exact.
        let claim = if self.lamp.has_extent() { Claim::Approximate } else { Claim::Exact };
        Visibility::of(samples, center, claim, |hit| match plane {
            Some(plane) if plane.holds(hit.corners) => self.answer(hit, &layers),
            _ => self.rays.answer(hit),
        })
    }

    fn bytes(&self) -> usize {
        self.rays.bytes()
    }
}
