//! Many layers, coincident edges and overlapping lobes, by the stencil pass against counts in closed form.

use std::collections::BTreeSet;

use umbrage::facing::{CasterFaces, facing_of};
use umbrage::geom::{Facing, Light};
use umbrage::glam::Vec3;
use umbrage::mesh::Mesh;
use umbrage::oracle::Oracle;
use umbrage::shadow::stencil::{Counting, ShadowMask, StencilMethod};
use umbrage::shadow::volume::ShadowVolume;
use umbrage::testing::shapes;
use umbrage::verify::pixels::PixelVerdict;

use super::figures::*;
use super::screen::*;

/// Number of cubes that cover a pixel, of `n` nested cubes with half sides 1/2, 1, 3/2, … about (1/4, 1/8).
fn covering(n: u32, x: f32, y: f32) -> i32 {
    let out = (x - 0.25).abs().max((y - 0.125).abs());
    (1..=n).filter(|&k| 0.5 * k as f32 > out).count() as i32
}

/// Guards against eight bits: 128 closed shells, or 256 with front faces alone, wrap to lit.
#[test]
fn hard_13_wrap_of_the_stencil_is_foreseen_and_counted_beyond() {
    let light = sun(0.0, 0.0, -1.0);
    for (shells, faces, counting) in [
        (60, Some(CasterFaces::All), Counting::Stencil),
        (128, Some(CasterFaces::All), Counting::Integer),
        (60, None, Counting::Stencil),
        (256, None, Counting::Integer),
        (300, None, Counting::Integer),
        (300, Some(CasterFaces::All), Counting::Integer),
    ] {
        let scene = walled(&[placed(&shapes::nested_cubes(shells), 0.5, [0.25, 0.125, 256.0])]);
        let caster = casting(&scene, faces);
        let each = if faces == Some(CasterFaces::All) { 2 } else { 1 };
        let must = |x: f32, y: f32| Pixel::Count(each * covering(shells, x, y));
        let Some(shot) = shoot_as(&caster, &light, &plain(), Some(StencilMethod::ZFail), None) else {
            return;
        };
        assert_eq!(shot.casting.counting(), counting, "{shells} {faces:?}: {}", shot.casting.layers);
        assert_eq!(shot.wrong(8.0, must), [], "{shells} {faces:?}");
        assert!(shot.comparison.agrees(), "{:?}", shot.comparison.mismatches);
        // Negative test: trusting eight bits. The first count that they get wrong is 256, with all shells in
        // a pixel.
        let eight =
            shoot_as(&caster, &light, &plain(), Some(StencilMethod::ZFail), Some(Counting::Stencil)).unwrap();
        let wraps = |x: f32, y: f32| Pixel::Count((each * covering(shells, x, y)) & 255);
        assert_eq!(eight.wrong(8.0, wraps), [], "{shells} {faces:?}");
        let overflown = eight.comparison.count(PixelVerdict::Overflow);
        assert_eq!(overflown, eight.wrong(8.0, must).len());
        let expected = match shells as i32 * each {
            60 | 120 => 0,
            256 => 1,
            // At least 256 crossings in every pixel: 256 of 300 cubes once, or 128 of them twice.
            _ => 256,
        };
        assert_eq!((overflown, eight.comparison.agrees()), (expected, expected == 0), "{shells} {faces:?}");
    }
}

/// The corners of a volume's side triangles, as position bits.
fn sides(volume: &ShadowVolume) -> BTreeSet<Vec<[u64; 4]>> {
    let corners = |triangle: &[u32; 3]| {
        let mut corners = triangle.map(|v| volume.vertex(v).to_f64().map(f64::to_bits)).to_vec();
        corners.sort_unstable();
        corners
    };
    volume.triangles()[volume.sides()].iter().map(corners).collect()
}

/// Guards against diagonals chosen by vertex index: two meshes that meet would leave a raster crack between
/// their sides.
#[test]
fn hard_14_coincident_edges_sweep_the_same_two_triangles() {
    let mut state = 5_u32;
    let mut next = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 8) as f32 / 1_048_576.0 - 8.0
    };
    let light = point(0.3, 4.0, 1.0);
    for _ in 0..200 {
        let [a, b, c, d]: [[f32; 3]; 4] = std::array::from_fn(|_| std::array::from_fn(|_| next()));
        // The edge from a to b in two meshes, with its ends numbered in opposite order.
        let one = Mesh::new(vec![a, b, c], vec![[0, 1, 2]]).unwrap();
        let two = Mesh::new(vec![d, b, a], vec![[2, 0, 1]]).unwrap();
        let [one, two] = [one, two].map(|mesh| sides(&shadow(&mesh, &light)));
        assert_eq!(one.intersection(&two).count(), 2);
        // Negative test: the other diagonal of the same quad.
        let quad = one.intersection(&two).flatten().copied().collect::<BTreeSet<_>>();
        assert_eq!(quad.len(), 4);
        let all: Vec<_> = quad.into_iter().collect();
        let halves =
            (0..4).map(|left_out| (0..4).filter(|&i| i != left_out).map(|i| all[i]).collect::<Vec<_>>());
        assert_eq!(
            halves.filter(|half| one.contains(half)).count(),
            2,
            "two of the four triangles of four points"
        );
    }
}

