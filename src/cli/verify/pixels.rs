//! Stencil counts of every pixel, compared with the ray cast.

use umbrage::verify::pixels::{Mismatch, PixelCounts};
use umbrage::verify::points::Judge;
use umbrage::view::{Projection, Size};

/// The stencil passes of all lights.
pub(super) struct Pixels {
    /// The graphics adapter's name.
    pub(super) adapter: String,
    pub(super) size: Size,
    pub(super) projection: Projection,
    /// Whether the distance of the near plane was asked for.
    pub(super) near_asked: bool,
    /// One entry per light.
    pub(super) lights: Vec<LightPixels>,
}

/// The stencil passes of one light.
pub(super) struct LightPixels {
    /// z-fail for all shells; then, where that chooses z-pass for any of them, the choice for each.
    pub(super) passes: Vec<Pass>,
    /// Each pixel with its worst verdict.
    pub(super) counts: PixelCounts,
}

/// One stencil pass, compared with the ray cast.
pub(super) struct Pass {
    pub(super) asked: &'static str,
    /// The method for all shells, or `mixed`.
    pub(super) method: &'static str,
    pub(super) reason: String,
    /// How the counts are kept, and why.
    pub(super) counting: &'static str,
    pub(super) counting_reason: String,
    pub(super) counts: PixelCounts,
    /// The first few that nothing explains.
    pub(super) mismatches: Vec<Mismatch>,
}

impl Pixels {
    /// Summed over the lights.
    pub(super) fn counts(&self) -> PixelCounts {
        self.lights.iter().fold(PixelCounts::default(), |sum, light| sum.plus(light.counts))
    }
}

/// The passes of one light: the method that was asked for, and the name in the table of methods.
pub(super) const PASSES: [(&str, &str); 2] =
    [("zfail", "stencil pass, z-fail"), ("auto", "stencil pass, z-pass where proven")];

impl LightPixels {
    /// One row per pass, in which grazing pixels abstain. A pass that was not needed has no pixels.
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
