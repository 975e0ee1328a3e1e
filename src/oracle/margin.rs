//! How far a point, and its light, may move before the verdict changes: a proven lower bound.

mod distance;

use super::{Intersection, Oracle, Verdict};
use crate::geom::bvh::Step;
use crate::geom::{Aabb, Light};
use distance::{Points, apart};

/// Segments are cut where they have left all faces by seven times this many: 8 times as far from the point as
/// the farthest face.
const BEYOND: f64 = 8.0;

impl Oracle {
    /// A distance within which the verdict at `p` does not change, in mesh units: it is the same for every
    /// point less than this far from `p`, and every position of a point light less than this far from its
    /// own, both at once. A directional light keeps its direction; only the point moves. 0 for
    /// [`Verdict::Grazing`], and for a point, or a light, on a face. Infinite without faces.
    ///
    /// A tracer in `f32` can be held to it: where its errors move a ray by less than the margin, its answer
    /// has to be the exact one. Where the margin is less, either answer may be right.
    ///
    /// ```
    /// use umbrage::geom::Light;
    /// use umbrage::oracle::{Oracle, Verdict};
    /// use umbrage::testing::shapes;
    /// // The segment from one point to another, among several meshes.
    /// let roof = shapes::translated(&shapes::cube(), [0.0, 4.0, 0.0]); // from y = 3 to 5
    /// let oracle = Oracle::over(&[&shapes::cube(), &roof]);
    /// let (from, to) = ([0.5, 2.0, 0.25], [3.5, 2.0, 0.25]);
    /// assert_eq!(oracle.verdict(from, &Light::point(to)?), Verdict::Lit);
    /// let margin = oracle.margin(from, &Light::point(to)?);
    /// assert!(0.999_999 < margin && margin <= 1.0); // to the cube below, and to the one above
    /// // Yours: any answer for a segment whose ends are off by less.
    /// let shadowed = |p, light| oracle.verdict(p, light) == Verdict::Shadowed;
    /// assert!(!shadowed([0.5, 1.25, 0.25], &Light::point([3.5, 2.7, 0.25])?));
    /// # Ok::<(), umbrage::geom::LightError>(())
    /// ```
    ///
    /// # Proof
    ///
    /// Let both ends move by at most e. Then every point of the segment moves by at most e, since it moves by
    /// the weighted mean of what the ends do; of a ray whose direction stays, every point moves by the same.
    ///
    /// - *Lit*: a segment that meets a face after the move has a point within e of that face before it. So
    ///   the margin is the least distance of the segment, its ends included, from any face. It is exact but
    ///   for rounding.
    /// - *Shadowed*: let a face be crossed before the move, and no longer after it. Move both ends along
    ///   straight lines. At the first moment without a proper crossing, the segment meets an edge of the
    ///   face, or one of its ends lies on the face. So one of these distances was at most e: of the segment
    ///   from an edge, or of an end from the face. A face keeps its crossing within the least of them, and
    ///   the shadow stays within the largest such value of all faces that are crossed. Exact for one face;
    ///   where several are crossed, and one is left while another is still crossed, the true margin is
    ///   larger.
    ///
    /// Each distance is a lower bound by a separating plane: for any direction n, two convex sets are apart
    /// by at least the gap between their projections on n. How n was found does not matter to the proof.
    /// Rounding is subtracted: with all coordinates seen from `p`, and at most M, no more than
    /// 54 · 2⁻⁵³ · M, for which 64 is taken. Beyond eight times the farthest face, segments are cut: the rest
    /// is at least seven times as far from `p` as any face, and `p` itself is nearer.
    ///
    /// Time: that of a verdict, and up to six distances for each face in boxes near the segment. There are
    /// few such faces, unless most are about as far from it as the nearest one.
    #[must_use]
    pub fn margin(&self, p: [f32; 3], light: &Light) -> f64 {
        let Some(view) = View::of(self, p, light) else { return f64::INFINITY };
        match self.verdict(p, light) {
            Verdict::Grazing => 0.0,
            Verdict::Shadowed => {
                let mut largest = 0.0_f64;
                self.meetings::<false>(p, light, &self.way(p, light), |slot, meeting| {
                    if matches!(meeting, Intersection::Crossing(_)) {
                        largest = largest.max(view.keeps_crossing(&self.triangles[slot]));
                    }
                    Step::On
                });
                largest
            }
            Verdict::Lit => self.least_distance(p, light, &view),
        }
    }