/// Guards against cracks of a pixel: inner edges of a torn sheet run exactly through pixel centers.
#[test]
fn hard_14_coincident_edges_through_pixel_middles_leave_no_crack() {
    // Seven by seven unit quads about the center, every triangle with corners of its own, numbered at random.
    let torn = shapes::shuffled(&shapes::soup(&placed(&shapes::sheet(7), 1.0, [-3.5, -3.5, 16.0])), 3);
    assert_eq!(counts(&torn).boundary_edges, 3 * 98);
    let must = |x: f32, y: f32| match x.abs().max(y.abs()) {
        out if out < 3.5 => Pixel::Count(1),
        out if out > 3.5 => Pixel::Count(0),
        _ => Pixel::Either,
    };
    let scene = walled(std::slice::from_ref(&torn));
    for light in [sun(0.0, 0.0, -1.0), point(0.0, 0.0, 1e9)] {
        expect_pixels("a torn sheet", &scene, &light, (0.5, 8.0), must);
    }
    // Negative test: one triangle missing is a hole.
    let (positions, mut triangles, ..) = torn.into_parts();
    let middle = triangles.iter().position(|face| {
        let corners = face.map(|v| positions[v as usize]);
        [0, 1].iter().all(|&i| corners.iter().all(|p| p[i].abs() <= 0.5))
    });
    triangles.remove(middle.unwrap());
    let scene = walled(&[Mesh::new(positions, triangles).unwrap()]);
    let shot = shoot(&scene, &sun(0.0, 0.0, -1.0), &plain(), Some(StencilMethod::ZFail));
    assert!(shot.is_none_or(|shot| !shot.wrong(8.0, must).is_empty()));
}

/// Guards against light that shines through a slit: the meeting edges do not share the same vertices.
#[test]
fn hard_08_t_junction_throws_a_shadow_without_a_crack() {
    // The open edge lies over the centers of a row of pixels.
    let scene = walled(&[placed(&shapes::t_junction(), 3.5, [0.25, 0.0, 20.0])]);
    let must = |x: f32, y: f32| match y.abs() {
        y if y > 3.5 || (x - 0.25).abs() > 3.5 => Pixel::Count(0),
        y if y < 3.5 => Pixel::Count(2),
        _ => Pixel::Either,
    };
    expect_pixels("a T-junction", &scene, &sun(0.0, 0.0, -1.0), (0.5, 8.0), must);
    // Tilted so that the slit lies over pixels that are dark on both sides of the slit.
    let tilted = walled(&[placed(&shapes::t_junction(), 4.0, [0.0, 20.5, 20.0])]);
    let must = |x: f32, y: f32| {
        // The oblique sun shifts each level by its height: lid (z = 24) and front (y = 16.5) side by side.
        let dark = x.abs() < 4.0 && y > -7.5 && y < 8.5;
        counted(dark, 2)
    };
    expect_pixels("a T-junction, slanting", &tilted, &sun(0.0, -1.0, -1.0), (0.5, 8.0), must);
    let open = walled(&[placed(&shapes::open_cube(), 4.0, [0.0, 20.5, 20.0])]);
    let shot = shoot(&open, &sun(0.0, -1.0, -1.0), &plain(), Some(StencilMethod::ZFail));
    assert!(shot.is_none_or(|shot| !shot.wrong(8.0, must).is_empty()), "the sabotage: no lid");
}

