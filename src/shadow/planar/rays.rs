//! The samples that are not on the plane: exact shadow rays.

use crate::caster::CasterGroup;
use crate::geom::Light;
use crate::oracle::{Oracle, PrimaryHit, Verdict};
use crate::random::r2;
use crate::scene::Lamp;
use crate::shadow::Answer;

/// Exact rays to one or several points of a lamp. A grazing ray counts as lit.
#[derive(Debug)]
pub(super) struct LampRays<'a> {
    oracle: &'a Oracle,
    lamp: Lamp,
    /// The light points, in the unit square; none for the lamp's center.
    points: Vec<[f64; 2]>,
}

impl<'a> LampRays<'a> {
    /// Rays to the lamp's center.
    pub(super) fn hard(casters: &'a CasterGroup<'a>, lamp: &Lamp) -> Self {
        Self { oracle: casters.oracle(), lamp: lamp.clone(), points: Vec::new() }
    }

    /// Rays to `n` points of the lamp; of a lamp without extent, to its center.
    pub(super) fn soft(casters: &'a CasterGroup<'a>, lamp: &Lamp, n: u32) -> Self {
        let n = if lamp.has_extent() { n } else { 0 };
        Self { points: (0..n).map(r2).collect(), ..Self::hard(casters, lamp) }
    }

    pub(super) fn answer(&self, hit: &PrimaryHit) -> Answer {
        let lit = |light: &Light| u32::from(self.reaches(hit.point, light));
        let value = match self.lamp.patch(hit.point) {
            Some(patch) if !self.points.is_empty() => {
                let sum: u32 = self.points.iter().map(|&uv| lit(&patch.light(uv))).sum();
                sum as f32 / self.points.len() as f32
            }
            _ => lit(self.lamp.light()) as f32,
        };
        Answer { is_exact: true, ..Answer::of(value) }
    }

    /// Whether light from one point of the lamp reaches a point.
    pub(super) fn reaches(&self, p: [f32; 3], light: &Light) -> bool {
        self.oracle.verdict(p, light) != Verdict::Shadowed
    }

    /// Points of the lamp as they are seen from `p`; its center alone for a lamp without extent.
    pub(super) fn lights(&self, p: [f32; 3]) -> Vec<Light> {
        match self.lamp.patch(p) {
            Some(patch) if !self.points.is_empty() => self.points.iter().map(|&uv| patch.light(uv)).collect(),
            _ => vec![*self.lamp.light()],
        }
    }

    pub(super) fn bytes(&self) -> usize {
        size_of_val(&*self.points)
    }
}
