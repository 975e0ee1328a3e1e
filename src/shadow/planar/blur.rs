//! Blurred planar shadows: the techniques `planar-blur` and `planar-contact`.
//!
//! The faces are drawn flattened into a texture on the plane, and a sample takes the mean over a box as wide
//! as the penumbra of one rise (see [`Texture`]). `planar-blur` has one width for all (D. Odin, *Shadows*,
//! 2016, blurs a planar shadow so): that of the mean rise, so that a shadow is too wide at its contact.
//! `planar-contact` takes the mean rise of what covers the sample's surroundings, as far as the highest
//! caster may hide the lamp (Randima Fernando, *Percentage-Closer Soft Shadows*, 2005, on a plane). It errs
//! where casters at different heights overlap.

use glam::DVec3;

use super::boxes::Rect;
use super::matrix::Flattening;
use super::options::TextureOptions;
use super::rays::LampRays;
use super::texture::Texture;
use super::{Ground, Plane};
use crate::caster::CasterGroup;
use crate::mesh::FaceId;
use crate::oracle::PrimaryHit;
use crate::scene::Lamp;
use crate::shadow::LampShadow;
use crate::shadow::soft::{Sums, above_horizon};
use crate::shadow::{Answer, Claim, Samples, Visibility, is_front_lit};

/// Rays to the lamp for a sample that is not on the plane.
const RAYS: u32 = 16;
/// A box has the same mean square along an axis as a disk of this part of its half-width.
const BOX_OF_DISK: f64 = 0.866_025_403_784_438_6; // √3/2
/// Texels that are read for a mean over a box.
const READS: u32 = 4;

/// Which width the penumbra has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Width {
    /// One for the whole plane.
    Common,
    /// Each sample's own.
    Own,
}

#[derive(Debug)]
struct Blur<'a> {
    casters: &'a CasterGroup<'a>,
    lamp: Lamp,
    options: TextureOptions,
    width: Width,
    rays: LampRays<'a>,
}

/// The plane with its texture.
struct Drawn {
    plane: Plane,
    flattening: Flattening<f64>,
    texture: Texture,
    /// The covered part, and the rise times that part.
    sums: Sums<2>,
    mean_rise: f64,
    most_rise: f64,
}

pub(in crate::shadow) fn planar_blur<'a>(
    casters: &'a CasterGroup<'a>,
    lamp: &Lamp,
    options: TextureOptions,
) -> Box<dyn LampShadow + 'a> {
    of(casters, lamp, options, Width::Common)
}

pub(in crate::shadow) fn planar_contact<'a>(
    casters: &'a CasterGroup<'a>,
    lamp: &Lamp,
    options: TextureOptions,
) -> Box<dyn LampShadow + 'a> {
    of(casters, lamp, options, Width::Own)
}

fn of<'a>(
    casters: &'a CasterGroup<'a>,
    lamp: &Lamp,
    options: TextureOptions,
    width: Width,
) -> Box<dyn LampShadow + 'a> {
    let rays = LampRays::soft(casters, lamp, RAYS);
    Box::new(Blur { casters, lamp: lamp.clone(), options, width, rays })
}

