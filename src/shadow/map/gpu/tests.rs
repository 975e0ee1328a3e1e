use super::*;
use crate::caster::{Caster, CasterGroup};
use crate::gpu::tests::gpu;
use crate::mesh::Mesh;
use crate::scene::Lamp;
use crate::shadow::map::{DepthSource, Fit, MapOptions, MapShadow, ShadowMap, Texel};
use crate::shadow::{Depth, Samples};
use crate::testing::shapes;
use crate::view::{Camera, Size, Up};

/// A torus and a cube over a floor.
fn scene() -> Caster {
    let floor = shapes::translated(&shapes::scaled(&shapes::sheet(1), 16.0), [-8.0, -8.0, -3.0]);
    let cube = shapes::translated(&shapes::cube(), [2.5, -1.0, 1.0]);
    Caster::new(Mesh::concat(&[floor, cube, shapes::torus(24, 12, 2.0, 0.7)]).unwrap())
}

/// One light of each kind: parallel, one layer, six layers.
const LAMPS: [&str; 3] = ["directional:0.4,0.2,-1", "spot:3,4,9:-0.3,-0.4,-0.9:35", "point:0.5,0.25,3"];

const SIZE: u32 = 128;

#[test]
fn map_on_a_device_has_the_depths_of_the_reference() {
    let Some(gpu) = gpu() else { return };
    let caster = scene();
    let casters = CasterGroup::new(vec![&caster]);
    let on_device = GpuCaster::upload(&gpu, &caster).unwrap();
    let pass = MapPass::new(&gpu).unwrap();
    for lamp in LAMPS {
        let lamp: Lamp = lamp.parse().unwrap();
        let space = LightSpace::of_scene(&casters, &lamp, SIZE).unwrap();
        let offset = crate::shadow::map::PolygonOffset::default();
        let map: ShadowMap<f32> =
            ShadowMap::draw(&casters, lamp.light(), space, DepthSource::Plane, offset).unwrap();
        let drawn = pass.draw(&on_device, &space).unwrap();
        let (mut texels, mut far) = (0, 0);
        for layer in 0..space.layers() {
            let depths = drawn.download(&gpu, layer).unwrap();
            for (index, &depth) in depths.iter().enumerate() {
                let [i, j] = [index % SIZE as usize, index / SIZE as usize];
                let reference = map.texel(layer, i as i64, j as i64).map_or(0.0, |texel| texel.depth());
                texels += 1;
                // Another face at an edge, or a rounding: the planes are steep, too.
                far += u32::from((f64::from(depth) - f64::from(reference)).abs() > 1e-4);
            }
        }
        assert!(f64::from(far) < 0.005 * f64::from(texels), "{lamp}: {far} of {texels}");
        // Fault injected: the same map with its rows upside down.
        let depths = drawn.download(&gpu, 0).unwrap();
        let turned = (0..depths.len()).filter(|&index| {
            let [i, j] = [index % SIZE as usize, SIZE as usize - 1 - index / SIZE as usize];
            let reference = map.texel(0, i as i64, j as i64).map_or(0.0, |texel| texel.depth());
            (depths[index] - reference).abs() > 1e-4
        });
        assert!(turned.count() > depths.len() / 20, "{lamp}");
    }
}

