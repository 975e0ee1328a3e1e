//! Cells: a rectangle of y, cut into columns and rows.

use super::facet::Square;
use super::view::ERROR;

/// A grid of `side` columns and rows over a rectangle of y.
///
/// A bound of y passes through the same monotonic function as every other, rounding included: if y lies
/// between two bounds, one of the cells between theirs is the *cell of y*. The rays of a cell are those with
/// such a y; they form a rectangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Cells {
    low: [f64; 2],
    high: [f64; 2],
    /// Cells per unit; 0 for a single column or row.
    scale: [f64; 2],
    side: u32,
}

/// How much a cell is enlarged, in cells: far more than the roundings of an index, which are 2⁻⁵¹ of at most
/// 2¹² cells.
const MARGIN: f64 = 1.0 / (1 << 20) as f64;

/// Position of the generic ray in each cell, in cells.
const GENERIC: [f64; 2] = [0.5 + 1.0 / 32.0, 0.5 - 3.0 / 64.0];

impl Cells {
    pub(super) fn over([x, y]: [[f64; 2]; 2], side: u32) -> Self {
        let scale = [x, y].map(|[low, high]| {
            let scale = f64::from(side) / (high - low);
            if scale.is_finite() { scale } else { 0.0 }
        });
        Self { low: [x[0], y[0]], high: [x[1], y[1]], scale, side }
    }

    pub(super) fn side(&self) -> u32 {
        self.side
    }

    /// Number of cells.
    pub(super) fn count(&self) -> u32 {
        self.side * self.side
    }

    fn index(&self, axis: usize, y: f64) -> u32 {
        let index = ((y - self.low[axis]) * self.scale[axis]) as u32; // saturates
        index.min(self.side - 1)
    }

    /// The columns and the rows, each first to last, that hold a rectangle; `None` if it lies off the grid.
    #[inline]
    pub(super) fn of(&self, rectangle: &[[f64; 2]; 2]) -> Option<[[u32; 2]; 2]> {
        let is_off = (0..2).any(|i| !(rectangle[i][0] <= self.high[i] && rectangle[i][1] >= self.low[i]));
        (!is_off).then(|| [0, 1].map(|i| rectangle[i].map(|y| self.index(i, y))))
    }

    /// The columns and the rows that hold a rectangle; `None` if part of it lies off the grid.
    pub(super) fn all_of(&self, rectangle: &[[f64; 2]; 2]) -> Option<[[u32; 2]; 2]> {
        let is_on = (0..2).all(|i| self.low[i] <= rectangle[i][0] && rectangle[i][1] <= self.high[i]);
        self.of(rectangle).filter(|_| is_on)
    }

    /// The number of the one cell that holds a rectangle, which lies on the grid.
    pub(super) fn one_of(&self, rectangle: &[[f64; 2]; 2]) -> Option<u32> {
        let [[x, x1], [y, y1]] = self.all_of(rectangle)?;
        (x == x1 && y == y1).then(|| self.number(x, y))
    }

    /// The number of a cell, row by row.
    pub(super) fn number(&self, x: u32, y: u32) -> u32 {
        y * self.side + x
    }

    /// A rectangle around all rays of a cell that lie on the grid.
    pub(super) fn square(&self, [x, y]: [u32; 2]) -> Square {
        let mut square = Square { middle: [0.0; 2], half: [0.0; 2] };
        for (i, index) in [x, y].into_iter().enumerate() {
            let (low, high, scale) = (self.low[i], self.high[i], self.scale[i]);
            (square.middle[i], square.half[i]) = if scale > 0.0 {
                (low + (f64::from(index) + 0.5) / scale, (0.5 + MARGIN) / scale)
            } else {
                (0.5 * (low + high), 0.5 * (high - low))
            };
            // Where the borders are much larger than a cell, their rounding dominates.
            square.half[i] += ERROR * (low.abs() + high.abs());
        }
        square
    }

    /// A ray of a cell, at the same position in each; `None` where rounding leaves the cell.
    pub(super) fn generic_ray(&self, cell: [u32; 2]) -> Option<Square> {
        let y = [0, 1].map(|i| {
            let (low, high, scale) = (self.low[i], self.high[i], self.scale[i]);
            if scale > 0.0 {
                low + (f64::from(cell[i]) + GENERIC[i]) / scale
            } else {
                low + GENERIC[i] * (high - low)
            }
        });
        let is_within =
            (0..2).all(|i| self.index(i, y[i]) == cell[i] && self.low[i] <= y[i] && y[i] <= self.high[i]);
        is_within.then(|| Square::ray(y))
    }
}
