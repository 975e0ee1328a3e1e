//! A picture of sixteen by sixteen pixels whose counts are known in closed form.
//!
//! The eye is at (0, 0, 8) and looks down at the plane z = 0. There pixels are the unit squares of [−8, 8]²,
//! with half-integer centers. A wall in this plane receives the shadows of casters in and out of view.

use std::sync::OnceLock;

use umbrage::caster::{Caster, GpuCaster};
use umbrage::facing::CasterFaces;
use umbrage::geom::Light;
use umbrage::mesh::Mesh;
use umbrage::shadow::Depth;
use umbrage::shadow::stencil::{Counting, ShadowMask, StencilMethod, StencilPass, StencilVolumes};
use umbrage::testing::shapes;
use umbrage::verify::pixels::{Comparison, PixelVerdict, Rendered, compare};
use umbrage::view::{Projection, Size};

use crate::support::gpu;

const SIDE: u32 = 16;

/// The expected content of a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Pixel {
    /// No surface.
    Sky,
    /// This number of casting faces between the visible point and the light.
    Count(i32),
    /// A shadow boundary through the pixel's center: either count is correct.
    Either,
}

/// The projection with the near plane at `near`; at depth 8 the picture reaches `reach` to each side.
pub(super) fn view(near: f32, reach: f32) -> Projection {
    let scale = 8.0 / reach;
    Projection {
        eye: [0.0, 0.0, 8.0],
        right: [scale, 0.0, 0.0],
        up: [0.0, scale, 0.0],
        forward: [0.0, 0.0, -1.0],
        near,
        kind: Default::default(),
    }
}

/// The projection with pixels of unit squares and the near plane at 0.5.
pub(super) fn plain() -> Projection {
    view(0.5, 8.0)
}

/// The rectangle from `low` to `high` at height z, facing up.
pub(super) fn plate(low: [f32; 2], high: [f32; 2], z: f32) -> Mesh {
    let [[x, y], [u, v]] = [low, high];
    Mesh::new(vec![[x, y, z], [u, y, z], [u, v, z], [x, v, z]], vec![[0, 1, 2], [0, 2, 3]]).unwrap()
}

/// A wall behind everything, larger than the picture, with `casters` in front of it.
pub(super) fn walled(casters: &[Mesh]) -> Mesh {
    let wall = plate([-20.25, -20.5], [20.5, 20.75], 0.0);
    Mesh::concat(&[&[wall], casters].concat()).unwrap()
}

/// A solid scaled by `factor` and moved to `at`.
pub(super) fn placed(mesh: &Mesh, factor: f32, at: [f32; 3]) -> Mesh {
    shapes::translated(&shapes::scaled(mesh, factor), at)
}

/// A scene as drawn, with its counts.
pub(super) struct Shot {
    pub(super) casting: StencilVolumes,
    pub(super) mask: ShadowMask,
    pub(super) comparison: Comparison,
}

impl Shot {
    /// The pixels whose content is not as expected: their centers at depth 8, and the counts found.
    pub(super) fn wrong(&self, reach: f32, must: impl Fn(f32, f32) -> Pixel) -> Vec<([f32; 2], Option<i32>)> {
        let pixels = (0..SIDE).flat_map(|y| (0..SIDE).map(move |x| (x, y)));
        let shown = pixels.map(|(x, y)| {
            let at = |i: u32| (i as f32 + 0.5 - 8.0) * (reach / 8.0);
            ([at(x), -at(y)], self.mask.count(x, y))
        });
        shown
            .filter(|&([x, y], count)| match must(x, y) {
                Pixel::Sky => count.is_some(),
                Pixel::Count(expected) => count != Some(expected),
                Pixel::Either => count.is_none(),
            })
            .collect()
    }
}

pub(super) fn pass() -> Option<StencilPass> {
    static PASS: OnceLock<Option<StencilPass>> = OnceLock::new();
    PASS.get_or_init(|| gpu().map(|gpu| StencilPass::new(&gpu, Depth::Plane).unwrap())).clone()
}

