//! Tests of the soft techniques against closed forms.

use super::light_map::LightMap;
use super::*;
use crate::caster::{Caster, CasterGroup};
use crate::mesh::Mesh;
use crate::scene::Lamp;
use crate::shadow::{Request, Samples, Technique};
use crate::testing::shapes;
use crate::view::{Camera, Size, Up};

/// The visible part of a square light with an edge of a half-plane at an angle, `x` its signed distance in
/// half-widths of the penumbra.
pub(super) fn square_fraction(x: f64, angle: f64) -> f64 {
    let (sin, cos) = angle.sin_cos();
    let (p, q) = (cos.abs().max(sin.abs()), cos.abs().min(sin.abs()));
    let positive = |x: f64| match x {
        _ if x <= p - q => 0.5 + x / (2.0 * p),
        _ if x < p + q => 1.0 - (p + q - x).powi(2) / (8.0 * p * q),
        _ => 1.0,
    };
    if x < 0.0 { 1.0 - positive(-x) } else { positive(x) }
}

/// The same of a disk.
pub(super) fn disk_fraction(x: f64) -> f64 {
    let x = x.clamp(-1.0, 1.0);
    0.5 + (x.asin() + x * (1.0 - x * x).sqrt()) / std::f64::consts::PI
}

/// A square light of half-size 1 at height 4 over the floor z = 0, and a sun of the same penumbra.
pub(super) const SQUARE: &str = "rect:-1,-1,4:2,0,0:0,2,0";
pub(super) const SUN: &str = "directional:0,0,-1,angle=26.565051"; // tan = 1/2

/// A floor z = 0 and a plate at height 2 that ends on the line x·cos + y·sin = 0: under [`SQUARE`] and
/// [`SUN`] the half-width of the penumbra is 1 on the floor.
pub(super) fn half_plane(angle: f64) -> Caster {
    let floor = shapes::translated(&shapes::scaled(&shapes::sheet(1), 8.0), [-4.0, -4.0, 0.0]);
    let (sin, cos) = angle.sin_cos();
    let at = |across: f64, along: f64| {
        [(across * cos - along * sin) as f32, (across * sin + along * cos) as f32, 2.0]
    };
    let corners = [at(-6.0, -6.0), at(0.0, -6.0), at(0.0, 6.0), at(-6.0, 6.0)];
    let plate = Mesh::new(corners.to_vec(), vec![[0, 1, 2], [0, 2, 3]]).unwrap();
    Caster::new(Mesh::concat(&[floor, plate]).unwrap())
}

/// Values on the floor with their signed distances from the plate's edge.
pub(super) fn values(technique: &str, lamp: &str, angle: f64) -> Vec<(f64, f64)> {
    let caster = half_plane(angle);
    let casters = CasterGroup::new(vec![&caster]);
    let size = Size::new(40, 30).unwrap();
    let camera = Camera::look_at([0.2, -1.0, 1.5], [0.2, 0.0, 0.0], 1.2, Up::Z).unwrap();
    let samples = Samples::of_view(&casters, &camera.projection(size, 0.125), size, 1).unwrap();
    let lamp: Lamp = lamp.parse().unwrap();
    let technique: Technique = technique.parse().unwrap();
    let found = technique.shade(&Request { casters: &casters, lamp: &lamp, samples: &samples }).unwrap();
    let (sin, cos) = angle.sin_cos();
    let hits = samples.hits().iter().zip(found.values());
    hits.filter_map(|(hit, &value)| {
        let [x, y, z] = hit.as_ref()?.point.map(f64::from);
        (z < 1.0).then_some((x * cos + y * sin, f64::from(value)))
    })
    .collect()
}

/// Greatest difference from a truth.
pub(super) fn worst(found: &[(f64, f64)], truth: impl Fn(f64) -> f64) -> f64 {
    assert!(found.iter().filter(|(x, _)| x.abs() < 1.0).count() > 300);
    found.iter().fold(0.0, |most, &(x, value)| most.max((value - truth(x)).abs()))
}

