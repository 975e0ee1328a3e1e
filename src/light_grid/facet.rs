//! A face as a view sees it: three edges and a plane, as functions that are affine in y.
//!
//! Let q = (Y₁, Y₂, W) be a corner's homogeneous coordinates, and d = (y₁, y₂, 1) the direction of a ray. The
//! ray passes inside of the edge from a to b where `σ·(q_a × q_b)·d > 0`, σ being the orientation of the
//! face. This holds wherever the corners are: behind the light too. The three values are the barycentric
//! coordinates of the crossing, up to one factor, so the nearness of the plane is their mean of the corners'
//! H, divided by |det q|.
//!
//! # Effect of rounding
//!
//! Let ε = 2⁻⁵³, and let the *size* of a term be the product of its factors' sizes. By the bounds of
//! [`Projected`], a product of two coordinates errs by at most (6 + 6 + 1)ε of its size, a component of a
//! cross product by 14ε, and `n·d` by 17ε of `Σ size·|dᵢ|`: a rounding for each product, two for the sums.
//! Its range over a square is added up with four more, and the sizes have as many roundings of their own:
//! 25ε, to first order. The numerator of the plane has one more product and two more sums, and H errs by ε:
//! 29ε. The determinant `q·n`: 14 + 6 + 3 = 23ε. [`ERROR`] is 32ε.

use super::view::{ERROR, Projected, View};

/// A rectangle of y.
#[derive(Clone, Copy, Debug)]
pub(super) struct Square {
    pub(super) middle: [f64; 2],
    /// Half of the sides; 0 for a single ray.
    pub(super) half: [f64; 2],
}

impl Square {
    /// A rectangle around these bounds, which may be as near as rounding makes them.
    pub(super) fn around([[x0, x1], [y0, y1]]: [[f64; 2]; 2]) -> Self {
        let half = |low: f64, high: f64| 0.5 * (high - low) + ERROR * (low.abs() + high.abs());
        Self { middle: [0.5 * (x0 + x1), 0.5 * (y0 + y1)], half: [half(x0, x1), half(y0, y1)] }
    }

    /// The ray through a point.
    pub(super) fn ray(y: [f64; 2]) -> Self {
        Self { middle: y, half: [0.0; 2] }
    }
}

/// A function that is affine in y: `n·(y, 1)`.
#[derive(Clone, Copy, Debug)]
struct Affine {
    n: [f64; 3],
    size: [f64; 3],
}

impl Affine {
    /// `σ·(p × q)·(y, 1)`.
    fn through(p: &Projected, q: &Projected, sign: f64) -> Self {
        let [a, b] = [p.at, q.at];
        let [c, d] = [p.size, q.size];
        let minor = |i: usize, j: usize| sign * (a[i] * b[j] - a[j] * b[i]);
        let size = |i: usize, j: usize| c[i] * d[j] + c[j] * d[i];
        Self { n: [minor(1, 2), minor(2, 0), minor(0, 1)], size: [size(1, 2), size(2, 0), size(0, 1)] }
    }

    /// Bounds of the values on a square.
    #[inline]
    fn over(&self, square: &Square) -> [f64; 2] {
        let ([n1, n2, n3], [s1, s2, s3]) = (self.n, self.size);
        let ([y1, y2], [h1, h2]) = (square.middle, square.half);
        let middle = n1 * y1 + n2 * y2 + n3;
        let reach = n1.abs() * h1 + n2.abs() * h2;
        let error = ERROR * (s1 * (y1.abs() + h1) + s2 * (y2.abs() + h2) + s3);
        [middle - (reach + error), middle + (reach + error)]
    }
}

/// How the rays through a square meet a face.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Meeting {
    /// No ray meets the face.
    None,
    /// Every ray properly crosses the face.
    All,
    /// Undecided. The bits are set of the edges that a ray may meet, k for the edge from corner k to the
    /// next.
    Some(u8),
}

/// A face of the chain, as a view sees it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Facet {
    /// Edge k from corner k to the next.
    edges: [Affine; 3],
    /// The nearness of the plane times `det`.
    plane: Affine,
    /// Bounds of |det q|; the lower one is not positive if the plane is not certain.
    det: [f64; 2],
    /// Bounds of the nearness of all of the face's points that are ahead.
    range: [f64; 2],
}

impl Facet {
    /// A face with a sign that is not 0.
    pub(super) fn new(view: &View, corners: [[f32; 3]; 3], sign: i8) -> Self {
        let q = corners.map(|corner| view.project(corner));
        let sign = view.toward() * f64::from(sign);
        let edges = [0, 1, 2].map(|k| Affine::through(&q[k], &q[(k + 1) % 3], sign));
        let mut plane = Affine { n: [0.0; 3], size: [0.0; 3] };
        for (corner, opposite) in q.iter().zip([1, 2, 0]) {
            for i in 0..3 {
                plane.n[i] += corner.height * edges[opposite].n[i];
                plane.size[i] += corner.height.abs() * edges[opposite].size[i];
            }
        }
        let (of_first, opposite) = (&q[0], &edges[1]);
        let det: f64 = (0..3).map(|i| of_first.at[i] * opposite.n[i]).sum();
        let error = ERROR * (0..3).map(|i| of_first.size[i] * opposite.size[i]).sum::<f64>();
        Self { edges, plane, det: [det - error, det + error], range: range(&q) }
    }

    /// Certain answers about all rays of a square.
    #[inline]
    pub(super) fn meeting(&self, square: &Square) -> Meeting {
        let (mut all, mut met) = (true, 0);
        for (k, edge) in self.edges.iter().enumerate() {
            let [low, high] = edge.over(square);
            if high < 0.0 {
                return Meeting::None;
            }
            let is_inside = low > 0.0;
            all &= is_inside;
            met |= u8::from(!is_inside) << k;
        }
        if all { Meeting::All } else { Meeting::Some(met) }
    }

    /// Bounds of the nearness of all points of the face whose rays pass through a square.
    #[inline]
    pub(super) fn nearness(&self, square: &Square) -> [f64; 2] {
        let [least, most] = self.det;
        let is_certain = least > 0.0;
        if !is_certain {
            return self.range;
        }
        let [low, high] = self.plane.over(square);
        // A quotient by a determinant from `least` to `most`; two roundings, of 32.
        let low = low / if low < 0.0 { least } else { most };
        let high = high / if high < 0.0 { most } else { least };
        let (low, high) = (low - ERROR * low.abs(), high + ERROR * high.abs());
        let (low, high) = (low.max(self.range[0]), high.min(self.range[1]));
        // The square and the corners may know of no common point.
        if low <= high { [low, high] } else { self.range }
    }
}

/// Bounds of the nearness of a triangle's points ahead of the light. Where an edge leaves them, z goes to 0
/// and the nearness to infinity, so the least value is at a corner.
fn range(q: &[Projected; 3]) -> [f64; 2] {
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    for corner in q {
        if corner.is_ahead() {
            let [from, to] = corner.nearness();
            (low, high) = (low.min(from), high.max(to));
        } else {
            high = f64::INFINITY;
        }
    }
    [low, high]
}
