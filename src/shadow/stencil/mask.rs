//! The result of a stencil pass: a count per pixel.

use crate::view::Size;

/// The type of the counts of a stencil pass.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Counting {
    /// In eight bits of a stencil: right modulo 256.
    Stencil,
    /// In 32 bits of memory.
    Integer,
}

impl Counting {
    /// Lower-case name, as in reports.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Stencil => "stencil",
            Self::Integer => "integer",
        }
    }
}

/// The number of volumes of one light that the visible point of each pixel is in.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ShadowMask {
    size: Size,
    counting: Counting,
    counts: Vec<i32>,
    receiver: Vec<bool>,
}

impl ShadowMask {
    /// A mask from counts, and from whether a pixel has a receiver: row after row from the top. Passes of
    /// this crate make masks; so may any other renderer, to be verified.
    ///
    /// # Panics
    ///
    /// Panics if there is not one entry of each per pixel.
    #[must_use]
    pub fn new(size: Size, counting: Counting, counts: Vec<i32>, receiver: Vec<bool>) -> Self {
        assert!(counts.len() == size.pixels() && receiver.len() == size.pixels(), "one entry per pixel");
        Self { size, counting, counts, receiver }
    }

    /// Pixels per row and column.
    #[must_use]
    pub fn size(&self) -> Size {
        self.size
    }

    /// The type of the counts.
    #[must_use]
    pub fn counting(&self) -> Counting {
        self.counting
    }

    /// The count of a pixel, from the upper left corner: in shadow where it is not 0. `None` where nothing
    /// receives a shadow, the sky.
    ///
    /// # Panics
    ///
    /// Panics if there is no such pixel.
    #[inline]
    #[must_use]
    pub fn count(&self, x: u32, y: u32) -> Option<i32> {
        assert!(x < self.size.width(), "pixel {x} of a row of {}", self.size.width());
        let index = y as usize * self.size.width() as usize + x as usize;
        self.receiver[index].then(|| self.counts[index])
    }

    /// Every pixel's count before the sky is masked, row after row from the top.
    #[must_use]
    pub fn raw(&self) -> &[i32] {
        &self.counts
    }
}
