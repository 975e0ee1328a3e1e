//! Maps of face numbers with an exact test of the faces: the technique `map-ids`.
//!
//! (Jean-Christophe Hourcade and Alain Nicolas, *Algorithms for Antialiased Cast Shadows*, 1985; Chris Wyman
//! et al., *Frustum-Traced Shadows*, 2015.) The texels around a lookup name candidates. A candidate that the
//! segment to the light properly crosses is a shadow: this clause is never falsely dark.

use super::neighborhood::{Around, Neighborhood, Seen};
use super::options::ExactOptions;
use super::raster::{DepthSource, PolygonOffset};
use super::space::{LightSpace, wide};
use super::{MapError, Named, ShadowMap, Texel};
use crate::caster::CasterGroup;
use crate::geom::Light;
use crate::mesh::FaceId;
use crate::oracle::{Intersection, PrimaryHit, intersect};
use crate::scene::Lamp;
use crate::shadow::visibility::Answer;
use crate::shadow::{Claim, LampShadow, Samples, Visibility};

/// A map of face numbers of one lamp.
#[derive(Debug)]
pub struct IdShadow<'a> {
    casters: &'a CasterGroup<'a>,
    /// First face number of each caster.
    first_faces: Vec<u32>,
    light: Light,
    reach: i64,
    map: ShadowMap<Named>,
    /// False where a test injects a fault.
    tests_faces: bool,
}

impl<'a> IdShadow<'a> {
    /// Draws the map of the scene.
    ///
    /// # Errors
    ///
    /// [`MapError`] if an option is out of range, or the texels do not fit the memory.
    pub fn prepare(
        casters: &'a CasterGroup<'a>,
        lamp: &Lamp,
        options: &ExactOptions,
    ) -> Result<Self, MapError> {
        let reach = options.checked_reach()?;
        let space = LightSpace::of_scene(casters, lamp, options.size)?;
        let (light, offset) = (*lamp.light(), PolygonOffset::default());
        let map = ShadowMap::draw(casters, &light, space, DepthSource::Plane, offset)?;
        let first_faces = casters.casters().iter().scan(0, |next: &mut u32, caster| {
            let first = *next;
            *next += caster.mesh().face_count() as u32; // the rasterizer has counted them
            Some(first)
        });
        Ok(Self { casters, first_faces: first_faces.collect(), light, reach, map, tests_faces: true })
    }

    /// 0 or 1 at each front-lit sample.
    ///
    /// A sample is in shadow if its segment to the light crosses one of the candidates, or if all texels lie
    /// above its plane: faces smaller than a texel may be named by none. The second clause errs where light
    /// passes between covered texel centers.
    #[must_use]
    pub fn shade(&self, samples: &Samples) -> Visibility {
        self.shade_with(samples, true)
    }

    pub(super) fn shade_with(&self, samples: &Samples, interior: bool) -> Visibility {
        Visibility::of(samples, &self.light, Claim::Approximate, |hit| {
            let Some(around) = Neighborhood::of(self.map.space(), hit, Around::Reach(self.reach)) else {
                return Answer { is_outside: true, ..Answer::of(1.0) };
            };
            let value = if self.shadows(hit, &around, interior) { 0.0 } else { 1.0 };
            Answer { reads: around.reads(), is_outside: around.is_outside(), ..Answer::of(value) }
        })
    }

    fn shadows(&self, hit: &PrimaryHit, around: &Neighborhood<'_>, interior: bool) -> bool {
        let mut last = None;
        let mut crossed = false;
        let seen = around.look(|tap| {
            let texel = self.map.texel(tap.layer, tap.i, tap.j)?;
            if texel.face() != last {
                last = texel.face();
                crossed |= last.is_some_and(|face| self.crosses(hit, face));
            }
            Some(texel.depth())
        });
        crossed || interior && seen == Seen::Blocked
    }

    fn crosses(&self, hit: &PrimaryHit, face: u32) -> bool {
        if !self.tests_faces {
            return true;
        }
        let caster = self.first_faces.partition_point(|&first| first <= face) - 1;
        let face = FaceId(face - self.first_faces[caster]);
        let corners = self.casters.casters()[caster].mesh().corners(face);
        matches!(intersect(hit.point, &self.light, corners), Intersection::Crossing(_))
    }

    #[cfg(test)]
    pub(super) fn without_test(self) -> Self {
        Self { tests_faces: false, ..self }
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

impl LampShadow for IdShadow<'_> {
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