/// Guards against counts that cancel: the lobes have windings +1 and −1, and where their caps overlap both
/// count.
#[test]
fn hard_21_winding_of_lobes_adds_up_in_the_stencil() {
    let scene = walled(&[placed(&shapes::figure_eight_prism(), 2.0, [0.25, 0.0, 16.0])]);
    let light = sun(0.0, 0.0, -1.0);
    let must = |x: f32, y: f32| {
        let p = [(x - 0.25) / 2.0, y / 2.0];
        let inside = |corners: [[f32; 2]; 3]| {
            let side = |i: usize| {
                let (a, b) = (corners[i], corners[(i + 1) % 3]);
                (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]) > 0.0
            };
            side(0) == side(1) && side(1) == side(2)
        };
        let (a, b, c, d) = ([2.0, -2.0], [2.0, 2.0], [-1.0, -1.0], [-1.0, 1.0]);
        Pixel::Count(2 * (i32::from(inside([a, b, c])) + i32::from(inside([a, c, d]))))
    };
    expect_pixels("a figure-eight prism", &scene, &light, (0.5, 8.0), must);
    let caster = casting(&scene, None);
    let Some(shot) = shoot_as(&caster, &light, &plain(), Some(StencilMethod::ZFail), None) else { return };
    assert_eq!(shot.casting.faces.choices[1].what, CasterFaces::All);
    assert_eq!(shot.wrong(8.0, must), []);
    assert!([2, 4].iter().all(|count| shot.mask.raw().contains(count)));
    // Negative test: front faces alone count half.
    let front = casting(&scene, Some(CasterFaces::Front));
    let shot = shoot_as(&front, &light, &plain(), Some(StencilMethod::ZFail), None).unwrap();
    assert!(!shot.wrong(8.0, must).is_empty());
}

/// Whether a smooth ball about the origin is lit at a point.
fn round_is_lit(p: [f32; 3], light: &Light) -> bool {
    let (p, light) = (Vec3::from(p), Vec3::from(light.xyz()));
    p.dot(light - p) > 0.0
}

/// Guards against calling the staircase of a faceted terminator an error of the shadow, and against blurring
/// it. A facet that faces away from the light is entirely dark, whatever a smooth normal says.
#[test]
fn hard_24_terminator_follows_the_facets() {
    let ball = placed(&shapes::icosphere(2), 4.0, [0.0, 0.0, 0.0]);
    let light = point(30.0, 9.0, 2.0);
    let Some(shot) = shoot(&ball, &light, &plain(), Some(StencilMethod::ZFail)) else { return };
    let oracle = Oracle::build(&ball);
    let (mut lit, mut dark, mut smooth_differs) = (0, 0, 0);
    for y in 0..16_u8 {
        for x in 0..16_u8 {
            let ray = [f32::from(x) - 7.5, 7.5 - f32::from(y), -8.0];
            let seen = oracle.first_visible([0.0, 0.0, 8.0], ray);
            let count = shot.mask.count(x.into(), y.into());
            let Some(seen) = seen else {
                assert_eq!(count, None);
                continue;
            };
            // From just outside a facet that faces away, the segment enters the ball through this facet and
            // leaves it again.
            let facing = facing_of(&ball, seen.face, &light);
            assert_eq!(count, Some(if facing == Facing::Front { 0 } else { 2 }), "{x} {y}");
            (lit, dark) =
                (lit + i32::from(facing == Facing::Front), dark + i32::from(facing == Facing::Back));
            smooth_differs += i32::from(round_is_lit(seen.point, &light) != (facing == Facing::Front));
        }
    }
    assert!(lit > 10 && dark > 10);
    // Near the terminator, facets and smooth ball differ: such pixels are counted here, and are no
    // disagreement.
    assert!(smooth_differs > 0, "{lit} lit, {dark} dark");
    let verdicts = [PixelVerdict::Lit, PixelVerdict::Shadowed, PixelVerdict::Real, PixelVerdict::Grazing];
    let found = verdicts.map(|verdict| shot.comparison.count(verdict) as i32);
    assert_eq!(found, [lit, dark, 0, 0]);
    // Negative test: a mask that shades the smooth ball is wrong in these pixels.
    let pixels = (0..16_u32).flat_map(|y| (0..16).map(move |x| (x, y)));
    let (mut raw, mut receivers) = (Vec::new(), Vec::new());
    for (x, y) in pixels {
        let seen = oracle.first_visible([0.0, 0.0, 8.0], [x as f32 - 7.5, 7.5 - y as f32, -8.0]);
        receivers.push(seen.is_some());
        raw.push(seen.map_or(0, |seen| if round_is_lit(seen.point, &light) { 0 } else { 2 }));
    }
    let smooth = ShadowMask::new(shot.mask.size(), Counting::Integer, raw, receivers);
    let found = judge(&casting(&ball, None).0, &shot.casting.signs, &light, &plain(), &smooth);
    assert_eq!(found.count(PixelVerdict::Real) as i32, smooth_differs, "{:?}", found.mismatches);
}