#[test]
fn map_on_a_device_shades_as_that_of_the_cpu() {
    let Some(gpu) = gpu() else { return };
    let caster = scene();
    let casters = CasterGroup::new(vec![&caster]);
    let size = Size::new(160, 120).unwrap();
    let camera = Camera::look_at([7.0, -9.0, 8.0], [0.0, 0.0, -1.0], 0.9, Up::Z).unwrap();
    let projection = camera.projection(size, 0.125);
    let samples = Samples::of_view(&casters, &projection, size, 1).unwrap();
    let on_device = GpuCaster::upload(&gpu, &caster).unwrap();
    let drawn = on_device.samples(&projection, size, Depth::Plane).unwrap();
    let pass = MapPass::new(&gpu).unwrap();
    for lamp in LAMPS {
        let lamp: Lamp = lamp.parse().unwrap();
        let space = LightSpace::of_scene(&casters, &lamp, SIZE).unwrap();
        let map = pass.draw(&on_device, &space).unwrap();
        for bias in [Bias::Receiver, Bias::Texel, Bias::Constant, Bias::Range, Bias::Normal] {
            for filter in [Filter::Nearest, Filter::Bilinear, Filter::Box3, Filter::Tent5] {
                let options = MapOptions {
                    size: SIZE,
                    fit: Fit::Scene,
                    cascades: 1,
                    bias,
                    depth: DepthSource::Plane,
                    filter,
                };
                let cpu = MapShadow::prepare(&casters, &lamp, &options).unwrap().shade(&samples);
                let values =
                    pass.visibility(&drawn, &map, Lookup { filter, bias }).unwrap().download(&gpu).unwrap();
                let pairs = cpu.values().iter().zip(&values).zip(cpu.asked()).filter(|(_, asked)| **asked);
                let differences: Vec<f32> = pairs.map(|((cpu, device), _)| (cpu - device).abs()).collect();
                // A half has 11 bits; a texel whose coverage or comparison turns at an edge weighs more.
                let off = differences.iter().filter(|&&difference| difference > 1.0 / 1024.0).count();
                let text = format!("{lamp} {bias} {filter}: {off} of {}", differences.len());
                assert!(differences.len() > 2000 && off * 100 < differences.len(), "{text}");
                let shadowed =
                    values.iter().zip(cpu.asked()).filter(|&(value, &asked)| asked && *value < 0.5);
                assert!(shadowed.count() > 100, "{text}");
            }
        }
    }
}

#[test]
fn map_on_a_device_refuses_what_it_has_no_form_of() {
    let Some(gpu) = gpu() else { return };
    let caster = scene();
    let casters = CasterGroup::new(vec![&caster]);
    let size = Size::new(16, 12).unwrap();
    let projection = Camera::fit(&casters.bounds(), Up::Z, size.aspect()).projection(size, 0.125);
    let on_device = GpuCaster::upload(&gpu, &caster).unwrap();
    let drawn = on_device.samples(&projection, size, Depth::Plane).unwrap();
    let pass = MapPass::new(&gpu).unwrap();
    let lamp: Lamp = LAMPS[0].parse().unwrap();
    let map = pass.draw(&on_device, &LightSpace::of_scene(&casters, &lamp, 16).unwrap()).unwrap();
    for lookup in [
        Lookup { filter: Filter::Poisson16, bias: Bias::Receiver },
        Lookup { filter: Filter::Nearest, bias: Bias::Offset },
        Lookup { filter: Filter::Nearest, bias: Bias::Second },
    ] {
        let error = pass.visibility(&drawn, &map, lookup).unwrap_err();
        assert!(matches!(error, GpuError::NotBuilt(_)), "{error}");
    }
    let limit = gpu.limits().max_texture_dimension_2d;
    if let Ok(space) = LightSpace::of_scene(&casters, &lamp, limit + 1) {
        assert!(matches!(pass.draw(&on_device, &space), Err(GpuError::Picture { .. })));
    }
}

/// Samples under a lamp whose value on the device is not that of the CPU form, and all that face the lamp.
fn off(gpu: &Gpu, pass: &MapPass, lamp: &str, lookup: Lookup) -> [usize; 2] {
    off_with(gpu, pass, lamp, lookup, DepthSource::Plane)
}

/// The same of a map with depths from elsewhere.
fn off_with(gpu: &Gpu, pass: &MapPass, lamp: &str, lookup: Lookup, depth: DepthSource) -> [usize; 2] {
    let caster = scene();
    let casters = CasterGroup::new(vec![&caster]);
    let size = Size::new(129, 96).unwrap();
    let projection = Camera::fit(&casters.bounds(), Up::Z, size.aspect()).projection(size, 0.125);
    let samples = Samples::of_view(&casters, &projection, size, 1).unwrap();
    let lamp: Lamp = lamp.parse().unwrap();
    let Lookup { filter, bias } = lookup;
    let options = MapOptions { size: SIZE, fit: Fit::Scene, cascades: 1, bias, depth, filter };
    let cpu = MapShadow::prepare(&casters, &lamp, &options).unwrap().shade(&samples);
    let on_device = GpuCaster::upload(gpu, &caster).unwrap();
    let drawn = on_device.samples(&projection, size, Depth::Plane).unwrap();
    let space = LightSpace::of_scene(&casters, &lamp, SIZE).unwrap();
    let map = match depth {
        DepthSource::Plane => pass.draw(&on_device, &space),
        DepthSource::Interpolated => pass.draw_interpolated(&on_device, &space, lookup),
    };
    let map = map.unwrap();
    let values = pass.visibility(&drawn, &map, lookup).unwrap().download(gpu).unwrap();
    let pairs = cpu.values().iter().zip(&values).zip(cpu.asked()).filter(|(_, asked)| **asked);
    let differ = pairs.clone().filter(|((cpu, device), _)| (*cpu - *device).abs() > 1.0 / 1024.0);
    [differ.count(), pairs.count()]
}

