//! Shadow volumes of the surface that a shadow map shows: the technique `reconstruct`.
//!
//! (Michael McCool, *Shadow Volume Reconstruction from Depth Maps*, ACM Transactions on Graphics, 2000.) The
//! map needs no mesh that can be extruded, and the volume needs no lookup. McCool finds the edges of the map
//! and extrudes these. Here the map becomes a mesh, a sheet, and the extruder takes any mesh: its silhouette
//! has those edges. The errors are about twice those of the map: between a near and a far texel the sheet
//! hides what lies behind, up to the far texel's center.

use super::map::{DepthSource, LightSpace, MapError, PolygonOffset, ShadowMap, wide};
use super::options::{Key, Options, set_number};
use super::stencil::{ClosedVolume, Counter};
use super::visibility::asked;
use super::volume::Caps;
use super::{Answer, Claim, LampShadow, Samples, Visibility};
use crate::caster::{Caster, CasterGroup};
use crate::facing::CasterFaces;
use crate::geom::Light;
use crate::mesh::Mesh;
use crate::scene::Lamp;

/// Options of the technique `reconstruct`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct ReconstructOptions {
    /// Side of the map in texels, 2 to 512. The sheet has two faces per texel, in each of six maps of a lamp
    /// without a cone.
    pub size: u32,
}

impl ReconstructOptions {
    /// 128².
    pub const DEFAULT: Self = Self { size: 128 };
}

impl Default for ReconstructOptions {
    fn default() -> Self {
        Self::DEFAULT
    }
}

impl Options for ReconstructOptions {
    const KEYS: &'static [Key] = &[Key { name: "size", takes: "a number from 2 to 512" }];

    fn get(&self, _: &str) -> String {
        self.size.to_string()
    }

    fn set(&mut self, _: &str, value: &str) -> bool {
        set_number(&mut self.size, value, 2..=512)
    }
}

/// How far the sheet lies behind the surface: as much as the depth changes over one texel, for surfaces that
/// bend between texel centers, and some units of the depth.
const BIAS: PolygonOffset = PolygonOffset { constant: 8, slope_scale: 1.0 };

/// Bytes per texel at the peak: the map, the sheet with its edge table, the volume with its parts.
const BYTES_PER_TEXEL: usize = 700;

/// The volume of one lamp's map.
#[derive(Debug)]
pub(super) struct Reconstruction {
    light: Light,
    volume: ClosedVolume,
    texel_world: f64,
}

impl Reconstruction {
    pub(super) fn prepare(
        casters: &CasterGroup<'_>,
        lamp: &Lamp,
        options: ReconstructOptions,
    ) -> Result<Self, MapError> {
        Self::with_bias(casters, lamp, options, BIAS)
    }

    fn with_bias(
        casters: &CasterGroup<'_>,
        lamp: &Lamp,
        options: ReconstructOptions,
        bias: PolygonOffset,
    ) -> Result<Self, MapError> {
        let light = *lamp.light();
        let space = LightSpace::of_scene(casters, lamp, options.size.clamp(2, 512))?;
        let map: ShadowMap<f32> = ShadowMap::draw(casters, &light, space, DepthSource::Interpolated, bias)?;
        let sheet = Caster::new(sheet(&map)?);
        // Faces that a rounded vertex turns from the light belong to the chain like all others.
        let faces = sheet.shell_faces(&light, Some(CasterFaces::All));
        let volume = ClosedVolume::new(sheet.volume_of(&light, &faces, Caps::Both));
        Ok(Self { light, volume, texel_world: space.texel_world(wide(casters.bounds().center())) })
    }
}

/// The surface that a map shows: a vertex per texel that sees something, two faces between four of them. No
/// face where one of the texels sees nothing.
fn sheet(map: &ShadowMap<f32>) -> Result<Mesh, MapError> {
    let (space, side) = (map.space(), map.space().size());
    let texels = map.texels().len();
    let error = MapError::Memory {
        size: side,
        layers: space.layers(),
        bytes: texels.saturating_mul(BYTES_PER_TEXEL),
    };
    let (mut positions, mut triangles, mut vertex_of) = (Vec::new(), Vec::new(), Vec::new());
    // What the steps that follow take is asked for once.
    drop(reserved::<u8>(texels.saturating_mul(BYTES_PER_TEXEL)).ok_or(error)?);
    // The outer vertices of a cube lie on its seams, where those of two maps meet.
    let place = |i: u32| match i {
        0 if space.layers() > 1 => 0.0,
        i if space.layers() > 1 && i + 1 == side => f64::from(side),
        i => f64::from(i) + 0.5,
    };
    for layer in 0..space.layers() {
        vertex_of.clear();
        for (j, i) in (0..side).flat_map(|j| (0..side).map(move |i| (j, i))) {
            let depth = map.texel(layer, i.into(), j.into()).copied().unwrap_or_default();
            let at = space.point(layer, place(i), place(j), depth.into()).as_vec3();
            let is_seen = depth > 0.0 && at.is_finite();
            vertex_of.push(is_seen.then_some(positions.len() as u32)); // at most 6 · 512²
            positions.extend(is_seen.then(|| at.to_array()));
        }
        for (j, i) in (0..side - 1).flat_map(|j| (0..side - 1).map(move |i| (j, i))) {
            let at = |i: u32, j: u32| vertex_of[(j * side + i) as usize];
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i, j + 1), at(i + 1, j + 1)];
            for corners in [[a, c, b], [b, c, d]] {
                if let [Some(a), Some(b), Some(c)] = corners {
                    triangles.push([a, b, c]);
                }
            }
        }
    }
    Mesh::new(positions, triangles).map_err(|_| error)
}

