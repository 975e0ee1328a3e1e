//! Points sorted into cells, and faces tested against them: the technique `alias-free`.

use super::GridOptions;
use crate::caster::CasterGroup;
use crate::geom::Light;
use crate::light_grid::{Chain, GridVerdict, sorted_verdicts};
use crate::oracle::Verdict;
use crate::shadow::visibility::asked;
use crate::shadow::{Answer, Claim, LampShadow, Samples, Visibility};

/// The chain of one light. It needs no tree over the faces.
#[derive(Debug)]
pub(in crate::shadow) struct AliasFree<'a> {
    casters: &'a CasterGroup<'a>,
    chain: Chain<'a>,
    options: GridOptions,
}

impl<'a> AliasFree<'a> {
    pub(in crate::shadow) fn prepare(
        casters: &'a CasterGroup<'a>,
        light: &Light,
        options: GridOptions,
    ) -> Self {
        Self { casters, chain: Chain::of(casters, light), options }
    }
}

impl LampShadow for AliasFree<'_> {
    /// 0 or 1 at each front-lit sample. A grazing ray counts as lit.
    fn shade(&self, samples: &Samples) -> Visibility {
        let light = self.chain.light();
        let asked = asked(samples, light);
        let points = samples.hits().iter().zip(&asked).filter(|(_, asked)| **asked);
        let points: Vec<[f32; 3]> = points.filter_map(|(hit, _)| hit.as_ref().map(|hit| hit.point)).collect();
        let verdicts = sorted_verdicts(&self.chain, &points, self.options.grid);
        // Where faces overlap too often, the tree is worth its time.
        let exactly = |p: [f32; 3]| self.casters.oracle().verdict(p, light) == Verdict::Shadowed;
        let mut visibility = Visibility::of(samples, light, Claim::Exact, |_| Answer::of(1.0));
        visibility.darken(points.iter().zip(verdicts).map(|(&p, verdict)| match verdict {
            GridVerdict::Dark => true,
            GridVerdict::Lit => false,
            GridVerdict::Undecided => exactly(p),
        }));
        visibility
    }

    /// Memory of the chain in bytes.
    fn bytes(&self) -> usize {
        self.chain.bytes()
    }
}
