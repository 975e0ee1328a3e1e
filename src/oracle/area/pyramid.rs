//! The pyramid of a receiver and a light, in coordinates in which it is a unit square seen from the origin.
//!
//! With d from the receiver P to the corner of the light, x − P = α·e1 + β·e2 + γ·d. The segment from P
//! through x meets the light's plane at u = α/γ, v = β/γ; γ = 1 is that plane, γ = 0 the parallel one through
//! P. The coordinates are linear in x: the rows of a 3 × 3 inverse. For a light at infinity γ ≤ 1 is left
//! out.
//!
//! Nothing here overflows: coordinates are `f32`, so that products of three stay within 2^±450, and the
//! ratios of such products within the range of `f64` too.

use glam::DVec3;

use super::frame::{EPSILON, Frame, wide};
use crate::geom::bvh::{HalfSpace, MOST_SIDES};
use crate::geom::predicate::Sign;

/// A point in the coordinates of the pyramid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Place {
    pub(super) a: f64,
    pub(super) b: f64,
    pub(super) g: f64,
    /// The sum of the terms of `a`, `b` and twice `g`, without their signs: errors are in proportion to it.
    pub(super) terms: f64,
}

/// The end of an edge.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub(super) enum End {
    /// A point.
    Corner([f32; 3]),
    /// A point at infinity.
    Direction([f32; 3]),
}

#[derive(Clone, Debug)]
pub(super) struct Pyramid {
    /// The receiver.
    pub(super) p: [f32; 3],
    wide_p: DVec3,
    pub(super) frame: Frame,
    /// From P to the corner u = v = 0.
    pub(super) d: DVec3,
    rows: [DVec3; 3],
    /// Bounds of the terms of each row.
    terms: [DVec3; 3],
    /// Whether faces that run counter-clockwise in (u, v) have P behind them.
    pub(super) mirrored: bool,
    side_of_p: Option<Sign>,
    /// Relative error of coordinates, over their terms.
    pub(super) error: f64,
    /// Nearer to 1 than this a rounded γ may err about its side of 1.
    pub(super) doubt: f64,
}

/// A receiver without a pyramid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Flat {
    /// It lies exactly in the plane of the light.
    EdgeOn,
    /// It lies so close to that plane that `f64` does not tell how the light is seen.
    Unresolved,
}

impl Pyramid {
    /// `reach` bounds |x − p| for every corner x of a face.
    ///
    /// Error of the coordinates, with ε the rounding unit. Entries of e1, e2 and d err by at most 2ε of their
    /// bounds, a cross product by 6ε of its terms, the determinant D by ρ|D|, ρ = 16ε times its terms over
    /// |D|. A row entry errs by (8ε + ρ) of its terms over |D|, and a coordinate, a dot product with x − P
    /// that is rounded once, by (13ε + ρ) of its terms, times 1/(1 − ρ). Interpolation between two points
    /// adds 6ε, the division by γ another ε. 24ε + 2ρ bounds it all if ρ ≤ ¼.
    #[inline(always)]
    pub(super) fn new(frame: Frame, p: [f32; 3], reach: [f64; 3]) -> Result<Self, Flat> {
        let side_of_p = frame.side(p);
        if side_of_p.is_some_and(Sign::is_zero) {
            return Err(Flat::EdgeOn);
        }
        let Frame { e1, e2, at_infinity, .. } = frame;
        let (d, bound_of_d) = frame.corner_from(p);
        let [alpha, beta, gamma] = [e2.cross(d), d.cross(e1), e1.cross(e2)];
        let determinant = e1.dot(alpha);
        let (size1, size2) = (e1.abs(), e2.abs());
        let terms = [permanent(size2, bound_of_d), permanent(bound_of_d, size1), permanent(size1, size2)];
        let size = determinant.abs();
        let rho = 16.0 * EPSILON * size1.dot(terms[0]) / size;
        let is_resolved = rho <= 0.25; // not if the determinant is 0
        if !is_resolved {
            return Err(Flat::Unresolved);
        }
        let inverse = 1.0 / determinant;
        let rows = [alpha * inverse, beta * inverse, gamma * inverse];
        let size = inverse.abs();
        let terms = [terms[0] * size, terms[1] * size, terms[2] * size];
        let error = 24.0 * EPSILON + 2.0 * rho;
        let doubt = if at_infinity { -1.0 } else { error * terms[2].dot(DVec3::from(reach)) };
        let mirrored = determinant < 0.0;
        Ok(Self { p, wide_p: wide(p), frame, d, rows, terms, mirrored, side_of_p, error, doubt })
    }

