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
use crate::scene::{Lamp, SpotCone};

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
    /// The cone of a spot light; nothing shines beyond it.
    pub cone: Option<SpotCone>,
    /// How the light weakens with the distance.
    pub falloff: Falloff,
    /// Whether [`render`](super::render) asks what blocks the light; if not, it passes through everything.
    pub shadow: bool,
}

/// How light weakens with the distance from a lamp at a position. A directional lamp is as strong everywhere.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub enum Falloff {
    /// It does not.
    #[default]
    Plain,
    /// With the inverse square of the distance, windowed as KHR_lights_punctual recommends: at the distance
    /// `d` a lamp of the range `r` gives `1/d² · clamp(1 − (d/r)⁴, 0, 1)`.
    Physical {
        /// The distance at which the color of the lamp holds, without the window; above 0.
        full_at: f64,
        /// The distance at which the light ends, above 0.
        range: Option<f32>,
    },
}

/// The most that falloff may strengthen the color of a lamp, so that a half float of the device holds the
/// product with the color, at most 1, and with what a surface reflects, at most 1 + [`SPECULAR`].
pub(super) const MOST_FALLOFF: f32 = 32_768.0;

impl ShadedLight {
    fn new(lamp: &Lamp, color: [f32; 3]) -> Self {
        Self { light: *lamp.light(), color, cone: lamp.cone, falloff: Falloff::Plain, shadow: true }
    }

    /// White lights of equal strength.
    #[must_use]
    pub fn equal<L: Clone + Into<Lamp>>(lamps: &[L]) -> Vec<Self> {
        let color = [KEY / (lamps.len() as f32).sqrt(); 3];
        let shaded = |lamp: Lamp| Self::new(&lamp, color);
        lamps.iter().map(|lamp| shaded(lamp.clone().into())).collect()
    }

    /// Lights of a file, balanced in exposure, since candela and lux do not determine the exposure.
    ///
    /// A light's share is its illuminance at the center of `bounds`: lux as given, candela divided by the
    /// square of the distance (taken as no less than a quarter of the diagonal). Shares are scaled so that
    /// the square root of the sum of their squares is fixed: one light alone is always equally bright. A
    /// light whose intensity is not above 0 gives nothing.
    #[must_use]
    pub fn balanced(lamps: &[Lamp], bounds: &Aabb) -> Vec<Self> {
        let illuminance = |lamp: &Lamp| {
            let distance = distance(lamp.light(), bounds);
            let strongest = lamp.color.iter().fold(0.0_f32, |most, &x| most.max(x));
            let share = f64::from(lamp.intensity) * f64::from(strongest) / distance.powi(2);
            if share.is_finite() && share > 0.0 { share } else { 0.0 }
        };
        let shares: Vec<f64> = lamps.iter().map(illuminance).collect();
        let most = shares.iter().fold(0.0_f64, |most, &x| most.max(x));
        let relative = |share: f64| if most > 0.0 { share / most } else { 0.0 };
        let norm = shares.iter().map(|&share| relative(share).powi(2)).sum::<f64>().sqrt().max(1.0);
        let shaded = |(lamp, &share): (&Lamp, &f64)| {
            let strongest = lamp.color.iter().fold(f32::MIN_POSITIVE, |most, &x| most.max(x));
            let strength = KEY * (relative(share) / norm) as f32;
            let color = lamp.color.map(|x| strength * (x.max(0.0) / strongest).min(1.0));
            Self::new(lamp, color)
        };
        lamps.iter().zip(&shares).map(shaded).collect()
    }

    /// The same lamp with physical falloff, as strong as before at the center of `bounds` (no nearer than a
    /// quarter of the diagonal) if `range` reaches that far.
    #[must_use]
    pub fn with_physical_falloff(self, range: Option<f32>, bounds: &Aabb) -> Self {
        let full_at = distance(&self.light, bounds).max(f64::from(f32::MIN_POSITIVE));
        Self { falloff: Falloff::Physical { full_at, range }, ..self }
    }

    /// The unit vector from `point` towards the light, and the unoccluded color that arrives there.
    fn reach(&self, point: DVec3) -> (Vec3, Vec3) {
        let to_light = wide(self.light.xyz()) - if self.light.is_directional() { DVec3::ZERO } else { point };
        let color = Vec3::from(self.color) * self.strength(to_light.length());
        let to_light = to_light.normalize_or_zero().as_vec3();
        (to_light, self.cone.map_or(color, |cone| color * within(cone, to_light)))
    }

