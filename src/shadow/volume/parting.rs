//! Planes that part the shadow volume of a box from receivers.
//!
//! The shadow volume of a box is the set of its points `v`, and of all points beyond them on the rays of the
//! lamp: the non-negative combinations of v and of `v − l` at infinity, for all points l of the lamp. The
//! receivers are the combinations of some points and, for a view, of its corner rays at infinity. A plane
//! parts the two iff its normal n fulfills
//!
//! - `n·v < n·a` for all points v of the box and all points a of the receivers,
//! - `n·(v − l) < 0` for all v and l, and `n·r > 0` for all corner rays r.
//!
//! Boxes make each of these a single expression: the greatest `n·v` is `n·center + |n|·half`. The search for
//! a normal is Gilbert's iteration (Elmer G. Gilbert, *An Iterative Procedure for Computing the Minimum of a
//! Quadratic Form on a Convex Set*, 1966): the normal moves towards the vector that violates it most. What
//! it finds is checked with all roundings; what it does not find is kept.
//!
//! # Effect of rounding
//!
//! Each expression has fewer than 16 roundings of at most 2⁻⁵³ of its terms; [`ERROR`] is 2⁷ roundings. A
//! view is enlarged by one pixel on each side, and its eye by the roundings of the visible points. So what is
//! dropped also draws no fragment, if the clip coordinates of the drawn volume err by at most
//! `2⁻²⁰·Σ|rowᵢ·qᵢ|` each; [`DRAWN`] is twice that, and [`FLUSH`] is what is lost where small numbers are
//! flushed to zero. (The derivation is that of the light pyramid of the stencil pass.)

use glam::{DMat3, DVec2, DVec3};

use crate::geom::Aabb;
use crate::scene::{Lamp, LampShape};
use crate::view::{Projection, Size};

/// See the head of this file.
const ERROR: f64 = 1.0 / (1_u64 << 46) as f64;
const DRAWN: f64 = 1.0 / (1 << 19) as f64;
const FLUSH: f64 = f32::MIN_POSITIVE as f64;
/// Beyond this a clip coordinate might leave `f32`, and nothing is claimed.
const LARGEST: f64 = 1.0 / FLUSH;

/// A box by its center and the halves of its sides.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Centered {
    at: DVec3,
    half: DVec3,
}

impl Centered {
    pub(crate) fn of(aabb: &Aabb) -> Self {
        let [low, high] = [aabb.low, aabb.high].map(|p| DVec3::from(p.map(f64::from)));
        Self { at: 0.5 * (low + high), half: 0.5 * (high - low) }
    }

    fn minus(self, origin: DVec3) -> Self {
        Self { at: self.at - origin, ..self }
    }

    /// Bound of the magnitudes of all coordinates.
    fn size(&self) -> DVec3 {
        self.at.abs() + self.half
    }

    fn most(&self, n: DVec3) -> f64 {
        n.dot(self.at) + n.abs().dot(self.half)
    }

    fn least(&self, n: DVec3) -> f64 {
        n.dot(self.at) - n.abs().dot(self.half)
    }

    /// The corner where `n·v` is greatest.
    fn farthest(&self, n: DVec3) -> DVec3 {
        self.at + n.signum() * self.half
    }
}

/// A box around all points of a lamp, or around all its directions.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LampBox {
    place: Centered,
    is_directional: bool,
}

impl LampBox {
    pub(crate) fn of(lamp: &Lamp) -> Self {
        let at = DVec3::from(lamp.light().xyz().map(f64::from));
        let half = match &lamp.shape {
            LampShape::Hard(_) => DVec3::ZERO,
            LampShape::Disk { radius, .. } => DVec3::splat(f64::from(*radius)),
            LampShape::Sun { half_angle_rad, .. } => {
                // A half-space has no bound: nothing is parted from it.
                let tangent = f64::from(*half_angle_rad).tan();
                DVec3::splat(if tangent >= 0.0 {
                    at.length() * tangent * (1.0 + ERROR)
                } else {
                    f64::INFINITY
                })
            }
            LampShape::Rectangle(rectangle) => {
                let [u, v] = rectangle.edges().map(|edge| DVec3::from(edge.map(f64::from)));
                // The center is rounded to `f32`, by 2⁻²⁴ of a coordinate.
                0.5 * (u.abs() + v.abs()) + at.abs() / f64::from(1 << 23)
            }
        };
        Self { place: Centered { at, half }, is_directional: lamp.light().is_directional() }
    }