    /// The sides of the pyramid, moved outwards by the error of their normals.
    #[inline(always)]
    pub(super) fn sides(&self, reach: [f64; 3]) -> ([HalfSpace; MOST_SIDES], usize) {
        let reach = DVec3::from(reach);
        let side = |normal: DVec3, terms: DVec3, least: f64| HalfSpace {
            normal: normal.to_array(),
            least: least - self.error * terms.dot(reach),
        };
        let ([a, b, g], [ta, tb, tg]) = (self.rows, self.terms);
        let all = [
            side(a, ta, 0.0),
            side(b, tb, 0.0),
            side(g - a, tg + ta, 0.0),
            side(g - b, tg + tb, 0.0),
            side(-g, tg, -1.0 - self.error),
        ];
        (all, MOST_SIDES - usize::from(self.frame.at_infinity))
    }

    /// The coordinates of a corner, without [`Place::terms`]. The side of γ = 1 is exact.
    #[inline(always)]
    pub(super) fn coordinates(&self, x: [f32; 3]) -> [f64; 3] {
        let from_p = wide(x) - self.wide_p;
        let [a, b, mut g] = self.rows.map(|row| row.dot(from_p));
        if (1.0 - g).abs() <= self.doubt {
            g = self.decided(x, g);
        }
        [a, b, g]
    }

    /// γ on the right side of 1, for a corner in or near the plane of the light.
    #[cold]
    fn decided(&self, x: [f32; 3], g: f64) -> f64 {
        match (self.frame.side(x), self.side_of_p) {
            (None, _) | (_, None) => g,
            (x, p) if x == p => g.min(1_f64.next_down()),
            _ => g.max(1.0),
        }
    }

    /// Whether rounded numbers alone say on which side of the light a corner lies, and do not suffice.
    #[inline(always)]
    pub(super) fn is_doubtful(&self, x: [f32; 3]) -> bool {
        self.side_of_p.is_none() && (1.0 - self.rows[2].dot(wide(x) - self.wide_p)).abs() <= self.doubt
    }

    pub(super) fn place(&self, end: End) -> Place {
        let ([a, b, g], along) = match end {
            End::Corner(x) => (self.coordinates(x), wide(x) - self.wide_p),
            End::Direction(x) => (self.rows.map(|row| row.dot(wide(x))), wide(x)),
        };
        let [ta, tb, tg] = self.terms.map(|row| row.dot(along.abs()));
        Place { a, b, g, terms: ta + tb + 2.0 * tg }
    }

    /// How large an area may belong to faces that were left out as outside of a side by less than rounding.
    ///
    /// In the pyramid |x − P| is at most γ(|e1| + |e2| + |d|), axis by axis, which bounds the terms over γ.
    /// Each of four sides is 1 long.
    #[inline]
    pub(super) fn least_error(&self) -> f64 {
        let size = self.frame.e1.abs() + self.frame.e2.abs() + self.d.abs();
        let [a, b, g] = self.terms;
        4.0 * self.error * (a + b + 2.0 * g).dot(size)
    }

    /// The vector from P to a point of the light's plane.
    pub(super) fn towards(&self, u: f64, v: f64) -> DVec3 {
        self.d + u * self.frame.e1 + v * self.frame.e2
    }
}

/// The terms of a cross product, all added.
fn permanent(a: DVec3, b: DVec3) -> DVec3 {
    DVec3::new(a.y * b.z + a.z * b.y, a.z * b.x + a.x * b.z, a.x * b.y + a.y * b.x)
}

impl Place {
    /// The point of the segment to `other` where a linear function is 0, given its values `here` and `there`
    /// of opposite sign. Both weights have a relative error of 2ε.
    pub(super) fn zero(&self, other: &Self, here: f64, there: f64) -> Self {
        let span = here - there;
        let (own, its) = (-there / span, here / span);
        Self {
            a: own * self.a + its * other.a,
            b: own * self.b + its * other.b,
            g: own * self.g + its * other.g,
            terms: own * self.terms + its * other.terms,
        }
    }

    pub(super) fn coordinates(&self) -> [f64; 3] {
        [self.a, self.b, self.g]
    }

    /// v in 0 ..= 1.
    pub(super) fn v(&self) -> f64 {
        self.over(self.b)
    }

    /// u in 0 ..= 1.
    pub(super) fn u(&self) -> f64 {
        self.over(self.a)
    }

    fn over(&self, coordinate: f64) -> f64 {
        if self.g > 0.0 {
            (coordinate / self.g).clamp(0.0, 1.0)
        } else {
            f64::from(u8::from(coordinate > 0.0)) // the limit
        }
    }
}
