//! The techniques that a lamp could have, each with a bound of its error and a time, or why it has none.

use super::Evidence;
use super::costs::{Costs, Step, Work};
use super::probe::Share;
use crate::shadow::map::{MapOptions, PcfOptions};
use crate::shadow::soft::SamplesOptions;
use crate::shadow::{GridOptions, Technique};

/// Parts that lamps share, as bits of a set.
pub(super) const TREE: u8 = 1;
pub(super) const TOPOLOGY: u8 = 2;
pub(super) const DEVICE: u8 = 4;
pub(super) const PREPASS: u8 = 8;

/// A technique for one lamp.
#[derive(Clone, Debug)]
pub(super) struct Candidate {
    pub(super) technique: Technique,
    /// Whether it runs on the graphics adapter.
    pub(super) on_device: bool,
    /// Fraction of wrong samples, its bound, and the evidence; `None` without a bound.
    pub(super) error: Option<(Share, Evidence)>,
    /// Own time in nanoseconds, and what it is the time of.
    pub(super) time: f64,
    pub(super) step: Step,
    pub(super) work: Work,
    pub(super) shared: u8,
    /// Why it cannot run here.
    pub(super) not_applicable: Option<&'static str>,
    /// Why there is no bound of its error.
    pub(super) no_bound: &'static str,
}

impl Candidate {
    /// All lit or all dark, where that was shown.
    pub(super) fn plain(technique: Technique, work: Work, costs: &Costs, evidence: Evidence) -> Self {
        Self {
            technique,
            on_device: false,
            error: Some((Share::NONE, evidence)),
            time: costs.nanoseconds(Step::Plain, &work),
            step: Step::Plain,
            work,
            shared: 0,
            not_applicable: None,
            no_bound: NO_BOUND,
        }
    }

    /// The part of its time that does not depend on the samples, in nanoseconds.
    pub(super) fn without_samples(&self, costs: &Costs) -> f64 {
        costs.nanoseconds(self.step, &Work { samples: 0.0, facing: 0.0, unsure: 0.0, ..self.work })
    }

    /// Whether its error is bounded well enough.
    pub(super) fn is_admissible(&self, prove: bool, most: f64) -> bool {
        let is_within =
            |(share, evidence): (Share, Evidence)| share.bound <= most && (evidence.proves() || !prove);
        self.not_applicable.is_none() && self.error.is_some_and(is_within)
    }
}

/// What is known of a lamp before the choice.
#[derive(Clone, Copy, Debug)]
pub(super) struct Known {
    /// Counts of the picture: samples, facing samples, faces.
    pub(super) work: Work,
    /// Whether there is a graphics adapter.
    pub(super) has_device: bool,
    /// Whether the lamp has an extent.
    pub(super) has_extent: bool,
    /// Samples that face the lamp's center.
    pub(super) facing: Share,
    /// Samples that face it and are dark, for its center; `None` if unknown.
    pub(super) dark: Option<Share>,
    /// Samples that face it and are lit.
    pub(super) lit: Option<Share>,
    /// Side of the light grid, and the samples that it leaves undecided.
    pub(super) undecided: Option<(u32, Share)>,
    /// Samples that may be in a penumbra; `None` if unknown. Nothing for a lamp without extent.
    pub(super) penumbra: Option<Share>,
    /// How much wider a map over the scene is than the grid over what is seen.
    pub(super) widening: f64,
    /// Samples on the plane of most samples, as a fraction of the facing ones.
    pub(super) on_plane: f64,
}

/// Sides of the grid.
const GRIDS: [u32; 5] = [64, 128, 256, 512, 1024];
/// Sides of maps.
const MAPS: [u32; 6] = [256, 512, 1024, 2048, 4096, 8192];
/// Numbers of rays to a lamp.
const RAYS: [u32; 3] = [16, 64, 256];

