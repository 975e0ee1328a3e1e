//! Shading of flat, two-sided faces: hemispheric ambient light, Lambert's diffuse term and Blinn's specular
//! term.
//!
//! Bui Tuong Phong, *Illumination for Computer Generated Pictures*, 1975, with the half vector of James F.
//! Blinn, *Models of Light Reflection for Computer Synthesized Pictures*, 1977.

use glam::{DVec3, Vec3};

use super::View;
use crate::geom::predicate::{Sign, side_of_light};
use crate::geom::{Aabb, Light};
use crate::oracle::{Oracle, PrimaryHit, Verdict};
use crate::scene::{SceneLight, SpotCone};

/// Total light on a white surface. One lamp alone gives this much, n equal lamps `KEY / √n` each, since few
/// surfaces face all of them.
const KEY: f32 = 0.95;

/// Ambient light on faces that look sideways, and the amount added for faces that look straight up or
/// subtracted for those that look straight down.
pub(super) const AMBIENT: f32 = 0.17;
pub(super) const AMBIENT_SLOPE: f32 = 0.07;

/// Strength of the specular highlight, and its exponent as a number of squarings: 2⁵ = 32.
pub(super) const SPECULAR: f32 = 0.12;
pub(super) const SPECULAR_SQUARINGS: u32 = 5;

/// A light for rendering: its strength does not depend on distance, so that nothing is over- or underexposed.
///
/// ```
/// use umbrage::geom::Light;
/// use umbrage::render::ShadedLight;
///
/// let lights = [Light::point([3.0, 5.0, 4.0])?, Light::directional([0.0, -1.0, 0.0])?];
/// let one = ShadedLight::equal(&lights[..1])[0];
/// let two = ShadedLight::equal(&lights);
/// assert!(two[0].color == two[1].color && two[0].color[0] < one.color[0]);
/// # Ok::<(), umbrage::geom::LightError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShadedLight {
    /// The light, as it casts shadows.
    pub light: Light,
    /// The light's contribution to a white surface facing it, in linear red, green, blue.
    pub color: [f32; 3],
    /// The cone of a spot light: nothing outside is lit.
    pub spot: Option<SpotCone>,
}

impl ShadedLight {
    /// White lights of equal strength.
    #[must_use]
    pub fn equal(lights: &[Light]) -> Vec<Self> {
        let color = [KEY / (lights.len() as f32).sqrt(); 3];
        lights.iter().map(|&light| Self { light, color, spot: None }).collect()
    }

    /// Lights of a file, balanced in exposure, since candela and lux do not determine the exposure.
    ///
    /// A light's share is its illuminance at the center of `bounds`: lux as given, candela divided by the
    /// square of the distance (taken as no less than a quarter of the diagonal). Shares are scaled so that
    /// the square root of the sum of their squares is fixed: one light alone is always equally bright. A
    /// light whose intensity is not above 0 gives nothing.
    #[must_use]
    pub fn balanced(lights: &[SceneLight], bounds: &Aabb) -> Vec<Self> {
        let center = wide(bounds.center());
        let near = 0.25 * bounds.diagonal();
        let illuminance = |light: &SceneLight| {
            let distance = match light.light.is_directional() {
                true => 1.0,
                false => wide(light.light.xyz()).distance(center).max(near),
            };
            let strongest = light.color.iter().fold(0.0_f32, |most, &x| most.max(x));
            let share = f64::from(light.intensity) * f64::from(strongest) / distance.powi(2);
            if share.is_finite() && share > 0.0 { share } else { 0.0 }
        };
        let shares: Vec<f64> = lights.iter().map(illuminance).collect();
        let most = shares.iter().fold(0.0_f64, |most, &x| most.max(x));
        let relative = |share: f64| if most > 0.0 { share / most } else { 0.0 };
        let norm = shares.iter().map(|&share| relative(share).powi(2)).sum::<f64>().sqrt().max(1.0);
        let lamp = |(light, &share): (&SceneLight, &f64)| {
            let strongest = light.color.iter().fold(f32::MIN_POSITIVE, |most, &x| most.max(x));
            let strength = KEY * (relative(share) / norm) as f32;
            let color = light.color.map(|x| strength * (x.max(0.0) / strongest).min(1.0));
            Self { light: light.light, color, spot: light.spot }
        };
        lights.iter().zip(&shares).map(lamp).collect()
    }

    /// The unit vector from `point` towards the light, and the unoccluded color that arrives there.
    fn reach(&self, point: DVec3) -> (Vec3, Vec3) {
        let to_light = wide(self.light.xyz()) - if self.light.is_directional() { DVec3::ZERO } else { point };
        let to_light = to_light.normalize_or_zero().as_vec3();
        let color = Vec3::from(self.color);
        (to_light, self.spot.map_or(color, |cone| color * within(cone, to_light)))
    }
}

