//! The light grid decides what it can prove, and the exact ray cast the rest: the technique `hybrid`.
//!
//! (Eric Chan and Frédo Durand, *An Efficient Hybrid Shadow Rendering Algorithm*, EGSR 2004, with bounds of
//! whole cells instead of the depths of a map: exact.)

use super::GridOptions;
use crate::caster::CasterGroup;
use crate::geom::Light;
use crate::light_grid::{Chain, GridVerdict, LightGrid};
use crate::oracle::{Oracle, Verdict};
use crate::shadow::visibility::asked;
use crate::shadow::{Answer, Claim, LampShadow, Samples, Visibility};

/// The chain of one light, and the exact ray cast. The grid is made for each view, over what is visible.
#[derive(Debug)]
pub(in crate::shadow) struct GridHybrid<'a> {
    oracle: &'a Oracle,
    chain: Chain<'a>,
    options: GridOptions,
}

impl<'a> GridHybrid<'a> {
    pub(in crate::shadow) fn prepare(
        casters: &'a CasterGroup<'a>,
        light: &Light,
        options: GridOptions,
    ) -> Self {
        Self { oracle: casters.oracle(), chain: Chain::of(casters, light), options }
    }
}

impl LampShadow for GridHybrid<'_> {
    /// 0 or 1 at each front-lit sample. A grazing ray counts as either.
    fn shade(&self, samples: &Samples) -> Visibility {
        let light = self.chain.light();
        let asked = asked(samples, light);
        let points = samples.hits().iter().zip(&asked).filter(|(_, asked)| **asked);
        let points = points.filter_map(|(hit, _)| hit.as_ref().map(|hit| hit.point));
        let grid = LightGrid::build(&self.chain, points, self.options.grid);
        by_grid(&grid, self.oracle, light, samples)
    }

    /// Memory of the chain in bytes.
    fn bytes(&self) -> usize {
        self.chain.bytes()
    }
}

/// 0 or 1 at each front-lit sample, by a grid of the light, and by exact rays where it does not decide.
pub(crate) fn by_grid(grid: &LightGrid<'_>, oracle: &Oracle, light: &Light, samples: &Samples) -> Visibility {
    Visibility::of(samples, light, Claim::Exact, |hit| {
        let proven = grid.verdict(hit);
        let is_dark = match proven {
            GridVerdict::Dark => true,
            GridVerdict::Lit => false,
            GridVerdict::Undecided => oracle.verdict(hit.point, light) == Verdict::Shadowed,
        };
        Answer { is_exact: proven == GridVerdict::Undecided, ..Answer::of(f32::from(u8::from(!is_dark))) }
    })
}