const ANGLES: [f64; 2] = [0.0, std::f64::consts::FRAC_PI_6];

#[test]
fn pcss_of_all_texels_equals_the_visible_part_of_a_half_plane() {
    for size in [128, 256] {
        // The map shows 8 units; a penumbra's half-width is 1 unit.
        let width = f64::from(size) / 8.0;
        let technique = format!("pcss:size={size},blockers=all,taps=all");
        for angle in ANGLES {
            let square = values(&technique, SQUARE, angle);
            let error = worst(&square, |x| square_fraction(x, angle));
            assert!(error < 1.0 / width, "{size} {angle}: {error}");
            let sun = values(&technique, SUN, angle);
            let error = worst(&sun, disk_fraction);
            // The map of the sun shows the plate's 12 to 17 units.
            assert!(error < 2.0 / width, "{size} {angle}: {error}");
            // The sabotage: half the width, and the profile turned over at the edge.
            assert!(worst(&square, |x| square_fraction(2.0 * x, angle)) > 2.5 / width);
            assert!(worst(&square, |x| square_fraction(x.signum() - x, angle)) > 2.5 / width);
        }
    }
}

#[test]
fn pcss_of_taps_errs_by_less_as_there_are_more() {
    for (lamp, angle) in [(SQUARE, ANGLES[0]), (SQUARE, ANGLES[1]), (SUN, ANGLES[1])] {
        let mean = |taps: u32| {
            let found = values(&format!("pcss:size=256,blockers={taps},taps={taps}"), lamp, angle);
            let truth = |x| if lamp == SUN { disk_fraction(x) } else { square_fraction(x, angle) };
            let inside: Vec<f64> = found.iter().map(|&(x, value)| (value - truth(x)).abs()).collect();
            inside.iter().sum::<f64>() / inside.len() as f64
        };
        let errors = [4, 16, 64, 256].map(mean);
        assert!(errors.windows(2).all(|pair| pair[1] < 0.7 * pair[0]), "{lamp} {errors:?}");
        assert!(errors[3] < 0.02, "{lamp} {errors:?}");
    }
}

/// The penumbra law as the techniques use it.
#[test]
fn pcss_width_doubles_with_the_map_and_the_lamp_and_is_that_of_the_geometry() {
    let caster = half_plane(0.0);
    let casters = CasterGroup::new(vec![&caster]);
    let hit = casters.oracle().first_visible_beyond([0.1, 0.2, 1.0], [0.0, 0.0, -1.0], 0.0).unwrap();
    let width = |lamp: &str, size: u32| {
        let map = LightMap::prepare(&casters, &lamp.parse().unwrap(), size).unwrap();
        let mut receiver = map.receiver(&hit).unwrap();
        let blocker = map.space().at(glam::DVec3::new(-0.1, 0.0, 2.0)).unwrap().d;
        let [width, other] = receiver.penumbra(Taps::All).unwrap();
        assert!((width - other).abs() < 1e-6 * width);
        let law = receiver.widths(blocker)[0];
        assert!((width - law).abs() < 1e-3 * width, "{lamp} {width} {law}");
        // The sabotage: a difference of distances instead of depths.
        let linear = receiver.k[0] * (receiver.d / blocker) * (blocker - receiver.d);
        assert!((width - linear).abs() > 0.1 * width);
        (width, width * map.space().texel_world(glam::DVec3::from(hit.point.map(f64::from))))
    };
    let lamps = [SQUARE, "rect:-2,-2,4:4,0,0:0,4,0", "rect:-1,-1,4:1,1,0:1,-1,0", SUN];
    let [(once, world), (_, twice), (_, turned), (_, sun)] = lamps.map(|lamp| width(lamp, 256));
    assert!((world - 1.0).abs() < 1e-3 && (twice - 2.0).abs() < 2e-3 && (sun - 1.0).abs() < 1e-2);
    // A square rotated by 45° has the mean squares, along each axis, of an upright square of half-size 1/√2.
    assert!((turned - 0.5_f64.sqrt()).abs() < 1e-3, "{turned}");
    assert!((width(SQUARE, 512).0 - 2.0 * once).abs() < 1e-2);
}