    /// A bound of the distance of a lamp's points from its center; 0 for a lamp without extent.
    pub(crate) fn radius(&self) -> f64 {
        self.place.half.length() * (1.0 + ERROR)
    }

    /// Whether no point of the lamp lies in a box; a directional lamp is far away.
    pub(crate) fn is_off(&self, bounds: &Aabb) -> bool {
        let bounds = Centered::of(bounds);
        let gap = (bounds.at - self.place.at).abs() - (bounds.half + self.place.half) * (1.0 + ERROR);
        self.is_directional || gap.max_element() > ERROR * bounds.size().max(self.place.size()).max_element()
    }

    /// A box around `v − l`, for all v of a box and all l of the lamp.
    fn away(&self, volume: &Centered) -> Centered {
        match self.is_directional {
            true => Centered { at: -self.place.at, ..self.place },
            false => Centered { at: volume.at - self.place.at, half: volume.half + self.place.half },
        }
    }

    /// The point nearest to `p`, roughly, on the way from `from` to the lamp.
    fn nearest(&self, from: DVec3, p: DVec3) -> DVec3 {
        let along = if self.is_directional { self.place.at } else { self.place.at - from };
        let t = (p - from).dot(along) / along.length_squared();
        let end = if self.is_directional { f64::INFINITY } else { 1.0 };
        if t > 0.0 { from + t.min(end) * along } else { from }
    }
}

/// Receivers: a box of points, and corner rays.
#[derive(Clone, Debug)]
struct Receivers {
    points: Centered,
    rays: [DVec3; 4],
    ray_count: usize,
}

/// What is parted, and the last normal that parted it: the first to try for the next box.
#[derive(Clone, Debug)]
pub(crate) struct Parting {
    lamp: LampBox,
    normal: DVec3,
    /// Whether the points at infinity are forgotten.
    no_extruded: bool,
}

/// A view as a drawn volume sees it.
#[derive(Clone, Debug)]
pub(crate) struct Frustum {
    eye: DVec3,
    receivers: Receivers,
    rows: [DVec3; 3],
    /// From the coordinates of the three rows to space.
    inverse: DMat3,
}

impl Frustum {
    /// The view of a picture, for visible points of a scene in a box.
    pub(crate) fn of(projection: &Projection, size: Size, bounds: &Aabb) -> Self {
        let wide = |p: [f32; 3]| DVec3::from(p.map(f64::from));
        let rows = [projection.right, projection.up, projection.forward].map(wide);
        let inverse = DMat3::from_cols(rows[0], rows[1], rows[2]).transpose().inverse();
        let eye = wide(projection.eye);
        // One pixel, of 2 units over all pixels of a row or column.
        let margin = DVec2::new(2.0 / f64::from(size.width()), 2.0 / f64::from(size.height()));
        let corner = |x: f64, y: f64| DVec2::new(x, y) * (1.0 + margin);
        let corners = [corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)];
        // Visible points are rounded to `f32`, and moved by some units in their last place.
        let scene = Centered::of(bounds).size().max(eye.abs());
        let rounding = scene.max_element() / f64::from(1 << 20);
        let (half, rays, ray_count) = match projection.is_orthographic() {
            false => (DVec3::ZERO, corners.map(|xy| inverse * xy.extend(1.0)), 4),
            true => {
                let reach = corners.map(|xy| (inverse * xy.extend(0.0)).abs());
                (reach[0].max(reach[1]), [inverse * DVec3::Z; 4], 1)
            }
        };
        let points = Centered { at: DVec3::ZERO, half: half + rounding };
        Self { eye, receivers: Receivers { points, rays, ray_count }, rows, inverse }
    }

    /// How much a drawn clip coordinate may err, as a bound of `slack·|q|` for the function with the normal
    /// n; and what may be lost to flushed numbers, times a bound of the coordinates.
    fn slack(&self, n: DVec3) -> (DVec3, f64) {
        let weights = [0, 1, 2].map(|i| n.dot(self.inverse.col(i)).abs());
        let slack = (0..3).map(|i| weights[i] * self.rows[i].abs()).sum::<DVec3>();
        (DRAWN * slack, FLUSH * weights.iter().sum::<f64>())
    }

    /// Whether a point seems to lie in the view: nothing around it is parted.
    fn holds(&self, p: DVec3) -> bool {
        let [x, y, distance] = self.rows.map(|row| row.dot(p));
        let w = if self.receivers.ray_count == 1 { 1.0 } else { distance };
        distance > 0.0 && x.abs() < w && y.abs() < w
    }
}

/// Steps of the search for a view, and for a tile.
const VIEW_STEPS: usize = 24;
const TILE_STEPS: usize = 8;