/// The bias of a depth range is a part of the depth for central lights alone.
#[test]
fn map_on_a_device_with_a_fault_in_its_range_is_found() {
    let Some(gpu) = gpu() else { return };
    let lookup = Lookup { filter: Filter::Tent5, bias: Bias::Range };
    let faulty = MapPass::with_fault(&gpu, "*= 1.0 + light.bias", "*= 1.0 - light.bias");
    let [wrong, all] = off(&gpu, &faulty, LAMPS[2], lookup);
    assert!(wrong * 100 > all, "{wrong} of {all}");
    let [wrong, all] = off(&gpu, &MapPass::new(&gpu).unwrap(), LAMPS[2], lookup);
    assert!(wrong * 100 < all, "{wrong} of {all}");
}

/// Faults injected into the shader exceed the limit of one in a hundred, and without them it is kept.
#[test]
fn map_on_a_device_with_a_fault_is_found() {
    let Some(gpu) = gpu() else { return };
    let right = MapPass::new(&gpu).unwrap();
    let faults = [
        // The bias has the other sign.
        ("+ slack * slope", "- slack * slope", Bias::Texel),
        ("receiver.depth += light.reach * slope", "receiver.depth -= light.reach * slope", Bias::Receiver),
        // The lookup is off by half a texel.
        ("to_texels(at.xy / at.w)", "to_texels(at.xy / at.w) + 0.5", Bias::Texel),
        // Rows run upwards.
        ("vec2f(1.0 + at.x, 1.0 - at.y)", "vec2f(1.0 + at.x, 1.0 + at.y)", Bias::Receiver),
        // What lies behind the receiver blocks.
        (", receiver.layer, 0) > least", ", receiver.layer, 0) < least", Bias::Texel),
        // Biases with the other sign, or none.
        ("receiver.depth += light.bias", "receiver.depth -= light.bias", Bias::Constant),
        ("return q + offset * up;", "return q - offset * up;", Bias::Normal),
        ("depth = at.z / at.w;", "depth -= light.rounding;", Bias::Normal),
    ];
    for (text, fault, bias) in faults {
        let lookup = Lookup { filter: Filter::Tent5, bias };
        let faulty = MapPass::with_fault(&gpu, text, fault);
        for lamp in [LAMPS[0], LAMPS[2]] {
            let [wrong, all] = off(&gpu, &faulty, lamp, lookup);
            assert!(wrong * 100 > all, "{fault} {lamp}: {wrong} of {all}");
        }
        let [wrong, all] = off(&gpu, &right, LAMPS[1], lookup);
        assert!(wrong * 100 < all, "{bias}: {wrong} of {all}");
    }
}

/// A device interpolates depths and moves them by a polygon offset as the CPU form does. Faults injected: a
/// lower receiver, and casters nearer to the light.
#[test]
fn map_on_a_device_has_a_polygon_offset() {
    let Some(gpu) = gpu() else { return };
    let pass = MapPass::new(&gpu).unwrap();
    for (lamp, filter) in LAMPS.into_iter().zip([Filter::Bilinear, Filter::Box3, Filter::Nearest]) {
        for bias in [Bias::Offset, Bias::Receiver] {
            let [wrong, all] =
                off_with(&gpu, &pass, lamp, Lookup { filter, bias }, DepthSource::Interpolated);
            assert!(wrong * 100 < all, "{lamp} {bias} {filter}: {wrong} of {all}");
        }
    }
    let lookup = Lookup { filter: Filter::Box3, bias: Bias::Offset };
    for (text, fault) in [
        ("receiver.depth += light.bias", "receiver.depth -= 0.01"),
        ("from_light(triangles[index])).z;", "from_light(triangles[index])).z + 0.02;"),
    ] {
        let faulty = MapPass::with_fault(&gpu, text, fault);
        let [wrong, all] = off_with(&gpu, &faulty, LAMPS[0], lookup, DepthSource::Interpolated);
        assert!(wrong * 100 > all, "{fault}: {wrong} of {all}");
    }
}
