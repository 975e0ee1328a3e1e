//! How many casting faces a ray from the light can cross: a bound, before anything is drawn.
//!
//! The stencil count of a visible point is the number of casting faces between it and the light. Eight bits hold 255:
//! one more wraps to "lit". The count of all faces would nearly always forbid eight bits, so this looks at the faces
//! as the light sees them: each has a rectangle of directions, rounded outwards, and a quadtree over the directions
//! splits squares until fewer faces than the limit lie in each. What a ray crosses lies in the square of that ray.
//!
//! A [`View`] gives directions two coordinates. Seen from afar one view holds the whole mesh; a light near or inside
//! the mesh takes the six sides of a cube around it. Around one vertex no split parts the faces: with hundreds of
//! them the bound is larger than the truth.

use std::fmt;

use crate::geom::{Aabb, Light};
use crate::mesh::{FaceId, Mesh};

/// How many casting faces a ray from the light may cross, against a limit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DepthComplexity {
    /// Proven: every ray crosses fewer faces than the limit, and not more than this.
    Below(u32),
    /// A ray may cross as many as the limit; none crosses more than this.
    MayReach(u32),
}

impl DepthComplexity {
    /// No ray crosses more faces than this.
    #[must_use]
    pub fn at_most(self) -> u32 {
        match self {
            Self::Below(bound) | Self::MayReach(bound) => bound,
        }
    }

    /// Whether every ray is proven to cross fewer faces than the limit.
    #[must_use]
    pub fn is_below(self) -> bool {
        matches!(self, Self::Below(_))
    }
}

/// In words.
impl fmt::Display for DepthComplexity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Below(bound) => write!(f, "no ray from the light crosses more than {bound} casting faces"),
            Self::MayReach(bound) => write!(f, "a ray from the light may cross up to {bound} casting faces"),
        }
    }
}

/// Bounds how many casting faces (those whose sign is not 0) any ray from `light` crosses; asked with the counts
/// that a stencil has (256 for eight bits), [`DepthComplexity::Below`] means that it cannot wrap.
/// `limit` is at least 1; 0 is taken as 1.
///
/// Not more is worked out than the limit takes: the bound is seldom tight. Linear time for surfaces, in the number of
/// casting faces, and linear memory; where the search would take long it gives up, which may
/// miss a proof but never invents one.
///
/// Memory: at its peak 125 bytes a face where the surface is one, at most 800.
///
/// # Panics
///
/// Panics if there is not one sign a face.
///
/// ```
/// use umbrage::facing::{CasterFaces, classify};
/// use umbrage::geom::Light;
/// use umbrage::testing::shapes;
/// use umbrage::shadow::stencil::max_depth_complexity;
/// let light = Light::point([9.0, 8.0, 7.0])?;
/// let layers = |mesh| max_depth_complexity(&mesh, &CasterFaces::All.signs(&classify(&mesh, &light)), &light, 256);
/// assert!(layers(shapes::icosphere(4)).is_below());
/// assert!(!layers(shapes::nested_cubes(128)).is_below());
/// # Ok::<(), umbrage::geom::LightError>(())
/// ```
#[must_use]
pub fn max_depth_complexity(mesh: &Mesh, signs: &[i8], light: &Light, limit: u32) -> DepthComplexity {
    assert_eq!(signs.len(), mesh.face_count(), "one sign a face");
    let casting =
        || (0..signs.len()).filter(|&face| signs[face] != 0).map(|face| mesh.corners(FaceId::new(face)));
    let limit = limit.max(1);
    let count = casting().count() as u32; // face ids are 32 bits
    if count < limit {
        return DepthComplexity::Below(count);
    }
    let mut search = Search { limit, below: 0, reached: None };
    for view in View::all(&Aabb::around(casting().flatten()), light) {
        search.view(&casting().filter_map(|corners| view.see(corners)).collect::<Vec<_>>());
    }
    search.reached.map_or(DepthComplexity::Below(search.below), DepthComplexity::MayReach)
}

/// More than all roundings of one coordinate, relative to its terms (see [`View`]): 2⁻⁴⁸, or 32 of them.
const ERROR: f64 = 1.0 / (1_u64 << 48) as f64;

