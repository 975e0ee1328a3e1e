//! What is known about each sample before any shadow is computed, as a picture in false colors.

use glam::{DVec3, Vec3};

use super::{MemoryError, Picture, buffer};
use crate::oracle::PrimaryHit;
use crate::shadow::Samples;
use crate::view::Rays;

/// What is known about a sample and a lamp, from the least doubt to the most.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Knowledge {
    /// It turns away from the lamp, or no surface is seen: no shadow matters.
    Irrelevant,
    /// Proven to see all of the lamp.
    Lit,
    /// Proven to see nothing of it.
    Dark,
    /// May see a part of a lamp with an extent.
    Penumbra,
    /// Not proven.
    Undecided,
}

impl Knowledge {
    /// All of them.
    pub const ALL: [Self; 5] = [Self::Irrelevant, Self::Lit, Self::Dark, Self::Penumbra, Self::Undecided];

    /// Name in reports.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Irrelevant => "irrelevant",
            Self::Lit => "proven lit",
            Self::Dark => "proven dark",
            Self::Penumbra => "maybe penumbra",
            Self::Undecided => "undecided",
        }
    }

    /// Name and sRGB bytes of its color. They differ in brightness too.
    #[must_use]
    pub fn color(self) -> (&'static str, [u8; 3]) {
        match self {
            Self::Irrelevant => ("gray", [150; 3]),
            Self::Lit => ("yellow", [240, 228, 66]),
            Self::Dark => ("blue", [0, 60, 140]),
            Self::Penumbra => ("sky blue", [86, 180, 233]),
            Self::Undecided => ("vermilion", [213, 94, 0]),
        }
    }
}

/// Brightness of a surface seen edge-on, relative to one seen from the front.
const EDGE_ON: f32 = 0.6;
const SKY: [u8; 4] = [232, 235, 239, 255];

/// Draws what is known about each sample. A pixel of several samples shows the one of most doubt.
/// [`Knowledge::color`] has what the colors mean.
///
/// # Errors
///
/// [`MemoryError`] if four bytes per pixel cannot be allocated.
///
/// # Panics
///
/// Panics if there is not one entry per sample.
pub fn knowledge(samples: &Samples, known: &[Knowledge]) -> Result<Picture, MemoryError> {
    assert_eq!(samples.len(), known.len(), "one entry per sample");
    let size = samples.size();
    let rays = Rays::new(samples.projection(), size);
    let (width, n) = (size.width() as usize, samples.per_side() as usize);
    let mut picture = Picture { size, pixels: buffer(size, SKY)? };
    for (at, pixel) in picture.pixels.iter_mut().enumerate() {
        let [x, y] = [at % width, at / width];
        let of_pixel = (0..n * n).map(|k| (y * n + k / n) * samples.row_len() + x * n + k % n);
        let seen = of_pixel.filter_map(|index| Some((known[index], samples.hits()[index].as_ref()?)));
        if let Some((known, hit)) = seen.max_by_key(|&(known, _)| known) {
            let along = rays.direction(x as f64 + 0.5, y as f64 + 0.5);
            let bright = EDGE_ON + (1.0 - EDGE_ON) * facing(hit, along);
            let [r, g, b] = (Vec3::from(known.color().1.map(f32::from)) * bright).to_array();
            *pixel = [r as u8, g as u8, b as u8, 255];
        }
    }
    Ok(picture)
}

/// Cosine of the angle between a surface and the direction that it is seen along.
fn facing(hit: &PrimaryHit, along: DVec3) -> f32 {
    let [a, b, c] = hit.corners.map(|corner| DVec3::from(corner.map(f64::from)));
    let normal = (b - a).cross(c - a).normalize_or_zero();
    normal.dot(along.normalize_or_zero()).abs() as f32
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::caster::{Caster, CasterGroup};
    use crate::testing::shapes;
    use crate::view::{Camera, Size, Up};

    #[test]
    fn knowledge_is_drawn_where_a_surface_is_seen_and_doubt_wins() {
        let caster = Caster::new(shapes::cube());
        let casters = CasterGroup::new(vec![&caster]);
        let size = Size::new(64, 48).unwrap();
        let camera = Camera::fit(&casters.bounds(), Up::Y, size.aspect());
        let samples = Samples::of_view(&casters, &camera.projection(size, 0.1), size, 2).unwrap();
        let mut known = vec![Knowledge::Lit; samples.len()];
        let middle = 48 * 128 + 64;
        known[middle] = Knowledge::Undecided;
        let picture = knowledge(&samples, &known).unwrap();
        let at = picture.pixels[24 * 64 + 32];
        assert!(at[2] == 0 && at[0] > 120 && at[1] < 110, "{at:?}");
        let beside = picture.pixels[24 * 64 + 34];
        assert!(beside[1] > 120, "{beside:?}");
        assert_eq!(picture.pixels[0], SKY);
        let brightness = |known: Knowledge| {
            let [r, g, b] = known.color().1.map(f64::from);
            0.2126 * r + 0.7152 * g + 0.0722 * b
        };
        let mut bright = Knowledge::ALL.map(brightness);
        bright.sort_by(f64::total_cmp);
        assert!(bright.windows(2).all(|pair| pair[1] - pair[0] > 12.0), "{bright:?}");
    }
}
