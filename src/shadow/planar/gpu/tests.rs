//! The device's planar shadows, pixel by pixel against the exact verdict.

use wgpu::{CompareFunction, StencilOperation};

use super::*;
use crate::caster::CasterGroup;
use crate::gpu::tests::gpu;
use crate::scene::Lamp;
use crate::shadow::Depth;
use crate::testing::shapes;
use crate::view::{Camera, Projection, Size, Up};

const SIZE: [u32; 2] = [96, 72];

/// How the pixels compare.
#[derive(Debug, Default, PartialEq)]
struct Tally {
    lit: usize,
    dark: usize,
    /// Within the footprint: the exact value changes there.
    excused: usize,
    wrong: usize,
    /// Pixels that are not of the plane, and are not 0.
    outside: usize,
    /// Values that are neither 0 nor 1.
    between: usize,
}

struct Scene {
    seen: Caster,
    projection: Projection,
    size: Size,
}

impl Scene {
    fn new(meshes: &[Mesh], eye: [f32; 3]) -> Self {
        let size = Size::new(SIZE[0], SIZE[1]).unwrap();
        let camera = Camera::look_at(eye, [0.1, 0.2, 0.0], 0.9, Up::Z).unwrap();
        Self {
            seen: Caster::new(Mesh::concat(meshes).unwrap()),
            projection: camera.projection(size, 0.125),
            size,
        }
    }

    fn tally(&self, gpu: &Gpu, rules: Rules, plane: &Plane, marks_all: bool, lamp: &str) -> Tally {
        let light = *lamp.parse::<Lamp>().unwrap().light();
        let casters = CasterGroup::new(vec![&self.seen]);
        let on_device = GpuCaster::upload(gpu, &self.seen).unwrap();
        let samples = on_device.samples(&self.projection, self.size, Depth::Plane).unwrap();
        let mut ground = GpuGround::new(gpu, *plane, &self.seen, &self.seen, &on_device).unwrap();
        if marks_all {
            let words = vec![u32::MAX; self.seen.mesh().face_count().div_ceil(32)];
            ground.seen_bits = gpu.upload("faces of a plane", &words).unwrap();
        }
        let pass = PlanarPass::with(gpu, rules).unwrap();
        let values = pass.visibility(&samples, &ground, &light).unwrap().download(gpu).unwrap();
        let footprint = Footprint::new(&casters, *plane, light, &self.projection, self.size);
        let mut tally = Tally::default();
        for (index, &value) in values.iter().enumerate() {
            let [x, y] = [index % SIZE[0] as usize, index / SIZE[0] as usize].map(|k| k as f64 + 0.5);
            let here = footprint.exact(x, y);
            tally.between += usize::from(value != 0.0 && value != 1.0);
            if here == Some(value == 1.0) {
                *if value == 1.0 { &mut tally.lit } else { &mut tally.dark } += 1;
                continue;
            }
            if here.is_none() && value == 0.0 {
                continue;
            }
            if footprint.changes(x, y) {
                tally.excused += 1;
            } else if here.is_none() {
                // A sample that is turned from the light is up to the technique.
                tally.outside += 1;
            } else {
                tally.wrong += 1;
            }
        }
        tally
    }
}

fn floor(quads: u32) -> Mesh {
    shapes::translated(&shapes::scaled(&shapes::sheet(quads), 12.0 / quads as f32), [-6.0, -6.0, 0.0])
}

fn ground() -> Plane {
    Plane::new([0.0, 0.0, 1.0, 0.0]).unwrap()
}

const EYE: [f32; 3] = [2.0, -8.0, 7.0];

