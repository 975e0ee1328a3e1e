//! Every test alone, and all together, against the exact ray cast: on scenes of six families, under lamps of
//! all kinds, in several views. Each fault that is injected is caught.

mod families;
#[cfg(feature = "gpu")]
mod masks;
mod truth;

use super::fault::{Fault, Faults};
use super::question::relevant_over;
use super::*;
use crate::caster::{Caster, CasterGroup};
use crate::mesh::Mesh;
use crate::scene::Lamp;
use crate::shadow::Samples;
use crate::testing::scenes::{Place, city};
use crate::testing::shapes;
use crate::view::{Camera, Size, Up};
use families::{Family, families};
use truth::{Figures, Truth};

/// The sets of tests: none, each alone, all together, and all but the strongest.
fn sets() -> Vec<TestSet> {
    let mut sets: Vec<TestSet> = RelevanceTest::ALL.map(TestSet::only).to_vec();
    let without_grid = TestSet::ALL.without(RelevanceTest::NothingBehind).without(RelevanceTest::Known);
    sets.extend([TestSet::NONE, TestSet::ALL, TestSet::ALL.without(RelevanceTest::Known), without_grid]);
    sets
}

/// What became of all questions about some families.
#[derive(Debug, Default)]
struct Tally {
    violations: usize,
    samples: usize,
    /// Pieces dropped by each test.
    pieces: [usize; RelevanceTest::ALL.len()],
    /// Lamps dropped by each test.
    lamps: [usize; RelevanceTest::ALL.len()],
}

/// Asks every question about a family under the given sets of tests.
fn ask_family(family: &Family, sets: &[TestSet], faults: Faults, is_stale: bool, tally: &mut Tally) {
    let casters: Vec<Caster> = family.casters.iter().cloned().map(Caster::new).collect();
    let group = CasterGroup::new(casters.iter().collect());
    let pieces = Pieces::of(&group);
    let samples: Vec<Samples> = family
        .projections()
        .iter()
        .map(|(projection, size)| Samples::of_view(&group, projection, *size, 1).unwrap())
        .collect();
    for (view, here) in samples.iter().enumerate() {
        let tiled = if is_stale { &samples[(view + 1) % samples.len()] } else { here };
        for (number, lamp) in family.lamps.iter().enumerate() {
            for physical_falloff in [false, true] {
                let mut question = Question {
                    casters: &group,
                    pieces: &pieces,
                    lamp,
                    number,
                    samples: here,
                    physical_falloff,
                    level: 0.0,
                    tests: TestSet::NONE,
                };
                let truth = Truth::of(&question);
                tally.samples += truth.len();
                for &tests in sets {
                    question.tests = tests;
                    let found = relevant_over(&question, tiled, faults);
                    let wrong = truth.violations(&pieces, &found);
                    let is_sound = faults.0.is_none() && !is_stale;
                    assert!(
                        wrong == 0 || !is_sound,
                        "{wrong} of {} samples of {}, view {view}, {lamp}, {tests:?}: {found:?}",
                        truth.len(),
                        family.name,
                    );
                    tally.violations += wrong;
                    for dropped in &found.dropped {
                        assert!(tests.has(dropped.test) && dropped.lamp == number);
                        match dropped.what {
                            Triple::Piece(_) => tally.pieces[dropped.test as usize] += 1,
                            Triple::Lamp => tally.lamps[dropped.test as usize] += 1,
                            Triple::Samples(_) => {}
                        }
                    }
                }
            }
        }
    }
}

fn ask(seeds: std::ops::Range<u64>, sets: &[TestSet]) -> Tally {
    let mut tally = Tally::default();
    for family in seeds.flat_map(families) {
        ask_family(&family, sets, Faults::default(), false, &mut tally);
    }
    tally
}

#[test]
fn nothing_that_matters_is_dropped_by_any_test() {
    let tally = ask(1..2, &sets());
    eprintln!("{tally:?}");
    for test in RelevanceTest::ALL {
        let expects_piece = matches!(test.equality(), Equality::Count | Equality::Verdict);
        if expects_piece && test != RelevanceTest::Known {
            assert!(tally.pieces[test as usize] > 0, "{} drops nothing", test.name());
        }
    }
    for test in
        [RelevanceTest::NoReceiver, RelevanceTest::Enclosed, RelevanceTest::Unblocked, RelevanceTest::Known]
    {
        assert!(tally.lamps[test as usize] > 0, "{} drops no lamp", test.name());
    }
}

#[test]
#[ignore = "a minute; cargo test --lib relevance::tests::many -- --ignored"]
fn many_scenes_lose_nothing_that_matters() {
    ask(2..40, &sets());
}

