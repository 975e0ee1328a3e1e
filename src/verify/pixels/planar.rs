//! Which pixels of a device's planar shadow may differ from the exact verdict.
//!
//! A rasterizer snaps corners to 1/256 of a pixel. A pixel that differs is excused only if the exact verdict,
//! or the plane's outline, changes within one step sideways, as for the stencil pass. There is no tolerance
//! of depth: no depth is compared.

use super::footprint::step;
use crate::caster::CasterGroup;
use crate::geom::Light;
use crate::oracle::Verdict;
use crate::shadow::is_front_lit;
use crate::shadow::planar::Plane;
use crate::view::{Projection, Rays, Size};

/// Positions along each side of the square that is searched.
const GRID: u32 = 9;

/// The exact planar shadow at any position of a picture.
#[derive(Debug)]
pub(crate) struct Footprint<'a> {
    casters: &'a CasterGroup<'a>,
    plane: Plane,
    light: Light,
    rays: Rays,
    step: f64,
}

impl<'a> Footprint<'a> {
    pub(crate) fn new(
        casters: &'a CasterGroup<'a>,
        plane: Plane,
        light: Light,
        projection: &Projection,
        size: Size,
    ) -> Self {
        Self { casters, plane, light, rays: Rays::new(projection, size), step: step(projection, size) }
    }

    /// Whether the point that is seen at a position is lit; `None` if it is not of the plane, or turns from
    /// the light.
    pub(crate) fn exact(&self, x: f64, y: f64) -> Option<bool> {
        let ray = self.rays.ray(x, y);
        let hit = self.casters.seen().first_visible_beyond(ray.origin, ray.direction, 0.0)?;
        if !self.plane.holds(hit.corners) || !is_front_lit(&hit, &self.light) {
            return None;
        }
        Some(self.casters.oracle().verdict(hit.point, &self.light) != Verdict::Shadowed)
    }

    /// Whether the exact value changes within one step of a position.
    pub(crate) fn changes(&self, x: f64, y: f64) -> bool {
        let here = self.exact(x, y);
        let offset = |k: u32| self.step * (2.0 * f64::from(k) / f64::from(GRID - 1) - 1.0);
        (0..GRID * GRID).any(|k| self.exact(x + offset(k % GRID), y + offset(k / GRID)) != here)
    }
}