/// An empty list with room, if there is memory.
fn reserved<T>(count: usize) -> Option<Vec<T>> {
    let mut list = Vec::new();
    list.try_reserve_exact(count).ok().map(|()| list)
}

impl LampShadow for Reconstruction {
    /// A sample is in shadow if its count is not 0. What lies on the volume is lit.
    fn shade(&self, samples: &Samples) -> Visibility {
        let asked = asked(samples, &self.light);
        let (counts, updates) = Counter::default().counts(samples, &asked, [&self.volume]);
        let lit = |count: Option<i32>| f32::from(u8::from(count.unwrap_or(0) == 0));
        let answer = |index: usize| Answer::of(lit(counts[index]));
        Visibility::of_indexed(samples, &self.light, Claim::Approximate, |index, _| answer(index))
            .with_updates(updates)
    }

    fn bytes(&self) -> usize {
        self.volume.bytes()
    }

    fn texel_world(&self) -> Option<f64> {
        Some(self.texel_world)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shadow::{Request, Technique};
    use crate::testing::shapes;
    use crate::verify::errors::{Errors, Made, Truth};
    use crate::view::{Camera, Size, Up};

    /// Samples that are wrong by the map, by the reconstruction, and by one without bias.
    fn wrong(mesh: Mesh, lamp: &str, size: u32) -> [u64; 3] {
        let caster = Caster::new(mesh);
        let casters = CasterGroup::new(vec![&caster]);
        let view = Size::new(64, 48).unwrap();
        let camera = Camera::look_at([5.0, 6.0, 9.0], [0.0, -0.5, 0.0], 0.9, Up::Y).unwrap();
        let samples = Samples::of_view(&casters, &camera.projection(view, 0.5), view, 1).unwrap();
        let lamp: Lamp = lamp.parse().unwrap();
        let request = Request { casters: &casters, lamp: &lamp, samples: &samples };
        let truth = Truth::of(&request);
        let wrong =
            |visibility: &Visibility| Errors::of(&request, visibility, &truth, &Made::default()).wrong;
        let map: Technique = format!("map:size={size},filter=nearest").parse().unwrap();
        let of_sheet: Technique = format!("reconstruct:size={size}").parse().unwrap();
        let options = ReconstructOptions { size };
        let flush = Reconstruction::with_bias(&casters, &lamp, options, PolygonOffset::default()).unwrap();
        [
            wrong(&map.shade(&request).unwrap()),
            wrong(&of_sheet.shade(&request).unwrap()),
            wrong(&flush.shade(&samples)),
        ]
    }

    #[test]
    fn reconstruct_errs_as_its_map_does_and_without_bias_shadows_itself() {
        let floor = shapes::cuboid([-6.0, -3.0, -6.0], [6.0, -2.0, 6.0]);
        let solids = [shapes::torus(32, 16, 2.0, 0.7), shapes::menger_sponge(1)];
        let (mut coarse, mut fine) = ([0; 3], [0; 3]);
        for solid in solids {
            let scene = Mesh::concat(&[solid, floor.clone()]).unwrap();
            for lamp in ["directional:0.3,-1,0.2", "spot:2,9,1:-0.2,-1,-0.1:45", "point:2,7,1"] {
                for (sum, size) in [(&mut coarse, 32), (&mut fine, 128)] {
                    let own = wrong(scene.clone(), lamp, size);
                    *sum = [0, 1, 2].map(|i| sum[i] + own[i]);
                }
            }
        }
        eprintln!("map, sheet, sheet without bias: {coarse:?}, {fine:?}");
        for [map, sheet, flush] in [coarse, fine] {
            assert!(sheet < 3 * map && flush > sheet, "{map} {sheet} {flush}");
        }
        assert!(fine[1] * 2 < coarse[1], "{coarse:?} {fine:?}");
    }
}
