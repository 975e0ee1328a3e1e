//! Soft verdicts: whether a light with an extent is wholly visible, wholly hidden, or neither for sure.

use super::bits::RankedBits;
use super::cells::Cells;
use super::chain::Chain;
use super::extent::Extent;
use super::fault::{Fault, Faults};
use super::grid::{LightGrid, Limits, Rectangle, ViewGrid, most_pairs, rectangle, window_around};
use super::sheets::Sheet;
use super::view::View;
use crate::geom::Aabb;
use crate::geom::predicate::side_of_point;
use crate::oracle::PrimaryHit;
use crate::scene::Lamp;

/// Bound of |y| in the views of a cube: rays leave the side of the cube that they begin in.
const WINDOW: f64 = 1.5;

/// Most cells that one verdict looks at.
const MOST_CELLS: u32 = 1 << 12;

/// What the grid proves about a point and a light with an extent.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum SoftVerdict {
    /// The light is wholly visible.
    Lit,
    /// The light is wholly hidden.
    Dark,
    /// Neither is proven: the point may be in a penumbra.
    Maybe,
}

/// What a light with an extent sees, conservatively, in cells: a [`LightGrid`] of its center, in all cells
/// that a ray may pass through.
///
/// ```
/// use umbrage::caster::{Caster, CasterGroup};
/// use umbrage::light_grid::{Chain, SoftGrid, SoftVerdict};
/// use umbrage::scene::Lamp;
/// use umbrage::testing::shapes;
///
/// let caster = Caster::new(shapes::cube());
/// let casters = CasterGroup::new(vec![&caster]);
/// let lamp: Lamp = "point:0.1,0.2,9,radius=0.1".parse()?;
/// let chain = Chain::of(&casters, lamp.light());
/// let points = [[0.2, 0.1, -2.0], [1.35, 0.1, -2.0], [4.0, 3.0, -2.0]];
/// let grid = SoftGrid::build(&chain, &lamp, points, 64);
/// let verdicts = points.map(|p| grid.verdict_at(p));
/// assert_eq!(verdicts, [SoftVerdict::Dark, SoftVerdict::Maybe, SoftVerdict::Lit]);
/// # Ok::<(), umbrage::scene::LampError>(())
/// ```
#[derive(Clone, Debug)]
pub struct SoftGrid<'a> {
    grid: LightGrid<'a>,
    extent: Extent,
}

impl<'a> SoftGrid<'a> {
    /// The grid over given points, `side` cells along each side of each view; at most 4096. A rectangle is
    /// taken as the ball around it.
    ///
    /// # Panics
    ///
    /// Panics if the chain is not that of the lamp's center.
    #[must_use]
    pub fn build(
        chain: &'a Chain<'a>,
        lamp: &Lamp,
        points: impl IntoIterator<Item = [f32; 3], IntoIter: Clone>,
        side: u32,
    ) -> Self {
        Self::build_with(chain, lamp, points.into_iter(), side, Faults::default())
    }

    pub(super) fn build_with(
        chain: &'a Chain<'a>,
        lamp: &Lamp,
        points: impl Iterator<Item = [f32; 3]> + Clone,
        side: u32,
        faults: Faults,
    ) -> Self {
        assert_eq!(chain.light(), lamp.light(), "the chain of another light");
        let views = View::all_with(&Aabb::around(points.clone()), chain.light(), WINDOW);
        let extent = Extent::of(chain, lamp);
        // Every cell of the window may be passed through.
        let most = most_pairs(chain.face_count());
        let limits = Limits { side: side.clamp(1, 4096), most, faults };
        let grid = |number: usize| {
            let view = &views[number];
            let inside = points.clone().filter(|&p| View::holding(&views, p) == number);
            let around = |p| {
                let projected = view.project(p);
                let own = rectangle(view, &projected)?;
                let start = extent.start(chain, view, p, &projected);
                let reach = start.map_or([0.0; 2], |top| extent.reach(chain, view, p, &projected, top));
                Some((own, [0, 1].map(|i| [own[i][0] - reach[i], own[i][1] + reach[i]])))
            };
            let rectangles = inside.filter_map(around);
            let own = window_around(rectangles.clone().map(|(own, _)| own))?;
            let wide = window_around(rectangles.map(|(_, wide)| wide))?;
            // Far rays are left undecided, rather than all cells large.
            let window = [0, 1].map(|i| {
                let [low, high] = own[i];
                let most = high - low;
                [
                    wide[i][0].max(low - most).max(-view.window()),
                    wide[i][1].min(high + most).min(view.window()),
                ]
            });
            let all = |cells: &Cells| RankedBits::all(cells.count());
            let casting =
                || chain.all_faces().filter(move |face| face.sign != 0 || !faults.has(Fault::EdgeOnLeftOut));
            Some(ViewGrid::build(chain, casting, view, window, all, limits))
        };
        let grids = (0..views.len()).map(grid).collect();
        Self { grid: LightGrid { chain, views, grids, faults }, extent }
    }

