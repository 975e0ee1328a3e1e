//! The techniques beside `planar`: limits, convergence, and the faults that they have.

use super::blob::spheres;
use super::{Plane, TextureOptions, projective};
use crate::caster::{Caster, CasterGroup};
use crate::geom::Light;
use crate::mesh::Mesh;
use crate::oracle::Verdict;
use crate::random::r2;
use crate::scene::Lamp;
use crate::shadow::LampShadow;
use crate::shadow::{Request, Samples, Technique, Visibility};
use crate::testing::shapes;
use crate::verify::errors::{Errors, Made, Truth};
use crate::view::{Camera, Size, Up};

/// A square light of half-size 1 at height 4 over the floor z = 0, and a sun of the same half-width of
/// penumbra under a plate at height 2.
const SQUARE: &str = "rect:-1,-1,4:2,0,0:0,2,0";
const SUN: &str = "directional:0,0,-1,angle=26.565051"; // tan = 1/2

fn floor() -> Mesh {
    shapes::translated(&shapes::scaled(&shapes::sheet(1), 8.0), [-4.0, -4.0, 0.0])
}

/// The rectangle from (x, −6) to (to, 6) at a height.
fn plate(x: f32, to: f32, z: f32) -> Mesh {
    let corners = [[x, -6.0, z], [to, -6.0, z], [to, 6.0, z], [x, 6.0, z]];
    Mesh::new(corners.to_vec(), vec![[0, 1, 2], [0, 2, 3]]).unwrap()
}

fn scene(meshes: &[Mesh]) -> Caster {
    Caster::new(Mesh::concat(&[&[floor()], meshes].concat()).unwrap())
}

