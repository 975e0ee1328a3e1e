//! Soft verdicts: whether a light with an extent is wholly visible, wholly hidden, or neither for sure.
//!
//! # How far rays leave the cell
//!
//! A light of radius ρ around L is the set of the points L + ρe, |e| ≤ 1. Let d be the depth z of a point p,
//! and s its slopes `(pᵢ − Lᵢ)/d`. A ray from p to L + ρe is at depth z at the parameter
//! `t = (d − z)/(d − ρeₖ) ≤ (d − z)/(d − ρ)`, and there `yᵢ − yᵢ(p) = tρ(eᵢ − sᵢeₖ)/z`. So |y − y(p)| is at most
//!
//! `ρ·√(1 + sᵢ²)·(d − z)/(z·(d − ρ))`, which falls with z.
//!
//! A sun with the tangent ρ is the set of the directions l + ρu, l of length 1, u ⟂ l, |u| ≤ 1. After a climb h
//! along the axis, `|y − y(p)| ≤ ρ·√(1 + sᵢ²)·h/(|lₖ| − ρ)`, with the slopes s of l.
//!
//! # How near to the light a face may be
//!
//! Let D = |p − L|, and let no face be nearer to L than R. A point of a ray with a depth of at most z₀ has a
//! distance from L of at most `ρ + D·(z₀ + ρ)/(d − ρ)`, since 1 − t is at most (z₀ + ρ)/(d − ρ). So nothing
//! blocks a ray beyond the depth `z₀ = (R − ρ)(d − ρ)/D − ρ`, and of all faces those parts alone count whose
//! depth is more than that.
//!
//! All of this is computed with fewer than 64 roundings, each of at most 2⁻⁵³ of the terms that are added up;
//! [`SLACK`] of these terms is added on the safe side.

use super::bits::RankedBits;
use super::cells::Cells;
use super::chain::Chain;
use super::fault::{Fault, Faults};
use super::grid::{LightGrid, Limits, Rectangle, ViewGrid, most_pairs, rectangle, window_around};
use super::sheets::Sheet;
use super::view::{Projected, View};
use crate::geom::Aabb;
use crate::geom::predicate::{Homogeneous, height, side_of_light, side_of_point};
use crate::oracle::PrimaryHit;
use crate::scene::{Lamp, LampShape};

/// See the head of this file.
const SLACK: f64 = 1.0 / (1_u64 << 40) as f64;

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

/// The size of a light, and what is near it.
#[derive(Clone, Copy, Debug)]
struct Extent {
    /// ρ: a radius, or the tangent of an angle.
    radius: f64,
    /// Least distance of a face from a point light.
    clearance: f64,
    casting: Aabb,
}

impl<'a> SoftGrid<'a> {
    /// The grid over given points, `side` cells along each side of each view; at most 4096. A rectangle is taken
    /// as the ball around it.
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
    /// *Lit*: no face in the cells that the rays pass through is nearer to the light than the point. *Dark*: in
    /// these cells all of some shell is nearer than the point, no boundary of it meets them, and its sheets are
    /// crossed. Then a path from below all of it to above all of it crosses it, whatever its slope.
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

/// Whether some shell hides the light from all points below a nearness, along rays that stay in these cells up
/// to another nearness.
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

impl Extent {
    fn of(chain: &Chain<'_>, lamp: &Lamp) -> Self {
        let length = |v: [f64; 3]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
        let light = lamp.light().xyz().map(f64::from);
        let radius = match &lamp.shape {
            LampShape::Hard(_) => 0.0,
            LampShape::Disk { radius, .. } => f64::from(*radius),
            LampShape::Sun { half_angle_rad, .. } => f64::from(*half_angle_rad).tan(),
            LampShape::Rectangle(rectangle) => {
                let [u, v] = rectangle.edges().map(|edge| edge.map(f64::from));
                let diagonal = |sign: f64| length([0, 1, 2].map(|i| u[i] + sign * v[i]));
                // The center is rounded to `f32`, by 2⁻²⁴ of a coordinate.
                0.5 * diagonal(1.0).max(diagonal(-1.0)) + length(light) / f64::from(1 << 23)
            }
        };
        let mut clearance = f64::INFINITY;
        for face in chain.all_faces() {
            let bounds = Aabb::around(face.corners);
            let gap =
                |i: usize| (f64::from(bounds.low[i]) - light[i]).max(light[i] - f64::from(bounds.high[i]));
            clearance = clearance.min(length([0, 1, 2].map(|i| gap(i).max(0.0))));
        }
        let casting = Aabb::around(chain.all_faces().flat_map(|face| face.corners));
        Self { radius: radius * (1.0 + SLACK), clearance: clearance * (1.0 - SLACK), casting }
    }