/// Two coordinates for the rays of a light, the same for all points of one ray: with z the distance of a point p
/// along an axis k, for the other two axes i,
///
/// `yᵢ = ((pᵢ − cᵢ) − rᵢ·(pₖ − cₖ)) / z`, z = ±(pₖ − Lₖ) for a point light, 1 for a directional one.
///
/// For c = L and r = 0 that is the plain projection onto a side of a cube. A light far away has the middle of the mesh
/// for c, and for r the slope of the ray through it, |rᵢ| ≤ 1: this shifts y by a constant, and what would cancel
/// never arises. Seven roundings lead to y, each of at most ε = 2⁻⁵³ of `(|pᵢ − cᵢ| + |pₖ − cₖ|)/z`. Since r is itself
/// rounded, off by 3ε at most, y is not quite the same along a ray, but changes by at most 3ε·|pₖ − cₖ|/z against its
/// value in the plane of c. All together 10ε; [`ERROR`] is 32ε.
#[derive(Clone, Copy, Debug)]
struct View {
    /// k, then the other two.
    axes: [usize; 3],
    /// Which way along k.
    sign: f64,
    pivot: [f64; 3],
    slope: [f64; 2],
    /// Where z = 0; `None` for a directional light.
    light: Option<f64>,
    /// |yᵢ| up to this belongs to the view.
    window: f64,
}

impl View {
    /// Views that hold all rays of `light` that meet the box.
    fn all(bounds: &Aabb, light: &Light) -> Vec<Self> {
        if bounds.is_empty() {
            return Vec::new();
        }
        let (l, center) = (light.xyz().map(f64::from), bounds.center().map(f64::from));
        let towards = if light.is_directional() { l } else { std::array::from_fn(|i| center[i] - l[i]) };
        let longest = |a: usize, b: usize| if towards[b].abs() > towards[a].abs() { b } else { a };
        let k = [1, 2].into_iter().fold(0, longest);
        let axes = [k, (k + 1) % 3, (k + 2) % 3];
        let (sign, depth) = (towards[k].signum(), towards[k].abs());
        let far = Self {
            axes,
            sign,
            pivot: center,
            slope: [axes[1], axes[2]].map(|i| towards[i] / towards[k]),
            light: (!light.is_directional()).then_some(l[k]),
            window: f64::INFINITY,
        };
        let nearest = [bounds.low[k], bounds.high[k]].map(|x| far.depth(f64::from(x)));
        // Any positive depth would do; a quarter keeps near faces from dwarfing the rest.
        if nearest[0].min(nearest[1]) > 0.25 * if light.is_directional() { 1.0 } else { depth } {
            return vec![far];
        }
        let side = |(k, sign)| Self {
            axes: [k, (k + 1) % 3, (k + 2) % 3],
            sign,
            pivot: l,
            slope: [0.0; 2],
            light: Some(l[k]),
            window: 1.0,
        };
        [0, 1, 2].into_iter().flat_map(|k| [(k, 1.0), (k, -1.0)]).map(side).collect()
    }

    /// z of a point with the coordinate `x` on the axis; its sign is exact.
    #[inline]
    fn depth(&self, x: f64) -> f64 {
        self.light.map_or(1.0, |l| self.sign * (x - l))
    }

    /// What a triangle looks like; `None` if the view holds none of its points.
    #[inline]
    fn see(&self, corners: [[f32; 3]; 3]) -> Option<Seen> {
        let [k, ..] = self.axes;
        let z = corners.map(|p| self.depth(f64::from(p[k])));
        let from_pivot = |p: [f32; 3], i: usize| f64::from(p[i]) - self.pivot[i];
        let mut rectangle = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
        let (mut places, mut off) = ([[0.0; 2]; 3], [0.0_f64; 2]);
        for i in 0..2 {
            let [low, high] = &mut rectangle[i];
            let mut numerators = [0.0; 3];
            for c in 0..3 {
                let (across, along) = (from_pivot(corners[c], self.axes[i + 1]), from_pivot(corners[c], k));
                numerators[c] = across - self.slope[i] * along;
                if z[c] > 0.0 {
                    let error = ERROR * (across.abs() + along.abs());
                    *low = low.min((numerators[c] - error) / z[c]);
                    *high = high.max((numerators[c] + error) / z[c]);
                    places[c][i] = numerators[c] / z[c];
                    off[i] = off[i].max(error / z[c]);
                }
            }
            // Along an edge that leaves z > 0, y grows without bound, to the side where the edge passes z = 0.
            for (p, q) in [(0, 1), (1, 2), (2, 0), (1, 0), (2, 1), (0, 2)] {
                if z[p] > 0.0 && z[q] <= 0.0 {
                    let terms = [numerators[p] * -z[q], numerators[q] * z[p]];
                    let (sum, error) = (terms[0] + terms[1], ERROR * (terms[0].abs() + terms[1].abs()));
                    if sum >= -error {
                        *high = f64::INFINITY;
                    }
                    if sum <= error {
                        *low = f64::NEG_INFINITY;
                    }
                }
            }
            if !(*low <= self.window && *high >= -self.window) {
                return None;
            }
            (*low, *high) = (low.max(-self.window), high.min(self.window));
        }
        Some(Seen { rectangle, corners: z.iter().all(|&z| z > 0.0).then_some(places), off })
    }
}

