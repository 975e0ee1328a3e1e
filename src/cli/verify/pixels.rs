//! What the stencil pass counted in every pixel, against the ray cast.

use umbrage::verify::pixels::{Mismatch, PixelVerdict};
use umbrage::verify::points::Judge;
use umbrage::view::Projection;
use umbrage::view::Size;

/// The stencil passes of all lights.
pub(super) struct Pixels {
    /// The graphics adapter's name.
    pub(super) adapter: String,
    pub(super) size: Size,
    pub(super) projection: Projection,
    /// One entry a light.
    pub(super) lights: Vec<LightPixels>,
}

/// The stencil passes of one light.
pub(super) struct LightPixels {
    /// z-fail for all shells; then, where that chooses z-pass for any of them, the choice for each.
    pub(super) passes: Vec<Pass>,
    /// Each pixel with its gravest verdict.
    pub(super) counts: Counts,
}

/// One stencil pass, judged.
pub(super) struct Pass {
    pub(super) asked: &'static str,
    /// What all shells are counted by, or `mixed`.
    pub(super) method: &'static str,
    pub(super) reason: String,
    /// How the counts are kept, and why.
    pub(super) counting: &'static str,
    pub(super) counting_reason: String,
    pub(super) counts: Counts,
    /// The first few that nothing explains.
    pub(super) mismatches: Vec<Mismatch>,
}

/// How many pixels got each verdict, in the order of [`PixelVerdict::ALL`].
#[derive(Clone, Copy, Default)]
pub(super) struct Counts(pub(super) [usize; PixelVerdict::ALL.len()]);

impl Counts {
    pub(super) fn of(self, verdict: PixelVerdict) -> usize {
        self.0[verdict as usize]
    }

    pub(super) fn pixels(self) -> usize {
        self.0.iter().sum()
    }

    pub(super) fn agree(self) -> usize {
        self.of(PixelVerdict::Sky) + self.of(PixelVerdict::Lit) + self.of(PixelVerdict::Shadowed)
    }

    pub(super) fn grazing(self) -> usize {
        self.of(PixelVerdict::Grazing)
    }

    pub(super) fn disagree(self) -> usize {
        self.pixels() - self.agree() - self.grazing()
    }

    pub(super) fn plus(self, other: Self) -> Self {
        Self(std::array::from_fn(|i| self.0[i] + other.0[i]))
    }
}

impl Pixels {
    /// Summed over the lights.
    pub(super) fn counts(&self) -> Counts {
        self.lights.iter().fold(Counts::default(), |sum, light| sum.plus(light.counts))
    }
}

/// What was asked for in the passes of one light, and their names as judges.
pub(super) const PASSES: [(&str, &str); 2] =
    [("zfail", "stencil pass, z-fail"), ("auto", "stencil pass, z-pass where proven")];

impl LightPixels {
    /// A row a pass: a grazing pixel is one that it stands on the boundary of. A pass that was not needed was asked
    /// about nothing.
    pub(super) fn judges(&self) -> [Judge; 2] {
        PASSES.map(|(asked, name)| {
            let counts = self.passes.iter().find(|pass| pass.asked == asked).map(|pass| pass.counts);
            let counts = counts.unwrap_or_default();
            let [points, abstain, disagree] =
                [counts.pixels(), counts.grazing(), counts.disagree()].map(|count| count as u64);
            Judge { name, points, abstain, disagree }
        })
    }
}
