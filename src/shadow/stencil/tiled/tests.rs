//! Counts of every state and of the choice in tiles, against exact winding numbers.

use super::fault::{Fault, Faults};
use super::state::{DepthTest, State};
use super::*;
use crate::caster::Caster;
use crate::geom::Aabb;
use crate::mesh::Mesh;
use crate::scene::Lamp;
use crate::shadow::volume::WindingIndex;
use crate::shadow::{Request, Technique};
use crate::testing::shapes;
use crate::view::{Camera, Projection, Size, Up};

/// Solids on a floor, an open mesh, one that cannot be oriented, nested shells.
fn scenes() -> [Vec<Mesh>; 4] {
    let floor = |y: f32| shapes::cuboid([-9.0, y - 1.0, -9.0], [9.0, y, 9.0]);
    let apart = |mesh: Mesh, x: f32| shapes::translated(&mesh, [x, 0.0, 0.0]);
    let both = Mesh::concat(&[apart(shapes::cube(), -1.5), apart(shapes::icosphere(1), 1.5)]).unwrap();
    [
        vec![both, floor(-1.5)],
        vec![shapes::cube()],
        vec![shapes::mobius(16), shapes::translated(&shapes::sheet(2), [0.3, 1.5, 0.2]), floor(-2.0)],
        vec![shapes::nested_cubes(2)],
    ]
}

/// Views from afar and from within, along an axis, where rays run exactly through edges, and without
/// perspective.
fn views(size: Size) -> [Projection; 5] {
    let look = |eye, target| Camera::look_at(eye, target, 1.2, Up::Y).unwrap();
    let camera = look([4.0, 3.0, 7.0], [0.0; 3]);
    let axis = |eye, forward| {
        let (right, up) = ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0]);
        Projection { eye, right, up, forward, near: 0.125, kind: Default::default() }
    };
    [
        camera.projection(size, 0.1),
        look([0.3, -0.4, 0.2], [1.0, 0.1, 0.4]).projection(size, 0.01),
        axis([0.0, 0.0, 4.0], [0.0, 0.0, -1.0]),
        axis([0.5, 0.5, 3.0], [0.0, 0.0, -1.0]),
        camera.orthographic(8.0).unwrap().projection(size, 0.1),
    ]
}

const LAMPS: [&str; 3] = ["point:3,9,5", "directional:0.3,-1,0.2", "point:0.25,0.5,4"];

