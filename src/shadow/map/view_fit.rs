//! Fitting a directional light's space to a view, in one piece or in slices (cascades).
//!
//! (Fan Zhang et al., *Parallel-Split Shadow Maps for Large-Scale Virtual Environments*, VRCIA 2006.)

use std::ops::RangeInclusive;

use glam::DVec3;

use super::fit::padding;
use super::space::{Frame, LightSpace, Spread, wide};
use crate::shadow::Samples;

/// The weight of logarithmic splits against even ones.
const LOGARITHMIC: f64 = 0.5;

impl LightSpace {
    /// The spaces around `cascades` slices of what a view sees, the nearest slice first, with the same rows
    /// and depth range as this space. Slices that are no smaller than this space are left out; without any
    /// for a central projection.
    ///
    /// Receivers bound the squares, casters do not: the depth range is that of the whole scene, so that no
    /// caster between the light and a square is lost, wherever the eye is. Each square is around a sphere
    /// that holds the slice, and moves by whole texels of this space's origin: turning and moving the camera
    /// neither scales nor shifts texels.
    #[must_use]
    pub fn of_view(&self, samples: &Samples, cascades: u32) -> Vec<Self> {
        let Some([near, far]) = seen_range(samples) else { return Vec::new() };
        let split = |index: u32| {
            let part = f64::from(index) / f64::from(cascades.max(1));
            let even = near + (far - near) * part;
            // An orthographic view may begin behind the eye.
            if near > 0.0 {
                LOGARITHMIC * near * (far / near).powf(part) + (1.0 - LOGARITHMIC) * even
            } else {
                even
            }
        };
        (0..cascades.max(1))
            .filter_map(|index| self.of_slice(samples, split(index)..=split(index + 1)))
            .collect()
    }

    /// The space around the part of a view's pyramid at these distances.
    fn of_slice(&self, samples: &Samples, distances: RangeInclusive<f64>) -> Option<Self> {
        let Spread::Parallel { half: scene_half, lowest, range } = self.spread else { return None };
        let projection = samples.projection();
        let (eye, forward) = (wide(projection.eye), wide(projection.forward));
        let near = f64::from(projection.near);
        let corners_at = |distance: f64| {
            projection.near_corners().map(|corner| match projection.is_orthographic() {
                true => corner + (distance - near) * forward,
                false => eye + (corner - eye) * (distance / near),
            })
        };
        let ends = [corners_at(*distances.start()), corners_at(*distances.end())];
        let center = ends.as_flattened().iter().sum::<DVec3>() / 8.0;
        let radius = ends.as_flattened().iter().fold(0.0_f64, |most, p| most.max(p.distance(center)));
        // Rounded up to 1/64, so that the rounding of the camera's rows does not scale the texels.
        let unit = (radius.log2().floor() - 6.0).exp2();
        let radius = (radius / unit).ceil() * unit;
        let half = radius * padding(self.size);
        if !(half.is_finite() && half < scene_half) {
            return None;
        }
        let Frame { right, up, .. } = self.frames[0];
        let texel = 2.0 * half / f64::from(self.size);
        let whole = |row: DVec3| ((center - self.origin).dot(row) / texel).round() * texel * row;
        let origin = self.origin + whole(right) + whole(up);
        Some(Self { origin, spread: Spread::Parallel { half, lowest, range }, ..*self })
    }
}

/// The distances along the view's axis between which points are seen, each rounded outwards to a half power
/// of two, so that they are constant over most motions. `None` if nothing is seen.
fn seen_range(samples: &Samples) -> Option<[f64; 2]> {
    let projection = samples.projection();
    let (eye, forward) = (wide(projection.eye), wide(projection.forward));
    let distances = samples.hits().iter().flatten().map(|hit| forward.dot(wide(hit.point) - eye));
    let [least, most] =
        distances.fold([f64::INFINITY, 0.0_f64], |[least, most], x| [least.min(x), most.max(x)]);
    let near = f64::from(projection.near);
    let half_power = |x: f64, round: fn(f64) -> f64| (0.5 * round(2.0 * x.log2())).exp2();
    let from = if least > 0.0 { half_power(least, f64::floor).max(near) } else { near };
    (most > near && most > 0.0).then(|| [from, half_power(most, f64::ceil)])
}
