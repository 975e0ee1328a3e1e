//! Sides that the eye sees nearly edge-on, a few 256ths of a pixel from a pixel's center. A rasterizer covers
//! pixels beside such sides, where their planes may have any depth.

use umbrage::facing::CasterFaces;
use umbrage::glam::Vec3;
use umbrage::mesh::Mesh;
use umbrage::shadow::stencil::{Counting, ShadowMask, StencilMethod};
use umbrage::verify::pixels::PixelVerdict;

use super::figures::*;
use super::screen::*;

/// The light's direction of travel.
const TRAVEL: Vec3 = Vec3::new(1.0, 0.0, -1.0);

/// One triangle per pixel. `corners` gets the ray through a pixel's center, scaled to depth 1, a position
/// next to this center at the given depth, and random numbers from -1 to 1.
fn fins(seed: u32, depth: f32, corners: impl Fn(Vec3, Vec3, &mut dyn FnMut() -> f32) -> [Vec3; 3]) -> Mesh {
    let mut state = seed;
    let mut next = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 8) as f32 / 8_388_608.0 - 1.0
    };
    let eye = Vec3::new(0.0, 0.0, 8.0);
    let mut positions = Vec::new();
    for pixel in 0..256_u16 {
        let ray = (Vec3::new(f32::from(pixel % 16) - 7.5, f32::from(pixel / 16) - 7.5, 0.0) - eye) / 8.0;
        let beside = Vec3::new(next(), next(), 0.0) * (1.5 / 256.0);
        positions.extend(corners(ray, eye + ray * depth + beside, &mut next).map(|p| p.to_array()));
    }
    Mesh::new(positions, (0..256).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect()).unwrap()
}

/// Asserts that no pixel is miscounted, and few are forgiven: the pixels' centers lie beside the shadows, not
/// on their boundaries.
fn expect_beside_shadows(seed: u32, fins: Mesh) {
    let (light, scene) = (sun(TRAVEL.x, TRAVEL.y, TRAVEL.z), walled(&[fins]));
    let caster = casting(&scene, Some(CasterFaces::All));
    for asked in [Some(StencilMethod::ZFail), None] {
        for counting in [Counting::Stencil, Counting::Integer] {
            let shot = shoot_as(&caster, &light, &plain(), asked, Some(counting));
            let Some(Shot { comparison, .. }) = shot else { return };
            assert!(comparison.agrees(), "{asked:?} {counting:?} {seed}: {:?}", comparison.mismatches);
            assert!(comparison.count(PixelVerdict::Grazing) < 8);
        }
    }
    // Negative test: the count of each pixel is off by one, as with a side on the wrong side of the wall.
    let Some(Shot { mask, casting, .. }) =
        shoot_as(&caster, &light, &plain(), Some(StencilMethod::ZFail), None)
    else {
        return;
    };
    let by = if seed.is_multiple_of(2) { 1 } else { -1 };
    let raw = mask.raw().iter().map(|count| count + by).collect();
    let altered = ShadowMask::new(mask.size(), Counting::Integer, raw, vec![true; 256]);
    let found = judge(&caster.0, &casting.signs, &light, &plain(), &altered);
    assert!(found.count(PixelVerdict::Real) > 200);
}

/// Guards against the depth of a plane beyond its side. A rasterizer may cover a pixel there, and the plane
/// of a steep side is in front of the wall where the side itself is behind the wall. Below a fin's tip this
/// side meets another one, just beneath the wall.
#[test]
fn hard_14_coincident_lines_of_a_steep_side_and_another_are_of_one_depth() {
    for seed in 1..=8 {
        let fins = fins(seed, 8.01, |ray, below, next| {
            let tip = below - TRAVEL * 0.6;
            let gentle = tip + Vec3::new(0.0, 0.2 * next().signum(), 0.0);
            [tip, gentle, tip + 0.2 * ray + Vec3::new(0.0, 0.03 * next(), 0.0)]
        });
        expect_beside_shadows(seed, fins);
    }
}

/// Guards against the same beyond a silhouette edge. The edge runs from in front of the wall to behind the
/// wall, and just behind the wall past the pixel's center. Between the lines of the edge's two ends, the
/// side's plane is in front of the wall again.
#[test]
fn hard_14_coincident_edge_and_flank_of_a_steep_side_are_of_one_depth() {
    for seed in 1..=8 {
        let fins = fins(seed, 8.03, |ray, middle, next| {
            let half = 0.3 * ray - 0.15 * TRAVEL + Vec3::new(0.0, 0.015 * next(), 0.0);
            let gentle = middle + 0.3 * ray + Vec3::new(0.0, 0.2 * next().signum(), 0.0);
            [middle - half, middle + half, gentle]
        });
        expect_beside_shadows(seed, fins);
    }
}
