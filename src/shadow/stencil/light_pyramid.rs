//! Light pyramid test: a proof that no volume of a set of points reaches the near rectangle of a camera,
//! rounding included.
//!
//! The volume of a face is the set of non-negative combinations of its corners `v` and of the same corners at
//! infinity, `v·w − L`. The volume misses the near rectangle if a plane separates the two: a linear function
//! of clip coordinates that is positive at the rectangle's corners and negative at all of the volume's
//! points. (Such a plane exists iff the points do not meet the convex hull of the light and the rectangle,
//! with the light itself excluded.) Then the sum of such volumes over many faces has winding number 0 all
//! over the rectangle, and z-pass counts correctly.
//!
//! # Effect of rounding
//!
//! The proof must hold for the volume as drawn. A shader computes `q = p − w·eye` and three sums of three
//! products with the rows of the [`Projection`]; depth is `near·w`, which is exact. So a clip coordinate has
//! an error of at most `n·2⁻²³·Σ|rowᵢ·qᵢ|`, where n is the number of roundings (WGSL may round in either
//! direction, 2⁻²³ each). There is one rounding in a vertex at infinity, one in q, one in a product, two in
//! the sums. Three more (a weight, a product, a sum) occur where a primitive is clipped: the new vertex is
//! interpolated, as a combination of the old ones. The total is 8·2⁻²³ = 2⁻²⁰. [`ERROR`] is twice this total,
//! which also covers products of errors and the `f64` arithmetic of this file. Numbers below 2⁻¹²⁶ may be
//! flushed to zero: [`FLUSH`] for each operand, product and sum. From [`LARGEST`] on a coordinate might leave
//! `f32`, and nothing is claimed.
//!
//! A point with these bounds is a box in clip space. The function must have its sign all over the box. All
//! fragments of the drawn volume are combinations of points in such boxes, so none of the fragments lies on
//! the near rectangle. The rectangle's corners get boxes of the same relative size, which moves the
//! rectangle's sides by a few thousandths of a pixel.

use glam::{DVec3, DVec4};

use crate::geom::Light;
use crate::view::Projection;

/// Error of a clip coordinate, relative to the sum of its products: see the head of this file.
const ERROR: f64 = 1.0 / (1 << 19) as f64;
/// Error of flushing to zero: the smallest normal `f32`, 2⁻¹²⁶.
const FLUSH: f64 = f32::MIN_POSITIVE as f64;
/// Limit of the products' sums, 2¹²⁶: half of the range of `f32`, so no smaller sum can overflow.
const LARGEST: f64 = 1.0 / FLUSH;

/// Iterations of the search for a separating plane; after the last one no gap is assumed.
const TRIES: usize = 64;

/// Maximum number of points per query: the rectangle's four corners, and twice the eight corners of a box.
const MOST: usize = 4 + 2 * 8;

/// A camera and a light, ready for [`LightPyramid::misses`]. A caster in the pyramid may spoil z-pass.
#[derive(Clone, Debug)]
pub(super) struct LightPyramid {
    eye: DVec3,
    rows: [DVec3; 3],
    near: f64,
    light: Light,
    /// The last separating plane: the first to try for the next query.
    plane: DVec4,
}

/// A point of clip space `(x, y, w, near·homogeneous w)` with an error bound per coordinate. A separating
/// plane must be positive all over this box: the points of a caster are stored with their sign flipped.
#[derive(Clone, Copy, Default)]
struct Boxed {
    at: DVec4,
    by: DVec4,
}

impl Boxed {
    /// The box scaled to a length near 1: only signs matter, and no point should outweigh the others.
    fn unit(at: DVec4, by: DVec4) -> Self {
        let scale = (at.length() + by.length()).recip();
        Self { at: at * scale, by: by * scale }
    }

    /// The minimum of a linear function on the box.
    #[inline]
    fn least(&self, plane: DVec4) -> f64 {
        plane.dot(self.at) - plane.abs().dot(self.by)
    }

    /// The corner of the box where the linear function is minimal.
    fn corner(&self, plane: DVec4) -> DVec4 {
        self.at - plane.signum() * self.by
    }
}

impl LightPyramid {
    pub(super) fn new(projection: &Projection, light: &Light) -> Self {
        let wide = |p: [f32; 3]| DVec3::from(p.map(f64::from));
        Self {
            eye: wide(projection.eye),
            rows: [projection.right, projection.up, projection.forward].map(wide),
            // The proof is about a perspective eye: without one nothing is claimed.
            near: if projection.is_orthographic() { f64::NAN } else { f64::from(projection.near) },
            light: *light,
            // Separates the rectangle from everything well in front of it.
            plane: DVec4::new(0.0, 0.0, -1.0, 1.5),
        }
    }

