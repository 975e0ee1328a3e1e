//! The technique `planar` on the CPU.

use super::Plane;
use super::coverage::Coverage;
use super::options::{Ground, PlanarOptions};
use crate::caster::CasterGroup;
use crate::geom::Light;
use crate::oracle::{Oracle, PrimaryHit, Verdict};
use crate::scene::Lamp;
use crate::shadow::LampShadow;
use crate::shadow::{Answer, Claim, Samples, Visibility};

/// Exact planar shadows of one lamp.
#[derive(Debug)]
struct Planar<'a> {
    casters: &'a CasterGroup<'a>,
    light: Light,
    ground: Ground,
    /// For a given plane; one that depends on the samples is flattened onto with them.
    given: Option<OnPlane>,
}

/// A plane with the faces flattened onto it, if the light is beside it.
#[derive(Debug)]
struct OnPlane {
    plane: Plane,
    coverage: Option<Coverage>,
}

pub(in crate::shadow) fn planar<'a>(
    casters: &'a CasterGroup<'a>,
    lamp: &Lamp,
    options: PlanarOptions,
) -> Box<dyn LampShadow + 'a> {
    let (light, ground) = (*lamp.light(), options.plane);
    let given = match ground {
        Ground::Most => None,
        Ground::Given(given) => Some(OnPlane::new(casters, given.plane(), &light)),
    };
    Box::new(Planar { casters, light, ground, given })
}

impl OnPlane {
    fn new(casters: &CasterGroup<'_>, plane: Plane, light: &Light) -> Self {
        Self { plane, coverage: Coverage::new(casters, &plane, light) }
    }

    /// Whether a sample is in shadow; `None` if it is not on the plane.
    fn covers(&self, hit: &PrimaryHit) -> Option<bool> {
        self.coverage.as_ref().filter(|_| self.plane.holds(hit.corners))?.covers(hit.point)
    }
}

impl LampShadow for Planar<'_> {
    /// Samples that are not on the plane are passed to the exact ray cast. A grazing ray counts as lit.
    fn shade(&self, samples: &Samples) -> Visibility {
        let most = match self.given {
            Some(_) => None,
            None => self.ground.plane(samples, &self.light),
        };
        let most = most.map(|plane| OnPlane::new(self.casters, plane, &self.light));
        let on_plane = self.given.as_ref().or(most.as_ref());
        let oracle: &Oracle = self.casters.oracle();
        Visibility::of(samples, &self.light, Claim::Exact, |hit| {
            let covered = on_plane.and_then(|on_plane| on_plane.covers(hit));
            let by_ray = || oracle.verdict(hit.point, &self.light) == Verdict::Shadowed;
            let is_dark = covered.unwrap_or_else(by_ray);
            Answer { is_exact: covered.is_none(), ..Answer::of(if is_dark { 0.0 } else { 1.0 }) }
        })
    }

    fn bytes(&self) -> usize {
        self.given.as_ref().and_then(|given| given.coverage.as_ref()).map_or(0, Coverage::bytes)
    }
}