#[test]
fn pyramid_bounds_every_box() {
    let caster = Caster::new(shapes::torus_knot(2, 3, 40, 7, 0.4));
    let casters = CasterGroup::new(vec![&caster]);
    let mut random = crate::random::SplitMix64(5);
    for lamp in ["directional:0.3,-1,0.2", "point:0.3,6,-1", "spot:1,9,2:-0.1,-1,-0.2:35"] {
        let map = LightMap::prepare(&casters, &lamp.parse().unwrap(), 100).unwrap();
        let mut tight = 0;
        for _ in 0..300 {
            let at = [0; 2].map(|_| 100.0 * random.unit());
            let half = [0; 2].map(|_| 30.0 * random.unit().powi(3));
            let layer = random.below(map.space().layers());
            let mut most = 0.0_f64;
            let window = window::Window { at, half, is_round: false };
            window.for_each_texel([0, 100], |i, j, _| {
                most = most.max(f64::from(*map.map.texel(layer, i, j).unwrap()));
            });
            let (bound, cells) = map.pyramid.most_within(layer, at, half);
            assert!(bound >= most && cells <= 25);
            tight += u32::from(bound == most);
        }
        assert!(tight > 100, "{lamp} {tight}");
    }
}

/// Lamps inside the mesh, on it, and of any size: a value for every sample, the same twice.
#[test]
fn soft_techniques_answer_for_any_lamp() {
    let caster = Caster::new(shapes::torus(24, 12, 2.0, 0.7));
    let casters = CasterGroup::new(vec![&caster]);
    let size = Size::new(12, 9).unwrap();
    let camera = Camera::fit(&casters.bounds(), Up::Y, size.aspect());
    let samples = Samples::of_view(&casters, &camera.projection(size, 0.125), size, 1).unwrap();
    let lamps = [
        "point:2,0,0,radius=0.1",    // within the tube
        "point:2.7,0,0,radius=0.1",  // on it
        "point:0,0,0.1,radius=1e30", // larger than all
        "point:0,0,3,radius=1e-30",
        "point:3e38,0,0,radius=3e38",
        "rect:0,0,3:1e30,0,0:0,1e30,0",
        "rect:0,3,3:0,0,1e-20:0,1,0", // edge-on
        "directional:0,0,-1,angle=90",
        "spot:0,0,6:0,0,-1:89,radius=2",
        "spot:0,0,1:0,0,1:20,radius=2", // turned away
        "point:0,3,4",
    ];
    for technique in Technique::ALL {
        // Those with a map.
        let Ok(technique) = technique.with("size", "64") else { continue };
        if !technique.is_soft() {
            continue;
        }
        for lamp in lamps {
            let lamp: Lamp = lamp.parse().unwrap();
            let request = Request { casters: &casters, lamp: &lamp, samples: &samples };
            let found = technique.shade(&request).unwrap();
            assert!(found.values().iter().all(|value| (0.0..=1.0).contains(value)), "{technique} {lamp}");
            assert_eq!(found, technique.shade(&request).unwrap(), "{technique} {lamp}");
        }
    }
}

#[test]
fn soft_options_are_refused_by_name() {
    let error = |text: &str| text.parse::<Technique>().unwrap_err().to_string();
    let device = error("single-sample:search=gpu");
    assert_eq!(device, "single-sample:search=gpu: `gpu` is not `cpu` or `device`");
    assert_eq!(error("pcss:taps=0"), "pcss:taps=0: `0` is not a number from 1 to 1024, or `all`");
    assert_eq!(error("vsm:size=16385"), "vsm:size=16385: `16385` is not a number from 1 to 16384");
    assert_eq!(error("msm:taps=4"), "`msm` has no option `taps`; it has size");
    for text in [
        "pcss:size=64,blockers=all,taps=64",
        "single-sample:adaptive=4,literal=yes",
        "single-sample:search=device",
        "soft-hybrid:rays=16,certain=pcss",
        "smoothies:profile=full",
    ] {
        assert_eq!(text.parse::<Technique>().unwrap().to_string(), text);
    }
}

