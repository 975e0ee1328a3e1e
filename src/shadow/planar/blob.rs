//! A dark spot under each caster, from its bounding sphere alone: the technique `blob`.
//!
//! A sphere of radius R whose center is z above a plane hides the part `R²·z / (x² + z²)^(3/2)` of the light
//! that the sky sends to the plane at the distance x from the sphere's foot, as long as it does not reach
//! below the plane; a sunken sphere is raised to rest on it. This is the closed form of ambient occlusion:
//! the position of the lamp plays no part, and what the lamp hides is not computed at all.

use glam::DVec3;

use super::Plane;
use super::coverage::slack;
use super::options::PlanarOptions;
use super::rays::LampRays;
use crate::caster::{Caster, CasterGroup};
use crate::mesh::FaceId;
use crate::scene::Lamp;
use crate::shadow::LampShadow;
use crate::shadow::{Answer, Claim, Samples, Visibility};

/// Most shells of all casters that have a sphere each; more have one together.
const MOST_SPHERES: usize = 256;

#[derive(Debug)]
struct Blob<'a> {
    casters: &'a CasterGroup<'a>,
    lamp: Lamp,
    options: PlanarOptions,
    rays: LampRays<'a>,
}

/// A sphere above a plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Sphere {
    center: DVec3,
    radius: f64,
}

pub(in crate::shadow) fn blob<'a>(
    casters: &'a CasterGroup<'a>,
    lamp: &Lamp,
    options: PlanarOptions,
) -> Box<dyn LampShadow + 'a> {
    Box::new(Blob { casters, lamp: lamp.clone(), options, rays: LampRays::hard(casters, lamp) })
}

impl Sphere {
    /// A sphere around the middle of the points' box; `None` without points.
    fn around(points: impl Iterator<Item = DVec3> + Clone) -> Option<Self> {
        let low = points.clone().reduce(DVec3::min)?;
        let high = points.clone().reduce(DVec3::max)?;
        let center = 0.5 * low + 0.5 * high;
        let radius = points.map(|p| p.distance(center)).fold(0.0, f64::max);
        Some(Self { center, radius })
    }

    /// The part of the sky that the sphere hides from a point of the plane.
    pub(super) fn hides(&self, plane: &Plane, p: DVec3) -> f64 {
        let Self { center, radius } = *self;
        let height = plane.normal.dot(center - plane.origin);
        let z = height.max(radius);
        let across = center - p;
        let x2 = (across.length_squared() - plane.normal.dot(across).powi(2)).max(0.0);
        // Of points of no extent: nothing.
        if radius > 0.0 { radius * radius * z / (x2 + z * z).powf(1.5) } else { 0.0 }
    }
}

/// A sphere around the part in front of the plane of each shell.
pub(super) fn spheres(casters: &CasterGroup<'_>, plane: &Plane) -> Vec<Sphere> {
    let slack = slack(casters, plane);
    let in_front = |caster: &&Caster, face: FaceId| {
        let corners = caster.mesh().corners(face).into_iter();
        corners
            .filter(|&p| plane.height(p) > slack)
            .map(|p| DVec3::from(p.map(f64::from)))
            .collect::<Vec<_>>()
    };
    let count: usize = casters.casters().iter().map(|caster| caster.shells().count).sum();
    let mut shells = vec![Vec::new(); count.clamp(1, MOST_SPHERES)];
    let mut first = 0;
    for caster in casters.casters() {
        for (face, shell) in caster.shells().of_face.iter().enumerate() {
            let Some(shell) = shell else { continue };
            let own = if count > MOST_SPHERES { 0 } else { first + *shell as usize };
            shells[own].extend(in_front(caster, FaceId::new(face)));
        }
        first += caster.shells().count;
    }
    shells.iter().filter_map(|points| Sphere::around(points.iter().copied())).collect()
}

impl LampShadow for Blob<'_> {
    fn shade(&self, samples: &Samples) -> Visibility {
        let light = self.lamp.light();
        let plane = self.options.plane.plane(samples, light);
        let plane = plane.and_then(|plane| plane.towards(light));
        let spheres = plane.map_or_else(Vec::new, |plane| spheres(self.casters, &plane));
        Visibility::of(samples, light, Claim::Approximate, |hit| match plane {
            Some(plane) if plane.holds(hit.corners) => {
                let p = DVec3::from(hit.point.map(f64::from));
                let hidden: f64 = spheres.iter().map(|sphere| sphere.hides(&plane, p)).sum();
                Answer::of(1.0 - hidden.clamp(0.0, 1.0) as f32)
            }
            _ => self.rays.answer(hit),
        })
    }

    fn bytes(&self) -> usize {
        0
    }
}
