//! The mean open direction: ∫ ω cos θ dω over the visible parts, in closed form; without a normal ∫ ω dω.
//!
//! For a constant vector n the part of ω (n·ω) along the sphere has the divergence n − 3 ω (n·ω). So over a
//! spherical polygon with the solid angle Ω, whose side from a to b lies in the plane with the normal
//! g = a × b / |a × b|, which is at right angles to the side and points into the polygon,
//!
//! ```text
//! 3 ∫ ω (n·ω) dω = n Ω + Σ (n·g) ∫ ω ds,    ∫ ω ds = (b − a) × g    along a side
//! 2 ∫ ω dω       = Σ (angle from a to b) g
//! ```
//!
//! (Arvo, *Applications of Irradiance Tensors to the Simulation of Non-Lambertian Phenomena*, 1995, section
//! 4, has moments of all orders; the second line is Lambert's.) The integral along a side is small where the
//! side is short, so that the error of g there does no harm.

use std::f64::consts::{PI, TAU};

use glam::DVec3;

use super::pyramid::Pyramid;
use super::sky::solid_angle;
use super::sweep::Trapezoid;

#[derive(Debug)]
pub(super) struct Bent<'a> {
    pyramid: &'a Pyramid,
    /// Unit length.
    normal: Option<DVec3>,
    sum: DVec3,
}

impl<'a> Bent<'a> {
    pub(super) fn new(pyramid: &'a Pyramid, normal: Option<DVec3>) -> Self {
        Self { pyramid, normal, sum: DVec3::ZERO }
    }

    /// The mean over the hemisphere weighted by the cosine, or over the sphere. Nothing hidden: 2/3 of the
    /// normal, or 0.
    pub(super) fn total(&self) -> DVec3 {
        self.sum / if self.normal.is_some() { 3.0 * PI } else { 4.0 * TAU }
    }

    pub(super) fn add(&mut self, Trapezoid { v, left, right }: Trapezoid) {
        if left == right {
            return;
        }
        let corners = [[left[0], v[0]], [right[0], v[0]], [right[1], v[1]], [left[1], v[1]]]
            .map(|[u, v]| self.pyramid.towards(u, v).normalize());
        // A mirrored pyramid turns the corners the other way around.
        let turn = if self.pyramid.mirrored { -1.0 } else { 1.0 };
        for i in 0..4 {
            self.sum += turn * self.side(corners[i], corners[(i + 1) % 4]);
        }
        if let Some(normal) = self.normal {
            let [a, b, c, d] = corners;
            self.sum += (solid_angle([a, b, c]) + solid_angle([a, c, d])) * normal;
        }
    }

    /// The part of a side between unit vectors.
    fn side(&self, a: DVec3, b: DVec3) -> DVec3 {
        let across = a.cross(b);
        let size = across.length();
        if size == 0.0 {
            return DVec3::ZERO;
        }
        let g = across / size;
        match self.normal {
            Some(normal) => normal.dot(g) * (b - a).cross(g),
            None => size.atan2(a.dot(b)) * g,
        }
    }
}