impl Known {
    /// The fraction of samples that a grid of this side leaves undecided. Measured on generated cities, it
    /// halves with every doubling, within a quarter.
    fn undecided(&self, side: u32) -> f64 {
        // A grid that was not built: what meshes of 10⁴ to 10⁵ faces leave undecided at 256.
        let (at, share) =
            self.undecided.map_or((256, 0.15 * self.facing.of_probe), |(at, share)| (at, share.of_probe));
        (share * f64::from(at) / f64::from(side)).min(self.facing.of_probe)
    }

    /// All candidates, in the order in which ties are resolved.
    pub(super) fn candidates(&self, costs: &Costs) -> Vec<Candidate> {
        let mut list = Listed { known: self, costs, all: Vec::new() };
        list.plain();
        list.exact_hard();
        if self.has_extent {
            list.soft();
        }
        list.maps();
        list.others();
        list.all
    }
}

struct Listed<'a> {
    known: &'a Known,
    costs: &'a Costs,
    all: Vec<Candidate>,
}

const EXACT: Option<(Share, Evidence)> = Some((Share::NONE, Evidence::Exact));
const NO_BOUND: &str = "no bound of its error";
const NO_GRID: &str = "no bound of its error: how many samples may be in a penumbra was not looked for";
const NO_RAYS: &str = "no bound of its error: no rays were cast for the plan";