/// A triangle as a view sees it.
#[derive(Clone, Copy, Debug)]
struct Seen {
    /// Bounds `[low, high]` of both coordinates over all its points that the view holds.
    rectangle: [[f64; 2]; 2],
    /// Where its corners are; `None` if one of them is not in front of the light.
    corners: Option<[[f64; 2]; 3]>,
    /// How far a corner may be off.
    off: [f64; 2],
}

/// Bits of a grid coordinate; the depth of the tree.
const BITS: u32 = 16;

/// A triangle on the grid.
#[derive(Clone, Copy)]
struct Cells {
    /// First and last column, first and last row.
    bounds: [u16; 4],
    seen: u32,
}

/// How a triangle lies on a square.
#[derive(PartialEq)]
enum Overlap {
    None,
    /// It may or may not have points in any part of the square.
    Some,
    /// About all of it. (Only a guide: counting too much is safe.)
    All,
}

/// The square's middle, and half its side in both coordinates, slightly widened.
struct Place {
    middle: [f64; 2],
    half: [f64; 2],
}

impl Seen {
    /// `None` is certain: the line of an edge has the triangle on one side and the square on the other.
    ///
    /// The square is widened by what the corners may be off; then they count as exact. Of the values that
    /// are compared none errs by more than 16 roundings of its terms; [`ERROR`] is 32.
    fn overlap(&self, place: &Place) -> Overlap {
        let Some(corners) = self.corners else { return Overlap::All };
        let half = [place.half[0] + self.off[0], place.half[1] + self.off[1]];
        let mut all = true;
        for k in 0..3 {
            let [a, b, c] = [corners[k], corners[(k + 1) % 3], corners[(k + 2) % 3]];
            let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
            let height = |p: [f64; 2]| {
                let terms = [dx * (p[1] - a[1]), dy * (p[0] - a[0])];
                (terms[0] - terms[1], terms[0].abs() + terms[1].abs())
            };
            let ((third, terms), (middle, more)) = (height(c), height(place.middle));
            let reach = dx.abs() * half[1] + dy.abs() * half[0];
            let error = ERROR * (terms + more + reach);
            if middle + reach + error < third.min(0.0) || middle - reach - error > third.max(0.0) {
                return Overlap::None;
            }
            all &= if third > 0.0 { middle >= reach } else { -middle >= reach };
        }
        if all { Overlap::All } else { Overlap::Some }
    }
}

/// The search through one view after another.
struct Search {
    limit: u32,
    /// The most faces in a square with fewer than `limit`.
    below: u32,
    /// The most that a square may hold, once one could not be brought below `limit`.
    reached: Option<u32>,
}

/// A square of 2^`bits` cells a side, whose children before `child` are done.
struct Square {
    x: u32,
    y: u32,
    bits: u32,
    /// How many faces cover all of it.
    covering: u32,
    /// Where the others stand in the list.
    start: usize,
    end: usize,
    child: u32,
}

impl Square {
    /// The most faces that a ray through it can cross.
    fn count(&self) -> u32 {
        self.covering + (self.end - self.start) as u32
    }
}

