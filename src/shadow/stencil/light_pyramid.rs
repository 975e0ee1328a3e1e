//! A proof that no volume of a set of points reaches the near rectangle of a camera, rounding included.
//!
//! The volume of a face is the set of non-negative combinations of its corners `v` and of the same corners at
//! infinity, `v·w − L`. It misses the near rectangle if a linear function of clip coordinates is positive at the
//! rectangle's corners and negative at all of those points: a plane between them. (Such a plane exists iff the points
//! do not meet the convex hull of the light and the rectangle, the light itself left out.) The sum of
//! such volumes over many faces has winding number 0 all over the rectangle, and z-pass counts right.
//!
//! # What rounding may do
//!
//! What counts is the volume that is drawn. A shader forms `q = p − w·eye` and three sums of three products with the
//! rows of the [`Projection`]; depth is `near·w`, which is exact. So a clip coordinate is off by at most
//! `n·2⁻²³·Σ|rowᵢ·qᵢ|`, where n counts the roundings on the way (WGSL may round either way, 2⁻²³ each): one in a
//! vertex at infinity, one in q, one in a product, two in the sums; and three more (a weight, a product, a sum)
//! where a primitive is clipped and a new vertex interpolated, which is a combination of the old ones. That is
//! 8·2⁻²³ = 2⁻²⁰; [`ERROR`] is twice that, and pays for products of errors and for the `f64` of this file. Numbers
//! below 2⁻¹²⁶ may be flushed to zero: [`FLUSH`] for each operand, product and sum. From [`LARGEST`] on a coordinate
//! might leave `f32`, and nothing is claimed.
//!
//! A point with these bounds is a box in clip space. The function must have its sign all over the box: since all
//! fragments of the drawn volume are combinations of points in such boxes, none of them is on the near rectangle.
//! The rectangle gets boxes of the same relative size, which moves its sides by a few thousandths of a pixel.

use glam::{DVec3, DVec4};

use crate::geom::Light;
use crate::view::Projection;

/// Relative to the sum of a coordinate's products: see the head of this file.
const ERROR: f64 = 1.0 / (1 << 19) as f64;
/// The smallest normal `f32`, 2⁻¹²⁶.
const FLUSH: f64 = f32::MIN_POSITIVE as f64;
/// Half of what `f32` can hold, 2¹²⁶: no sum of products below it can overflow.
const LARGEST: f64 = 1.0 / FLUSH;

/// How many planes the search tries before a gap counts as none.
const TRIES: usize = 64;

/// The most points a query has: the rectangle's corners, and eight corners of a box twice.
const MOST: usize = 4 + 2 * 8;

/// A camera and a light, ready for [`LightPyramid::misses`]: the points between which a caster would do harm.
#[derive(Clone, Debug)]
pub(super) struct LightPyramid {
    eye: DVec3,
    rows: [DVec3; 3],
    near: f64,
    light: Light,
    /// The plane that parted the last points: the first to try for the next.
    plane: DVec4,
}

/// A point of clip space `(x, y, w, near·homogeneous w)`, and how far each coordinate may be off. A parting plane is
/// positive all over it: points of a caster stand here with their sign turned.
#[derive(Clone, Copy, Default)]
struct Boxed {
    at: DVec4,
    by: DVec4,
}

impl Boxed {
    /// The same direction at a length near 1: only signs count, and no point shall outweigh the others.
    fn unit(at: DVec4, by: DVec4) -> Self {
        let scale = (at.length() + by.length()).recip();
        Self { at: at * scale, by: by * scale }
    }

    /// The least value of the linear function on the box.
    #[inline]
    fn least(&self, plane: DVec4) -> f64 {
        plane.dot(self.at) - plane.abs().dot(self.by)
    }

    /// The corner where it has that value.
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
            plane: DVec4::new(0.0, 0.0, -1.0, 1.5), // parts the rectangle from what is well in front of it
        }
    }

    /// Whether the volume of the convex hull of `points` (eight at most) surely misses the near rectangle. No false
    /// "yes".
    ///
    /// The plane that parted the points before is tried first; then those through a side or corner of the
    /// rectangle, at a few angles; then a search by Gilbert's iteration (Elmer G. Gilbert, *An Iterative Procedure for Computing
    /// the Minimum of a Quadratic Form on a Convex Set*, 1966): from a plane's normal towards the point that is least
    /// in front of it, as far as makes it shortest. The first plane that has all points in front is proof enough.
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
                return false; // the origin itself: nothing parts them
            }
            plane -= step * (plane.dot(step) / length).clamp(0.0, 1.0);
        }
        false
    }

    /// All points that a plane must have in front: the rectangle's corners, and those of the caster and its
    /// extrusion with their sign turned. `None` where `f32` might not hold one of them.
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
            // A corner that is the light extrudes to the null vector, exactly: no point at all.
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
            return None; // a NaN ends here too
        }
        let operands = q.abs().element_sum() + 8.0;
        let [by_x, by_y, by_w] =
            [0, 1, 2].map(|i| ERROR * lengths[i] + FLUSH * (operands + self.rows[i].abs().element_sum()));
        let by = DVec4::new(by_x, by_y, by_w, ERROR * depth + FLUSH);
        Some(Boxed::unit(-DVec4::new(x, y, w, depth), by))
    }
}

/// How far planes through a corner lean from the side that they belong to: none for a plane through the side itself.
/// A small lean serves a light in line with that side; larger ones, casters that are off aslant.
const LEANS: [f64; 9] = [0.0, 0.00390625, -0.00390625, 0.0625, -0.0625, 0.25, -0.25, 1.0, -1.0];

/// Planes through a side or a corner of the rectangle that have all of `points` in front, one for each side, lean and
/// way of tilt where there is one.
///
/// With the lean given, all of them are `side + t·depth`, where `side` vanishes on a plane through the eye and `depth`
/// on the near plane. A point in front of both `side` and `±depth` by so much is in front of their sum by no less:
/// each bounds |t| from one end.
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
        // Off the side by a little more than what the rectangle's corners may be off.
        let off = DVec4::new(0.0, 0.0, 0.0, 16.0 * ERROR * (1.0 + t));
        (low < high).then_some(side + t * tilt + off)
    })
}
