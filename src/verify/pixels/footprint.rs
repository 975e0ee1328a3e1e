//! The footprint of a pixel: the tolerance of a rasterizer, within which its count may differ from the exact
//! one.
//!
//! A mismatch is *grazing* only if the exact count changes within the pixel's own footprint. The footprint is
//! the visible surface at most one step sideways, and everything within the depth bound of this surface along
//! the ray. The search samples some 260 positions, and the outline where the visible surface ends between two
//! of them. Too few positions can only call more mismatches real.
//!
//! - **Sideways**: vertices are snapped to 1/256 pixel (the sub-pixel precision of all common rasterizers).
//!   Their clip coordinates err by at most 4.5u of the products' magnitudes in each of two dot products (u =
//!   2⁻²³: the difference to the eye, the row's own rounding, a product, two sums). The oracle's ray errs by
//!   u of its length. Let `s` be the length of the longer row, and `c` the length of the ray through a corner
//!   of the picture. Then the error is less than `8u·(1 + s)·c` of half the picture's longer side. So the
//!   step is `1/256 + 4u·(1 + s)·c·max(width, height)` pixels. The second term dominates only for a field of
//!   view of a few degrees.
//! - **Along the ray**: the error of two depths computed from planes. A depth is `near·(n·r)/(n·a)` with the
//!   plane's normal `n`, the ray `r`, and `a` from the eye to a corner. The numerator errs by 10u of
//!   `|n||r|/|n·r|` (three rounded coefficients and three sums), the denominator by 5u of `|n||a|/|n·a|`. Let
//!   `h` be the eye's distance from the plane. Let `D` be the larger of two distances from the eye: that of
//!   the face's first corner, to which the shader anchors its plane, and that of the point itself. Then the
//!   error is in all 16u of `D/h`. Where the two planes are far from parallel, a step sideways changes the
//!   distance between the planes by more than this error. Where the planes are nearly parallel, `h` is the
//!   same for both. So the bound is `32u·D/h` of the depth.
//!
//!   This bound takes the depth of a side of the volume at a point of the side, at most one step from the
//!   ray. A pixel may be covered just beyond the side's silhouette edge, or beyond the line below a vertex
//!   where two sides meet. There the plane of a side that is seen nearly edge-on may have any depth. The
//!   shader moves such a pixel back to the line.
//!
//!   Not in the bound: the side of an edge nearly in line with the light, whose plane is less exact. Such a
//!   mismatch is called real.
//!
//! Anything wider would forgive cracks of one pixel. Where the exact count changes within a footprint, any
//! count passes.

use glam::{DVec2, DVec3};

use super::ray_point::RayPoint;
use super::{Pixels, Seen};
use crate::geom::predicate::{Homogeneous, Rounded, Sign, orient3d_rounded};
use crate::geom::{Aabb, Segment};
use crate::mesh::FaceId;
use crate::view::{Projection, Size};

/// Eight offsets of one whole step, on the rim of the square from −1 to 1.
const RIM: [[f64; 2]; 8] =
    [[-1.0, -1.0], [0.0, -1.0], [1.0, -1.0], [-1.0, 0.0], [1.0, 0.0], [-1.0, 1.0], [0.0, 1.0], [1.0, 1.0]];

/// 256 offsets spread evenly over the square from −1 to 1, by the additive recurrence of the plastic number
/// (Martin Roberts, *The Unreasonable Effectiveness of Quasirandom Sequences*, 2018).
fn inside_the_square() -> impl Iterator<Item = [f64; 2]> {
    const PLASTIC: f64 = 1.324_717_957_244_746;
    (1..=256).map(|i| [PLASTIC, PLASTIC * PLASTIC].map(|base| 2.0 * (f64::from(i) / base).fract() - 1.0))
}

/// Sideways reach of a pixel's footprint, in pixels.
pub(crate) fn step(projection: &Projection, size: Size) -> f64 {
    const U: f64 = f32::EPSILON as f64;
    let length = |row: [f32; 3]| DVec3::from(row.map(f64::from)).length();
    let rows = 1.0 + length(projection.right).max(length(projection.up));
    let corners = [DVec2::ONE, DVec2::NEG_ONE, DVec2::new(1.0, -1.0), DVec2::new(-1.0, 1.0)];
    let corner = corners.map(|corner| projection.ray(corner).length()).into_iter().fold(0.0, f64::max);
    1.0 / 256.0 + 4.0 * U * rows * corner * f64::from(size.width().max(size.height()))
}