#[test]
fn planar_on_a_device_is_the_exact_verdict_at_every_pixel_outside_the_footprint() {
    let Some(gpu) = gpu() else { return };
    let sphere = shapes::translated(&shapes::icosphere(2), [-2.5, 1.0, 0.3]);
    let knot =
        shapes::translated(&shapes::scaled(&shapes::torus_knot(2, 3, 40, 6, 0.4), 0.5), [1.0, 0.5, 1.5]);
    let scenes = [
        Scene::new(&[floor(1), sphere.clone(), knot.clone()], EYE),
        Scene::new(&[floor(4), shapes::menger_sponge(1), sphere], [1.0, 0.5, 0.25]),
        Scene::new(&[floor(2), knot, shapes::translated(&shapes::cube(), [-2.0, -2.0, 1.0])], EYE),
    ];
    let lamps = ["point:1,-2,6", "point:0.4,0.3,1.7", "spot:-4,1,5:1,0,-1:60", "directional:0.3,-0.5,-1"];
    let mut dark = 0;
    for (index, scene) in scenes.iter().enumerate() {
        for lamp in lamps {
            for clips_by_device in [true, false] {
                let rules = Rules { clips_by_device, ..Rules::RIGHT };
                let tally = scene.tally(&gpu, rules, &ground(), false, lamp);
                let named = format!("{index} {lamp} {clips_by_device} {tally:?}");
                assert_eq!((tally.wrong, tally.outside, tally.between), (0, 0, 0), "{named}");
                assert!(tally.excused * 20 < tally.lit + tally.dark + 200, "{named}");
                dark += tally.dark;
            }
        }
    }
    assert!(dark > 5000, "{dark}");
}

/// Two plates, one above the other: a pixel under both has the value of a pixel under one.
#[test]
fn planar_on_a_device_counts_overlapping_casters_once() {
    let Some(gpu) = gpu() else { return };
    let plate = |z: f32| shapes::translated(&shapes::scaled(&shapes::sheet(2), 1.0), [-1.0, -1.0, z]);
    let scene = Scene::new(&[floor(1), plate(1.0), plate(1.5)], EYE);
    let lamp = "directional:0.25,0.3,-1";
    let right = scene.tally(&gpu, Rules::RIGHT, &ground(), false, lamp);
    assert!(right.wrong == 0 && right.dark > 50, "{right:?}");
    // Fault injected: the mark stays, so that nothing is dark.
    let keep = Rules { operation: StencilOperation::Keep, ..Rules::RIGHT };
    assert!(scene.tally(&gpu, keep, &ground(), false, lamp).wrong > 50);
    // Fault injected: a mark that every fragment turns over is dark under one plate and lit under two.
    let invert =
        Rules { operation: StencilOperation::Invert, compare: CompareFunction::Always, ..Rules::RIGHT };
    assert!(scene.tally(&gpu, invert, &ground(), false, lamp).wrong > 20);
}

/// A small receiver, half hidden by a box that stands before it.
#[test]
fn planar_on_a_device_draws_on_visible_samples_of_the_plane_alone() {
    let Some(gpu) = gpu() else { return };
    let small = shapes::translated(&shapes::scaled(&shapes::sheet(1), 3.0), [-1.5, -1.5, 0.0]);
    let plate = shapes::translated(&shapes::scaled(&shapes::sheet(1), 8.0), [-4.0, -4.0, 9.0]);
    let hides = shapes::cuboid([-0.5, -2.0, 0.125], [1.0, -1.0, 1.5]);
    let scene = Scene::new(&[small, plate, hides], EYE);
    let lamp = "point:0.5,-1,20";
    let right = scene.tally(&gpu, Rules::RIGHT, &ground(), false, lamp);
    assert_eq!((right.wrong, right.outside), (0, 0), "{right:?}");
    assert!(right.dark > 20, "{right:?}");
    // Fault injected: samples in front of the plane are marked too.
    let box_marked =
        scene.tally(&gpu, Rules::RIGHT, &Plane::new([0.0, 0.0, 1.0, 0.0]).unwrap(), true, "point:9,-9,2");
    assert!(box_marked.outside > 50, "{box_marked:?}");
    // Fault injected: drawn wherever the flattened casters are, a zero becomes the mark.
    let always = Rules { compare: CompareFunction::Always, ..Rules::RIGHT };
    assert!(scene.tally(&gpu, always, &ground(), false, lamp).outside > 20);
}

#[test]
fn planar_on_a_device_with_the_light_in_the_plane_draws_nothing() {
    let Some(gpu) = gpu() else { return };
    let scene = Scene::new(&[floor(1), shapes::cube()], EYE);
    let tally = scene.tally(&gpu, Rules::RIGHT, &ground(), false, "point:3,1,0");
    assert_eq!((tally.lit, tally.dark, tally.wrong), (0, 0, 0), "no sample is asked");
}
