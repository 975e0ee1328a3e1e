//! How many pixels got which verdict.

use super::{Comparison, PixelVerdict};

/// The number of pixels with each verdict.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PixelCounts([usize; PixelVerdict::ALL.len()]);

impl PixelCounts {
    /// How many pixels got this verdict.
    #[must_use]
    pub fn of(self, verdict: PixelVerdict) -> usize {
        self.0[verdict as usize]
    }

    /// All pixels.
    #[must_use]
    pub fn pixels(self) -> usize {
        self.0.iter().sum()
    }

    /// Pixels where stencil pass and ray cast say the same.
    #[must_use]
    pub fn agree(self) -> usize {
        self.of(PixelVerdict::Sky) + self.of(PixelVerdict::Lit) + self.of(PixelVerdict::Shadowed)
    }

    /// Pixels that differ as their footprint explains.
    #[must_use]
    pub fn grazing(self) -> usize {
        self.of(PixelVerdict::Grazing)
    }

    /// All other pixels that differ.
    #[must_use]
    pub fn disagree(self) -> usize {
        self.pixels() - self.agree() - self.grazing()
    }

    /// The sum of two.
    #[must_use]
    pub fn plus(self, other: Self) -> Self {
        Self(std::array::from_fn(|i| self.0[i] + other.0[i]))
    }
}

impl Comparison {
    /// How many pixels got each verdict.
    #[must_use]
    pub fn counts(&self) -> PixelCounts {
        PixelCounts(PixelVerdict::ALL.map(|verdict| self.count(verdict)))
    }
}
