//! The bound of what simplified casters change, against all verdicts.

use super::*;
use crate::caster::Caster;
use crate::scene::Lamp;
use crate::shadow::{Request, Technique};
use crate::testing::shapes;
use crate::verify::errors::{Errors, Made, Truth};
use crate::view::{Camera, Size, Up};

/// A solid high over a floor, on which its shadow is seen from below the solid's lit side.
fn over_floor(solid: &Mesh, height: f32) -> Caster {
    let floor = shapes::cuboid([-12.0, -1.0, -12.0], [12.0, 0.0, 12.0]);
    Caster::new(Mesh::concat(&[shapes::translated(solid, [0.0, height, 0.0]), floor]).unwrap())
}

fn solids() -> [Mesh; 3] {
    [shapes::icosphere(4), shapes::torus(64, 32, 1.4, 0.5), shapes::torus_knot(2, 3, 160, 16, 0.3)]
}

struct Case<'a> {
    request: Request<'a>,
    truth: Truth,
}

/// Calls `visit` for each solid and lamp.
fn for_each(lamps: &[&str], mut visit: impl FnMut(&Case<'_>)) {
    let size = Size::new(80, 60).unwrap();
    for solid in solids() {
        let caster = over_floor(&solid, 6.0);
        let casters = CasterGroup::new(vec![&caster]);
        // The solid is above the picture.
        let camera = Camera::look_at([0.0, 4.0, 9.0], [0.0, -0.5, 0.0], 0.75, Up::Y).unwrap();
        let samples = Samples::of_view(&casters, &camera.projection(size, 0.1), size, 1).unwrap();
        for lamp in lamps {
            let lamp: Lamp = lamp.parse().unwrap();
            let request = Request { casters: &casters, lamp: &lamp, samples: &samples };
            visit(&Case { request, truth: Truth::of(&request) });
        }
    }
}

impl Case<'_> {
    /// Wrong samples, those of them that were said not to change, all that may change, and those judged.
    fn count(&self, options: LodOptions, fault: Option<Fault>) -> [u64; 4] {
        let Request { casters, samples, .. } = self.request;
        let mut shadow = LodShadow::prepare(casters, self.request.light(), options);
        shadow.faults = Faults(fault);
        let visibility = shadow.shade(samples);
        let errors = Errors::of(&self.request, &visibility, &self.truth, &Made::default());
        let simplified = shadow.simplified(samples, visibility.asked());
        let (mut missed, mut changing) = (0, 0);
        for (index, hit) in samples.hits().iter().enumerate() {
            let Some(hit) = hit.as_ref().filter(|_| visibility.asked()[index]) else { continue };
            let may_change = shadow.changing(&simplified, &[hit.point]) > 0;
            let is_wrong = match self.truth.verdicts()[index] {
                Some(Verdict::Lit) => visibility.values()[index] != 1.0,
                Some(Verdict::Shadowed) => visibility.values()[index] != 0.0,
                _ => false,
            };
            missed += u64::from(is_wrong && !may_change);
            changing += u64::from(may_change);
        }
        assert!(fault.is_some() || errors.hold(visibility.claim()), "{}", visibility.claim());
        [errors.wrong, missed, changing, errors.judged]
    }
}

fn options(moves: f64, on: LodOn) -> LodOptions {
    LodOptions { moves: Tolerance::new(moves).unwrap(), on }
}

const FAR: [&str; 2] = ["point:2,14,1", "directional:-0.2,-1,0.1"];
/// So near that a shadow's edge moves several times as far as the caster's.
const NEAR: [&str; 1] = ["point:0.2,8.5,0.1"];

#[test]
fn lod_changes_no_more_samples_than_its_bound_allows() {
    let (mut wrong, mut bound, mut judged) = (0, 0, 0);
    for_each(&[FAR[0], FAR[1], NEAR[0]], |case| {
        for (moves, on) in [(0.01, LodOn::Rays), (0.04, LodOn::Rays), (0.04, LodOn::ZFail)] {
            let [own, missed, most, all] = case.count(options(moves, on), None);
            assert!(own <= most && missed == 0, "{moves} {on:?}: {own} of {most}, {missed} missed");
            (wrong, bound, judged) = (wrong + own, bound + most, judged + all);
        }
    });
    assert!(wrong > 50 && 3 * bound < 2 * judged, "{wrong} {bound} {judged}");
}

