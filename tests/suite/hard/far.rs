//! Scenes far from the origin, whose coordinates do not survive a translation: pixels agree as they do near it.

use umbrage::caster::Caster;
use umbrage::geom::Light;
use umbrage::mesh::Mesh;
use umbrage::testing::shapes;
use umbrage::verify::pixels::PixelVerdict;
use umbrage::view::{Camera, Up};

use super::near::{Drawn, draw, size};

/// A ball over a tilted sheet, moved to a position that rounds some coordinates and not others.
fn ball_over_sheet(at: [f32; 3]) -> Mesh {
    let sheet = shapes::scaled(&shapes::sheet(6), 0.4);
    let tilted =
        sheet.positions().iter().map(|&[x, y, _]| [x - 1.2, -0.5 + 0.1 * (x + y), 1.2 - y]).collect();
    let sheet = Mesh::new(tilted, sheet.triangles().to_vec()).unwrap();
    let ball = shapes::scaled(&shapes::icosphere(3), 0.3);
    shapes::translated(&Mesh::concat(&[ball, sheet]).unwrap(), at)
}

fn from(at: [f32; 3], by: [f32; 3]) -> [f32; 3] {
    [0, 1, 2].map(|i| at[i] + by[i])
}

/// Guards against visible points that are rounded to f32: here its spacing is up to a dozen pixels.
#[test]
fn hard_27_pixels_far_along_some_axes_agree() {
    let places = [
        [5000.1, 0.0, -3000.3],
        [1000.1, 0.001, 77.7],
        [0.0, -9000.0, 1e-3],
        [3.1e4, 1e-6, 3.0],
        [-2e5, 2e5, 0.3],
    ];
    let mut sum = [0; 4];
    for at in places {
        let caster = Caster::new(ball_over_sheet(at));
        let lights = [
            Light::point(from(at, [0.7, 2.1, 0.9])),
            Light::point([at[0] + 0.3, at[1] + 900.0, 0.0]),
            Light::directional([0.2, -1.0, -0.3]),
        ];
        for light in lights.map(Result::unwrap) {
            for by in [[1.1, 1.3, 2.6], [0.02, 0.6, 0.3]] {
                let camera = Camera::look_at(from(at, by), from(at, [0.0, -0.2, 0.0]), 0.7, Up::Y).unwrap();
                let projection = camera.projection(size(), camera.near([caster.mesh()], size()));
                let Some(Drawn { found, .. }) = draw(&caster, &light, &projection, size(), 0.0) else {
                    return;
                };
                assert!(found.agrees(), "{at:?} {light} {by:?}: {:?}", found.mismatches);
                let verdicts =
                    [PixelVerdict::Sky, PixelVerdict::Lit, PixelVerdict::Shadowed, PixelVerdict::Grazing];
                for (sum, verdict) in sum.iter_mut().zip(verdicts) {
                    *sum += found.count(verdict);
                }
            }
        }
    }
    eprintln!("sky, lit, shadowed, grazing: {sum:?}");
    assert!(sum[1] > 50_000 && sum[2] > 1000 && sum[3] * 100 < sum[2], "{sum:?}");
}

