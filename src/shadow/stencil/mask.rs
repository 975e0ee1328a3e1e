//! Shadow mask: the result of a stencil pass, one count per pixel.

use crate::view::Size;

/// Storage of the counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Counting {
    /// Eight stencil bits: counts are correct modulo 256.
    Stencil,
    /// 32-bit integers in a buffer.
    Integer,
}

/// Number of volumes of one light that contain the visible point, per pixel.
///
/// ```
/// use umbrage::shadow::stencil::{Counting, ShadowMask};
/// use umbrage::view::Size;
///
/// let size = Size::new(2, 1).unwrap();
/// let mask = ShadowMask::new(size, Counting::Integer, vec![1, 0], vec![true, false]);
/// assert_eq!(mask.count(0, 0), Some(1)); // in shadow
/// assert_eq!(mask.count(1, 0), None); // sky
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ShadowMask {
    size: Size,
    counting: Counting,
    counts: Vec<i32>,
    receiver: Vec<bool>,
}

impl ShadowMask {
    /// A mask from counts, and from flags that say whether a pixel shows a receiver: row by row from the top.
    /// The stencil pass of this crate makes such masks. Any other renderer may make one to be compared with
    /// the ray cast ([`compare`](crate::verify::pixels::compare)).
    ///
    /// # Panics
    ///
    /// Panics if there is not one count and one flag per pixel.
    #[must_use]
    pub fn new(size: Size, counting: Counting, counts: Vec<i32>, receiver: Vec<bool>) -> Self {
        assert!(counts.len() == size.pixels() && receiver.len() == size.pixels(), "one entry a pixel");
        Self { size, counting, counts, receiver }
    }

    /// Width and height in pixels.
    #[must_use]
    pub fn size(&self) -> Size {
        self.size
    }

    /// Storage of the counts.
    #[must_use]
    pub fn counting(&self) -> Counting {
        self.counting
    }

    /// The count of a pixel, in columns from the left and rows from the top: the pixel is in shadow if the
    /// count is not 0. `None` for sky, where there is no receiver.
    ///
    /// # Panics
    ///
    /// Panics if the pixel lies outside of the mask.
    #[inline]
    #[must_use]
    pub fn count(&self, x: u32, y: u32) -> Option<i32> {
        assert!(x < self.size.width(), "pixel {x} of a row of {}", self.size.width());
        let place = y as usize * self.size.width() as usize + x as usize;
        self.receiver[place].then(|| self.counts[place])
    }

    /// The count of every pixel, sky included, row by row from the top.
    #[must_use]
    pub fn raw(&self) -> &[i32] {
        &self.counts
    }
}