/// A strip with teeth along both sides; its base comes first, and all tips merge into it.
fn saw() -> Mesh {
    let (teeth, step, height) = (12_u32, 0.12_f32, 0.07_f32);
    let at = |i: f32, z: f32| [(i - 6.0) * step, 0.0, z];
    let base = (0..=teeth).flat_map(|i| [at(i as f32, -0.2), at(i as f32, 0.2)]);
    let tips = (0..teeth).flat_map(|i| [at(i as f32 + 0.5, -0.2 - height), at(i as f32 + 0.5, 0.2 + height)]);
    let first_tip = 2 * (teeth + 1);
    let faces = (0..teeth).flat_map(|i| {
        let [a, b, c, d, tip] = [2 * i, 2 * i + 1, 2 * i + 2, 2 * i + 3, first_tip + 2 * i];
        [[a, b, c], [c, b, d], [a, c, tip], [d, b, tip + 1]]
    });
    Mesh::new(base.chain(tips).collect(), faces.collect()).unwrap()
}

/// The light is so near that the shadows of the teeth are twenty times as large.
#[test]
fn lod_bound_without_the_light_s_distance_is_false() {
    let size = Size::new(80, 60).unwrap();
    let caster = over_floor(&saw(), 9.5);
    let casters = CasterGroup::new(vec![&caster]);
    let camera = Camera::look_at([0.0, 6.0, 14.0], [0.0, -0.5, 0.0], 0.75, Up::Y).unwrap();
    let samples = Samples::of_view(&casters, &camera.projection(size, 0.1), size, 1).unwrap();
    let lamp: Lamp = "point:0.1,10.0,0.05".parse().unwrap();
    let request = Request { casters: &casters, lamp: &lamp, samples: &samples };
    let case = Case { request, truth: Truth::of(&request) };
    let [wrong, missed, ..] = case.count(options(0.07, LodOn::Rays), None);
    assert!(wrong > 50 && missed == 0, "{wrong} {missed}");
    let [_, missed, ..] = case.count(options(0.07, LodOn::Rays), Some(Fault::EdgeMovesByDelta));
    assert!(missed > 10, "{missed}");
}

/// A caster that is seen keeps its form, or its surface would shadow itself.
#[test]
fn lod_leaves_casters_that_are_seen_as_they_are() {
    let size = Size::new(60, 45).unwrap();
    let caster = over_floor(&shapes::torus_knot(2, 3, 160, 16, 0.4), 2.5);
    let casters = CasterGroup::new(vec![&caster]);
    let camera = Camera::look_at([3.0, 6.0, 8.0], [0.0, 2.0, 0.0], 0.9, Up::Y).unwrap();
    let samples = Samples::of_view(&casters, &camera.projection(size, 0.1), size, 1).unwrap();
    let lamp: Lamp = "point:3,9,4".parse().unwrap();
    let request = Request { casters: &casters, lamp: &lamp, samples: &samples };
    let case = Case { request, truth: Truth::of(&request) };
    let [wrong, _, changing, _] = case.count(options(0.04, LodOn::Rays), None);
    assert_eq!((wrong, changing), (0, 0));
    assert_eq!(Technique::Lod(LodOptions::DEFAULT).shade(&request).unwrap().claim(), Claim::Bounded(0.0));
    let [wrong, ..] = case.count(options(0.04, LodOn::Rays), Some(Fault::SeenAreSimplified));
    assert!(wrong > 20, "{wrong}");
}

/// Visible faces that do not cast have the corners of no casting face.
#[test]
fn lod_finds_the_shells_of_what_is_seen_beside_receivers() {
    let caster = over_floor(&shapes::icosphere(3), 1.5);
    let wall = shapes::cuboid([-3.0, 0.0, -4.0], [3.0, 4.0, -3.0]);
    let seen = Caster::new(Mesh::concat(&[wall, caster.mesh().clone()]).unwrap());
    let casters = CasterGroup::new(vec![&caster]).seen_with(&seen);
    let size = Size::new(40, 30).unwrap();
    let camera = Camera::look_at([3.0, 4.0, 6.0], [0.0, 1.0, 0.0], 0.9, Up::Y).unwrap();
    let samples = Samples::of_view(&casters, &camera.projection(size, 0.1), size, 1).unwrap();
    let shells = ShellOfFace::new(&casters);
    let mut found = [0; 3];
    for hit in samples.hits().iter().flatten() {
        found[shells.of(hit).unwrap_or(2)] += 1;
    }
    assert!(found.iter().all(|&count| count > 20), "{found:?}");
}
