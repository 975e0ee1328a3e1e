//! Pixel comparison on masks that no device made: correct masks agree, and a single wrong pixel is reported.

use umbrage::caster::Caster;
use umbrage::facing::{CasterFaces, classify};
use umbrage::geom::Light;
use umbrage::mesh::{FaceId, Mesh};
use umbrage::shadow::stencil::{Counting, ShadowMask};
use umbrage::testing::shapes;
use umbrage::verify::pixels::{Comparison, PixelVerdict, Rendered, compare};
use umbrage::view::{Camera, Projection, Size, Up};

struct Scene {
    caster: Caster,
    light: Light,
    projection: Projection,
    size: Size,
    signs: Vec<i8>,
}

impl Scene {
    fn new(mesh: Mesh, light: Light) -> Self {
        let size = Size::new(40, 32).unwrap();
        let signs = CasterFaces::All.signs(&classify(&mesh, &light));
        let caster = Caster::new(mesh);
        let bounds = caster.oracle().bounds();
        let camera = Camera::fit(&bounds, Up::Y, size.aspect());
        Self { caster, projection: camera.projection(size, 0.01), size, signs, light }
    }

    /// The exact count of each pixel, by the oracle; `None` for sky.
    fn exact(&self) -> Vec<Option<i32>> {
        let (width, height) = (self.size.width(), self.size.height());
        let places = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
        places
            .map(|(x, y)| {
                let ndc = [
                    2.0 * (f64::from(x) + 0.5) / f64::from(width) - 1.0,
                    1.0 - 2.0 * (f64::from(y) + 0.5) / f64::from(height),
                ];
                let ray = self.projection.ray(ndc.into()).as_vec3().into();
                let seen = self.caster.oracle().first_visible_beyond(self.projection.eye, ray, 0.01)?;
                let crossings = self.caster.oracle().crossings(seen.point, &self.light);
                Some((crossings.front + crossings.back) as i32)
            })
            .collect()
    }

    fn judge(&self, counts: &[Option<i32>], counting: Counting, unsure: &[FaceId]) -> Comparison {
        let raw = counts.iter().map(|count| count.unwrap_or(0)).collect();
        let receivers = counts.iter().map(Option::is_some).collect();
        let mask = ShadowMask::new(self.size, counting, raw, receivers);
        let Self { caster, signs, light, projection, .. } = self;
        let rendered = Rendered {
            caster,
            seen: None,
            signs,
            light,
            projection,
            seen_from: projection.near,
            mask: &mask,
            unsure,
        };
        compare(&rendered, 10, &|_| {})
    }
}

fn knot() -> Scene {
    let mesh = shapes::torus_knot(2, 3, 80, 10, 0.3);
    Scene::new(mesh, Light::point([4.0, 6.0, 3.0]).unwrap())
}

#[test]
fn compare_agrees_with_the_exact_counts_everywhere() {
    let scene = knot();
    let exact = scene.exact();
    let result = scene.judge(&exact, Counting::Integer, &[]);
    assert!(result.agrees() && result.mismatches.is_empty());
    let shadowed = exact.iter().filter(|count| count.is_some_and(|count| count > 0)).count();
    assert_eq!(result.count(PixelVerdict::Shadowed), shadowed);
    assert_eq!(result.count(PixelVerdict::Sky), exact.iter().filter(|count| count.is_none()).count());
    assert!(result.count(PixelVerdict::Lit) > 0 && shadowed > 0);
}

#[test]
fn compare_calls_a_single_wrong_pixel_real_wherever_no_boundary_is_near() {
    let scene = knot();
    let exact = scene.exact();
    // Cracks of one pixel: one volume more, one less, sky instead of a surface, a surface in the sky.
    type Fault = fn(Option<i32>) -> Option<i32>;
    let faults: [Fault; 3] = [
        |count| count.map(|n| n + 1),
        |count| count.map(|n| n - 2),
        |count| match count {
            None => Some(0),
            Some(_) => None,
        },
    ];
    for fault in faults {
        let mut altered = exact.clone();
        altered.iter_mut().skip(3).step_by(7).for_each(|count| *count = fault(*count));
        let changed = altered.iter().zip(&exact).filter(|(a, b)| a != b).count();
        let result = scene.judge(&altered, Counting::Integer, &[]);
        let [real, grazing] =
            [PixelVerdict::Real, PixelVerdict::Grazing].map(|verdict| result.count(verdict));
        eprintln!("{changed} pixels altered: {real} real, {grazing} grazing");
        assert_eq!(real + grazing, changed);
        // A boundary within 1/250 of a pixel is rare.
        assert!(changed > 20 && grazing * 20 < changed, "{grazing} of {changed} are forgiven");
        assert!(!result.agrees() && result.mismatches.len() == 10);
    }
}

#[test]
fn compare_tells_overflow_from_other_mismatches() {
    // Looking towards the light, where most of the 300 shells are crossed twice.
    let mesh = shapes::nested_cubes(300);
    let scene = Scene::new(mesh, Light::point([-900.0, -800.0, -950.0]).unwrap());
    let exact = scene.exact();
    let wrapped: Vec<_> = exact.iter().map(|count| count.map(|count| count & 255)).collect();
    let overflown = exact.iter().zip(&wrapped).filter(|(a, b)| a != b).count();
    assert!(overflown > 20);
    let result = scene.judge(&wrapped, Counting::Stencil, &[]);
    assert_eq!((result.count(PixelVerdict::Overflow), result.agrees()), (overflown, false));
    // Integer counts have no excuse.
    let result = scene.judge(&wrapped, Counting::Integer, &[]);
    assert_eq!(result.count(PixelVerdict::Overflow), 0);
    assert!(result.count(PixelVerdict::Real) > 0);
}

#[test]
fn compare_tells_mismatches_of_unsure_faces_from_real_ones() {
    let scene = knot();
    let wrong: Vec<_> = scene.exact().iter().map(|count| count.map(|count| count + 1)).collect();
    let all: Vec<FaceId> = scene.caster.topology().faces().collect();
    let result = scene.judge(&wrong, Counting::Integer, &all);
    assert_eq!(result.count(PixelVerdict::Real), 0);
    assert!(result.count(PixelVerdict::Unsure) > 0 && !result.agrees());
}

#[test]
fn compare_far_from_the_origin_is_as_near_it() {
    let mesh = shapes::icosphere(2);
    let far = [65_536.0, -131_072.0, 32_768.0];
    // Positions on a coarse grid, so that a translation rounds nothing.
    let coarse = mesh.positions().iter().map(|p| p.map(|x| (x * 16.0).round() / 16.0)).collect();
    let mesh = Mesh::new(coarse, mesh.triangles().to_vec()).unwrap();
    let near = Scene::new(mesh.clone(), Light::point([4.0, 6.0, 3.0]).unwrap());
    let moved = shapes::translated(&mesh, far);
    let mut there = Scene::new(moved, Light::point([0, 1, 2].map(|i| far[i] + [4.0, 6.0, 3.0][i])).unwrap());
    let eye = near.projection.eye.map(|x| (x * 16.0).round() / 16.0);
    let mut here = near;
    here.projection.eye = eye;
    there.projection = Projection { eye: [0, 1, 2].map(|i| eye[i] + far[i]), ..here.projection };
    let exact = here.exact();
    assert!(here.judge(&exact, Counting::Integer, &[]).agrees());
    let result = there.judge(&exact, Counting::Integer, &[]);
    assert!(result.agrees(), "{:?}", result.mismatches);
}