/// A view of the floor from below all plates.
fn with_request<T>(caster: &Caster, lamp: &str, work: impl FnOnce(&Request<'_>) -> T) -> T {
    with_view(caster, lamp, [48, 36], work)
}

fn with_view<T>(
    caster: &Caster,
    lamp: &str,
    [width, height]: [u32; 2],
    work: impl FnOnce(&Request<'_>) -> T,
) -> T {
    let casters = CasterGroup::new(vec![caster]);
    let size = Size::new(width, height).unwrap();
    let camera = Camera::look_at([0.2, -0.75, 0.9], [0.2, 0.0, 0.0], 1.4, Up::Z).unwrap();
    let samples = Samples::of_view(&casters, &camera.projection(size, 0.125), size, 1).unwrap();
    let lamp: Lamp = lamp.parse().unwrap();
    work(&Request { casters: &casters, lamp: &lamp, samples: &samples })
}

fn shade(request: &Request<'_>, technique: &str) -> Visibility {
    technique.parse::<Technique>().unwrap().shade(request).unwrap()
}

/// Mean error over the floor near the line x = 0 where the truth is a function of x.
fn mean_error(caster: &Caster, lamp: &str, technique: &str, truth: impl Fn(f64) -> f64) -> f64 {
    with_request(caster, lamp, |request| {
        let found = shade(request, technique);
        let hits = request.samples.hits().iter().zip(found.values());
        let errors: Vec<f64> = hits
            .filter_map(|(hit, &value)| {
                let [x, _, z] = hit.as_ref()?.point.map(f64::from);
                (z < 0.1 && x.abs() < 1.0).then(|| (f64::from(value) - truth(x)).abs())
            })
            .collect();
        assert!(errors.len() > 300, "{}", errors.len());
        errors.iter().sum::<f64>() / errors.len() as f64
    })
}

fn of_square(x: f64) -> f64 {
    (0.5 + 0.5 * x).clamp(0.0, 1.0)
}

fn of_disk(x: f64) -> f64 {
    let x = x.clamp(-1.0, 1.0);
    0.5 + (x.asin() + x * (1.0 - x * x).sqrt()) / std::f64::consts::PI
}

/// The mean of |value − truth| of the analytic fraction over all judged samples.
fn mean_of(request: &Request<'_>, technique: &str) -> f64 {
    let truth = Truth::of(request);
    Errors::of(request, &shade(request, technique), &truth, &Made { is_soft: true, ..Made::default() }).mean
}

#[test]
fn planar_layers_come_nearer_to_the_visible_fraction_as_there_are_more() {
    let half_plane = scene(&[plate(-6.0, 0.0, 2.0)]);
    for (lamp, truth) in [(SQUARE, of_square as fn(f64) -> f64), (SUN, of_disk)] {
        let errors =
            [4, 16, 64].map(|n| mean_error(&half_plane, lamp, &format!("planar-layers:n={n}"), truth));
        assert!(errors.windows(2).all(|pair| pair[1] < 0.8 * pair[0]), "{lamp} {errors:?}");
        assert!(errors[2] < 0.02, "{lamp} {errors:?}");
        // The fault: one layer alone is a hard shadow.
        let hard = mean_error(&half_plane, lamp, "planar", truth);
        assert!(hard > 5.0 * errors[2], "{lamp} {hard} {errors:?}");
    }
    let knot =
        shapes::translated(&shapes::scaled(&shapes::torus_knot(2, 3, 40, 6, 0.4), 0.5), [0.0, 0.0, 2.0]);
    let knot = scene(&[knot]);
    for lamp in [SQUARE, "point:1,0.5,5,radius=0.5"] {
        with_request(&knot, lamp, |request| {
            let errors = [4, 64].map(|n| mean_of(request, &format!("planar-layers:n={n}")));
            assert!(errors[1] < 0.4 * errors[0] && errors[1] < 0.03, "{lamp} {errors:?}");
        });
    }
    with_request(&knot, "point:1,0.5,5", |request| {
        let hard = shade(request, "planar-layers");
        assert_eq!(hard.values(), shade(request, "planar").values());
        assert_eq!(hard.claim(), crate::shadow::Claim::Exact);
    });
}

#[test]
fn planar_blur_of_casters_at_one_height_is_the_visible_fraction() {
    let half_plane = scene(&[plate(-6.0, 0.0, 2.0)]);
    for technique in ["planar-blur", "planar-contact"] {
        let [coarse, fine] = [64, 256]
            .map(|size| mean_error(&half_plane, SQUARE, &format!("{technique}:size={size}"), of_square));
        assert!(fine < 0.008 && fine < 0.5 * coarse, "{technique} {coarse} {fine}");
        let sun = mean_error(&half_plane, SUN, &format!("{technique}:size=256"), of_disk);
        assert!(sun < 0.03, "{technique} {sun}");
        // The fault: no width.
        let hard = mean_error(&half_plane, "point:0,0,4", &format!("{technique}:size=256"), of_square);
        assert!(hard > 0.1, "{technique} {hard}");
    }
}

/// Edges at x = −½ and x = ½ on the floor, of plates at heights 1/2 and 3: each has its own width.
#[test]
fn planar_contact_has_a_width_per_height_and_planar_blur_one_for_all() {
    let lamp = "rect:-0.25,-0.25,4:0.5,0,0:0,0.5,0";
    // Shadows x < −0.6 and x > 0.6: the rise is 1/7 and 3.
    let both = scene(&[plate(-6.0, -0.6 * 7.0 / 8.0, 0.5), plate(0.6 / 4.0, 6.0, 3.0)]);
    let truth = |x: f64| {
        let edge = |x: f64, half: f64| (0.5 + 0.5 * x / half).clamp(0.0, 1.0);
        edge(x + 0.6, 0.25 / 7.0).min(edge(0.6 - x, 0.75))
    };
    let mean = |technique: &str| mean_error(&both, lamp, technique, truth);
    let [blur, contact] = ["planar-blur:size=512", "planar-contact:size=512"].map(mean);
    assert!(contact < 0.5 * blur, "{contact} {blur}");
    assert!(mean("planar-layers:n=256") < 0.02, "the truth is one");
}

/// A sphere above the floor, and one that is sunk into it.
#[test]
fn blob_is_the_closed_form_of_a_sphere_and_what_rays_to_the_sky_say() {
    let sphere = shapes::icosphere(3);
    let above = scene(&[shapes::translated(&sphere, [0.5, 0.25, 2.0])]);
    let plane = Plane::new([0.0, 0.0, 1.0, 0.0]).unwrap();
    let directions: Vec<Light> = (0..2048)
        .map(|i| {
            let [u, v] = r2(i);
            let (sin, cos) = (std::f64::consts::TAU * v).sin_cos();
            let [x, y, z] = [cos * u.sqrt(), sin * u.sqrt(), (1.0 - u).sqrt()];
            Light::directional([-x as f32, -y as f32, -z as f32]).unwrap()
        })
        .collect();
    let worst = with_request(&above, "point:3,4,9", |request| {
        let found = shade(request, "blob");
        let mut worst = [0.0_f64; 3];
        for (index, (hit, &value)) in request.samples.hits().iter().zip(found.values()).enumerate() {
            let Some(hit) = hit.filter(|hit| hit.point[2] < 0.01) else { continue };
            let [x, y, _] = hit.point.map(f64::from);
            let x2 = (x - 0.5).powi(2) + (y - 0.25).powi(2);
            let closed = |radius: f64, z: f64| 1.0 - radius * radius * z / (x2 + z * z).powf(1.5);
            worst[0] = worst[0].max((f64::from(value) - closed(1.0, 2.0)).abs());
            // The fault: a sphere at another height.
            worst[2] = worst[2].max((f64::from(value) - closed(1.0, 2.25)).abs());
            if index % 16 == 0 {
                let lit = directions
                    .iter()
                    .filter(|light| request.casters.oracle().verdict(hit.point, light) != Verdict::Shadowed);
                let open = lit.count() as f64 / directions.len() as f64;
                worst[1] = worst[1].max((f64::from(value) - open).abs());
            }
        }
        worst
    });
    assert!(worst[0] < 1e-6 && worst[1] < 0.01 && worst[2] > 0.03, "{worst:?}");

    // Two shells: one sunk to its middle, raised to rest on the plane; one below, which hides nothing.
    let sunken = scene(&[sphere.clone(), shapes::translated(&sphere, [2.5, 0.0, -3.0])]);
    let found = spheres(&CasterGroup::new(vec![&sunken]), &plane);
    assert_eq!(found.len(), 1);
    let hidden = found[0].hides(&plane, glam::DVec3::ZERO);
    assert!((hidden - 1.0).abs() < 1e-12, "{hidden}");
    with_request(&above, "point:3,4,9", |request| {
        assert_eq!(shade(request, "blob").values(), shade(request, "blob:plane=0/0/1/0").values());
    });
}

/// A plate casts onto a sphere, which does not cast. The lamp is a spot light.
#[test]
fn projective_shades_curved_receivers_behind_the_caster_and_errs_before_it() {
    let casts = Caster::new(shapes::translated(&shapes::scaled(&shapes::sheet(1), 1.0), [-0.4, -0.3, 2.0]));
    let wrong = |receiver: Mesh, spot: &str, eye: [f32; 3], to: f32| {
        let seen = Caster::new(Mesh::concat(&[casts.mesh().clone(), receiver]).unwrap());
        let casters = CasterGroup::new(vec![&casts]).seen_with(&seen);
        let size = Size::new(48, 36).unwrap();
        let camera = Camera::look_at(eye, [0.0, 0.0, to], 0.9, Up::Y).unwrap();
        let samples = Samples::of_view(&casters, &camera.projection(size, 0.125), size, 1).unwrap();
        let lamp: Lamp = spot.parse().unwrap();
        let request = Request { casters: &casters, lamp: &lamp, samples: &samples };
        let (found, rays) = (shade(&request, "projective:size=256"), shade(&request, "rays"));
        let asked = found.asked().iter().filter(|asked| **asked).count();
        let off = found.values().iter().zip(rays.values()).filter(|(a, b)| (**a >= 0.5) != (**b >= 0.5));
        let dark = rays.values().iter().zip(rays.asked()).filter(|(value, asked)| **asked && **value == 0.0);
        (off.count(), dark.count(), asked, found.outside().len())
    };
    let spot = "spot:0,0,6:0,0,-1:40";
    let (off, dark, asked, _) = wrong(shapes::icosphere(3), spot, [0.5, 3.0, 3.5], 1.5);
    assert!(dark * 10 > asked && off * 50 < asked, "{off} wrong, {dark} dark of {asked}");
    // The fault that it has: what is before the caster is dark as well.
    let before = shapes::translated(&shapes::scaled(&shapes::sheet(1), 2.0), [-1.0, -1.0, 4.0]);
    let (off, dark, asked, _) = wrong(before, spot, [0.1, 0.2, 5.9], 4.0);
    assert!(dark == 0 && off * 20 > asked, "{off} wrong of {asked}");
    // Behind the lamp: lit, though the same texels would be read there.
    let behind = shapes::translated(&shapes::scaled(&shapes::sheet(1), 2.0), [-1.0, -1.0, 7.0]);
    let (off, dark, asked, outside) = wrong(shapes::inside_out(&behind), spot, [0.1, 0.2, 5.0], 7.0);
    assert!(off == 0 && dark == 0 && outside > 100, "{off} {dark} {outside} of {asked}");
}

/// Where everything casts, the plane receives, and what is not on it is passed to rays.
#[test]
fn projective_onto_the_plane_is_off_by_texels_at_the_outline() {
    let knot = shapes::torus_knot(2, 3, 40, 6, 0.4);
    let caster =
        scene(&[shapes::translated(&shapes::scaled(&knot, 0.5), [0.0, 0.0, 1.5]), plate(-6.0, 6.0, -1.0)]);
    for lamp in ["point:1,0.5,5", "spot:0.5,0,5:0,0,-1:50", "directional:0.2,0.1,-1"] {
        with_request(&caster, lamp, |request| {
            let rays = shade(request, "rays");
            let wrong = |technique: &str| {
                let found = shade(request, technique);
                let pairs = found.values().iter().zip(rays.values());
                pairs.filter(|(a, b)| (**a >= 0.5) != (**b >= 0.5)).count()
            };
            let asked = rays.asked().iter().filter(|asked| **asked).count();
            let [coarse, fine] = [32, 512].map(|size| wrong(&format!("projective:size={size}")));
            let dark = |of: &Visibility| of.values().iter().filter(|value| **value < 0.5).count();
            let darks = [dark(&rays), dark(&shade(request, "projective:size=512"))];
            assert!(fine * 50 < asked && fine < coarse, "{lamp} {coarse} {fine} of {asked} {darks:?}");
            // The fault: without the clip by the plane its own faces cover everything.
            let options = TextureOptions { size: 64, ..TextureOptions::DEFAULT };
            let seen = Caster::new(request.casters.casters()[0].mesh().clone());
            let all = CasterGroup::new(request.casters.casters().to_vec()).seen_with(&seen);
            let whole: Box<dyn LampShadow> = projective(&all, request.lamp, options).unwrap();
            assert_eq!(whole.shade(request.samples).values(), rays.values(), "all casts: all by rays");
        });
    }
}

/// Lamps in the plane, behind it, inside the mesh and of any size: a value for every sample, the same twice.
#[test]
fn planar_techniques_answer_for_any_lamp_and_plane() {
    let caster = scene(&[shapes::torus(12, 6, 1.0, 0.5), plate(-6.0, 0.0, 3e5)]);
    let lamps = [
        "point:2,0,0,radius=0.1",     // in the plane
        "point:2,0,1e-30,radius=0.1", // as good as in it
        "point:0,0,-3",
        "point:1,0,0.1,radius=1e30",
        "point:3e38,0,3e38,radius=3e38",
        "rect:0,0,3:1e30,0,0:0,1e30,0",
        "directional:0,0,-1,angle=90",
        "directional:1,0,-1e-30",
        "spot:0,0,6:0,0,-1:89,radius=2",
        "spot:0,0,1:0,0,1:20,radius=2", // turned away
    ];
    let planes = ["most", "0/0/1/0", "0/0/1e300/-1", "1/0/0/1e300", "1e-300/1/0/3e38", "0.3/0.4/0.5/0.6"];
    for lamp in lamps {
        with_view(&caster, lamp, [12, 9], |request| {
            let rays = shade(request, "rays");
            for plane in planes {
                assert_eq!(
                    shade(request, &format!("planar:plane={plane}")).values(),
                    rays.values(),
                    "{lamp} {plane}"
                );
                for technique in [
                    "planar-blur:size=16",
                    "planar-contact:size=16",
                    "planar-layers:n=2",
                    "blob:",
                    "projective:size=16",
                ] {
                    let technique = format!("{technique},plane={plane}").replace(":,", ":");
                    let found = shade(request, &technique);
                    assert!(
                        found.values().iter().all(|value| (0.0..=1.0).contains(value)),
                        "{technique} {lamp}"
                    );
                    assert_eq!(found, shade(request, &technique), "{technique} {lamp}");
                }
            }
        });
    }
}