impl Listed<'_> {
    fn add(
        &mut self,
        technique: Technique,
        step: Step,
        work: Work,
        shared: u8,
        error: Option<(Share, Evidence)>,
    ) {
        let time = self.costs.nanoseconds(step, &work);
        self.all.push(Candidate {
            technique,
            on_device: false,
            error,
            time,
            step,
            work,
            shared,
            not_applicable: None,
            no_bound: NO_BOUND,
        });
    }

    /// A hard shadow: of a lamp with an extent, it is wrong where there may be a penumbra.
    fn hard(
        &mut self,
        technique: Technique,
        step: Step,
        work: Work,
        shared: u8,
        error: Option<(Share, Evidence)>,
    ) {
        let both =
            error.zip(self.known.penumbra).map(|((share, evidence), penumbra)| match self.known.has_extent {
                true => (share.or(penumbra), evidence.weaker(penumbra.evidence())),
                false => (share, evidence),
            });
        self.add(technique, step, work, shared, both);
        if let Some(last) = self.all.last_mut()
            && self.known.penumbra.is_none()
        {
            last.no_bound = NO_GRID;
        }
    }

    /// All lit, or all dark.
    fn plain(&mut self) {
        let known = self.known;
        let evidence = |share: Share| (share, share.evidence());
        for (technique, share) in [(Technique::None, known.dark), (Technique::Dark, known.lit)] {
            self.hard(technique, Step::Plain, known.work, 0, share.map(evidence));
            if let Some(last) = self.all.last_mut()
                && share.is_none()
            {
                last.no_bound = NO_RAYS;
            }
        }
    }

    fn exact_hard(&mut self) {
        let work = self.known.work;
        self.hard(Technique::Rays, Step::Rays, work, TREE, EXACT);
        for grid in GRIDS {
            let unsure = self.known.undecided(grid) * work.samples;
            let work = Work { side: grid.into(), unsure, ..work };
            self.hard(Technique::Hybrid(GridOptions { grid }), Step::Hybrid, work, TREE | TOPOLOGY, EXACT);
        }
        let alias_free = Technique::AliasFree(GridOptions::DEFAULT);
        self.hard(alias_free, Step::AliasFree, Work { side: 256.0, ..work }, TOPOLOGY, EXACT);
        let unsure = (1.0 - self.known.on_plane) * work.facing;
        self.hard(Technique::Planar(Default::default()), Step::Planar, Work { unsure, ..work }, TREE, EXACT);
        self.hard(Technique::Counter(Default::default()), Step::Counter, work, TOPOLOGY, EXACT);
        self.hard(Technique::Stencil, Step::Counting, work, TOPOLOGY, EXACT);
        self.hard(Technique::ZFail, Step::Counting, work, TOPOLOGY, EXACT);
        for technique in [Technique::Stencil, Technique::ZFail] {
            self.hard(technique, Step::Stencil, work, TOPOLOGY | DEVICE | PREPASS, EXACT);
            if let Some(last) = self.all.last_mut() {
                last.on_device = true;
                last.not_applicable = (!self.known.has_device).then_some("no graphics adapter");
            }
        }
    }

    /// Techniques for lamps with an extent whose error is bounded.
    fn soft(&mut self) {
        let work = self.known.work;
        let maybe = self.known.penumbra.map(|penumbra| penumbra.of_probe * work.samples);
        let unsure = maybe.unwrap_or(work.facing);
        self.add(Technique::Area, Step::Area, Work { unsure, ..work }, TREE, EXACT);
        // Outside of the penumbra all rays agree. Within it no bound is proven.
        let penumbra = self.known.penumbra.map(|share| (share, share.evidence()));
        for n in RAYS {
            let work = Work { each: n.into(), ..work };
            self.add(Technique::Samples(SamplesOptions { n }), Step::Samples, work, TREE, penumbra);
        }
    }

    /// Shadow maps. A map without a bias is right where a light grid of the same cells decides; with a filter
    /// also the cells around have to. The grid that was built has other cells, and the law by which the
    /// undecided samples become fewer is measured: so the bound is not proven.
    fn maps(&mut self) {
        let known = self.known;
        for size in MAPS {
            let bound = |reach: f64| {
                known.undecided.map(|(side, share)| {
                    let factor = f64::from(side) / f64::from(size) * known.widening * (1.0 + reach);
                    (share.scaled(factor), Evidence::Sampled)
                })
            };
            let map = MapOptions { size, ..MapOptions::DEFAULT };
            let pcf = PcfOptions(MapOptions { size, ..PcfOptions::DEFAULT.0 });
            let work = |each: f64| Work { side: size.into(), each, ..known.work };
            self.hard(Technique::Map(map), Step::Map, work(4.0), 0, bound(2.0));
            self.hard(Technique::Pcf(pcf), Step::Map, work(16.0), 0, bound(4.0));
        }
    }

    /// All other techniques: their error can only be sampled.
    fn others(&mut self) {
        let work = Work { side: 1024.0, each: 9.0, ..self.known.work };
        for technique in Technique::ALL {
            if self.all.iter().any(|candidate| candidate.technique.name() == technique.name()) {
                continue;
            }
            let many = |each: f64| Work { each, unsure: 0.4 * work.facing, ..work };
            let on_plane = Work { unsure: (1.0 - self.known.on_plane) * work.facing, ..work };
            let (step, work, shared) = match technique {
                Technique::ZPass | Technique::ZPassReversed => (Step::Counting, work, TOPOLOGY),
                Technique::ZPassPlus => (Step::Counting, work, TOPOLOGY | TREE),
                Technique::SoftHybrid(_) => (Step::SoftHybrid, many(64.0), TREE),
                Technique::Pcss(_) | Technique::SingleSample(_) => (Step::SoftMap, many(64.0), 0),
                Technique::Vsm(_) | Technique::Msm(_) => (Step::SoftMap, many(16.0), 0),
                Technique::PenumbraMap(_) | Technique::Smoothies(_) | Technique::ContactBlur(_) => {
                    (Step::SoftMap, many(64.0), TREE | TOPOLOGY)
                }
                Technique::PlanarBlur(_)
                | Technique::PlanarContact(_)
                | Technique::PlanarLayers(_)
                | Technique::Blob(_)
                | Technique::Projective(_) => (Step::Planar, on_plane, TREE),
                _ => (Step::Map, work, TREE),
            };
            self.add(technique, step, work, shared, None);
            let is_soft_without_need = technique.is_soft() && !self.known.has_extent;
            if let Some(last) = self.all.last_mut() {
                last.not_applicable = is_soft_without_need.then_some("the lamp has no extent");
            }
        }
    }
}
