//! Tests that drop a lamp with all its shadows: it gives no light, none that counts, or none to a sample.

use super::reach::Reach;
use super::receivers::Receivers;
use crate::scene::Lamp;

/// Largest slope of the sRGB curve, at black.
const STEEPEST: f64 = 12.92;
/// Steps of eight bits.
const STEPS: f64 = 255.0;
/// The most that a surface reflects of what arrives: a white one, and its highlight.
const REFLECTED: f64 = 1.12;

/// Whether the lamp gives no light at all: no intensity, no color, or a spot light without an angle.
pub(super) fn is_zero(lamp: &Lamp) -> bool {
    // What is not a number gives nothing either.
    let gives = |color: &f32| lamp.intensity > 0.0 && *color > 0.0;
    !lamp.color.iter().any(gives) || lamp.cone.is_some_and(|cone| cone.outer_rad <= 0.0)
}

/// An upper bound of what the lamp adds to any sample, in steps of eight bits. The lamp's color times its
/// intensity is the linear light that a white surface gets from it: with physical falloff at the distance 1,
/// otherwise at any.
pub(super) fn strongest(
    lamp: &Lamp,
    reach: &Reach,
    receivers: &Receivers<'_>,
    physical_falloff: bool,
) -> f64 {
    let color = lamp.color.iter().fold(0.0_f32, |most, &channel| most.max(channel));
    let arriving = match physical_falloff && !lamp.light().is_directional() {
        true => {
            let nearest = receivers.tiles.boxes().map(|tile| reach.least_distance_squared(tile));
            1.0 / nearest.fold(f64::INFINITY, f64::min)
        }
        false => 1.0,
    };
    STEPS * STEEPEST * REFLECTED * f64::from(color) * f64::from(lamp.intensity) * arriving
}