/// Violations on all families with a fault, under the tests that it concerns.
fn violations(fault: Option<Fault>, is_stale: bool, tests: &[RelevanceTest]) -> usize {
    let sets: Vec<TestSet> = tests.iter().map(|&test| TestSet::only(test)).collect();
    let mut tally = Tally::default();
    for family in families(1) {
        ask_family(&family, &sets, Faults(fault), is_stale, &mut tally);
    }
    tally.violations
}

#[test]
fn faults_are_caught() {
    use RelevanceTest::{OutOfReach, Parted, Shadowed, Tiles};
    for (fault, tests) in [
        (Fault::BoxInView, &[Parted][..]),
        (Fault::NoExtruded, &[Tiles]),
        (Fault::NotStrict, &[Shadowed]),
        (Fault::RangeAlways, &[OutOfReach]),
    ] {
        let wrong = violations(Some(fault), false, tests);
        assert!(wrong > 0, "{fault:?} is not caught");
    }
    assert!(violations(None, true, &[Tiles]) > 0, "stale tiles are not caught");
}

/// Kept, needed and decisive pieces of a city, under one lamp.
fn in_city(casters: usize, place: Place, lamp: usize, tests: TestSet, size: [u32; 2]) -> Figures {
    let city = city(7, casters);
    let caster = Caster::new(city.scene());
    let group = CasterGroup::new(vec![&caster]);
    let size = Size::new(size[0], size[1]).unwrap();
    let camera = city.camera(place);
    let projection = camera.projection(size, camera.near([caster.mesh()], size));
    let samples = Samples::of_view(&group, &projection, size, 1).unwrap();
    let pieces = Pieces::of(&group);
    let question = Question {
        casters: &group,
        pieces: &pieces,
        lamp: &city.lamps()[lamp],
        number: 0,
        samples: &samples,
        physical_falloff: true,
        level: 0.0,
        tests,
    };
    let (truth, found) = (Truth::of(&question), relevant(&question));
    assert_eq!(truth.violations(&pieces, &found), 0);
    truth.figures(&pieces, &found)
}

/// A test that keeps everything loses nothing: here is what has to be dropped.
#[test]
fn city_keeps_few_casters_in_a_street() {
    for lamp in 0..3 {
        let Figures { kept, needed, decisive } = in_city(200, Place::Street, lamp, TestSet::ALL, [120, 68]);
        eprintln!("lamp {lamp}: kept {kept}, needed {needed}, decisive {decisive}");
        assert!(2 * kept <= 5 * needed && kept >= decisive, "lamp {lamp}: {kept} kept, {needed} needed");
    }
}

#[test]
#[ignore = "figures; cargo test --lib relevance::tests::figures -- --ignored --nocapture"]
fn figures_of_a_city() {
    use RelevanceTest::{OutOfReach, Parted, Tiles};
    let boxes = TestSet::only(Parted).with(OutOfReach);
    let sets = [("view", boxes), ("tiles", boxes.with(Tiles)), ("all", TestSet::ALL)];
    for lamp in 0..3 {
        for place in Place::ALL {
            for (name, tests) in sets {
                let figures = in_city(565, place, lamp, tests, [240, 135]);
                eprintln!("lamp {lamp}, {}, {name}: {figures:?}", place.name());
            }
        }
    }
}

fn one_question(meshes: &[Mesh], lamp: &Lamp, eye: [f32; 3], level: f64, physical: bool) -> Relevance {
    let casters: Vec<Caster> = meshes.iter().cloned().map(Caster::new).collect();
    let group = CasterGroup::new(casters.iter().collect());
    let size = Size::new(32, 24).unwrap();
    let camera = Camera::look_at(eye, [0.0; 3], 0.9, Up::Y).unwrap();
    let samples = Samples::of_view(&group, &camera.projection(size, 0.1), size, 1).unwrap();
    relevant(&Question {
        casters: &group,
        pieces: &Pieces::of(&group),
        lamp,
        number: 3,
        samples: &samples,
        physical_falloff: physical,
        level,
        tests: TestSet::ALL,
    })
}

