//! The size of a light: where its rays to a point may pass.
//!
//! # How far rays leave the cell
//!
//! A light of radius ρ around L is the set of the points L + ρe, |e| ≤ 1. Let d be the depth z of a point p,
//! and s its slopes `(pᵢ − Lᵢ)/d`. A ray from p to L + ρe is at depth z at the parameter
//! `t = (d − z)/(d − ρeₖ)`, at most `(d − z)/(d − ρ)`, and there `yᵢ − yᵢ(p) = tρ(eᵢ − sᵢeₖ)/z`. So
//! |y − y(p)| is at most
//!
//! `ρ·√(1 + sᵢ²)·(d − z)/(z·(d − ρ))`, which falls with z.
//!
//! A sun with the tangent ρ is the set of the directions l + ρu, l of length 1, u ⟂ l, |u| ≤ 1. After a climb
//! h along the axis, `|y − y(p)| ≤ ρ·√(1 + sᵢ²)·h/(|lₖ| − ρ)`, with the slopes s of l.
//!
//! # How near to the light a face may be
//!
//! Let D = |p − L|, and let no face be nearer to L than R. A point of a ray with a depth of at most z₀ has a
//! distance from L of at most `ρ + D·(z₀ + ρ)/(d − ρ)`, since 1 − t is at most (z₀ + ρ)/(d − ρ). So nothing
//! blocks a ray beyond the depth `z₀ = (R − ρ)(d − ρ)/D − ρ`, and of all faces those parts alone count whose
//! depth is more than that.
//!
//! All of this is computed with fewer than 64 roundings, each of at most 2⁻⁵³ of the terms that are added up;
//! [`SLACK`] of these terms is added on the safe side.

use super::chain::Chain;
use super::view::{Projected, View};
use crate::geom::Aabb;
use crate::geom::predicate::{Homogeneous, height, side_of_light, side_of_point};
use crate::oracle::PrimaryHit;
use crate::scene::{Lamp, LampShape};

/// See the head of this file.
const SLACK: f64 = 1.0 / (1_u64 << 40) as f64;

/// The size of a light, and what is near it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Extent {
    /// ρ: a radius, or the tangent of an angle.
    radius: f64,
    /// Least distance of a face from a point light.
    clearance: f64,
    casting: Aabb,
}

impl Extent {
    pub(super) fn of(chain: &Chain<'_>, lamp: &Lamp) -> Self {
        let length = |v: [f64; 3]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
        let light = lamp.light().xyz().map(f64::from);
        let radius = match &lamp.shape {
            LampShape::Hard(_) => 0.0,
            LampShape::Disk { radius, .. } => f64::from(*radius),
            LampShape::Sun { half_angle_rad, .. } => f64::from(*half_angle_rad).tan(),
            LampShape::Rectangle(rectangle) => {
                let [u, v] = rectangle.edges().map(|edge| edge.map(f64::from));
                let diagonal = |sign: f64| length([0, 1, 2].map(|i| u[i] + sign * v[i]));
                // The center is rounded to `f32`, by 2⁻²⁴ of a coordinate.
                0.5 * diagonal(1.0).max(diagonal(-1.0)) + length(light) / f64::from(1 << 23)
            }
        };
        let mut clearance = f64::INFINITY;
        for face in chain.all_faces() {
            let bounds = Aabb::around(face.corners);
            let gap =
                |i: usize| (f64::from(bounds.low[i]) - light[i]).max(light[i] - f64::from(bounds.high[i]));
            clearance = clearance.min(length([0, 1, 2].map(|i| gap(i).max(0.0))));
        }
        let casting = Aabb::around(chain.all_faces().flat_map(|face| face.corners));
        Self { radius: radius * (1.0 + SLACK), clearance: clearance * (1.0 - SLACK), casting }
    }

    /// The nearness beyond which nothing blocks a ray of a point; `None` if there is none.
    pub(super) fn start(
        &self,
        chain: &Chain<'_>,
        view: &View,
        p: [f32; 3],
        projected: &Projected,
    ) -> Option<f64> {
        if chain.light().is_directional() {
            let [of_low, of_high] = [self.casting.low, self.casting.high].map(|p| view.project(p).height);
            let top = of_low.max(of_high);
            return (!self.casting.is_empty()).then_some(top + SLACK * top.abs());
        }
        let light = chain.light().xyz();
        let away = [0, 1, 2].map(|i| f64::from(p[i]) - f64::from(light[i]));
        let distance = away.iter().map(|x| x * x).sum::<f64>().sqrt();
        let depth = projected.at[2];
        let free = (self.clearance - self.radius) * (depth - self.radius) / distance;
        let free = free - self.radius - SLACK * (free.abs() + self.radius);
        let is_clear = free > 0.0 && self.clearance > self.radius && depth > self.radius;
        let nearness = view.nearness_at(free.min(depth));
        (is_clear && nearness.is_finite()).then_some(nearness + SLACK * (1.0 + nearness.abs()))
    }

    /// Bounds of |y − y(p)| for all rays of a point up to a nearness.
    pub(super) fn reach(
        &self,
        chain: &Chain<'_>,
        view: &View,
        p: [f32; 3],
        projected: &Projected,
        top: f64,
    ) -> [f64; 2] {
        let [k, i, j] = view.axes();
        let l = chain.light().xyz().map(f64::from);
        let widened =
            |slope: f64, share: f64| self.radius * (1.0 + slope * slope).sqrt() * share * (1.0 + SLACK);
        if chain.light().is_directional() {
            let length = l.iter().map(|x| x * x).sum::<f64>().sqrt();
            let climb = (top - projected.height).max(0.0) + SLACK * (top.abs() + projected.height.abs());
            let left = l[k].abs() / length * (1.0 - SLACK) - self.radius;
            let share = if left > 0.0 { climb / left } else { f64::INFINITY };
            return view.slope().map(|slope| widened(slope, share));
        }
        let depth = projected.at[2];
        let least = view.depth_at(top) * (1.0 - SLACK);
        let left = least * (depth - self.radius) * (1.0 - SLACK);
        let share = ((depth - least).max(0.0) + SLACK * depth) / left;
        let share = if least > 0.0 && left > 0.0 { share } else { f64::INFINITY };
        [i, j].map(|axis| widened((f64::from(p[axis]) - l[axis]) / depth, share))
    }

    /// Whether a visible point, and all of the light, are in front of the visible face, on one side of it.
    pub(super) fn is_before(&self, chain: &Chain<'_>, hit: &PrimaryHit) -> bool {
        let side = side_of_light(hit.corners, chain.light());
        if side.is_zero() || side_of_point(hit.corners, hit.point) != side {
            return false;
        }
        let [a, b, c] = hit.corners.map(|corner| corner.map(f64::from));
        let (u, v) = ([0, 1, 2].map(|i| b[i] - a[i]), [0, 1, 2].map(|i| c[i] - a[i]));
        let normal = [0, 1, 2].map(|i| u[(i + 1) % 3] * v[(i + 2) % 3] - u[(i + 2) % 3] * v[(i + 1) % 3]);
        let length = |v: [f64; 3]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
        let reach =
            if chain.light().is_directional() { length(chain.light().xyz().map(f64::from)) } else { 1.0 };
        // The cross product errs by a few roundings of the product of the lengths.
        let most = self.radius * reach * (length(normal) + SLACK * length(u) * length(v)) * (1.0 + SLACK);
        // Its relative error is 2⁻³⁹.
        height(hit.corners, Homogeneous::light(chain.light())).abs() * (1.0 - 8.0 * SLACK) > most
    }
}