impl Pixels<'_> {
    /// Whether the exact count changes within one step of `place`, a position in the picture.
    pub(super) fn changes_sideways(&self, here: &Seen, place: [f64; 2], thorough: bool) -> bool {
        let surfaces = self.surfaces(here);
        // The rim comes first: most changes are found there.
        let inside = inside_the_square().take(if thorough { usize::MAX } else { 0 });
        RIM.into_iter().chain(inside).map(|at| self.beside(place, at)).any(|beside| {
            let Some(there) = self.look(beside) else { return true };
            here.differs(&there)
                || self.changes_along_the_ray(&there)
                || thorough
                    && self.surfaces(&there) != surfaces
                    && self.changes_on_the_way(here, &surfaces, [place, beside])
        })
    }

    /// Whether the outline of the mesh passes within one step of `place`: sky beside a surface, or a surface
    /// beside sky.
    pub(super) fn is_at_outline(&self, surface: bool, place: [f64; 2]) -> bool {
        let mut places = RIM.into_iter().chain(inside_the_square()).map(|at| self.beside(place, at));
        places.any(|beside| self.look(beside).is_some() != surface)
    }

    /// The position `[x, y]` steps away from `place`.
    fn beside(&self, place: [f64; 2], [x, y]: [f64; 2]) -> [f64; 2] {
        [place[0] + self.step * x, place[1] + self.step * y]
    }

    /// Whether the volume begins or ends where a surface ends between two positions. This happens at a
    /// silhouette edge: both of its sides may well count the same, except for a strip too thin for a sample
    /// to hit.
    fn changes_on_the_way(&self, here: &Seen, surfaces: &[FaceId], [from, to]: [[f64; 2]; 2]) -> bool {
        let between = |s: f64| [0, 1].map(|i| from[i] + s * (to[i] - from[i]));
        let (mut same, mut other) = (0.0_f64, 1.0_f64);
        // Bisection down to 2⁻²⁴ of the step.
        for _ in 0..24 {
            let middle = 0.5 * (same + other);
            match self.look(between(middle)) {
                Some(there) if here.differs(&there) => return true,
                Some(there) if self.surfaces(&there) == surfaces => same = middle,
                _ => other = middle,
            }
        }
        let all = |s| self.look(between(s)).is_some_and(|seen| self.changes_along_the_ray(&seen));
        all(same) || all(other)
    }

    /// Whether a side of the volume begins or ends within the depth bound along the ray. Caps need no test:
    /// they lie behind the visible surface by definition.
    pub(super) fn changes_along_the_ray(&self, seen: &Seen) -> bool {
        let bound = self.depth_bound(seen);
        let eye = self.rendered.projection.eye;
        let [p, q] =
            [-bound, bound].map(|part| RayPoint::new(eye, seen.direction, (1.0 + part) * seen.visible.t));
        // In the triangle of both points and the light, no point is farther from the segment `p`–light than
        // `q` is.
        let apart = DVec3::from(p.at).distance(DVec3::from(q.at));
        let reach = ((2.0 * apart) as f32 + 2.0 * p.slack).min(f32::MAX);
        let way = Segment::to_light(p.world, self.rendered.light);
        let ends = [p, q].map(|point| Rounded::point(point.at));
        let mut found = false;
        self.edge_tree.walk(
            |aabb| {
                let low = aabb.low.map(|x| (x - reach).next_down().max(f32::MIN));
                let high = aabb.high.map(|x| (x + reach).next_up().min(f32::MAX));
                way.may_meet(&Aabb { low, high })
            },
            |slot| {
                let edge = self.edges[self.edge_tree.order()[slot] as usize];
                found = is_swept(edge.map(|end| self.relative(Homogeneous::point(end))), ends, self.light);
                !found
            },
        );
        found
    }

    /// The visible surface, and all other faces within the depth bound.
    fn surfaces(&self, seen: &Seen) -> Vec<FaceId> {
        let mut faces = vec![seen.visible.face];
        let bound = self.depth_bound(seen);
        let range = [1.0 - bound, 1.0 + bound].map(|part| part * seen.visible.t);
        self.seen.for_each_hit(self.rendered.projection.eye, seen.direction, range, |face| faces.push(face));
        faces.sort_unstable();
        faces.dedup();
        faces
    }

    /// The error bound of two depths, relative to the depth of the visible point.
    fn depth_bound(&self, seen: &Seen) -> f64 {
        const U: f64 = f32::EPSILON as f64;
        let wide = |p: [f32; 3]| DVec3::from(p.map(f64::from));
        let [a, b, c] = seen.visible.corners.map(|corner| wide(corner) - wide(self.rendered.projection.eye));
        let normal = (b - a).cross(c - a).normalize_or_zero();
        let at = seen.visible.t * DVec3::from(seen.direction.map(f64::from));
        let farthest = a.length().max(at.length());
        let height = normal.dot(a).abs();
        (32.0 * U * farthest / height).min(0.5) // also for a height of 0
    }
}

/// Whether the side that the light extrudes from an edge meets the segment between two points. Equivalently:
/// whether the edge meets the triangle of the segment and the light. An edge in the plane of this triangle
/// does not count.
///
/// Signs that rounding leaves open count as zero.
fn is_swept([a, b]: [Rounded; 2], [p, q]: [Rounded; 2], light: Rounded) -> bool {
    let sides = [orient3d_rounded([p, q, light, a]), orient3d_rounded([p, q, light, b])];
    if sides[0] == sides[1] {
        return false;
    }
    let around = [
        orient3d_rounded([a, b, p, q]),
        orient3d_rounded([a, b, q, light]),
        orient3d_rounded([a, b, light, p]),
    ];
    !(around.contains(&Sign::Positive) && around.contains(&Sign::Negative))
}