#[test]
fn lamp_without_light_is_dropped_and_so_is_a_faint_one() {
    let meshes = [shapes::cube(), shapes::cuboid([-4.0, -1.5, -4.0], [4.0, -1.2, 4.0])];
    let base: Lamp = "point:2,9,3".parse().unwrap();
    let eye = [5.0, 6.0, 7.0];
    let outcome = |lamp: &Lamp, level: f64, physical: bool| {
        let found = one_question(&meshes, lamp, eye, level, physical);
        (found.outcome, found.dropped.first().map(|dropped| dropped.test))
    };
    for zero in [
        Lamp { intensity: 0.0, ..base.clone() },
        Lamp { color: [0.0; 3], ..base.clone() },
        Lamp { color: [-1.0, f32::NAN, 0.0], ..base.clone() },
    ] {
        assert_eq!(outcome(&zero, 0.0, false), (Outcome::Dark, Some(RelevanceTest::Zero)));
    }
    assert_eq!(outcome(&base, 1.0, false).0, Outcome::Shadows);
    // 255 · 12.92 · 1.12 steps for a lamp of intensity 1.
    let faint = Lamp { intensity: 1.0 / 4000.0, ..base.clone() };
    assert_eq!(outcome(&faint, 0.9, false).0, Outcome::Shadows);
    let found = one_question(&meshes, &faint, eye, 1.0, false);
    let lamp = found.dropped.iter().find(|dropped| dropped.what == Triple::Lamp).unwrap();
    assert_eq!((found.outcome, lamp.test, lamp.bound), (Outcome::Dark, RelevanceTest::Faint, 1.0));
    // Within 8 and 9 units of the nearest receiver: at most 1/64 of the intensity.
    let physical = Lamp { intensity: 64.0 / 4000.0, ..base };
    assert_eq!(outcome(&physical, 1.0, true).0, Outcome::Dark);
    assert_eq!(outcome(&physical, 0.6, true).0, Outcome::Shadows);
}

#[test]
fn lamp_in_a_closed_house_is_dark_from_outside_and_not_from_inside() {
    let meshes = [
        shapes::cuboid([-3.0, 0.0, -3.0], [3.0, 4.0, 3.0]),
        shapes::cuboid([-9.0, -1.0, -9.0], [9.0, -0.5, 9.0]),
    ];
    let lamp: Lamp = "point:0.2,2,0.1".parse().unwrap();
    let dark = one_question(&meshes, &lamp, [9.0, 8.0, 12.0], 0.0, false);
    assert_eq!((dark.outcome, dark.kept.len()), (Outcome::Dark, 0));
    let test = dark.dropped.iter().find(|dropped| dropped.what == Triple::Lamp).unwrap().test;
    assert_eq!((test, dark.dropped[0].lamp), (RelevanceTest::Enclosed, 3));
    let inside = one_question(&meshes, &lamp, [1.0, 2.5, 1.5], 0.0, false);
    assert_eq!(inside.outcome, Outcome::Unshadowed);
    // An open house, of the same walls without one of their faces, lets light out.
    let open = Mesh::new(meshes[0].positions().to_vec(), meshes[0].triangles()[1..].to_vec()).unwrap();
    let open = one_question(&[open, meshes[1].clone()], &lamp, [9.0, 8.0, 12.0], 0.0, false);
    assert!(open.dropped.iter().all(|dropped| dropped.test != RelevanceTest::Enclosed));
}

#[test]
fn many_pieces_of_one_face_take_linear_time() {
    let soup = shapes::soup(&shapes::icosphere(6));
    let caster = Caster::new(soup);
    let group = CasterGroup::new(vec![&caster]);
    let size = Size::new(32, 24).unwrap();
    let camera = Camera::fit(&group.bounds(), Up::Y, size.aspect());
    let samples = Samples::of_view(&group, &camera.projection(size, 0.1), size, 1).unwrap();
    let pieces = Pieces::of(&group);
    assert_eq!(pieces.len(), 20 << 12);
    let lamp: Lamp = "point:2,3,4".parse().unwrap();
    let question = Question {
        casters: &group,
        pieces: &pieces,
        lamp: &lamp,
        number: 0,
        samples: &samples,
        physical_falloff: false,
        level: 0.0,
        tests: TestSet::ALL,
    };
    let found = relevant(&question);
    assert_eq!(Truth::of(&question).violations(&pieces, &found), 0);
    assert!(found.kept.len() < pieces.len() / 10, "{} kept", found.kept.len());
}

#[test]
fn kept_pieces_cast_what_all_cast() {
    let meshes = [shapes::nested_cubes(3), shapes::cuboid([-9.0, -7.0, -9.0], [9.0, -6.5, 9.0])];
    let casters: Vec<Caster> = meshes.iter().cloned().map(Caster::new).collect();
    let group = CasterGroup::new(casters.iter().collect());
    let pieces = Pieces::of(&group);
    let all: Vec<u32> = (0..pieces.len() as u32).collect();
    assert!(casting(&group, &pieces, &all).is_none());
    assert_eq!(casting(&group, &pieces, &[]).map(|casters| casters.len()), Some(0));
    let kept = casting(&group, &pieces, &[1, 3]).unwrap();
    let faces: Vec<usize> = kept.iter().map(|caster| caster.mesh().face_count()).collect();
    assert_eq!(faces, [12, 12]);
    for (caster, piece) in kept.iter().zip([1, 3]) {
        let corners = (0..12).map(|face| caster.mesh().corners(crate::mesh::FaceId::new(face)));
        assert!(corners.eq(pieces.corners(&group, piece)));
    }
}
