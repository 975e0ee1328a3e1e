//! What a rasteriser may do: the footprint of a pixel, within which a count may differ from the exact one.
//!
//! A mismatch is *grazing* only if the exact count changes within the pixel's own footprint: the visible surface at most
//! a step sideways, and what lies within the depth bound of it along the ray. That is looked for at some 260 places, and
//! at the outline where the visible surface ends between two of them; too few places can only call more mismatches real.
//!
//! - **Sideways**: vertices are snapped to 1/256 pixel (the sub-pixel precision
//!   of all common rasterisers), and their clip coordinates err by at most 4.5u of the products' magnitudes in each of
//!   two dot products (u = 2⁻²³: the difference to the eye, the row's own rounding, a product, two sums), which for
//!   vertices in view and fields of view down to 30° is below 16u of the picture's longer side. So the step is
//!   `1/256 + 2⁻¹⁹·max(width, height)` pixels.
//! - **Along the ray**: the error of two depths computed from planes. A depth is `near·(n·r)/(n·a)` with the
//!   plane's normal `n`, the ray `r`, and `a` from the eye to a corner: 10u of `|n||r|/|n·r|` for the numerator (three
//!   rounded coefficients and three sums), 5u of `|n||a|/|n·a|` for the denominator, in all 16u of `D/h` with the
//!   farthest distance `D` of the face's corners and of the point itself, and the eye's distance `h` from the plane. Where the
//!   two planes are far from parallel, a step sideways changes their distance by more than that; where they are not,
//!   `h` is the same for both. So the bound is `32u·D/h` of the depth.
//!
//! Anything wider would forgive cracks of one pixel.

use glam::DVec3;

use super::{Pixels, Seen};
use crate::geom::Light;
use crate::mesh::FaceId;
use crate::oracle::Meeting;
use crate::silhouette::facing_of;

/// Eight places a whole step away.
const RIM: [[f64; 2]; 8] =
    [[-1.0, -1.0], [0.0, -1.0], [1.0, -1.0], [-1.0, 0.0], [1.0, 0.0], [-1.0, 1.0], [0.0, 1.0], [1.0, 1.0]];

/// Places spread evenly over the square from −1 to 1 (the additive recurrence of the plastic number: Martin Roberts,
/// *The Unreasonable Effectiveness of Quasirandom Sequences*, 2018).
fn inside_the_square() -> impl Iterator<Item = [f64; 2]> {
    const PLASTIC: f64 = 1.324_717_957_244_746;
    (1..=256).map(|i| [PLASTIC, PLASTIC * PLASTIC].map(|base| 2.0 * (f64::from(i) / base).fract() - 1.0))
}

impl Pixels<'_> {
    /// Whether the exact count changes within one step of the place.
    pub(super) fn changes_sideways(&self, seen: Option<&Seen>, place: [f64; 2]) -> bool {
        let side = self.size.width().max(self.size.height());
        let step = 1.0 / 256.0 + f64::from(side) / f64::from(1 << 19);
        let beside = |[x, y]: [f64; 2]| [place[0] + step * x, place[1] + step * y];
        // The rim first: that is where most of it shows.
        let places = || RIM.into_iter().chain(inside_the_square()).map(beside);
        places().any(|beside| match (seen, self.look(beside).as_ref()) {
            (None, None) => false,
            (Some(here), Some(there)) => here.differs(there) || self.changes_along_the_ray(there, beside),
            _ => true,
        }) || seen.is_some_and(|here| places().any(|beside| self.changes_on_the_way(here, place, beside)))
    }

    /// Whether between two places a surface ends, and where it does the volume begins or ends: at a silhouette edge, both
    /// sides of which may well count the same, but for a strip too thin to be hit by chance.
    fn changes_on_the_way(&self, here: &Seen, place: [f64; 2], beside: [f64; 2]) -> bool {
        let between = |s: f64| [0, 1].map(|i| place[i] + s * (beside[i] - place[i]));
        let surfaces = self.surfaces(here, place);
        let (mut from, mut to) = (0.0_f64, 1.0_f64);
        // To a 2⁻²⁴th of the step.
        for _ in 0..24 {
            let middle = 0.5 * (from + to);
            match self.look(between(middle)) {
                Some(there) if here.differs(&there) => return true,
                Some(there) if self.surfaces(&there, between(middle)) == surfaces => from = middle,
                _ => to = middle,
            }
        }
        let changes =
            |s| self.look(between(s)).is_some_and(|seen| self.changes_along_the_ray(&seen, between(s)));
        to < 1.0 && (changes(from) || changes(to))
    }

    /// Whether the volume begins or ends within the bound of two depths, at anything but a cap.
    pub(super) fn changes_along_the_ray(&self, seen: &Seen, place: [f64; 2]) -> bool {
        self.ends(seen, place).into_iter().any(|end| {
            let (count, touching) = self.count(end);
            touching || i64::from(count) != i64::from(seen.count) + self.caps_between(seen, end)
        })
    }

    /// The visible surface, and all others within the bound of two depths.
    fn surfaces(&self, seen: &Seen, place: [f64; 2]) -> Vec<FaceId> {
        let mut faces = vec![seen.visible.face];
        for end in self.ends(seen, place) {
            if let Ok(towards) = Light::point(end) {
                self.oracle.for_each_meeting(seen.visible.point, &towards, |face, _| faces.push(face));
            }
        }
        faces.sort_unstable();
        faces.dedup();
        faces
    }

    /// The points on the ray that the bound of two depths reaches to, before and behind the visible point.
    fn ends(&self, seen: &Seen, place: [f64; 2]) -> [[f32; 3]; 2] {
        const U: f64 = f32::EPSILON as f64;
        let wide = |p: [f32; 3]| DVec3::from(p.map(f64::from));
        let eye = wide(self.rendered.projection.eye);
        let [a, b, c] = seen.visible.corners.map(|corner| wide(corner) - eye);
        let normal = (b - a).cross(c - a).normalize_or_zero();
        let at = seen.visible.t * self.ray(place);
        let farthest = [a, b, c, at].iter().fold(0.0_f64, |most, p| most.max(p.length()));
        let height = normal.dot(a).abs();
        let bound = (32.0 * U * farthest / height).min(0.5); // also for a height of 0
        [1.0 - bound, 1.0 + bound].map(|factor| (eye + factor * at).as_vec3().into())
    }

    /// By how much the count changes from the visible point to another point, for the faces in between alone.
    fn caps_between(&self, seen: &Seen, other: [f32; 3]) -> i64 {
        let Ok(towards) = Light::point(other) else { return 0 };
        let mut change = 0;
        self.oracle.for_each_meeting(seen.visible.point, &towards, |face, meeting| {
            if self.rendered.signs[face.index()] == 0 {
                return;
            }
            if let Meeting::Crossing(side) = meeting {
                let lit_side = facing_of(self.rendered.mesh, face, self.rendered.light);
                change += if side == lit_side { -1 } else { 1 };
            }
        });
        change
    }
}
