//! Surfaces right before the eye in scenes that are far larger: nothing is cut away.

use umbrage::caster::{Caster, GpuCaster};
use umbrage::facing::CasterFaces;
use umbrage::geom::Light;
use umbrage::mesh::Mesh;
use umbrage::shadow::stencil::ShadowMask;
use umbrage::testing::shapes;
use umbrage::verify::pixels::{Comparison, PixelVerdict, Rendered, compare};
use umbrage::view::{Camera, Projection, Size, Up};

use super::screen::{pass, plate};

/// A picture of a device, compared with rays from the eye.
pub(super) struct Drawn {
    pub(super) mask: ShadowMask,
    pub(super) found: Comparison,
}

/// Draws by z-pass where that is proven, else z-fail, and compares. `None` without an adapter.
pub(super) fn draw(
    caster: &Caster,
    light: &Light,
    projection: &Projection,
    size: Size,
    seen_from: f32,
) -> Option<Drawn> {
    let pass = pass()?;
    let casting = caster.stencil_volumes(light, projection, Some(CasterFaces::All), None);
    let device = casting.upload(pass.gpu()).unwrap();
    let receivers = GpuCaster::upload(pass.gpu(), caster).unwrap();
    let mask = pass.mask(projection, size, &receivers, &device.draws(), casting.counting()).unwrap();
    let signs = &casting.signs;
    let rendered =
        Rendered { caster, seen: None, signs, light, projection, seen_from, mask: &mask, unsure: &[] };
    let found = compare(&rendered, 3, &|_| {});
    Some(Drawn { mask, found })
}

pub(super) fn size() -> Size {
    Size::new(80, 64).unwrap()
}

/// A crate on a plain whose sides are this long, both with y upwards, and a mast beside the crate.
fn crate_on_plain(side: f32) -> Mesh {
    let h = 0.5 * side;
    let plain =
        Mesh::new(vec![[-h, 0.0, -h], [-h, 0.0, h], [h, 0.0, h], [h, 0.0, -h]], vec![[0, 1, 2], [0, 2, 3]]);
    let solids = [
        shapes::cuboid([-0.5, 0.0, -0.5], [0.5, 1.0, 0.5]),
        shapes::cuboid([1.0, 0.0, 0.0], [1.1, 3.0, 0.1]),
    ];
    Mesh::concat(&[&[plain.unwrap()], &solids[..]].concat()).unwrap()
}

/// Guards against a near plane that is a part of the scene's diagonal: 14 or 55 units here, beyond the crate.
#[test]
fn hard_26_crate_before_the_eye_is_drawn_whatever_the_size_of_the_plain() {
    for side in [10e3, 40e3] {
        let caster = Caster::new(crate_on_plain(side));
        let light = Light::point([30.0, 50.0, 20.0]).unwrap();
        for (eye, target) in [([2.5, 1.6, 4.0], [0.0, 0.5, 0.0]), ([0.2, 0.9, 0.7], [0.0, 0.6, 0.0])] {
            let camera = Camera::look_at(eye, target, 0.7, Up::Y).unwrap();
            let projection = camera.projection(size(), camera.near([caster.mesh()], size()));
            let Some(Drawn { mask, found }) = draw(&caster, &light, &projection, size(), 0.0) else { return };
            assert!(found.agrees(), "{side} {eye:?}: {:?}", found.mismatches);
            assert!(found.count(PixelVerdict::Lit) > 500 && mask.count(40, 32).is_some());

            // Negative test: the old near plane.
            let diagonal = caster.oracle().bounds().diagonal() as f32;
            let cutting = camera.projection(size(), diagonal / 1024.0);
            let found = draw(&caster, &light, &cutting, size(), 0.0).unwrap().found;
            assert!(found.count(PixelVerdict::Real) > 500 && found.mismatches[0].cut, "{side} {eye:?}");
            // A near plane that was asked for may cut.
            let found = draw(&caster, &light, &cutting, size(), cutting.near).unwrap().found;
            assert!(found.agrees(), "{side} {eye:?}: {:?}", found.mismatches);
        }
    }
}

/// Guards against an eye whose near rectangle reaches through a wall.
#[test]
fn hard_26_eye_a_hundredth_of_a_unit_from_a_wall_sees_the_wall() {
    // A wall of 20 by 20 at z = 0, a shelf in front of it, and a hall far away.
    let wall = plate([-10.0; 2], [10.0; 2], 0.0);
    let hall = shapes::cuboid([-900.0, -900.0, -900.0], [900.0, 900.0, 900.0]);
    let shelf = shapes::cuboid([0.3, -2.0, 0.002], [0.35, 2.0, 0.3]);
    let caster = Caster::new(Mesh::concat(&[wall, hall, shelf]).unwrap());
    let light = Light::point([6.0, 1.0, 4.0]).unwrap();
    for target in [[0.0, 0.0, 0.0], [1.0, 0.2, 0.0], [1.0, 0.0, 0.01], [0.01, 1.0, 0.02]] {
        let camera = Camera::look_at([0.0, 0.0, 0.01], target, 1.2, Up::Y).unwrap();
        let near = camera.near([caster.mesh()], size());
        assert!(near > 0.0 && near <= 0.005, "{near}");
        let projection = camera.projection(size(), near);
        let Some(Drawn { found, .. }) = draw(&caster, &light, &projection, size(), 0.0) else { return };
        assert!(found.agrees(), "{target:?}: {:?}", found.mismatches);
        let cutting = camera.projection(size(), 0.02);
        assert!(!draw(&caster, &light, &cutting, size(), 0.0).unwrap().found.agrees(), "{target:?}");
    }
}
