//! Which faces may shadow a point: those before it in its cell that nothing hides.

use super::bits::RankedBits;
use super::cells::Cells;
use super::chain::Chain;
use super::fault::Faults;
use super::grid::{LightGrid, Limits, Place, Rectangle, ViewGrid, most_pairs, rectangle, window_around};
use super::verdict::{GridVerdict, verdict};
use super::view::View;
use crate::geom::Aabb;
use crate::oracle::PrimaryHit;

/// A grid that has the sheets of every cell that a point may lie in, and what hides them.
#[derive(Clone, Debug)]
pub(crate) struct Occluders<'a> {
    grid: LightGrid<'a>,
    /// For each cell with a point, view by view, the greatest nearness that some sheet has all over the cell.
    covers: Vec<Vec<f32>>,
    placed: Vec<Placed>,
}

/// Where a point lies: in a view, at a nearness.
#[derive(Clone, Copy, Debug)]
struct Placed {
    view: usize,
    y: Rectangle,
    nearness: [f64; 2],
}

impl<'a> Occluders<'a> {
    /// The grid over given points; `None` if a point is not surely in a view, as next to the light.
    pub(crate) fn build(
        chain: &'a Chain<'a>,
        points: impl Iterator<Item = [f32; 3]> + Clone,
        side: u32,
    ) -> Option<Self> {
        let views = View::all(&Aabb::around(points.clone()), chain.light());
        let place = |p: [f32; 3]| {
            let number = View::holding(&views, p);
            let view = views.get(number)?;
            let projected = view.project(p);
            let y = rectangle(view, &projected)?;
            Some(Placed { view: number, y, nearness: projected.nearness() })
        };
        let placed = points.map(place).collect::<Option<Vec<_>>>()?;
        let (most, faults) = (most_pairs(chain.face_count()), Faults::default());
        let grid = |number: usize| {
            let rectangles = placed.iter().filter(|placed| placed.view == number).map(|placed| placed.y);
            let window = window_around(rectangles.clone())?;
            let occupied = |cells: &Cells| {
                let numbers = rectangles.clone().flat_map(|y| numbers(cells, y));
                RankedBits::of(numbers, cells.count())
            };
            let limits = Limits { side, most, faults };
            Some(ViewGrid::build(chain, || chain.faces(), &views[number], window, occupied, limits))
        };
        let grids: Vec<Option<ViewGrid>> = (0..views.len()).map(grid).collect();
        let covers = grids.iter().map(|grid| grid.as_ref().map_or(Vec::new(), covers)).collect();
        Some(Self { grid: LightGrid { chain, views, grids, faults }, covers, placed })
    }

    /// Calls `keep` with a face of each sheet that may shadow the visible point `index`, of those whose faces
    /// are `asked` for.
    ///
    /// A sheet does not shadow a point if all of it is farther from the light, or if it holds the visible
    /// face and no ray crosses it twice. It makes no point dark that is not dark without it, if another sheet
    /// that every ray of the cell meets is nearer to the light.
    pub(crate) fn for_each_before(
        &self,
        index: usize,
        hit: &PrimaryHit,
        asked: impl Fn(u32) -> bool,
        mut keep: impl FnMut(u32),
    ) {
        let Placed { view, y, nearness } = self.placed[index];
        let Some(grid) = &self.grid.grids[view] else { return };
        for slot in numbers(&grid.cells, y).filter_map(|number| grid.occupied.rank(number)) {
            let (_, _, range) = grid.slot(slot);
            let cover = self.covers[view][slot as usize];
            for (number, sheet) in grid.sheets[range].iter().enumerate() {
                let is_before = f64::from(sheet.near) >= nearness[0] && cover <= sheet.near;
                if is_before && asked(sheet.face) {
                    let place = self.place(grid, index, slot);
                    if !self.grid.is_own(&place, number, hit) {
                        keep(sheet.face);
                    }
                }
            }
        }
    }

    /// What is proven about the visible point `index`.
    pub(crate) fn verdict(&self, index: usize, hit: &PrimaryHit) -> GridVerdict {
        let Placed { view, y, .. } = self.placed[index];
        let slot = (self.grid.grids[view].as_ref())
            .and_then(|grid| Some((grid, grid.occupied.rank(grid.cells.one_of(&y)?)?)));
        let Some((grid, slot)) = slot else { return GridVerdict::Undecided };
        let place = self.place(grid, index, slot);
        verdict(&place, |number| self.grid.is_own(&place, number, hit))
    }

    fn place<'b>(&'b self, grid: &'b ViewGrid, index: usize, slot: u32) -> Place<'b> {
        let Placed { view, y, nearness } = self.placed[index];
        let (faces, sheet_of, sheets) = grid.slot(slot);
        Place {
            view: &self.grid.views[view],
            y,
            nearness,
            first_sheet: sheets.start as u32,
            sheets: &grid.sheets[sheets],
            faces,
            sheet_of,
        }
    }
}

/// The numbers of the cells that hold a rectangle.
fn numbers(cells: &Cells, y: Rectangle) -> impl Iterator<Item = u32> + use<> {
    let cells = *cells;
    let [columns, rows] = cells.of(&y).unwrap_or([[1, 0]; 2]);
    (rows[0]..=rows[1]).flat_map(move |y| (columns[0]..=columns[1]).map(move |x| cells.number(x, y)))
}

/// For each cell, the greatest nearness that some sheet has all over it.
fn covers(grid: &ViewGrid) -> Vec<f32> {
    let cover = |slot: u32| {
        let (_, _, range) = grid.slot(slot);
        let covering = grid.sheets[range].iter().filter(|sheet| sheet.covers());
        covering.fold(f32::NEG_INFINITY, |most, sheet| most.max(sheet.far))
    };
    (0..grid.occupied.count()).map(cover).collect()
}
