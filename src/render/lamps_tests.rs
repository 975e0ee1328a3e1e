//! Light adds up: the picture of two lamps is the sum of the pictures of one and one.

use super::{CLAY, Picture, ShadedLight, View, render_samples};
use crate::caster::{Caster, CasterGroup};
use crate::mesh::Mesh;
use crate::scene::Lamp;
use crate::shadow::{Request, Samples, Technique};
use crate::testing::shapes;
use crate::view::{Camera, Projection, Size, Up};

/// Levels of a channel: each of four pictures is rounded by half a level, and the transfer function is
/// steepest where light is least, so that errors of the parts are no greater in the sum.
const MOST: f64 = 2.0;

fn scene() -> Caster {
    let floor = shapes::translated(&shapes::scaled(&shapes::sheet(1), 12.0), [-6.0, -6.0, -2.0]);
    let cube = shapes::translated(&shapes::cube(), [2.5, -1.0, 0.0]);
    Caster::new(Mesh::concat(&[floor, cube, shapes::torus(24, 12, 2.0, 0.7)]).unwrap())
}

fn lamps() -> [Lamp; 2] {
    ["directional:0.4,0.2,-1", "point:-3,2,6"].map(|lamp| lamp.parse().unwrap())
}

fn view_of(projection_size: Size, casters: &CasterGroup<'_>) -> (Camera, Projection) {
    let camera = Camera::fit(&casters.bounds(), Up::Z, projection_size.aspect());
    (camera, camera.projection(projection_size, 0.125))
}

/// Below the knee of the highlights.
fn dim(lamps: &[Lamp; 2]) -> Vec<ShadedLight> {
    let shaded = ShadedLight::equal(lamps).into_iter();
    shaded.map(|lamp| ShadedLight { color: [0.2; 3], ..lamp }).collect()
}

/// The inverse of the transfer function of sRGB, and that function, in levels.
fn linear(level: u8) -> f64 {
    let x = f64::from(level) / 255.0;
    if x <= 0.040_45 { x / 12.92 } else { ((x + 0.055) / 1.055).powf(2.4) }
}

fn level(linear: f64) -> f64 {
    255.0 * if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 }
}

/// Channels of the picture of both that are not the sum of both less the ambient light, which each has.
fn differ(both: &Picture, one: &Picture, other: &Picture, none: &Picture) -> usize {
    let channels = |picture: &Picture| {
        let pixels = picture.pixels.iter();
        pixels.flat_map(|pixel| pixel[..3].to_vec()).collect::<Vec<u8>>()
    };
    let [both, one, other, none] = [both, one, other, none].map(channels);
    (0..both.len())
        .filter(|&at| {
            let sum = linear(one[at]) + linear(other[at]) - linear(none[at]);
            assert!(sum < 0.75, "{sum}");
            (level(sum) - f64::from(both[at])).abs() > MOST
        })
        .count()
}

#[test]
fn picture_of_two_lamps_is_the_sum_of_one_and_one() {
    let caster = scene();
    let casters = CasterGroup::new(vec![&caster]);
    let size = Size::new(96, 72).unwrap();
    let (camera, projection) = view_of(size, &casters);
    let samples = Samples::of_view(&casters, &projection, size, 1).unwrap();
    let lamps = lamps();
    for technique in ["pcf:size=256,kernel=tent3", "rays", "hybrid-3x3:size=128"] {
        let technique: Technique = technique.parse().unwrap();
        let visible = lamps
            .each_ref()
            .map(|lamp| technique.shade(&Request { casters: &casters, lamp, samples: &samples }).unwrap());
        let shaded = dim(&lamps);
        let picture = |lamps: &[ShadedLight], visible: &[crate::shadow::Visibility]| {
            let view = View {
                camera,
                size,
                lamps,
                casters: None,
                up: Up::Z,
                ground: None,
                paint: &|_| CLAY,
                edge_samples: 1,
                ambient: None,
            };
            render_samples(&samples, &view, visible).unwrap()
        };
        let both = picture(&shaded, &visible);
        let [one, other] = [0, 1].map(|at| picture(&shaded[at..=at], &visible[at..=at]));
        let none = picture(&[], &[]);
        assert_eq!(differ(&both, &one, &other, &none), 0, "{technique}");
        // Fault injected: both lamps get the shadows of one.
        let wrong = picture(&shaded, &[visible[0].clone(), visible[0].clone()]);
        assert!(differ(&wrong, &one, &other, &none) > 100, "{technique}");
    }
}

#[cfg(feature = "gpu")]
#[test]
fn picture_of_two_lamps_on_a_device_is_the_sum_of_one_and_one() {
    use super::render_visibility;
    use crate::caster::GpuCaster;
    use crate::shadow::Depth;
    use crate::shadow::map::gpu::{Lookup, MapPass};
    use crate::shadow::map::{Bias, Filter, LightSpace};

    let Some(gpu) = crate::gpu::tests::gpu() else { return };
    let caster = scene();
    let casters = CasterGroup::new(vec![&caster]);
    let size = Size::new(96, 72).unwrap();
    let (camera, projection) = view_of(size, &casters);
    let on_device = GpuCaster::upload(&gpu, &caster).unwrap();
    let samples = on_device.samples(&projection, size, Depth::Plane).unwrap();
    let (lamps, pass) = (lamps(), MapPass::new(&gpu).unwrap());
    let visible = lamps.each_ref().map(|lamp| {
        let map = pass.draw(&on_device, &LightSpace::of_scene(&casters, lamp, 256).unwrap()).unwrap();
        let lookup = Lookup { filter: Filter::Tent3, bias: Bias::Receiver };
        pass.visibility(&samples, &map, lookup).unwrap()
    });
    let shaded = dim(&lamps);
    let picture = |lamps: &[ShadedLight], of: &[usize]| {
        let view = View {
            camera,
            size,
            lamps,
            casters: None,
            up: Up::Z,
            ground: None,
            paint: &|_| CLAY,
            edge_samples: 1,
            ambient: None,
        };
        render_visibility(&samples, &caster, &view, |lamp| Ok(visible[of[lamp]].clone())).unwrap()
    };
    let both = picture(&shaded, &[0, 1]);
    let (one, other, none) = (picture(&shaded[..1], &[0]), picture(&shaded[1..], &[1]), picture(&[], &[]));
    assert_eq!(differ(&both, &one, &other, &none), 0);
    assert!(differ(&picture(&shaded, &[0, 0]), &one, &other, &none) > 100);
}
