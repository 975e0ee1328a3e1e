//! Coordinates of the rays of a light.
//!
//! A [`View`] gives directions two coordinates. One view holds all rays if the light is far away. A light
//! near or inside what it is asked about takes the six sides of a cube around the light.

use crate::geom::{Aabb, Light};

/// Upper bound of all roundings of one coordinate, relative to its terms (see [`View`]): 2⁻⁴⁸, or 32
/// roundings.
pub(crate) const ERROR: f64 = 1.0 / (1_u64 << 48) as f64;

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
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct View {
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
    /// Whether c = L and r = 0.
    is_side: bool,
}

impl View {
    /// The views that together hold all rays of `light` that meet the box.
    pub(crate) fn all(bounds: &Aabb, light: &Light) -> Vec<Self> {
        // A point on the border of two sides lies in both, rounding included.
        Self::all_with(bounds, light, 1.0 + 1.0 / (1_u64 << 40) as f64)
    }

    /// The same views; those of a cube hold the points with |yᵢ| up to `window`, which is more than 1.
    pub(super) fn all_with(bounds: &Aabb, light: &Light, window: f64) -> Vec<Self> {
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
            is_side: false,
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
            window,
            is_side: true,
        };
        [0, 1, 2].into_iter().flat_map(|k| [(k, 1.0), (k, -1.0)]).map(side).collect()
    }

    /// The view among those of [`View::all`] that holds a point, by its index.
    pub(super) fn holding(views: &[Self], p: [f32; 3]) -> usize {
        let [first, _, ..] = views else { return 0 };
        let from = [0, 1, 2].map(|i| f64::from(p[i]) - first.pivot[i]);
        let longest = |a: usize, b: usize| if from[b].abs() > from[a].abs() { b } else { a };
        let k = [1, 2].into_iter().fold(0, longest);
        2 * k + usize::from(from[k] < 0.0)
    }

    /// Direction of the light along axis k, 1 or −1: a face with sign s has the orientation `toward()·s` as
    /// the view sees it, that is the sign of the determinant of its corners' `(Y₁, Y₂, W)`. (The map from
    /// p − L to these is a shear, for a directional light the one of the last row; both keep volumes.)
    pub(super) fn toward(&self) -> f64 {
        if self.light.is_some() { -self.sign } else { self.sign }
    }

    /// Bound of |y| for the points that belong to the view.
    pub(super) fn window(&self) -> f64 {
        self.window
    }

    /// The axis k and the other two.
    pub(super) fn axes(&self) -> [usize; 3] {
        self.axes
    }

    /// The slopes that y is relative to.
    pub(super) fn slope(&self) -> [f64; 2] {
        self.slope
    }

    /// The depth z of a nearness, of a point light.
    pub(super) fn depth_at(&self, nearness: f64) -> f64 {
        if self.is_side { 1.0 / nearness } else { self.depth(self.pivot[self.axes[0]]) / (1.0 + nearness) }
    }

    /// The nearness of a depth z, of a point light.
    pub(super) fn nearness_at(&self, depth: f64) -> f64 {
        if self.is_side { 1.0 / depth } else { self.depth(self.pivot[self.axes[0]]) / depth - 1.0 }
    }

    /// A point in homogeneous coordinates.
    #[inline]
    pub(super) fn project(&self, p: [f32; 3]) -> Projected {
        let [k, ..] = self.axes;
        let from_pivot = |i: usize| f64::from(p[i]) - self.pivot[i];
        let (along, w) = (from_pivot(k), self.depth(f64::from(p[k])));
        let across = [self.axes[1], self.axes[2]].map(from_pivot);
        let [y1, y2] = [0, 1].map(|i| across[i] - self.slope[i] * along);
        let [size1, size2] = across.map(|across| across.abs() + along.abs());
        let height = if self.is_side { 1.0 } else { self.toward() * along };
        Projected { at: [y1, y2, w], size: [size1, size2, w.abs()], height }
    }

    /// The distance z of a point whose coordinate on axis k is `x`. The sign of z is exact.
    #[inline]
    fn depth(&self, x: f64) -> f64 {
        self.light.map_or(1.0, |l| self.sign * (x - l))
    }

    /// Bounds `[low, high]` of both coordinates over all of a triangle's points that the view holds; `None`
    /// if it holds none. As [`View::see`], in a quarter of the time where all corners are ahead.
    ///
    /// One quotient for each corner, times bounds of both numerators: two roundings more than a quotient
    /// each, 12ε of the 32ε of [`ERROR`], and two for the bound itself.
    #[inline]
    pub(super) fn bounds(&self, corners: [[f32; 3]; 3]) -> Option<[[f64; 2]; 2]> {
        let [k, a, b] = self.axes;
        let mut rectangle = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
        for p in corners {
            let z = self.depth(f64::from(p[k]));
            if z <= 0.0 {
                return self.see(corners).map(|seen| seen.rectangle);
            }
            let (inverse, along) = (1.0 / z, f64::from(p[k]) - self.pivot[k]);
            for (i, axis) in [a, b].into_iter().enumerate() {
                let across = f64::from(p[axis]) - self.pivot[axis];
                let numerator = across - self.slope[i] * along;
                let error = ERROR * (across.abs() + along.abs());
                let [low, high] = &mut rectangle[i];
                *low = low.min((numerator - error) * inverse);
                *high = high.max((numerator + error) * inverse);
            }
        }
        let is_held = rectangle.iter().all(|[low, high]| *low <= self.window && *high >= -self.window);
        is_held.then(|| rectangle.map(|[low, high]| [low.max(-self.window), high.min(self.window)]))
    }

    /// The projection of a triangle; `None` if the view holds none of the triangle's points.
    #[inline]
    pub(crate) fn see(&self, corners: [[f32; 3]; 3]) -> Option<Seen> {
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
pub(crate) struct Seen {
    /// Bounds `[low, high]` of both coordinates over all of the triangle's points that the view holds.
    pub(crate) rectangle: [[f64; 2]; 2],
    /// The projected corners; `None` if a corner is not in front of the light.
    pub(crate) corners: Option<[[f64; 2]; 3]>,
    /// Bound of the corners' error, per coordinate.
    pub(crate) off: [f64; 2],
}

/// A point in a view's homogeneous coordinates, all of them affine in the point: `y = Y/W`, and its
/// *nearness* `H/W`, which grows towards the light along each ray and is affine in y on each plane.
///
/// W is z. H is `±(pₖ − cₖ)`, which cancels nothing where the light is far away, and 1 for a side of a cube,
/// where the nearness is 1/z.
///
/// Errors against the exact slopes, with ε = 2⁻⁵³: Y errs by at most 6ε of its size (ε for each difference,
/// 3ε for the slope, ε for the product, ε for the sum), W and H by ε of themselves. [`ERROR`] is 32ε.
#[derive(Clone, Copy, Debug)]
pub(super) struct Projected {
    /// Y₁, Y₂, W.
    pub(super) at: [f64; 3],
    /// The sizes that the errors of Y₁, Y₂ and W are relative to.
    pub(super) size: [f64; 3],
    /// H.
    pub(super) height: f64,
}

impl Projected {
    /// Whether the point is in front of the light.
    pub(super) fn is_ahead(&self) -> bool {
        self.at[2] > 0.0
    }

    /// Bounds of the nearness of a point ahead: three roundings, of 32.
    pub(super) fn nearness(&self) -> [f64; 2] {
        let nearness = self.height / self.at[2];
        let error = ERROR * nearness.abs();
        [nearness - error, nearness + error]
    }

    /// Bounds of y of a point ahead: six roundings of Y, one of W, two of this line, of 32.
    pub(super) fn y(&self) -> [[f64; 2]; 2] {
        [0, 1].map(|i| {
            let error = ERROR * self.size[i];
            [(self.at[i] - error) / self.at[2], (self.at[i] + error) / self.at[2]]
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::SplitMix64;

    /// The bounds hold the corners as `see` projects them, wherever these may be within their error, and are
    /// no wider than a few errors. With errors of nothing they would not.
    #[test]
    fn bounds_of_a_triangle_are_those_of_its_projection_and_hold_its_corners() {
        let mut random = SplitMix64(11);
        let (mut ahead, mut seen_none, mut tight) = (0, 0, 0);
        for _ in 0..20_000 {
            let mut coordinate = || (random.below(2001) as f32 - 1000.0) * 0.013;
            let corners = [(); 3].map(|()| [(); 3].map(|()| coordinate()));
            let at = [(); 3].map(|()| coordinate() * 2.0);
            let light = if at[0] > 0.0 { Light::point(at) } else { Light::directional(at) };
            let Ok(light) = light else { continue };
            let bounds = Aabb { low: [-9.0; 3], high: [9.0; 3] };
            for view in View::all(&bounds, &light) {
                let (seen, found) = (view.see(corners), view.bounds(corners));
                let (Some(seen), Some(found)) = (seen, found) else {
                    assert_eq!(found.is_some(), view.see(corners).is_some(), "{corners:?} {light}");
                    seen_none += 1;
                    continue;
                };
                if seen.corners.is_none() {
                    assert_eq!(found, seen.rectangle);
                    continue;
                }
                ahead += 1;
                for (i, p) in [0, 1].into_iter().flat_map(|i| corners.map(|p| (i, p))) {
                    let ([low, high], window) = (found[i], view.window());
                    let projected = view.project(p);
                    // A corner errs by a third of this at most.
                    let error = ERROR * projected.size[i] / projected.at[2];
                    let place = (projected.at[i] / projected.at[2]).clamp(-window, window);
                    assert!(low <= place - 0.4 * error || low == -window, "{place} {low} {error}");
                    assert!(place + 0.4 * error <= high || high == window, "{place} {high} {error}");
                    tight += usize::from(low > place - 1.5 * error);
                }
            }
        }
        assert!(ahead > 5000 && seen_none > 100 && tight > 5000, "{ahead} {seen_none} {tight}");
    }
}
