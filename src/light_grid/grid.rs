//! The grid of one light over the visible points.

use std::ops::Range;

use super::bits::RankedBits;
use super::cells::Cells;
use super::chain::{Chain, ChainFace};
use super::fault::Faults;
use super::pairs::{by_cell, pairs};
use super::sheets::{Sheet, Uniting};
use super::view::{Projected, View};
use crate::geom::Aabb;

/// What a light sees, conservatively, in cells: sheets of the casters in each cell that holds a point.
#[derive(Clone, Debug)]
pub struct LightGrid<'a> {
    pub(super) chain: &'a Chain<'a>,
    pub(super) views: Vec<View>,
    /// One entry per view; `None` if no point lies in it.
    pub(super) grids: Vec<Option<ViewGrid>>,
    pub(super) faults: Faults,
}

/// The sheets of a light grid, which depend on the casters and the light: what a cache keeps.
///
/// ```
/// use umbrage::caster::{Caster, CasterGroup};
/// use umbrage::light_grid::{Chain, GridVerdict, LightGrid};
/// use umbrage::testing::shapes;
///
/// let caster = Caster::new(shapes::torus(24, 12, 2.0, 0.7));
/// let casters = CasterGroup::new(vec![&caster]);
/// let light = "point:0,0,9".parse()?;
/// let entries = {
///     let chain = Chain::of(&casters, &light);
///     LightGrid::over(&chain, &casters.bounds(), 64).into_entries()
/// };
/// let chain = Chain::of(&casters, &light);
/// let grid = LightGrid::of_entries(&chain, entries);
/// assert_eq!(grid.verdict_at([2.0, 0.1, -0.69]), GridVerdict::Dark);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GridEntries {
    views: Vec<View>,
    grids: Vec<Option<ViewGrid>>,
}

/// The cells of one view.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct ViewGrid {
    pub(super) cells: Cells,
    /// The cells that hold a point.
    pub(super) occupied: RankedBits,
    /// Index of the first face of each of these cells; one more than there are cells.
    pub(super) starts: Vec<u32>,
    /// The faces, ascending in each cell, and their sheets.
    pub(super) faces: Vec<u32>,
    pub(super) sheet_of: Vec<u32>,
    /// Index of the first sheet of each of these cells; one more than there are cells.
    pub(super) sheet_starts: Vec<u32>,
    pub(super) sheets: Vec<Sheet>,
}

/// Bounds `[low, high]` of both coordinates of rays.
pub(super) type Rectangle = [[f64; 2]; 2];

/// Where a point lies: in a cell, at a nearness.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place<'a> {
    pub(super) view: &'a View,
    /// Bounds of y.
    pub(super) y: Rectangle,
    /// Bounds of the nearness.
    pub(super) nearness: [f64; 2],
    /// The sheets of the cell.
    pub(super) sheets: &'a [Sheet],
    /// The faces of the cell, and their sheets, as numbers from `first_sheet`.
    pub(super) faces: &'a [u32],
    pub(super) sheet_of: &'a [u32],
    pub(super) first_sheet: u32,
}

/// Most pairs of a face and a cell, for `faces` faces in a view: about 100 bytes for each face, and 100 MiB.
pub(super) fn most_pairs(faces: usize) -> usize {
    4 * faces + (1 << 22)
}

impl<'a> LightGrid<'a> {
    /// The grid over given points, `side` cells along each side of each view; at most 4096.
    ///
    /// Cost: some 100 ns per face, and some 20 ns for each pair of a face and a cell. Where there would be
    /// more pairs than four per face and four million, the side is halved until there are not: the grid
    /// decides less then, and nothing wrong.
    #[must_use]
    pub fn build(
        chain: &'a Chain<'a>,
        points: impl IntoIterator<Item = [f32; 3], IntoIter: Clone>,
        side: u32,
    ) -> Self {
        Self::build_with(chain, points.into_iter(), side, most_pairs(chain.face_count()), Faults::default())
    }

    pub(super) fn build_with(
        chain: &'a Chain<'a>,
        points: impl Iterator<Item = [f32; 3]> + Clone,
        side: u32,
        most: usize,
        faults: Faults,
    ) -> Self {
        let views = View::all(&Aabb::around(points.clone()), chain.light());
        let limits = Limits { side: side.clamp(1, 4096), most, faults };
        let grid = |number: usize| {
            let view = &views[number];
            let inside = points.clone().filter(|&p| View::holding(&views, p) == number);
            let rectangles = inside.filter_map(|p| rectangle(view, &view.project(p)));
            let window = window_around(rectangles.clone())?;
            let occupied = |cells: &Cells| {
                let held = rectangles.clone().filter_map(|rectangle| cells.one_of(&rectangle));
                RankedBits::of(held, cells.count())
            };
            Some(ViewGrid::build(chain, || chain.faces(), view, window, occupied, limits))
        };
        let grids = (0..views.len()).map(grid).collect();
        Self { chain, views, grids, faults }
    }

    /// The grid over all points of a box, as [`LightGrid::build`], for any number of views: it has sheets in
    /// every cell, whether a visible point lies in it or not.
    #[must_use]
    pub fn over(chain: &'a Chain<'a>, bounds: &Aabb, side: u32) -> Self {
        let views = View::all(bounds, chain.light());
        let faults = Faults::default();
        let limits = Limits { side: side.clamp(1, 4096), most: most_pairs(chain.face_count()), faults };
        let grid = |view: &View| {
            // Every ray through the box passes its surface.
            let window = window_around(sides(bounds).into_iter().filter_map(|side| view.bounds(side)))?;
            let occupied = |cells: &Cells| RankedBits::all(cells.count());
            Some(ViewGrid::build(chain, || chain.faces(), view, window, occupied, limits))
        };
        let grids = views.iter().map(grid).collect();
        Self { chain, views, grids, faults }
    }

