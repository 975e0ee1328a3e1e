//! A coverage map projected from the lamp: the technique `projective`.
//!
//! (Mark Segal et al., *Fast Shadows and Lighting Effects Using Texture Mapping*, SIGGRAPH 1992.) There is no
//! depth: whatever has a caster anywhere on its light ray is dark, before the caster too, and casters shadow
//! themselves. So it shades receivers alone: all that is seen and does not cast, of any shape; where
//! everything casts, the plane that planar techniques take, whose casters are cut to what is between plane
//! and lamp. All other samples are passed to the exact ray cast.

use std::collections::HashSet;

use super::Plane;
use super::boxes::Rect;
use super::matrix::{Corner, Flattening};
use super::options::TextureOptions;
use super::polygon::clip;
use super::rays::LampRays;
use super::texture::Texture;
use crate::caster::CasterGroup;
use crate::mesh::FaceId;
use crate::oracle::PrimaryHit;
use crate::scene::Lamp;
use crate::shadow::LampShadow;
use crate::shadow::map::{LightSpace, MapError, wide};
use crate::shadow::{Answer, Claim, Samples, Visibility};

#[derive(Debug)]
struct Projective<'a> {
    casters: &'a CasterGroup<'a>,
    lamp: Lamp,
    options: TextureOptions,
    space: LightSpace,
    rays: LampRays<'a>,
    /// The corners of all that casts, and the map of it; where something is seen that does not cast.
    declared: Option<(HashSet<Corners>, Vec<Texture>)>,
}

/// The corners of a face as bits.
type Corners = [[u32; 3]; 3];

/// The map's window: clip coordinates.
const WINDOW: Rect = Rect { low: [-1.0; 2], high: [1.0; 2] };

pub(in crate::shadow) fn projective<'a>(
    casters: &'a CasterGroup<'a>,
    lamp: &Lamp,
    options: TextureOptions,
) -> Result<Box<dyn LampShadow + 'a>, MapError> {
    let space = LightSpace::of_scene(casters, lamp, options.size)?;
    let rays = LampRays::hard(casters, lamp);
    let mut shadow = Projective { casters, lamp: lamp.clone(), options, space, rays, declared: None };
    if casters.seen_caster().is_some() {
        let maps = shadow.draw(None)?;
        shadow.declared = Some((faces(casters).map(bits).collect(), maps));
    }
    Ok(Box::new(shadow))
}

fn faces<'a>(casters: &CasterGroup<'a>) -> impl Iterator<Item = [[f32; 3]; 3]> + use<'a> {
    let meshes: Vec<_> = casters.casters().iter().map(|caster| caster.mesh()).collect();
    meshes.into_iter().flat_map(|mesh| (0..mesh.face_count()).map(|face| mesh.corners(FaceId::new(face))))
}

fn bits(corners: [[f32; 3]; 3]) -> Corners {
    corners.map(|corner| corner.map(f32::to_bits))
}

impl Projective<'_> {
    /// Draws all casters, or with a plane what is between it and the lamp: one texture per layer.
    fn draw(&self, plane: Option<&Plane>) -> Result<Vec<Texture>, MapError> {
        let light = self.lamp.light();
        let flattening = plane.map(|plane| Flattening::<f64>::new(plane, light));
        let side = self.options.size as usize;
        let layers = self.space.layers();
        let bytes = side * side * layers * size_of::<f32>();
        let error = MapError::Memory { size: self.options.size, layers, bytes };
        let of_layer = |layer| {
            // Faces of the plane itself have no shadow on it.
            let casting = faces(self.casters).filter(|&corners| !plane.is_some_and(|it| it.holds(corners)));
            let polygons = casting.map(|corners| self.polygon(layer, corners, flattening.as_ref()));
            Texture::draw(WINDOW, self.options.size, polygons).ok_or(error)
        };
        (0..layers).map(of_layer).collect()
    }

    /// A face in clip coordinates. The height over the plane goes into the clip alone.
    fn polygon(
        &self,
        layer: usize,
        corners: [[f32; 3]; 3],
        flattening: Option<&Flattening<f64>>,
    ) -> Vec<Corner<f64>> {
        let corner = |p| {
            let [x, y, w, _] = self.space.homogeneous(layer, wide(p));
            let [_, _, below_light, height] = flattening.map_or([0.0, 0.0, 1.0, 1.0], |it| it.at(p));
            [x, y, w, height, below_light]
        };
        let mut polygon = corners.map(corner).to_vec();
        clip(&mut polygon, |corner| corner[3]);
        clip(&mut polygon, |corner| corner[4]);
        polygon.into_iter().map(|[x, y, w, _, _]| [x, y, w, 0.0]).collect()
    }

    fn answer(&self, hit: &PrimaryHit, maps: &[Texture]) -> Answer {
        let point = wide(hit.point);
        let layer = self.space.layer_of(point);
        let [x, y, w, _] = self.space.homogeneous(layer, point);
        // Behind the lamp the map would appear a second time, turned over.
        let at = maps[layer].texels([x / w, y / w]);
        let side = f64::from(self.options.size);
        let is_cube = maps.len() > 1;
        let is_outside = w <= 0.0 || !is_cube && at.iter().any(|t| !(0.0..side).contains(t));
        if w <= 0.0 || !at.iter().all(|t| t.is_finite()) {
            return Answer { is_outside: true, ..Answer::of(1.0) };
        }
        let covered = maps[layer].covered(at, is_cube) as f32;
        Answer { reads: 4, is_outside, ..Answer::of(1.0 - covered) }
    }
}

impl LampShadow for Projective<'_> {
    fn shade(&self, samples: &Samples) -> Visibility {
        let light = self.lamp.light();
        let by_rays = |hit: &PrimaryHit| self.rays.answer(hit);
        if let Some((casting, maps)) = &self.declared {
            return Visibility::of(samples, light, Claim::Approximate, |hit| {
                if casting.contains(&bits(hit.corners)) { by_rays(hit) } else { self.answer(hit, maps) }
            });
        }
        let plane = self.options.plane.plane(samples, light).and_then(|plane| plane.towards(light));
        let drawn = plane.and_then(|plane| Some((plane, self.draw(Some(&plane)).ok()?)));
        Visibility::of(samples, light, Claim::Approximate, |hit| match &drawn {
            Some((plane, maps)) if plane.holds(hit.corners) => self.answer(hit, maps),
            _ => by_rays(hit),
        })
    }

    fn bytes(&self) -> usize {
        let maps = self.declared.iter().flat_map(|(_, maps)| maps);
        maps.map(Texture::bytes).sum()
    }

    fn texel_world(&self) -> Option<f64> {
        Some(self.space.texel_world(wide(self.casters.bounds().center())))
    }
}