/// The cosine of a spot light's outer angle, and the difference to the cosine of its inner angle; never 0.
pub(super) fn cosines(cone: SpotCone) -> (f32, f32) {
    let (inner, outer) = (cone.inner_rad.cos(), cone.outer_rad.cos());
    (outer, (inner - outer).max(1e-3))
}

/// Fraction of a spot light in the direction of a point: the curve that KHR_lights_punctual recommends.
fn within(cone: SpotCone, to_light: Vec3) -> f32 {
    let cosine = -Vec3::from(cone.direction).dot(to_light);
    let (outer, width) = cosines(cone);
    ((cosine - outer) / width).clamp(0.0, 1.0).powi(2)
}

/// The light reflected from a visible point towards the eye. A grazing verdict counts as lit.
pub(super) fn shade(
    oracle: &Oracle,
    view: &View<'_>,
    seen: &PrimaryHit,
    direction: Vec3,
    base: Vec3,
) -> Vec3 {
    let [a, b, c] = seen.corners.map(wide);
    let to_eye = -direction;
    let normal = (b - a).cross(c - a).normalize_or_zero().as_vec3();
    let normal = if seen.side == Sign::Positive { normal } else { -normal };

    let up = normal[view.up.axis()];
    let mut light = base * (AMBIENT + AMBIENT_SLOPE * up);
    for lamp in view.lamps {
        // The light is behind the seen side of the face: the face itself blocks it.
        if side_of_light(seen.corners, &lamp.light) != seen.side {
            continue;
        }
        let (to_light, arriving) = lamp.reach(wide(seen.point));
        if arriving == Vec3::ZERO || oracle.verdict(seen.point, &lamp.light) == Verdict::Shadowed {
            continue;
        }
        let half = (to_light + to_eye).normalize_or_zero();
        let highlight = (0..SPECULAR_SQUARINGS).fold(normal.dot(half).max(0.0), |x, _| x * x);
        light += arriving * (base * normal.dot(to_light).max(0.0) + SPECULAR * highlight);
    }
    light
}

fn wide(p: [f32; 3]) -> DVec3 {
    DVec3::from(p.map(f64::from))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scene_light(light: &str, intensity: f32) -> SceneLight {
        let light = light.parse().unwrap();
        SceneLight { name: String::new(), light, color: [1.0, 0.5, 0.0], intensity, spot: None }
    }

    #[test]
    fn balanced_lamps_forget_the_unit_and_keep_the_ratio() {
        let bounds = Aabb { low: [-1.0; 3], high: [1.0; 3] };
        for intensity in [1e-6, 1.0, 5e4, 1e38] {
            let alone = ShadedLight::balanced(&[scene_light("point:0,30,40", intensity)], &bounds);
            assert_eq!(alone[0].color, [KEY, 0.5 * KEY, 0.0]);
        }
        // 2500 cd at 50 units are 1 lx at the center.
        let lights = [scene_light("point:0,30,40", 2500.0 * 3.0), scene_light("directional:0,-1,0", 4.0)];
        let lamps = ShadedLight::balanced(&lights, &bounds);
        assert!((lamps[0].color[0] - 0.6 * KEY).abs() < 1e-6 && (lamps[1].color[0] - 0.8 * KEY).abs() < 1e-6);
    }

    #[test]
    fn balanced_lamps_are_finite_for_any_light() {
        let bounds = Aabb { low: [0.0; 3], high: [0.0; 3] };
        for intensity in [0.0, -1.0, f32::NAN, f32::INFINITY, f32::MAX, f32::from_bits(1)] {
            let mut light = scene_light("point:0,0,0", intensity);
            light.color = [f32::NAN, -1.0, 3e38];
            for lamp in ShadedLight::balanced(&[light, scene_light("point:1,0,0", 1.0)], &bounds) {
                assert!(lamp.color.iter().all(|x| (0.0..=1.0).contains(x)), "{intensity}: {lamp:?}");
            }
        }
        assert_eq!(ShadedLight::balanced(&[], &bounds), []);
    }

    #[test]
    fn spot_light_fades_between_its_two_angles() {
        let cone = SpotCone { direction: [0.0, -1.0, 0.0], inner_rad: 0.2, outer_rad: 0.4 };
        let at = |angle: f32| within(cone, Vec3::new(angle.sin(), angle.cos(), 0.0));
        assert_eq!((at(0.0), at(0.19), at(0.41), at(3.0)), (1.0, 1.0, 0.0, 0.0));
        assert!(at(0.3) > 0.1 && at(0.3) < 0.9);
    }
}