    /// What is proven about a point that need not lie on a face.
    #[must_use]
    pub fn verdict_at(&self, p: [f32; 3]) -> SoftVerdict {
        self.decide(p, None).unwrap_or(SoftVerdict::Maybe)
    }

    /// What is proven about a visible point.
    ///
    /// As [`SoftGrid::verdict_at`], but faces on or behind the plane of the visible face hide nothing where
    /// the point and all of the light are in front of it.
    #[must_use]
    pub fn verdict(&self, hit: &PrimaryHit) -> SoftVerdict {
        self.decide(hit.point, Some(hit)).unwrap_or(SoftVerdict::Maybe)
    }

    /// `None` where nothing is proven.
    ///
    /// *Lit*: no face in the cells that the rays pass through is nearer to the light than the point. *Dark*:
    /// in these cells all of some shell is nearer than the point, no boundary of it meets them, and its
    /// sheets are crossed. Then a path from below all of it to above all of it crosses it, whatever its
    /// slope.
    fn decide(&self, p: [f32; 3], own: Option<&PrimaryHit>) -> Option<SoftVerdict> {
        let (chain, faults) = (self.grid.chain, self.grid.faults);
        let number = View::holding(&self.grid.views, p);
        let (view, grid) = (self.grid.views.get(number)?, self.grid.grids[number].as_ref()?);
        let projected = view.project(p);
        let y = rectangle(view, &projected)?;
        let [least, most] = projected.nearness();
        let start = self.extent.start(chain, view, p, &projected)?;
        let around = |top| {
            let reach = self.extent.reach(chain, view, p, &projected, top);
            let reach = if faults.has(Fault::NoReach) { [0.0; 2] } else { reach };
            let rectangle: Rectangle = [0, 1].map(|i| [y[i][0] - reach[i], y[i][1] + reach[i]]);
            let [columns, rows] = grid.cells.all_of(&rectangle)?;
            let [width, height] = [columns, rows].map(|[first, last]| last - first + 1);
            (width.saturating_mul(height) <= MOST_CELLS).then_some([columns, rows])
        };
        let (mut top, mut cells) = (start, around(start)?);
        for _ in 0..3 {
            let near =
                sheets(grid, cells).fold(f64::NEG_INFINITY, |near, (sheet, _)| near.max(sheet.near.into()));
            let low = near.min(start);
            if low < least {
                return Some(SoftVerdict::Lit);
            }
            if low >= top {
                break;
            }
            (top, cells) = (low, around(low)?);
        }
        if hides_all(chain, grid, cells, [most, top]) {
            return Some(SoftVerdict::Dark);
        }
        let hit = own.filter(|hit| self.extent.is_before(chain, hit))?;
        let is_left_out = |sheet: &Sheet, index: u32, slot: u32| {
            if faults.has(Fault::OwnLeftOut) && !sheet.is_outline {
                return true;
            }
            let (faces, sheet_of, _) = grid.slot(slot);
            let own = faces.iter().zip(sheet_of).filter(|(_, of)| **of == index);
            let side = side_of_point(hit.corners, hit.point);
            own.flat_map(|(face, _)| chain.corners(*face)).all(|v| side_of_point(hit.corners, v) != side)
        };
        let mut all = sheets(grid, cells);
        all.all(|(sheet, [index, slot])| f64::from(sheet.near) < least || is_left_out(sheet, index, slot))
            .then_some(SoftVerdict::Lit)
    }

    /// Memory in bytes, without the chain.
    #[must_use]
    pub fn bytes(&self) -> usize {
        self.grid.bytes()
    }
}

/// The sheets of some cells, each with its index and the cell's.
fn sheets(grid: &ViewGrid, [columns, rows]: [[u32; 2]; 2]) -> impl Iterator<Item = (&Sheet, [u32; 2])> {
    let numbers = (rows[0]..=rows[1]).flat_map(move |y| (columns[0]..=columns[1]).map(move |x| [x, y]));
    numbers.filter_map(|[x, y]| grid.occupied.rank(grid.cells.number(x, y))).flat_map(move |slot| {
        let (_, _, range) = grid.slot(slot);
        range.map(move |index| (&grid.sheets[index], [index as u32, slot]))
    })
}

/// Whether some shell hides the light from all points below a nearness, along rays that stay in these cells
/// up to another nearness.
fn hides_all(chain: &Chain<'_>, grid: &ViewGrid, cells: [[u32; 2]; 2], [below, above]: [f64; 2]) -> bool {
    let mut shells: Vec<([u32; 2], bool, bool)> = sheets(grid, cells)
        .map(|(sheet, _)| {
            let is_between = f64::from(sheet.far) > below && f64::from(sheet.near) <= above;
            (chain.shell(sheet.face), is_between && !sheet.is_outline, sheet.covers())
        })
        .collect();
    shells.sort_unstable();
    let mut of_shell = shells.chunk_by(|a, b| a.0 == b.0);
    of_shell.any(|sheets| sheets.iter().all(|sheet| sheet.1) && sheets.iter().any(|sheet| sheet.2))
}
