//! The lamps as they are drawn: how much each adds to a picture.

use umbrage::render::{Falloff, ShadedLight};
use umbrage::scene::Lamp;

use crate::cli::input::Source;

/// How lamps weaken with the distance.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum FalloffArg {
    /// Not at all: as strong far away as near
    Plain,
    /// With the inverse square of the distance, and ending at the light's range, as KHR_lights_punctual
    /// defines it
    Physical,
}

/// The lamps of a source for shading. Those that were asked for are equal; those of a file keep their ratio.
pub(crate) fn shaded(source: &Source, were_asked_for: bool, physical: bool) -> Vec<ShadedLight> {
    let mut shaded = match were_asked_for {
        true => ShadedLight::equal(&source.lights),
        false => ShadedLight::balanced(&source.lights, &source.bounds),
    };
    if physical {
        for (shaded, lamp) in shaded.iter_mut().zip(&source.lights) {
            *shaded = shaded.with_physical_falloff(lamp.range, &source.bounds);
        }
    }
    shaded
}

/// The lamps with the color and intensity that they are drawn with.
pub(crate) fn as_drawn(lamps: &[Lamp], shaded: &[ShadedLight]) -> Vec<Lamp> {
    let drawn = |(lamp, shaded): (&Lamp, &ShadedLight)| {
        let intensity = match shaded.falloff {
            // The color holds at this distance, and the intensity at 1.
            Falloff::Physical { full_at, .. } if !lamp.light().is_directional() => (full_at * full_at) as f32,
            _ => 1.0,
        };
        Lamp { color: shaded.color, intensity, ..lamp.clone() }
    };
    lamps.iter().zip(shaded).map(drawn).collect()
}