impl Parting {
    pub(crate) fn new(lamp: LampBox, no_extruded: bool) -> Self {
        Self { lamp, normal: DVec3::X, no_extruded }
    }

    /// Whether a plane parts the shadow volume of `bounds` from a view, as it is drawn.
    pub(crate) fn parts_view(&mut self, frustum: &Frustum, bounds: &Aabb) -> bool {
        let volume = Centered::of(bounds).minus(frustum.eye);
        let lamp = match self.lamp.is_directional {
            true => self.lamp,
            false => LampBox { place: self.lamp.place.minus(frustum.eye), ..self.lamp },
        };
        let away = lamp.away(&volume);
        let largest = frustum.rows.map(|row| row.abs().dot(volume.size().max(away.size()))).into_iter();
        if !largest.fold(0.0, f64::max).le(&LARGEST) || frustum.holds(volume.at) {
            return false;
        }
        let is_proof = |n: DVec3| {
            let (slack, flush) = frustum.slack(n);
            let rows = frustum.rows.iter().map(|row| row.abs().element_sum()).sum::<f64>();
            let lost = |size: DVec3| slack.dot(size) + flush * (size.element_sum() + 8.0 + rows);
            let Receivers { points, rays, ray_count } = &frustum.receivers;
            let apart = points.least(n) - volume.most(n);
            let most = apart.abs().max(volume.most(n).abs());
            apart > lost(volume.size()) + DRAWN * most + ERROR * n.abs().dot(volume.size())
                && (self.no_extruded || away.most(n) < -lost(away.size()) - ERROR * n.abs().dot(away.size()))
                && rays[..*ray_count].iter().all(|ray| n.dot(*ray) > ERROR * n.abs().dot(ray.abs()))
        };
        let found = self.search(&frustum.receivers, &volume, &away, self.normal, VIEW_STEPS, is_proof);
        self.keep(found)
    }

    /// Whether a plane parts the shadow volume of `bounds` from all points of a box.
    pub(crate) fn parts_box(&mut self, tile: &Aabb, bounds: &Aabb) -> bool {
        if tile.overlaps(bounds) {
            return false;
        }
        let (points, volume) = (Centered::of(tile), Centered::of(bounds));
        let away = self.lamp.away(&volume);
        let size = volume.size().max(points.size()).max(away.size());
        let is_proof = |n: DVec3| {
            let error = ERROR * n.abs().dot(size);
            points.least(n) - volume.most(n) > error && (self.no_extruded || away.most(n) < -error)
        };
        if is_proof(self.normal) {
            return true;
        }
        // Away from the box, towards the nearest point of the way from the tile to the lamp.
        let start = self.lamp.nearest(points.at, volume.at) - volume.at;
        let receivers = Receivers { points, rays: [DVec3::ZERO; 4], ray_count: 0 };
        let found = self.search(&receivers, &volume, &away, start, TILE_STEPS, is_proof);
        self.keep(found)
    }

    fn keep(&mut self, normal: Option<DVec3>) -> bool {
        self.normal = normal.unwrap_or(self.normal);
        normal.is_some()
    }

    /// A normal that fulfills `is_proof`, if one is found.
    fn search(
        &self,
        receivers: &Receivers,
        volume: &Centered,
        away: &Centered,
        start: DVec3,
        steps: usize,
        is_proof: impl Fn(DVec3) -> bool,
    ) -> Option<DVec3> {
        let mut normal = start.try_normalize().unwrap_or(DVec3::X);
        for _ in 0..steps {
            if is_proof(normal) {
                return Some(normal);
            }
            // Each of these should make a positive product with the normal; the least does so worst.
            let between = receivers.points.farthest(-normal) - volume.farthest(normal);
            let mut worst = (f64::INFINITY, DVec3::ZERO);
            let mut ask = |v: DVec3| {
                if let Some(unit) = v.try_normalize()
                    && normal.dot(unit) < worst.0
                {
                    worst = (normal.dot(unit), unit);
                }
            };
            ask(between);
            if !self.no_extruded {
                ask(-away.farthest(normal));
            }
            receivers.rays[..receivers.ray_count].iter().for_each(|&ray| ask(ray));
            let step = normal - worst.1;
            let length = step.length_squared();
            if length == 0.0 {
                return None;
            }
            normal -= step * (normal.dot(step) / length).clamp(0.0, 1.0);
            // Only its direction matters; the length falls as the gap does.
            if normal.length_squared() <= f64::MIN_POSITIVE {
                return None;
            }
        }
        is_proof(normal).then_some(normal)
    }
}
