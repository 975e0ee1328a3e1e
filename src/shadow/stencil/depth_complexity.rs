//! Depth complexity seen from the light: an upper bound of the stencil counts, before anything is drawn.
//!
//! The stencil count of a visible point is the number of casting faces between the point and the light. Eight
//! bits hold 255; a count of 256 wraps to "lit". The number of all faces is nearly always too large a bound,
//! so the faces are tested as the light sees them. Each face has a rectangle of directions, rounded outwards.
//! A quadtree over the directions splits squares until fewer faces than the limit lie in each square. All
//! faces that a ray crosses lie in the square that contains the ray's direction.
//!
//! A [`View`] gives directions two coordinates. No split separates the faces around one vertex, so with
//! hundreds of such faces the bound is larger than the truth.

use std::fmt;

use crate::geom::{Aabb, Light};
use crate::light_grid::view::{ERROR, Seen, View};
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

impl Place {
    /// Overlap of a triangle and the square. `None` is certain: the line of an edge separates the triangle
    /// from the square.
    ///
    /// The square is enlarged by the error bound of the corners; then the corners count as exact. No compared
    /// value has an error of more than 16 roundings of its terms; [`ERROR`] is 32 roundings.
    fn overlap(&self, seen: &Seen) -> Overlap {
        let Some(corners) = seen.corners else { return Overlap::All };
        let half = [self.half[0] + seen.off[0], self.half[1] + seen.off[1]];
        let mut all = true;
        for k in 0..3 {
            let [a, b, c] = [corners[k], corners[(k + 1) % 3], corners[(k + 2) % 3]];
            let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
            let height = |p: [f64; 2]| {
                let terms = [dx * (p[1] - a[1]), dy * (p[0] - a[0])];
                (terms[0] - terms[1], terms[0].abs() + terms[1].abs())
            };
            let ((third, terms), (middle, more)) = (height(c), height(self.middle));
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
                    match if inside { Overlap::Some } else { place.overlap(&seen[cells.seen as usize]) } {
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