impl Search {
    /// Depth first, with one list that grows and shrinks: a square's faces stand behind its parent's.
    fn view(&mut self, seen: &[Seen]) {
        let grid = Grid::over(seen);
        let mut list = grid.cells(seen);
        let whole = Square { x: 0, y: 0, bits: BITS, covering: 0, start: 0, end: list.len(), child: 0 };
        let mut squares = Vec::from_iter(self.open(whole));
        let mut work = 64 * list.len() + (1 << 20);
        while let Some(parent) = squares.last_mut() {
            let (from, to) = (parent.start, parent.end);
            if parent.child == 4 {
                list.truncate(from);
                squares.pop();
                continue;
            }
            let bits = parent.bits - 1;
            let (x, y) = (parent.x + ((parent.child & 1) << bits), parent.y + ((parent.child >> 1) << bits));
            let covering = parent.covering;
            parent.child += 1;
            let last = (1 << bits) - 1;
            for k in from..to {
                let cells = list[k];
                let [x0, x1, y0, y1] = cells.bounds.map(u32::from);
                if x0 <= x + last && x <= x1 && y0 <= y + last && y <= y1 {
                    list.push(cells);
                }
            }
            let mut square = Square { x, y, bits, covering, start: to, end: list.len(), child: 0 };
            if square.count() >= self.limit {
                let place = grid.place(&square);
                let mut kept = to;
                for k in to..list.len() {
                    let cells = list[k];
                    let [x0, x1, y0, y1] = cells.bounds.map(u32::from);
                    // Most are small and lie well inside: nothing to look at.
                    let inside = x <= x0 && x1 <= x + last && y <= y0 && y1 <= y + last;
                    let covers = x0 <= x && x + last <= x1 && y0 <= y && y + last <= y1;
                    match if inside { Overlap::Some } else { seen[cells.seen as usize].overlap(&place) } {
                        Overlap::None => continue,
                        Overlap::All if covers => square.covering += 1,
                        _ => {
                            list[kept] = cells;
                            kept += 1;
                        }
                    }
                }
                list.truncate(kept);
                square.end = kept;
            }
            match self.open(square) {
                Some(square) => squares.push(square),
                None => list.truncate(to),
            }
            let Some(rest) = work.checked_sub(to - from) else {
                // Nothing is known of what is left but how many faces it may hold.
                self.reached = self.reached.max(squares.iter().map(Square::count).max());
                return;
            };
            work = rest;
        }
    }

    /// Decides what it can of a square; gives it back if it must be split.
    fn open(&mut self, square: Square) -> Option<Square> {
        let count = square.count();
        if count < self.limit {
            self.below = self.below.max(count);
            return None;
        }
        if self.reached.is_some_and(|most| count <= most) {
            return None;
        }
        // Where so many cover the square, no split brings it below the limit.
        if square.covering >= self.limit || square.bits == 0 {
            self.reached = Some(count);
            return None;
        }
        Some(square)
    }
}

/// 2^[`BITS`] columns and rows over all rectangles.
///
/// A place and the bounds around it go through one monotonous function, rounding and all: what lies between two
/// bounds lies in a cell from the first to the last.
struct Grid {
    low: [f64; 2],
    /// Cells a unit.
    scale: [f64; 2],
}

impl Grid {
    fn over(seen: &[Seen]) -> Self {
        let low = [0, 1].map(|i| seen.iter().map(|s| s.rectangle[i][0]).fold(f64::INFINITY, f64::min));
        let high = [0, 1].map(|i| seen.iter().map(|s| s.rectangle[i][1]).fold(f64::NEG_INFINITY, f64::max));
        let cells = f64::from(1 << BITS);
        Self { low, scale: [0, 1].map(|i| if high[i] > low[i] { cells / (high[i] - low[i]) } else { 0.0 }) }
    }

    fn cell(&self, i: usize, y: f64) -> u16 {
        ((y - self.low[i]) * self.scale[i]) as u16 // saturates
    }

    fn cells(&self, seen: &[Seen]) -> Vec<Cells> {
        let cells = |(k, s): (usize, &Seen)| {
            let [x, y] = s.rectangle;
            let bounds = [self.cell(0, x[0]), self.cell(0, x[1]), self.cell(1, y[0]), self.cell(1, y[1])];
            Cells { bounds, seen: k as u32 } // at most as many as faces
        };
        seen.iter().enumerate().map(cells).collect()
    }

    /// Where all places of a square's cells lie: an eighth of a cell wider than it, which is far more than the
    /// roundings of a number of 16 bits and of a place on a grid that is not finer than `f64`.
    fn place(&self, square: &Square) -> Place {
        let side = f64::from(1_u32 << square.bits);
        let corner = [square.x, square.y].map(f64::from);
        let middle = [0, 1].map(|i| self.low[i] + (corner[i] + 0.5 * side) / self.scale[i]);
        // `low` may outweigh a cell: then its own rounding counts.
        let half = [0, 1]
            .map(|i| (0.5 * side + 0.125) / self.scale[i] + ERROR * (self.low[i].abs() + middle[i].abs()));
        Place { middle, half }
    }
}