    /// The grid from its entries, and the chain that they were made of.
    #[must_use]
    pub fn of_entries(chain: &'a Chain<'a>, entries: GridEntries) -> Self {
        Self { chain, views: entries.views, grids: entries.grids, faults: Faults::default() }
    }

    /// The entries of the grid, without the chain.
    #[must_use]
    pub fn into_entries(self) -> GridEntries {
        GridEntries { views: self.views, grids: self.grids }
    }

    /// The place of a point; `None` if its cell is not certain, or was no point's when the grid was built.
    pub(super) fn place(&self, p: [f32; 3]) -> Option<Place<'_>> {
        let number = View::holding(&self.views, p);
        let (view, grid) = (self.views.get(number)?, self.grids[number].as_ref()?);
        let projected = view.project(p);
        let y = rectangle(view, &projected)?;
        let (faces, sheet_of, sheets) = grid.slot(grid.occupied.rank(grid.cells.one_of(&y)?)?);
        Some(Place {
            view,
            y,
            nearness: projected.nearness(),
            first_sheet: sheets.start as u32,
            sheets: &grid.sheets[sheets],
            faces,
            sheet_of,
        })
    }

    /// Number of cells along a side of each view that holds a point.
    #[must_use]
    pub fn sides(&self) -> Vec<u32> {
        self.grids.iter().flatten().map(|grid| grid.cells.side()).collect()
    }

    /// Number of pairs of a face and a cell.
    #[must_use]
    pub fn pair_count(&self) -> usize {
        self.grids.iter().flatten().map(|grid| grid.faces.len()).sum()
    }

    /// Memory in bytes, without the chain.
    #[must_use]
    pub fn bytes(&self) -> usize {
        let of = |grid: &ViewGrid| {
            4 * (grid.starts.len() + grid.faces.len() + grid.sheet_of.len() + grid.sheet_starts.len())
                + size_of_val(&grid.sheets[..])
                + grid.occupied.bytes()
        };
        self.grids.iter().flatten().map(of).sum()
    }
}

/// The surface of a box, as triangles.
fn sides(bounds: &Aabb) -> [[[f32; 3]; 3]; 12] {
    let corner = |bits: usize| [0, 1, 2].map(|i| [bounds.low, bounds.high][bits >> i & 1][i]);
    std::array::from_fn(|index| {
        // One side is normal to axis k; a and b are the other two axes.
        let (k, far, half) = (index / 4, index / 2 % 2, index % 2);
        let [a, b] = [(k + 1) % 3, (k + 2) % 3].map(|axis| 1 << axis);
        let base = far << k;
        [base + half * (a + b), base + a, base + b].map(corner)
    })
}

/// Bounds of a point's y; `None` if the view may not hold all of them.
pub(super) fn rectangle(view: &View, projected: &Projected) -> Option<Rectangle> {
    let y = projected.is_ahead().then(|| projected.y())?;
    y.iter().all(|[low, high]| -view.window() <= *low && *high <= view.window()).then_some(y)
}

/// Bounds of all rectangles; `None` without any.
pub(super) fn window_around(rectangles: impl Iterator<Item = Rectangle>) -> Option<Rectangle> {
    rectangles.reduce(|[x, y], [u, v]| [[x[0].min(u[0]), x[1].max(u[1])], [y[0].min(v[0]), y[1].max(v[1])]])
}

/// What a grid may take.
#[derive(Clone, Copy, Debug)]
pub(super) struct Limits {
    pub(super) side: u32,
    /// Most pairs of a face and a cell; at least the number of faces.
    pub(super) most: usize,
    pub(super) faults: Faults,
}

impl ViewGrid {
    /// The sheets of `faces` in the cells that `occupied` lists.
    pub(super) fn build<F: Iterator<Item = ChainFace>>(
        chain: &Chain<'_>,
        faces: impl Fn() -> F,
        view: &View,
        window: Rectangle,
        occupied: impl Fn(&Cells) -> RankedBits,
        Limits { mut side, most, faults }: Limits,
    ) -> Self {
        loop {
            let cells = Cells::over(window, side);
            let occupied = occupied(&cells);
            // With a side of one cell there is at most one pair per face, which is never too many.
            if let Some(pairs) = pairs(faces(), view, &cells, &occupied, most, faults) {
                let (pairs, starts) = by_cell(&pairs, occupied.count(), |pair| pair.slot);
                let (mut uniting, mut sheets) = (Uniting::of(chain), Vec::new());
                let (mut sheet_of, mut sheet_starts) = (Vec::with_capacity(pairs.len()), vec![0]);
                for range in starts.windows(2) {
                    let pairs = &pairs[range[0] as usize..range[1] as usize];
                    uniting.sheets(chain, pairs, faults, &mut sheets, &mut sheet_of);
                    sheet_starts.push(sheets.len() as u32);
                }
                let faces = pairs.iter().map(|pair| pair.face).collect();
                return Self { cells, occupied, starts, faces, sheet_of, sheet_starts, sheets };
            }
            side /= 2;
        }
    }

    /// The faces of a cell, their sheets as indices of `sheets`, and the range of the cell's sheets.
    pub(super) fn slot(&self, slot: u32) -> (&[u32], &[u32], Range<usize>) {
        let of = |starts: &[u32]| starts[slot as usize] as usize..starts[slot as usize + 1] as usize;
        (&self.faces[of(&self.starts)], &self.sheet_of[of(&self.starts)], of(&self.sheet_starts))
    }
}