/// Draws the shadows that `caster` casts on its own mesh, and compares. `None` without an adapter.
pub(super) fn shoot_as(
    (caster, faces): &(Caster, Option<CasterFaces>),
    light: &Light,
    projection: &Projection,
    asked: Option<StencilMethod>,
    counting: Option<Counting>,
) -> Option<Shot> {
    let pass = pass()?;
    let size = Size::new(SIDE, SIDE).unwrap();
    let casting = caster.stencil_volumes(light, projection, *faces, asked);
    let device = casting.upload(pass.gpu()).unwrap();
    let receivers = GpuCaster::upload(pass.gpu(), caster).unwrap();
    let counting = counting.unwrap_or(casting.counting());
    let mask = pass.mask(projection, size, &receivers, &device.draws(), counting).unwrap();
    let comparison = judge(caster, &casting.signs, light, projection, &mask);
    Some(Shot { casting, mask, comparison })
}

/// Compares any mask with the shadows that the faces of `caster` cast with `signs`.
pub(super) fn judge(
    caster: &Caster,
    signs: &[i8],
    light: &Light,
    projection: &Projection,
    mask: &ShadowMask,
) -> Comparison {
    // The views have near planes of their own, some of which are meant to cut.
    let seen_from = projection.near;
    compare(
        &Rendered { caster, seen: None, signs, light, projection, seen_from, mask, unsure: &[] },
        3,
        &|_| {},
    )
}

/// A caster of a mesh, with the faces that should cast.
pub(super) fn casting(mesh: &Mesh, faces: Option<CasterFaces>) -> (Caster, Option<CasterFaces>) {
    (Caster::new(mesh.clone()), faces)
}

/// Draws `mesh` with all its faces casting.
pub(super) fn shoot(
    mesh: &Mesh,
    light: &Light,
    projection: &Projection,
    asked: Option<StencilMethod>,
) -> Option<Shot> {
    shoot_as(&casting(mesh, Some(CasterFaces::All)), light, projection, asked, None)
}

/// Asserts every pixel, by z-fail and by the chosen method, and that the pixel comparison agrees with both.
/// Returns the number of shells for which z-pass was chosen; `None` without an adapter.
pub(super) fn expect_pixels(
    what: &str,
    mesh: &Mesh,
    light: &Light,
    (near, reach): (f32, f32),
    must: impl Fn(f32, f32) -> Pixel,
) -> Option<usize> {
    let mut by_zpass = 0;
    for asked in [Some(StencilMethod::ZFail), None] {
        let shot = shoot(mesh, light, &view(near, reach), asked)?;
        let wrong = shot.wrong(reach, &must);
        assert!(
            wrong.is_empty(),
            "{what} {light} {asked:?}: {} pixels, {:?}",
            wrong.len(),
            &wrong[..wrong.len().min(8)]
        );
        let sum = PixelVerdict::ALL.map(|verdict| shot.comparison.count(verdict));
        assert!(
            shot.comparison.agrees(),
            "{what} {light} {asked:?}: {sum:?} {:?}",
            shot.comparison.mismatches
        );
        by_zpass = shot.casting.methods.count(StencilMethod::ZPass);
    }
    Some(by_zpass)
}

/// `count` where `inside` holds, 0 elsewhere.
pub(super) fn counted(inside: bool, count: i32) -> Pixel {
    Pixel::Count(if inside { count } else { 0 })
}

/// A picture of `mesh` without any light.
pub(super) fn zero_lights(mesh: &Mesh) -> Option<ShadowMask> {
    let pass = pass()?;
    let receivers = GpuCaster::upload(pass.gpu(), &Caster::new(mesh.clone())).unwrap();
    Some(pass.mask(&plain(), Size::new(SIDE, SIDE).unwrap(), &receivers, &[], Counting::Stencil).unwrap())
}