    /// The nearness beyond which nothing blocks a ray of a point; `None` if there is none.
    fn start(&self, chain: &Chain<'_>, view: &View, p: [f32; 3], projected: &Projected) -> Option<f64> {
        if chain.light().is_directional() {
            let [of_low, of_high] = [self.casting.low, self.casting.high].map(|p| view.project(p).height);
            let top = of_low.max(of_high);
            return (!self.casting.is_empty()).then_some(top + SLACK * top.abs());
        }
        let light = chain.light().xyz();
        let away = [0, 1, 2].map(|i| f64::from(p[i]) - f64::from(light[i]));
        let distance = away.iter().map(|x| x * x).sum::<f64>().sqrt();
        let depth = projected.at[2];
        let free = (self.clearance - self.radius) * (depth - self.radius) / distance;
        let free = free - self.radius - SLACK * (free.abs() + self.radius);
        let is_clear = free > 0.0 && self.clearance > self.radius && depth > self.radius;
        let nearness = view.nearness_at(free.min(depth));
        (is_clear && nearness.is_finite()).then_some(nearness + SLACK * (1.0 + nearness.abs()))
    }

    /// Bounds of |y − y(p)| for all rays of a point up to a nearness.
    fn reach(
        &self,
        chain: &Chain<'_>,
        view: &View,
        p: [f32; 3],
        projected: &Projected,
        top: f64,
    ) -> [f64; 2] {
        let [k, i, j] = view.axes();
        let l = chain.light().xyz().map(f64::from);
        let widened =
            |slope: f64, share: f64| self.radius * (1.0 + slope * slope).sqrt() * share * (1.0 + SLACK);
        if chain.light().is_directional() {
            let length = l.iter().map(|x| x * x).sum::<f64>().sqrt();
            let climb = (top - projected.height).max(0.0) + SLACK * (top.abs() + projected.height.abs());
            let left = l[k].abs() / length * (1.0 - SLACK) - self.radius;
            let share = if left > 0.0 { climb / left } else { f64::INFINITY };
            return view.slope().map(|slope| widened(slope, share));
        }
        let depth = projected.at[2];
        let least = view.depth_at(top) * (1.0 - SLACK);
        let left = least * (depth - self.radius) * (1.0 - SLACK);
        let share = ((depth - least).max(0.0) + SLACK * depth) / left;
        let share = if least > 0.0 && left > 0.0 { share } else { f64::INFINITY };
        [i, j].map(|axis| widened((f64::from(p[axis]) - l[axis]) / depth, share))
    }

    /// Whether a visible point, and all of the light, are in front of the visible face, on one side of it.
    fn is_before(&self, chain: &Chain<'_>, hit: &PrimaryHit) -> bool {
        let side = side_of_light(hit.corners, chain.light());
        if side.is_zero() || side_of_point(hit.corners, hit.point) != side {
            return false;
        }
        let [a, b, c] = hit.corners.map(|corner| corner.map(f64::from));
        let (u, v) = ([0, 1, 2].map(|i| b[i] - a[i]), [0, 1, 2].map(|i| c[i] - a[i]));
        let normal = [0, 1, 2].map(|i| u[(i + 1) % 3] * v[(i + 2) % 3] - u[(i + 2) % 3] * v[(i + 1) % 3]);
        let length = |v: [f64; 3]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
        let reach =
            if chain.light().is_directional() { length(chain.light().xyz().map(f64::from)) } else { 1.0 };
        // The cross product errs by a few roundings of the product of the lengths.
        let most = self.radius * reach * (length(normal) + SLACK * length(u) * length(v)) * (1.0 + SLACK);
        // Its relative error is 2⁻³⁹.
        height(hit.corners, Homogeneous::light(chain.light())).abs() * (1.0 - 8.0 * SLACK) > most
    }
}
