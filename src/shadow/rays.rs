//! An exact shadow ray per sample.

use super::{Answer, Claim, LampShadow, Samples, Visibility};
use crate::caster::CasterGroup;
use crate::geom::Light;
use crate::oracle::{Oracle, Verdict};

/// Ray-cast technique over all casters.
#[derive(Debug)]
pub(super) struct Rays<'a> {
    oracle: &'a Oracle,
    light: Light,
}

impl<'a> Rays<'a> {
    pub(super) fn prepare(casters: &'a CasterGroup<'a>, light: &Light) -> Self {
        Self { oracle: casters.oracle(), light: *light }
    }
}

impl LampShadow for Rays<'_> {
    /// One exact shadow ray per front-lit sample. A grazing ray counts as lit.
    fn shade(&self, samples: &Samples) -> Visibility {
        let mut visibility = Visibility::of(samples, &self.light, Claim::Exact, |_| Answer::of(1.0));
        let points: Vec<[f32; 3]> = asked_points(&visibility, samples);
        let mut verdicts = vec![Verdict::Lit; points.len()];
        self.oracle.verdicts_into(&points, &self.light, &mut verdicts);
        visibility.darken(verdicts.iter().map(|&verdict| verdict == Verdict::Shadowed));
        visibility
    }
}

/// The points of the front-lit samples, in sample order.
fn asked_points(visibility: &Visibility, samples: &Samples) -> Vec<[f32; 3]> {
    let asked = samples.hits().iter().zip(visibility.asked()).filter(|(_, asked)| **asked);
    asked.filter_map(|(hit, _)| hit.as_ref().map(|hit| hit.point)).collect()
}
