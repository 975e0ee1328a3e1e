//! An exact shadow ray per sample.

use super::{Answer, Claim, Samples, Visibility};
use crate::caster::CasterGroup;
use crate::geom::Light;
use crate::oracle::{Oracle, Verdict};

/// Ray-cast technique over all casters.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rays<'a> {
    oracle: &'a Oracle,
}

impl<'a> Rays<'a> {
    pub(super) fn prepare(casters: &'a CasterGroup<'a>) -> Self {
        Self { oracle: casters.oracle() }
    }

    /// One exact shadow ray per front-lit sample. A grazing ray counts as lit.
    pub(super) fn shade(&self, light: &Light, samples: &Samples) -> Visibility {
        let mut visibility = Visibility::of(samples, light, Claim::Exact, |_| Answer::of(1.0));
        let points: Vec<[f32; 3]> = asked_points(&visibility, samples);
        let mut verdicts = vec![Verdict::Lit; points.len()];
        self.oracle.verdicts_into(&points, light, &mut verdicts);
        visibility.darken(verdicts.iter().map(|&verdict| verdict == Verdict::Shadowed));
        visibility
    }
}

/// The points of the front-lit samples, in sample order.
fn asked_points(visibility: &Visibility, samples: &Samples) -> Vec<[f32; 3]> {
    let asked = samples.hits().iter().zip(visibility.asked()).filter(|(_, asked)| **asked);
    asked.filter_map(|(hit, _)| hit.as_ref().map(|hit| hit.point)).collect()
}
