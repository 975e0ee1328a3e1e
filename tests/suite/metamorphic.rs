//! Metamorphic relations: results that must not change, or must change in a known way, when a mesh is stored,
//! moved or cut differently.
//!
//! Every relation is tested on four families of meshes (soups, closed solids, solids with defects,
//! axis-aligned solids full of ties), with lights and points that are hard for the mesh at hand. The results
//! are facing, silhouettes, certificate, ray cast and winding number. Each run counts the cases of each
//! outcome, so that no relation holds for lack of cases. Then each relation is given a fault that the same
//! comparison must reject, and each comparison a wrong answer that no other comparison sees.
//!
//! Long form: `PROPTEST_CASES=1000 cargo test --test suite metamorphic` runs 1000 cases per family, and four
//! times as many soups, which are small.
//!
//! A failure is minimized and printed, and its seed is appended to
//! `tests/proptest-regressions/metamorphic.txt`, which is committed with the fix. Every later run of every
//! relation tries the seeds of this file before it draws new ones. To replay a single failure, run the
//! failing test by its name. (The seeds of other test files are in the same folder.)

mod answers;
mod same;
mod shadow;
mod union;

use std::cell::{Cell, RefCell};

use proptest::prelude::*;
use proptest::sample::Index;
use proptest::strategy::ValueTree;
use proptest::test_runner::{Config, TestRunner};
use umbrage::mesh::Mesh;
use umbrage::testing::strategy::{Case, cad, case, closed, damaged, soup, soup_at};

use answers::{Fault, Slip, Tally};

/// Random choices of a relation, in addition to the case.
#[derive(Clone, Debug)]
struct Twist {
    /// Exponent of a power of two.
    exponent: i32,
    /// A translation, in steps of this power of two.
    shift: ([i8; 3], i32),
    /// One of the six orders of the axes.
    order: usize,
    /// The axes that are mirrored, as bits.
    mirrored: u8,
    /// Seed for permutations and choices.
    seed: u64,
    pick: Index,
    /// A corner and two sides of a parallelogram.
    quad: [[i8; 3]; 3],
    /// Another caster.
    extra: Mesh,
    weld: bool,
}

fn twist() -> impl Strategy<Value = Twist> {
    let side = || [-3_i8..=3, -3_i8..=3, -3_i8..=3];
    (
        -60_i32..=60,
        (any::<[i8; 3]>(), -3_i32..=5),
        (0_usize..6, 0_u8..8),
        any::<u64>(),
        any::<Index>(),
        [side(), side(), side()],
        prop_oneof![soup(12), cad()],
        any::<bool>(),
    )
        .prop_map(|(exponent, shift, (order, mirrored), seed, pick, quad, extra, weld)| Twist {
            exponent,
            shift,
            order,
            mirrored,
            seed,
            pick,
            quad,
            extra,
            weld,
        })
}

impl Twist {
    /// A pseudo-random number for `i`.
    fn scattered(&self, i: usize) -> u64 {
        let z = (self.seed ^ i as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        let z = (z ^ (z >> 32)).wrapping_mul(0xd6e8_feb8_6659_fd93);
        z ^ (z >> 32)
    }

    /// A permutation: the new index of each of `count` items.
    fn permutation(&self, count: usize) -> Vec<u32> {
        let mut order: Vec<usize> = (0..count).collect();
        order.sort_by_key(|&i| self.scattered(i));
        let mut to = vec![0; count];
        (0..).zip(order).for_each(|(new, old)| to[old] = new);
        to
    }
}

/// A relation: checks one case, with a fault injected if requested. `None` if the relation does not apply to
/// the case.
type Relation = fn(&Case, &Twist, fault: Fault) -> Option<Result<Tally, String>>;

/// Name, factor of the number of cases relative to solids, and meshes of each family.
fn families() -> [(&'static str, u32, BoxedStrategy<Mesh>); 4] {
    let anywhere = || [-3.0_f32..3.0, -3.0_f32..3.0, -3.0_f32..3.0];
    [
        ("soups", 4, prop_oneof![2 => soup(24), 1 => soup_at(24, anywhere())].boxed()),
        ("closed solids", 1, closed().boxed()),
        ("solids with defects", 1, damaged(closed(), 4).prop_map(|damaged| damaged.mesh).boxed()),
        ("solids full of ties", 1, cad().boxed()),
    ]
}

/// What broke a relation once: one face, and a point in its plane beside it.
fn found_once() -> Vec<Case> {
    let mesh = Mesh::new(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]]).expect("finite");
    let points = vec![[2.0, 0.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 2.0, 0.0], [0.25, -3.0, 0.0]];
    ["point:0,0,1", "point:0.25,0.25,-2", "point:-1,-1,0", "directional:0,0,1", "directional:1,1,0"]
        .map(|light| Case {
            mesh: mesh.clone(),
            light: light.parse().expect("a light"),
            points: points.clone(),
        })
        .to_vec()
}

