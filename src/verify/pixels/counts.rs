//! Pixel counts per verdict.

use super::{Comparison, PixelVerdict};

/// Number of pixels with each verdict.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PixelCounts([usize; PixelVerdict::ALL.len()]);

impl PixelCounts {
    /// Number of pixels with this verdict.
    #[must_use]
    pub fn of(self, verdict: PixelVerdict) -> usize {
        self.0[verdict as usize]
    }

    /// Number of all pixels.
    #[must_use]
    pub fn pixels(self) -> usize {
        self.0.iter().sum()
    }

    /// Number of pixels where stencil pass and ray cast agree.
    #[must_use]
    pub fn agree(self) -> usize {
        self.of(PixelVerdict::Sky) + self.of(PixelVerdict::Lit) + self.of(PixelVerdict::Shadowed)
    }

    /// Number of pixels that differ, where the pixel's footprint explains the difference.
    #[must_use]
    pub fn grazing(self) -> usize {
        self.of(PixelVerdict::Grazing)
    }

    /// Number of pixels that differ for any other reason.
    #[must_use]
    pub fn disagree(self) -> usize {
        self.pixels() - self.agree() - self.grazing()
    }

    /// The sum of two counts, verdict by verdict.
    #[must_use]
    pub fn plus(self, other: Self) -> Self {
        Self(std::array::from_fn(|i| self.0[i] + other.0[i]))
    }
}

impl Comparison {
    /// The number of pixels with each verdict.
    #[must_use]
    pub fn counts(&self) -> PixelCounts {
        PixelCounts(PixelVerdict::ALL.map(|verdict| self.count(verdict)))
    }
}