impl Blur<'_> {
    /// Draws the texture over the samples of the plane, and as far around them as a caster midway to the lamp
    /// may reach.
    fn draw(&self, ground: Ground, samples: &Samples) -> Option<Drawn> {
        let light = self.lamp.light();
        let plane = ground.plane(samples, light)?.towards(light)?;
        let flattening = Flattening::<f64>::new(&plane, light);
        let mut window = Rect::EMPTY;
        for hit in samples.hits().iter().flatten() {
            if is_front_lit(hit, light) && plane.holds(hit.corners) {
                let [x, y, w, _] = flattening.at(hit.point);
                let at = [x / w, y / w];
                window = window.join(&Rect { low: at, high: at });
            }
        }
        let middle = [0, 1].map(|i| 0.5 * window.low[i] + 0.5 * window.high[i]);
        let margin = self.half_widths(&plane, &flattening, plane.middle(samples, light), middle, 1.0);
        for axis in 0..2 {
            let margin = margin[axis].min(0.5 * (window.high[axis] - window.low[axis]));
            window.low[axis] -= margin;
            window.high[axis] += margin;
        }
        let polygons = self.casters.casters().iter().flat_map(|caster| {
            let mesh = caster.mesh();
            let faces = (0..mesh.face_count()).map(|face| mesh.corners(FaceId::new(face)));
            // Faces of the plane itself have no shadow on it.
            faces.filter(|&corners| !plane.holds(corners)).map(|corners| flattening.clipped(corners, 0.0))
        });
        let texture = Texture::draw(window, self.options.size, polygons)?;
        let covered = |index| texture.rise(index).map_or([0.0; 2], |rise| [1.0, rise]);
        let (mut count, mut sum, mut most_rise) = (0.0, 0.0, 0.0_f64);
        for index in 0..texture.len() {
            let [one, rise] = covered(index);
            (count, sum, most_rise) = (count + one, sum + rise, most_rise.max(rise));
        }
        let mean_rise = if count > 0.0 { sum / count } else { 0.0 };
        let sums = Sums::of(self.options.size as usize, 1, covered).ok()?;
        Some(Drawn { plane, flattening, texture, sums, mean_rise, most_rise })
    }

    /// Half-widths along the two axes of the penumbra of a caster with a given rise, at a point of the plane.
    ///
    /// A light that moves by e moves the shadow by −rise times what e leaves on the plane if it is projected
    /// along the ray.
    fn half_widths(
        &self,
        plane: &Plane,
        flattening: &Flattening<f64>,
        p: [f32; 3],
        at: [f64; 2],
        rise: f64,
    ) -> [f64; 2] {
        let Some(patch) = self.lamp.patch(p) else { return [0.0; 2] };
        let light = DVec3::from(flattening.light);
        // A directional light's patch is at distance 1.
        let scale = if patch.is_directional { light.length() } else { 1.0 };
        let axes = plane.axes();
        [0, 1].map(|i| {
            let along_ray = if patch.is_directional { -light[axes[i]] } else { at[i] - light[axes[i]] };
            let shift = |e: DVec3| {
                (scale * rise * (e[axes[i]] + along_ray * plane.normal.dot(e) / flattening.height)).abs()
            };
            let [across, along] = [shift(patch.across), shift(patch.along)];
            if patch.is_round { BOX_OF_DISK * across.hypot(along) } else { across + along }
        })
    }

    fn answer(&self, hit: &PrimaryHit, drawn: &Drawn) -> Answer {
        let [x, y, w, _] = drawn.flattening.at(hit.point);
        let at = [x / w, y / w];
        let texels = drawn.texture.texels(at);
        let half = |rise: f64| {
            let half = self.half_widths(&drawn.plane, &drawn.flattening, hit.point, at, rise);
            drawn.texture.lengths(half)
        };
        let (rise, reads) = match self.width {
            Width::Common => (drawn.mean_rise, READS),
            Width::Own => {
                let [covered, rise] = drawn.sums.mean(texels, half(drawn.most_rise));
                if covered <= 0.0 {
                    return Answer { reads: READS, ..Answer::of(1.0) };
                }
                (rise / covered, 2 * READS)
            }
        };
        let [covered, _] = drawn.sums.mean(texels, half(rise));
        Answer { reads, ..Answer::of(1.0 - covered.clamp(0.0, 1.0) as f32) }
    }
}

impl LampShadow for Blur<'_> {
    fn shade(&self, samples: &Samples) -> Visibility {
        let drawn = self.draw(self.options.plane, samples);
        let mut visibility =
            Visibility::of(samples, self.lamp.light(), Claim::Approximate, |hit| match &drawn {
                Some(drawn) if drawn.plane.holds(hit.corners) => self.answer(hit, drawn),
                _ => self.rays.answer(hit),
            });
        above_horizon(&mut visibility, samples, &self.lamp);
        visibility
    }

    fn bytes(&self) -> usize {
        self.rays.bytes()
    }
}