    /// The factor that falloff has at this distance, at most [`MOST_FALLOFF`].
    fn strength(&self, distance: f64) -> f32 {
        match self.falloff {
            Falloff::Physical { full_at, range } if !self.light.is_directional() => {
                let part = range.map_or(0.0, |range| distance / f64::from(range));
                let window = (1.0 - part.powi(4)).clamp(0.0, 1.0);
                ((full_at / distance).powi(2) * window).min(MOST_FALLOFF.into()) as f32
            }
            _ => 1.0,
        }
    }
}

/// The distance from a light to the center of `bounds`, no less than a quarter of the diagonal; 1 for a
/// directional light.
fn distance(light: &Light, bounds: &Aabb) -> f64 {
    match light.is_directional() {
        true => 1.0,
        false => wide(light.xyz()).distance(wide(bounds.center())).max(0.25 * bounds.diagonal()),
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

/// How much of a lamp reaches a visible point on whose side of the face the lamp is, by exact ray cast. A
/// grazing verdict counts as lit.
pub(super) fn exact(casters: &Oracle, lamp: &ShadedLight, point: [f32; 3]) -> f32 {
    match lamp.shadow && casters.verdict(point, &lamp.light) == Verdict::Shadowed {
        true => 0.0,
        false => 1.0,
    }
}

/// The light reflected from a visible point towards the eye. `visibility` says how much of a lamp, by its
/// index, reaches the point.
pub(super) fn shade(
    view: &View<'_>,
    seen: &PrimaryHit,
    direction: Vec3,
    base: Vec3,
    visibility: impl Fn(usize) -> f32,
) -> Vec3 {
    let [a, b, c] = seen.corners.map(wide);
    let to_eye = -direction;
    let normal = (b - a).cross(c - a).normalize_or_zero().as_vec3();
    let normal = if seen.side == Sign::Positive { normal } else { -normal };

    let up = normal[view.up.axis()];
    let open = view.ambient.map_or(1.0, |ambient| ambient(seen.point, normal.to_array()));
    let mut light = base * (AMBIENT + AMBIENT_SLOPE * up) * open;
    for (index, lamp) in view.lamps.iter().enumerate() {
        // The light is behind the seen side of the face: the face itself blocks it.
        if side_of_light(seen.corners, &lamp.light) != seen.side {
            continue;
        }
        let (to_light, arriving) = lamp.reach(wide(seen.point));
        if arriving == Vec3::ZERO {
            continue;
        }
        let arriving = arriving * visibility(index);
        if arriving == Vec3::ZERO {
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

    fn scene_light(light: &str, intensity: f32) -> Lamp {
        Lamp { color: [1.0, 0.5, 0.0], intensity, ..light.parse().unwrap() }
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
    fn physical_falloff_is_the_inverse_square_within_its_window_and_1_at_the_center() {
        let bounds = Aabb { low: [-1.0; 3], high: [1.0; 3] };
        let [lamp] = ShadedLight::equal(&[Light::point([0.0, 4.0, 0.0]).unwrap()])[..] else {
            panic!("one lamp")
        };
        let [endless, ending] = [None, Some(8.0)].map(|range| lamp.with_physical_falloff(range, &bounds));
        for distance in [1.0, 2.0, 4.0, 6.0, 8.0, 9.0] {
            assert_eq!(lamp.strength(distance), 1.0);
            let inverse_square = 16.0 / (distance * distance);
            assert_eq!(endless.strength(distance), inverse_square as f32);
            let window = 1.0 - (distance / 8.0).powi(4);
            assert_eq!(ending.strength(distance), (inverse_square * window.max(0.0)) as f32);
        }
        assert_eq!((endless.strength(4.0), ending.strength(8.0), ending.strength(1e300)), (1.0, 0.0, 0.0));
        assert_eq!((ending.strength(0.0), endless.strength(1e-300)), (MOST_FALLOFF, MOST_FALLOFF));
        let [sun] = ShadedLight::equal(&[Light::directional([0.0, -1.0, 0.0]).unwrap()])[..] else {
            panic!("a sun")
        };
        assert_eq!(sun.with_physical_falloff(Some(1.0), &bounds).strength(100.0), 1.0);
    }

    #[test]
    fn spot_light_fades_between_its_two_angles() {
        let cone = SpotCone { direction: [0.0, -1.0, 0.0], inner_rad: 0.2, outer_rad: 0.4 };
        let at = |angle: f32| within(cone, Vec3::new(angle.sin(), angle.cos(), 0.0));
        assert_eq!((at(0.0), at(0.19), at(0.41), at(3.0)), (1.0, 1.0, 0.0, 0.0));
        assert!(at(0.3) > 0.1 && at(0.3) < 0.9);
    }
}