/// Calls `visit` for every scene, view and lamp.
fn for_each(mut visit: impl FnMut(&CasterGroup<'_>, &Samples, &Light)) {
    let size = Size::new(25, 25).unwrap();
    for scene in scenes() {
        let all: Vec<Caster> = scene.into_iter().map(Caster::new).collect();
        let casters = CasterGroup::new(all.iter().collect());
        for projection in views(size) {
            let samples = Samples::of_view(&casters, &projection, size, 1).unwrap();
            for lamp in LAMPS {
                let lamp: Lamp = lamp.parse().unwrap();
                visit(&casters, &samples, lamp.light());
            }
        }
    }
}

fn counter(tile: u32, state: Option<State>) -> Counter {
    let counter = Counter::of(CounterOptions { tile });
    state.map_or(counter, |state| counter.with_state(state))
}

/// The winding numbers at the samples that are asked.
fn expected(counting: &TiledCounting<'_>, samples: &Samples, asked: &[bool]) -> Vec<Option<i32>> {
    let within = Aabb::around(samples.hits().iter().flatten().map(|hit| hit.point));
    let indices: Vec<WindingIndex<'_>> =
        counting.volumes.iter().map(|volume| WindingIndex::build(volume.volume(), within)).collect();
    let count = |p: [f32; 3]| indices.iter().map(|index| index.number(p)).sum::<Option<i32>>();
    let hits = samples.hits().iter().zip(asked);
    hits.map(|(hit, asked)| hit.as_ref().filter(|_| *asked).map_or(Some(0), |hit| count(hit.point))).collect()
}

/// How many counts of a state differ from winding numbers, how many are unknown, and how many are not 0.
fn differing(states: &[Option<State>], tile: u32, fault: Option<Fault>) -> [usize; 3] {
    let mut found = [0; 3];
    for_each(|casters, samples, light| {
        let asked = asked(samples, light);
        let mut expected_counts = None;
        for &state in states {
            // From infinity nothing is counted.
            let from_eye = state.is_some_and(State::is_from_eye);
            if from_eye && samples.projection().is_orthographic() {
                continue;
            }
            let mut counter = counter(tile, state);
            counter.faults = Faults(fault);
            let counting = TiledCounting::with(casters, light, counter);
            let expected = expected_counts.get_or_insert_with(|| expected(&counting, samples, &asked));
            let (counts, _) = counting.counter.counts(samples, &asked, &counting.volumes);
            for (count, expected) in counts.iter().zip(expected) {
                match (count, *expected) {
                    (Some(count), Some(expected)) => {
                        found[0] += usize::from(*count != expected);
                        found[2] += usize::from(expected != 0);
                    }
                    _ => found[1] += 1,
                }
            }
        }
    });
    found
}

const STATES: [Option<State>; 4] = [None, Some(State::ZFAIL), Some(State::ZPASS), Some(State::REVERSED)];

#[test]
fn tiled_counts_are_winding_numbers_in_every_state() {
    let [wrong, unknown, dark] = differing(&STATES, 8, None);
    assert!(wrong == 0 && unknown < 40 && dark > 10_000, "{wrong} {unknown} {dark}");
    // Tiles of one sample, and one tile for all.
    for tile in [1, 64] {
        assert_eq!(differing(&STATES[..1], tile, None)[0], 0, "{tile}");
    }
}

#[test]
fn tiled_counts_with_faults_are_not() {
    for fault in [
        Fault::TieMisses,
        Fault::StartsAtZero,
        Fault::FirstDepth,
        Fault::CrossedIsUniform,
        Fault::WrongSideDropped,
    ] {
        let [wrong, ..] = differing(&STATES[..1], 8, Some(fault));
        let [wrong_fail, ..] = differing(&STATES[1..2], 8, Some(fault));
        assert!(wrong + wrong_fail > 10, "{fault:?}: {wrong} {wrong_fail}");
    }
}

/// Byte for byte; without equality in the test the caps of visible faces are lost.
#[test]
fn zpass_reversed_equals_zfail_and_its_strict_test_does_not() {
    let strict = State { test: DepthTest::Less, ..State::REVERSED };
    let (mut equal, mut different) = (0, 0);
    for_each(|casters, samples, light| {
        let lamp: Lamp = (*light).into();
        let request = Request { casters, lamp: &lamp, samples };
        let zfail = Technique::ZFail.shade(&request).unwrap();
        let reversed = Technique::ZPassReversed.shade(&request).unwrap();
        assert_eq!(zfail.values(), reversed.values(), "{light}");
        equal += zfail.values().len();
        let strict = TiledCounting::with(casters, light, counter(8, Some(strict))).shade(samples);
        different += strict.values().iter().zip(zfail.values()).filter(|(a, b)| a != b).count();
    });
    assert!(equal > 10_000 && different > 2000, "{equal} {different}");
}

/// What the choice in tiles saves, as numbers that every machine repeats.
#[test]
fn counter_updates_fewer_counts_than_either_method_alone() {
    let mut updates = [0; 3];
    let size = Size::new(64, 48).unwrap();
    let solids = (0..9_u8).map(|k| {
        let [x, z] = [k % 3, k / 3].map(|i| 4.0 * f32::from(i) - 4.0);
        shapes::translated(&shapes::icosphere(1), [x, 0.0, z])
    });
    let floor = shapes::cuboid([-12.0, -2.0, -12.0], [12.0, -1.0, 12.0]);
    let caster = Caster::new(Mesh::concat(&solids.chain([floor]).collect::<Vec<_>>()).unwrap());
    let casters = CasterGroup::new(vec![&caster]);
    let camera = Camera::look_at([7.0, 5.0, 12.0], [0.0, -1.0, 0.0], 0.9, Up::Y).unwrap();
    let samples = Samples::of_view(&casters, &camera.projection(size, 0.1), size, 1).unwrap();
    for lamp in ["point:3,9,-5", "directional:0.8,-1,0.3"] {
        let lamp: Lamp = lamp.parse().unwrap();
        let states = [None, Some(State::ZFAIL), Some(State::ZPASS)];
        for (sum, state) in updates.iter_mut().zip(states) {
            let shadow = TiledCounting::with(&casters, lamp.light(), counter(8, state)).shade(&samples);
            let found = shadow.updates().unwrap();
            assert!(found.updates <= found.fragments);
            *sum += found.updates;
        }
    }
    assert!(updates[0] * 8 < updates[1] && updates[0] < updates[2], "{updates:?}");
}