/// The form of the CPU does not silently search where it was not told to.
#[test]
fn single_sample_of_the_cpu_refuses_a_search_on_a_device() {
    let caster = half_plane(0.0);
    let casters = CasterGroup::new(vec![&caster]);
    let technique: Technique = "single-sample:search=device".parse().unwrap();
    let error = technique.prepare(&casters, &SQUARE.parse().unwrap()).unwrap_err().to_string();
    assert!(error.starts_with("single-sample:search=device: search=device needs"), "{error}");
    assert!(error.ends_with("use search=cpu"), "{error}");
}

/// Moments of a map that does not fit are refused with their bytes, and nothing is allocated.
#[test]
fn soft_maps_that_do_not_fit_are_refused() {
    let caster = half_plane(0.0);
    let casters = CasterGroup::new(vec![&caster]);
    let lamp: Lamp = SQUARE.parse().unwrap();
    for text in ["pcss:size=16384", "contact-blur:size=16384"] {
        let error = text.parse::<Technique>().unwrap().prepare(&casters, &lamp).unwrap_err().to_string();
        assert!(error.starts_with(text) && error.ends_with("choose a smaller size"), "{error}");
    }
}

/// One wall that the sun's disk stands behind in part, and nothing else: every map is empty of blockers.
#[test]
fn soft_values_are_cut_at_the_horizon_of_their_face() {
    let wall = Caster::new(shapes::scaled(&shapes::sheet(1), 2.0));
    let casters = CasterGroup::new(vec![&wall]);
    let size = Size::new(16, 12).unwrap();
    let camera = Camera::look_at([1.0, 1.0, 4.0], [1.0, 1.0, 0.0], 0.3, Up::Y).unwrap();
    let samples = Samples::of_view(&casters, &camera.projection(size, 0.125), size, 1).unwrap();
    // The center 10° above the wall's plane, the rim 20° around it: a chord at tan 10° / tan 20° of the
    // radius.
    let (sin, cos) = 10_f64.to_radians().sin_cos();
    let lamp: Lamp = format!("directional:{},0,{},angle=20", -cos, -sin).parse().unwrap();
    let request = Request { casters: &casters, lamp: &lamp, samples: &samples };
    let [x, _, z] = lamp.light().xyz().map(f64::from); // as rounded
    let radius = lamp.patch([0.0; 3]).unwrap().across.length();
    let expected = disk_fraction((z / x).abs() / radius);
    // A visible point lies before the wall, and light passes over the wall's rim below the horizon: 0.2 away
    // at least, and a share of the disk is at most 2/π of a height in radii.
    let height = samples.hits().iter().flatten().map(|hit| f64::from(hit.point[2])).fold(0.0, f64::max);
    let rim = height / 0.2 / radius * std::f64::consts::FRAC_2_PI;
    for technique in Technique::ALL.into_iter().filter(|technique| technique.is_soft()) {
        let found = technique.shade(&request).unwrap();
        assert!(found.asked().iter().all(|asked| *asked));
        let off = found.values().iter().map(|&value| (f64::from(value) - expected).abs()).fold(0.0, f64::max);
        // 64 points of the lamp show its parts to a tenth, and 16 to a fifth; the others know the plane.
        let most = match technique {
            Technique::Samples(_) | Technique::SoftHybrid(_) => 0.1,
            Technique::PlanarLayers(_) => 0.2,
            _ => rim + f64::from(f32::EPSILON),
        };
        assert!(off < most, "{technique} {off}");
    }
    assert!(expected < 0.85, "without the cut the maps answer 1");
}