    /// The least distance of a segment that meets no face from all faces. Looks at boxes around the segment,
    /// each four times as wide as the last, until a face is found that is nearer than the box is wide.
    fn least_distance(&self, p: [f32; 3], light: &Light, view: &View) -> f64 {
        // At least two units in the last place of the largest coordinate, as the traversal asks for.
        let largest = p.iter().fold(f32::MIN_POSITIVE, |most, x| most.max(x.abs()));
        let mut width = (view.reach as f32 / 1024.0).max(largest * (4.0 * f32::EPSILON)).min(f32::MAX);
        loop {
            let mut least = f64::INFINITY;
            self.tree.walk_loosely(p, width, light, |slot| {
                least = least.min(view.stays_clear_of(&self.triangles[slot]));
                Step::On
            });
            // A face within the width of the segment has been visited; a bound on the distance of any other
            // is at most its distance. All faces are within twice the reach.
            if least <= f64::from(width) {
                return least;
            }
            if f64::from(width) > 2.0 * view.reach || width == f32::MAX {
                return self.least_of_all(view);
            }
            width = (width * 4.0).min(f32::MAX);
        }
    }

    /// The least distance, face by face.
    fn least_of_all(&self, view: &View) -> f64 {
        self.triangles.iter().map(|face| view.stays_clear_of(face)).fold(f64::INFINITY, f64::min)
    }
}

/// A segment seen from its start, which is the origin.
pub(super) struct View {
    p: [f64; 3],
    /// The end of the segment: the light, or where it is cut.
    end: [f64; 3],
    /// The largest coordinate of any face.
    reach: f64,
}

impl View {
    /// `None` without faces.
    fn of(oracle: &Oracle, p: [f32; 3], light: &Light) -> Option<Self> {
        let Aabb { low, high } = oracle.bounds();
        if oracle.triangles.is_empty() {
            return None;
        }
        let p = p.map(f64::from);
        let far = |i: usize| (f64::from(high[i]) - p[i]).abs().max((f64::from(low[i]) - p[i]).abs());
        let reach = far(0).max(far(1)).max(far(2));
        let xyz = light.xyz().map(f64::from);
        let along = if light.is_directional() { xyz } else { [0, 1, 2].map(|i| xyz[i] - p[i]) };
        let longest = along.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
        let cut = BEYOND * reach / longest;
        let end = match light.is_directional() || cut < 1.0 {
            true => along.map(|x| cut * x),
            false => along,
        };
        Some(Self { p, end, reach })
    }

    fn seen(&self, corners: &[[f32; 3]; 3]) -> [[f64; 3]; 3] {
        corners.map(|corner| [0, 1, 2].map(|i| f64::from(corner[i]) - self.p[i]))
    }

    /// A lower bound of the distance of the segment from a face that it does not meet; 0 at least.
    fn stays_clear_of(&self, corners: &[[f32; 3]; 3]) -> f64 {
        apart(Points::of(&[[0.0; 3], self.end]), Points::of(&self.seen(corners)))
    }

    /// A lower bound of the move after which a face is still crossed; 0 at least.
    fn keeps_crossing(&self, corners: &[[f32; 3]; 3]) -> f64 {
        let [a, b, c] = self.seen(corners);
        let segment = [[0.0; 3], self.end];
        let ends = segment.map(|end| apart(Points::of(&[end]), Points::of(&[a, b, c])));
        let edges = [[a, b], [b, c], [c, a]].map(|edge| apart(Points::of(&segment), Points::of(&edge)));
        ends.into_iter().chain(edges).fold(f64::INFINITY, f64::min)
    }
}

#[cfg(test)]
mod tests;
