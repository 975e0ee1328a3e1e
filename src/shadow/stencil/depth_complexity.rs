//! Depth complexity seen from the light: an upper bound of the stencil counts, before anything is drawn.
//!
//! The stencil count of a visible point is the number of casting faces between the point and the light. Eight
//! bits hold 255; a count of 256 wraps to "lit". The number of all faces is nearly always too large a bound,
//! so the faces are tested as the light sees them. Each face has a rectangle of directions, rounded outwards.
//! A quadtree over the directions splits squares until fewer faces than the limit lie in each square. All
//! faces that a ray crosses lie in the square that contains the ray's direction.
//!
//! A [`View`] gives directions two coordinates. One view holds the whole mesh if the light is far away. A
//! light near or inside the mesh takes the six sides of a cube around the light. No split separates the faces
//! around one vertex, so with hundreds of such faces the bound is larger than the truth.

use std::fmt;

use crate::geom::{Aabb, Light};
use crate::mesh::{FaceId, Mesh};

/// Bound of the number of casting faces that a ray from the light may cross, compared with a limit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DepthComplexity {
    /// Proven: every ray crosses fewer faces than the limit, and at most this number.
    Below(u32),
    /// A ray may cross as many faces as the limit; no ray crosses more than this number.
    MayReach(u32),
}

impl DepthComplexity {
    /// The bound: no ray crosses more faces.
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

/// The bound as a sentence.
impl fmt::Display for DepthComplexity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Below(bound) => write!(f, "no ray from the light crosses more than {bound} casting faces"),
            Self::MayReach(bound) => write!(f, "a ray from the light may cross up to {bound} casting faces"),
        }
    }
}

/// Bounds the number of casting faces (faces whose sign is not 0) that any ray from `light` crosses. With a
/// stencil's number of values as `limit` (256 for eight bits), [`DepthComplexity::Below`] means that the
/// stencil cannot wrap. `limit` is at least 1; 0 is taken as 1.
///
/// The search stops as soon as the limit is decided, so the bound is rarely tight. Cost: linear time for
/// surfaces, in the number of casting faces, and linear memory. A search that would take long gives up, which
/// may miss a proof but never invents one.
///
/// Memory: at most 125 bytes per face at its peak if the mesh is a surface, otherwise at most 800.
///
/// # Panics
///
/// Panics if there is not one sign per face.
///
/// ```
/// use umbrage::facing::{CasterFaces, classify};
/// use umbrage::geom::Light;
/// use umbrage::mesh::Mesh;
/// use umbrage::shadow::stencil::max_depth_complexity;
/// use umbrage::testing::shapes;
/// let light = Light::point([9.0, 8.0, 7.0])?;
/// let signs = |mesh: &Mesh| CasterFaces::All.signs(&classify(mesh, &light));
/// let bound = |mesh: &Mesh| max_depth_complexity(mesh, &signs(mesh), &light, 256);
/// assert!(bound(&shapes::icosphere(4)).is_below());
/// assert!(!bound(&shapes::nested_cubes(128)).is_below());
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

/// Upper bound of all roundings of one coordinate, relative to its terms (see [`View`]): 2⁻⁴⁸, or 32
/// roundings.
const ERROR: f64 = 1.0 / (1_u64 << 48) as f64;

/// Two coordinates for the rays of a light, equal for all points of one ray. Let z be the distance of a point
/// p along an axis k. Then for each of the other two axes i,
///
/// `yᵢ = ((pᵢ − cᵢ) − rᵢ·(pₖ − cₖ)) / z`, z = ±(pₖ − Lₖ) for a point light, 1 for a directional one.
///
/// With c = L and r = 0 this is the plain projection onto a side of a cube. For a light far away, c is the
/// center of the mesh, and r is the slope of the ray through c, |rᵢ| ≤ 1. This choice shifts y by a constant,
/// and avoids cancellation. Seven roundings lead to y, each of at most ε = 2⁻⁵³ of
/// `(|pᵢ − cᵢ| + |pₖ − cₖ|)/z`. Since r is itself rounded, with an error of 3ε at most, y is not quite
/// constant along a ray: y differs from its value in the plane of c by at most 3ε·|pₖ − cₖ|/z. The sum is
/// 10ε; [`ERROR`] is 32ε.
#[derive(Clone, Copy, Debug)]
struct View {
    /// Axis k, then the other two axes.
    axes: [usize; 3],
    /// Direction of the view along axis k: 1 or −1.
    sign: f64,
    pivot: [f64; 3],
    slope: [f64; 2],
    /// Coordinate Lₖ of a point light, where z = 0; `None` for a directional light.
    light: Option<f64>,
    /// Bound of |yᵢ| for the points that belong to the view.
    window: f64,
}