/// Default number of cases per family (overridden by `PROPTEST_CASES`): each outcome occurs dozens of times.
const CASES: u32 = 60;

/// Asserts that the relation holds on every case of each family, that every outcome occurs, that its fault is
/// found, and that each of its `comparisons` finds the wrong answer made for it.
fn hold(name: &'static str, relation: Relation, comparisons: &[(Slip, &str)]) {
    for case in found_once() {
        let mut runner = TestRunner::deterministic();
        for _ in 0..20 {
            let twist = twist().new_tree(&mut runner).expect("nothing is rejected").current();
            if let Some(Err(broken)) = relation(&case, &twist, Fault::None) {
                panic!("{name} of {case:?}, {twist:?}: {broken}");
            }
        }
    }
    let asked = std::env::var_os("PROPTEST_CASES").map_or(CASES, |_| Config::default().cases);
    for (family, times, meshes) in families() {
        let cases = (case(meshes, 6), twist());
        let run = asked.saturating_mul(times);
        let config =
            Config { cases: run, source_file: Some(file!()), test_name: Some(name), ..Config::default() };
        let (tally, skipped) = (RefCell::new(Tally::default()), Cell::new(0_u32));
        let result = TestRunner::new(config).run(&cases, |(case, twist)| {
            match relation(&case, &twist, Fault::None) {
                Some(Ok(seen)) => tally.borrow_mut().add(&seen),
                Some(Err(broken)) => return Err(TestCaseError::fail(broken)),
                None => skipped.set(skipped.get() + 1),
            }
            Ok(())
        });
        if let Err(error) = result {
            panic!("{name} of {family}: {error}");
        }
        let (tally, skipped) = (tally.into_inner(), skipped.get());
        eprintln!("{name} of {family}: {run} cases, {skipped} without a say, {tally:?}");
        if asked >= CASES {
            assert!(2 * skipped < run, "{name} of {family}: {skipped} of {run} cases were left out");
            assert!(tally.has_seen_all(), "{name} of {family} has not seen everything: {tally:?}");
        }

        // Negative test: the same check with a fault finds the fault within some hundred cases, and in more
        // than one.
        let found = |fault, said: &str| {
            let mut runner = TestRunner::deterministic();
            let found = (0..400).filter(|_| {
                let (case, twist) = cases.new_tree(&mut runner).expect("nothing is rejected").current();
                matches!(relation(&case, &twist, fault), Some(Err(broken)) if broken.starts_with(said))
            });
            assert!(found.take(2).count() == 2, "{name} of {family}: {fault:?} was not found: {said}");
        };
        found(Fault::Image, "");
        for &(slip, said) in comparisons {
            found(Fault::Answer(slip), said);
        }
    }
}

macro_rules! relations {
    ($($name:ident: $relation:path, $comparisons:path;)*) => {
        $(
            #[test]
            fn $name() {
                hold(stringify!($name), $relation, $comparisons);
            }
        )*
    };
}

relations! {
    metamorphic_scaling_by_a_power_of_two_changes_nothing: same::scaled, same::COMPARISONS;
    metamorphic_an_exact_translation_changes_nothing: same::translated, same::COMPARISONS;
    metamorphic_permuted_axes_change_nothing: same::permuted, same::COMPARISONS;
    metamorphic_a_reflection_changes_nothing: same::mirrored, same::COMPARISONS;
    metamorphic_relabelled_vertices_change_nothing: same::relabelled, same::COMPARISONS;
    metamorphic_faces_in_another_order_change_nothing: same::reordered, same::COMPARISONS;
    metamorphic_rotated_corners_change_nothing: same::rotated, same::COMPARISONS;
    metamorphic_unreferenced_vertices_change_nothing: same::unreferenced, same::COMPARISONS;
    metamorphic_a_second_copy_counts_everything_twice: same::duplicated, same::COMPARISONS;
    metamorphic_flipped_windings_throw_the_same_shadow: shadow::turned, shadow::TURNED;
    metamorphic_an_edge_split_at_its_middle_throws_the_same_shadow: shadow::split, shadow::RECUT;
    metamorphic_a_quad_cut_along_its_other_diagonal_throws_the_same_shadow: shadow::recut, shadow::RECUT;
    metamorphic_faces_cut_in_four_throw_the_same_shadow: shadow::quartered, shadow::QUARTERED;
    metamorphic_another_caster_lights_no_point: union::adding, union::ADDING;
    metamorphic_casters_together_throw_all_their_shadows: union::parting, union::PARTING;
}