    /// Whether the volume of the convex hull of `points` (eight at most) certainly misses the near rectangle.
    /// True is never wrong; false may be.
    ///
    /// First the plane that separated the last points is tried. Then planes through a side or corner of the
    /// rectangle, at a few angles. Then a search by Gilbert's iteration (Elmer G. Gilbert, *An Iterative
    /// Procedure for Computing the Minimum of a Quadratic Form on a Convex Set*, 1966): the plane's normal
    /// moves towards the point on which its function is least, up to the shortest vector on this segment. The
    /// first plane that is positive on all points is a sufficient proof.
    pub(super) fn misses(&mut self, points: &[[f32; 3]]) -> bool {
        let mut all = [Boxed::default(); MOST];
        let Some(count) = self.gather(points, &mut all) else { return false };
        let all = &all[..count];
        let parts = |plane: &DVec4| all.iter().all(|point| point.least(*plane) > 0.0);
        if parts(&self.plane) {
            return true;
        }
        if let Some(plane) = all_through_sides(&all[4..]).find(parts) {
            self.plane = plane.normalize_or_zero();
            return true;
        }
        let mut plane = self.plane;
        for _ in 0..TRIES {
            let mut worst = (f64::INFINITY, &all[0]);
            for point in all {
                let least = point.least(plane);
                if least < worst.0 {
                    worst = (least, point);
                }
            }
            if worst.0 > 0.0 {
                self.plane = plane.normalize_or_zero();
                return true;
            }
            let step = plane - worst.1.corner(plane);
            let length = step.length_squared();
            if length == 0.0 {
                return false; // the hull contains the origin: no plane separates
            }
            plane -= step * (plane.dot(step) / length).clamp(0.0, 1.0);
        }
        false
    }

    /// All points on which a plane must be positive: the rectangle's corners, and the points of the caster
    /// and of its extrusion with their sign flipped. `None` if `f32` might not hold one of the points.
    fn gather(&self, points: &[[f32; 3]], all: &mut [Boxed; MOST]) -> Option<usize> {
        if !(self.near > 0.0 && self.near < LARGEST) {
            return None;
        }
        for (k, (x, y)) in [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].into_iter().enumerate() {
            all[k] = Boxed::unit(DVec4::new(x, y, 1.0, 1.0), DVec4::splat(ERROR));
        }
        let mut count = 4;
        let mut add = |boxed| {
            all[count] = boxed;
            count += 1;
        };
        let light = DVec3::from(self.light.xyz().map(f64::from));
        if self.light.is_directional() {
            add(self.boxed(-light, 0.0)?); // the one point at infinity
        }
        for point in points {
            let p = DVec3::from(point.map(f64::from));
            add(self.boxed(p - self.eye, self.near)?);
            // A corner exactly at the light extrudes to the null vector, which is no point at all.
            if !self.light.is_directional() && p != light {
                add(self.boxed(p - light, 0.0)?);
            }
        }
        Some(count)
    }

    fn boxed(&self, q: DVec3, depth: f64) -> Option<Boxed> {
        let [x, y, w] = self.rows.map(|row| row.dot(q));
        let lengths = self.rows.map(|row| row.abs().dot(q.abs()));
        if !lengths.iter().all(|&length| length < LARGEST) {
            return None; // also for NaN
        }
        let operands = q.abs().element_sum() + 8.0;
        let [by_x, by_y, by_w] =
            [0, 1, 2].map(|i| ERROR * lengths[i] + FLUSH * (operands + self.rows[i].abs().element_sum()));
        let by = DVec4::new(by_x, by_y, by_w, ERROR * depth + FLUSH);
        Some(Boxed::unit(-DVec4::new(x, y, w, depth), by))
    }
}

/// Tilts of the planes through a corner, relative to the plane through a side; 0 is the plane through the
/// side itself. A small tilt serves a light in line with this side. Large tilts serve casters that lie
/// diagonally off the rectangle.
const LEANS: [f64; 9] = [0.0, 0.00390625, -0.00390625, 0.0625, -0.0625, 0.25, -0.25, 1.0, -1.0];

/// Planes through a side or a corner of the rectangle that are positive on all of `points`: at most one per
/// side, lean and direction of tilt.
///
/// For a given lean, all these planes are `side + t·depth`. The function `side` vanishes on a plane through
/// the eye, `depth` on the near plane. The minimum of the sum on a box is at least the sum of the two minima.
/// So each point bounds t from one end.
fn all_through_sides(points: &[Boxed]) -> impl Iterator<Item = DVec4> {
    let leaning = |lean: f64| {
        [(1.0, lean), (-1.0, lean), (lean, 1.0), (lean, -1.0)]
            .map(|(x, y)| DVec4::new(x, y, 1.0 + lean.abs(), 0.0))
    };
    let sides = LEANS.into_iter().flat_map(leaning);
    let tilts = [-1.0, 1.0].map(|sign| DVec4::new(0.0, 0.0, sign, -sign));
    sides.flat_map(move |side| tilts.map(|tilt| (side, tilt))).filter_map(move |(side, tilt)| {
        let (mut low, mut high) = (0.0_f64, f64::INFINITY);
        for point in points {
            let (fixed, slope) = (point.least(side), point.least(tilt));
            if slope > 0.0 {
                low = low.max(-fixed / slope);
            } else if slope < 0.0 {
                high = high.min(-fixed / slope);
            } else if fixed <= 0.0 {
                return None;
            }
        }
        let t = if high < f64::INFINITY { 0.5 * (low + high) } else { 2.0 * low + 1.0 };
        // Moves the plane off the side by slightly more than the error bound of the rectangle's corners.
        let off = DVec4::new(0.0, 0.0, 0.0, 16.0 * ERROR * (1.0 + t));
        (low < high).then_some(side + t * tilt + off)
    })
}