impl View {
    /// The views that together hold all rays of `light` that meet the box.
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
        // Any positive depth would be correct. A quarter of the depth keeps near faces from dwarfing the
        // rest.
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

    /// The distance z of a point whose coordinate on axis k is `x`. The sign of z is exact.
    #[inline]
    fn depth(&self, x: f64) -> f64 {
        self.light.map_or(1.0, |l| self.sign * (x - l))
    }

    /// The projection of a triangle; `None` if the view holds none of the triangle's points.
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
            // Along an edge that leaves z > 0, y grows without bound, towards the side on which the edge
            // crosses z = 0.
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

/// A triangle as projected by a view.
#[derive(Clone, Copy, Debug)]
struct Seen {
    /// Bounds `[low, high]` of both coordinates over all of the triangle's points that the view holds.
    rectangle: [[f64; 2]; 2],
    /// The projected corners; `None` if a corner is not in front of the light.
    corners: Option<[[f64; 2]; 3]>,
    /// Bound of the corners' error, per coordinate.
    off: [f64; 2],
}

/// Bits per grid coordinate, and depth of the quadtree.
const BITS: u32 = 16;

/// A triangle's rectangle on the grid.
#[derive(Clone, Copy)]
struct Cells {
    /// First and last column, first and last row.
    bounds: [u16; 4],
    seen: u32,
}

/// Overlap of a triangle and a square.
#[derive(PartialEq)]
enum Overlap {
    None,
    /// The triangle may or may not have points in any part of the square.
    Some,
    /// The triangle covers about all of the square. (This only guides the search: overcounting is safe.)
    All,
}

/// Center of a square and half its side, in both coordinates, slightly enlarged.
struct Place {
    middle: [f64; 2],
    half: [f64; 2],
}

impl Seen {
    /// Overlap of the triangle and a square. `None` is certain: the line of an edge separates the triangle
    /// from the square.
    ///
    /// The square is enlarged by the error bound of the corners; then the corners count as exact. No compared
    /// value has an error of more than 16 roundings of its terms; [`ERROR`] is 32 roundings.
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

/// The quadtree search, through one view after another.
struct Search {
    limit: u32,
    /// The highest face count of a square with fewer faces than `limit`.
    below: u32,
    /// The highest face count of a square that could not be brought below `limit`; `None` without such a
    /// square.
    reached: Option<u32>,
}

/// A square of 2^`bits` cells per side. Its children before `child` are done.
struct Square {
    x: u32,
    y: u32,
    bits: u32,
    /// Number of faces that cover the whole square.
    covering: u32,
    /// Range `start..end` of the other faces in the list.
    start: usize,
    end: usize,
    child: u32,
}

impl Square {
    /// Upper bound of the number of faces that a ray through the square can cross.
    fn count(&self) -> u32 {
        self.covering + (self.end - self.start) as u32
    }
}

impl Search {
    /// Depth-first search of one view. A single list serves as a stack: a square's faces follow its parent's.
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
                    // Most triangles are small and lie well inside the square: no test is needed.
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
                // Out of work: the remaining squares are bounded by their face counts.
                self.reached = self.reached.max(squares.iter().map(Square::count).max());
                return;
            };
            work = rest;
        }
    }

    /// Closes a square if its bound is decided, or returns the square to be split.
    fn open(&mut self, square: Square) -> Option<Square> {
        let count = square.count();
        if count < self.limit {
            self.below = self.below.max(count);
            return None;
        }
        if self.reached.is_some_and(|most| count <= most) {
            return None;
        }
        // If at least `limit` faces cover the square, no split brings the count below the limit.
        if square.covering >= self.limit || square.bits == 0 {
            self.reached = Some(count);
            return None;
        }
        Some(square)
    }
}

/// A grid of 2^[`BITS`] columns and rows over all rectangles.
///
/// A coordinate and the bounds around it pass through the same monotonic function, rounding included. So a
/// coordinate between two bounds falls into a cell between the bounds' cells.
struct Grid {
    low: [f64; 2],
    /// Cells per unit.
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

    /// A region that contains all coordinates of a square's cells. It extends an eighth of a cell beyond the
    /// square on each side, far more than the rounding of a 16-bit number and of a coordinate on a grid that
    /// is not finer than `f64`.
    fn place(&self, square: &Square) -> Place {
        let side = f64::from(1_u32 << square.bits);
        let corner = [square.x, square.y].map(f64::from);
        let middle = [0, 1].map(|i| self.low[i] + (corner[i] + 0.5 * side) / self.scale[i]);
        // `low` may be much larger than a cell: then the rounding of `low` dominates.
        let half = [0, 1]
            .map(|i| (0.5 * side + 0.125) / self.scale[i] + ERROR * (self.low[i].abs() + middle[i].abs()));
        Place { middle, half }
    }
}