/// Guards against forgiving everything: one face that casts no shadow is found, as far away as near.
#[test]
fn hard_27_one_missing_face_is_found_far_away() {
    use umbrage::shadow::stencil::ShadowMask;
    use umbrage::verify::pixels::{Rendered, compare};
    let at = [5000.1, 0.0, -3000.3];
    let caster = Caster::new(ball_over_sheet(at));
    let light = Light::point(from(at, [0.3, 2.1, 0.4])).unwrap();
    let camera = Camera::look_at(from(at, [1.1, 1.3, 2.6]), from(at, [0.0, -0.2, 0.0]), 0.7, Up::Y).unwrap();
    let projection = camera.projection(size(), camera.near([caster.mesh()], size()));
    let Some(Drawn { mask, found }) = draw(&caster, &light, &projection, size(), 0.0) else { return };
    assert!(found.agrees());
    // Every second shadowed pixel lit: a face less.
    let (width, mut altered) = (size().width(), 0);
    let counts = (0..size().pixels() as u32).map(|i| {
        let count = mask.count(i % width, i / width);
        let wrong = i % 2 == 0 && count.is_some_and(|count| count > 0);
        altered += usize::from(wrong);
        count.unwrap_or(0) - i32::from(wrong)
    });
    let counts: Vec<i32> = counts.collect();
    let receivers = (0..size().pixels() as u32).map(|i| mask.count(i % width, i / width).is_some()).collect();
    let spoiled = ShadowMask::new(size(), mask.counting(), counts, receivers);
    let casting = caster.stencil_volumes(&light, &projection, Some(umbrage::facing::CasterFaces::All), None);
    let signs = &casting.signs;
    let projection = &projection;
    let light = &light;
    let rendered = Rendered {
        caster: &caster,
        seen: None,
        signs,
        light,
        projection,
        seen_from: 0.0,
        mask: &spoiled,
        unsure: &[],
    };
    let real = compare(&rendered, 0, &|_| {}).count(PixelVerdict::Real);
    eprintln!("{real} of {altered} altered pixels are found");
    assert!(altered > 30 && real * 20 > altered * 19, "{real} of {altered}");
}

/// Guards against a judge that moves everything to the origin of a large scene: an eye far out on a plain.
#[test]
fn hard_27_pixels_at_the_rim_of_a_plain_agree() {
    let plain = Mesh::new(
        vec![[-9e3, 0.0, -9e3], [-9e3, 0.0, 9e3], [9e3, 0.0, 9e3], [9e3, 0.0, -9e3]],
        vec![[0, 1, 2], [0, 2, 3]],
    );
    let at = [8000.3, 0.0, -7000.1];
    let ball = shapes::translated(&shapes::scaled(&shapes::icosphere(2), 0.3), from(at, [0.0, 0.5, 0.0]));
    let caster = Caster::new(Mesh::concat(&[plain.unwrap(), ball]).unwrap());
    for light in
        [Light::point(from(at, [1.0, 3.0, 0.5])), Light::directional([0.3, -1.0, 0.2])].map(Result::unwrap)
    {
        let camera =
            Camera::look_at(from(at, [0.8, 0.9, 1.7]), from(at, [0.0, 0.2, 0.0]), 0.7, Up::Y).unwrap();
        let projection = camera.projection(size(), camera.near([caster.mesh()], size()));
        let Some(Drawn { found, .. }) = draw(&caster, &light, &projection, size(), 0.0) else { return };
        assert!(found.agrees(), "{light}: {:?}", found.mismatches);
        assert!(found.count(PixelVerdict::Shadowed) > 100);
    }
}

/// Guards against differences of the largest numbers, which are infinite in a shader.
#[test]
fn hard_27_boxes_of_the_largest_numbers_agree() {
    for largest in [3.4e38_f32, 1.8e38, 1e30] {
        let caster = Caster::new(shapes::cuboid([-largest; 3], [largest; 3]));
        let eye = [0.5 * largest, 0.3 * largest, -0.7 * largest];
        let shelf = 0.1 * largest;
        let shelf = shapes::cuboid([-shelf, -shelf, 0.0], [shelf, shelf, shelf]);
        let room = Caster::new(Mesh::concat(&[shapes::cuboid([-largest; 3], [largest; 3]), shelf]).unwrap());
        let outside = [largest, 0.9 * largest, 0.8 * largest];
        for (caster, eye) in [(&caster, eye), (&room, eye), (&caster, outside)] {
            for light in [
                Light::point([0.2 * largest, 0.4 * largest, 0.6 * largest]),
                Light::directional([0.3, -1.0, 0.1]),
            ]
            .map(Result::unwrap)
            {
                let camera = Camera::look_at(eye, [0.0; 3], 0.7, Up::Y).unwrap();
                let projection = camera.projection(size(), camera.near([caster.mesh()], size()));
                let Some(Drawn { found, .. }) = draw(caster, &light, &projection, size(), 0.0) else {
                    return;
                };
                assert!(found.agrees(), "{largest:e} {light} {eye:?}: {:?}", found.mismatches);
            }
        }
    }
}
