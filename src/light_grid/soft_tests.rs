//! Soft verdicts against the analytic fraction.

use super::fault::{Fault, Faults};
use super::soft::{SoftGrid, SoftVerdict};
use super::tests::{points, scattered};
use super::*;
use crate::caster::{Caster, CasterGroup};
use crate::mesh::Mesh;
use crate::oracle::area::{AreaLight, SoftOracle};
use crate::random::SplitMix64;
use crate::scene::Lamp;
use crate::testing::shapes;

#[derive(Clone, Copy, Debug, Default)]
struct Tally {
    wrong: u64,
    lit: u64,
    dark: u64,
    all: u64,
}

/// Verdicts about visible points and points anywhere, against the fraction.
fn tally(
    casters: &CasterGroup<'_>,
    lamp: &Lamp,
    count: usize,
    side: u32,
    seed: u64,
    fault: Option<Fault>,
) -> Tally {
    let chain = Chain::of(casters, lamp.light());
    let mut random = SplitMix64(seed);
    let (hits, free) = points(&mut random, casters, lamp.light(), count);
    let all = hits.iter().map(|hit| hit.point).chain(free.iter().copied());
    let grid = SoftGrid::build_with(&chain, lamp, all, side, Faults(fault));
    let (soft, area) = (SoftOracle::new(casters.oracle()), AreaLight::of_lamp(lamp).unwrap().unwrap());
    let mut tally = Tally::default();
    let verdicts = hits.iter().map(|hit| (hit.point, grid.verdict(hit)));
    for (p, verdict) in verdicts.chain(free.iter().map(|&p| (p, grid.verdict_at(p)))) {
        tally.all += 1;
        if verdict == SoftVerdict::Maybe {
            continue;
        }
        let Some(seen) = soft.visible(p, &area) else { continue };
        // The fraction is right within its bound.
        let slack = seen.bound + 1e-9;
        let (is_lit, is_dark) = (seen.fraction >= 1.0 - slack, seen.fraction <= slack);
        (tally.lit, tally.dark) = (
            tally.lit + u64::from(verdict == SoftVerdict::Lit),
            tally.dark + u64::from(verdict == SoftVerdict::Dark),
        );
        tally.wrong += u64::from(if verdict == SoftVerdict::Lit { !is_lit } else { !is_dark });
    }
    tally
}

fn floor() -> Mesh {
    shapes::translated(&shapes::scaled(&shapes::sheet(3), 12.0), [-6.0, -6.0, -2.5])
}

fn scenes() -> Vec<Vec<Mesh>> {
    let solids = [
        shapes::torus(17, 9, 1.5, 0.6),
        shapes::icosphere(2),
        shapes::book(5),
        shapes::mobius(20),
        shapes::menger_sponge(1),
        shapes::open_cube(),
    ];
    let mut scenes: Vec<Vec<Mesh>> = solids.into_iter().map(|solid| vec![solid, floor()]).collect();
    scenes.push(vec![Mesh::concat(&[shapes::nested_cubes(2), floor()]).unwrap()]);
    scenes
}

const LAMPS: [&str; 6] = [
    "directional:0.4,0.3,-1,angle=0.5",
    "directional:-1.5,0.5,-0.8,angle=4",
    "point:2,-1,4,radius=0.05",
    "point:0.3,0.2,3.5,radius=0.4",
    "point:0.1,0.2,-2.1,radius=0.02",
    "rect:-0.2,-0.2,5:0.5,0,0:0,0.3,0.1",
];

fn over_scenes(count: usize, fault: Option<Fault>) -> Tally {
    let mut sum = Tally::default();
    for (seed, meshes) in (1..).zip(scenes()) {
        let owned: Vec<Caster> = meshes.into_iter().map(Caster::new).collect();
        let casters = CasterGroup::new(owned.iter().collect());
        for lamp in LAMPS {
            let lamp: Lamp = lamp.parse().unwrap();
            for side in [20, 96] {
                let found = tally(&casters, &lamp, count, side, seed, fault);
                assert!(fault.is_some() || found.wrong == 0, "{lamp} {side} {found:?}");
                (sum.wrong, sum.lit) = (sum.wrong + found.wrong, sum.lit + found.lit);
                (sum.dark, sum.all) = (sum.dark + found.dark, sum.all + found.all);
            }
        }
    }
    sum
}

#[test]
fn soft_grid_proves_nothing_that_is_false() {
    let tally = over_scenes(80, None);
    assert!(tally.lit * 3 > tally.all && tally.dark * 20 > tally.all && tally.all > 8000, "{tally:?}");
}

/// Hard meshes, and lights that are hard for them.
#[test]
fn soft_grid_proves_nothing_that_is_false_of_generated_meshes() {
    let (mut random, mut sum) = (SplitMix64(11), Tally::default());
    for seed in 0..100 {
        let (mesh, lamp) = scattered(&mut random);
        let caster = Caster::new(mesh);
        let casters = CasterGroup::new(vec![&caster]);
        let found = tally(&casters, &lamp, 60, 24, seed, None);
        assert!(found.wrong == 0, "{lamp} {found:?} {:?}", caster.mesh());
        (sum.lit, sum.dark, sum.all) = (sum.lit + found.lit, sum.dark + found.dark, sum.all + found.all);
    }
    assert!(sum.lit * 10 > sum.all && sum.dark > 100, "{sum:?}");
}

#[test]
fn soft_grid_that_breaks_a_rule_is_caught() {
    for fault in [Fault::NoReach, Fault::NoOutline] {
        let tally = over_scenes(40, Some(fault));
        assert!(tally.wrong > 8, "{fault:?} {tally:?}");
    }
}

/// A wall through the center of the light hides half of it, and is edge-on.
#[test]
fn soft_grid_without_edge_on_faces_is_caught() {
    let wall = Mesh::new(
        vec![[0.0, -9.0, -1.0], [0.0, 9.0, -1.0], [0.0, 9.0, 1.5], [0.0, -9.0, 1.5]],
        vec![[0, 1, 2], [0, 2, 3]],
    );
    let owned = [Caster::new(wall.unwrap()), Caster::new(floor())];
    let casters = CasterGroup::new(owned.iter().collect());
    let lamp: Lamp = "point:0,0.5,4,radius=0.3".parse().unwrap();
    let wrong = |fault| tally(&casters, &lamp, 1500, 64, 5, fault).wrong;
    assert!(
        wrong(None) == 0 && wrong(Some(Fault::EdgeOnLeftOut)) > 5,
        "{}",
        wrong(Some(Fault::EdgeOnLeftOut))
    );
}

/// A floor, a steep wall and a roof, without a silhouette edge for the center of the sun: from the edge of
/// the sun the wall hides the foot of the floor, which is the same sheet.
#[test]
fn soft_grid_that_leaves_its_own_sheet_out_is_caught() {
    let line = [[-3.5, 0.0], [0.0, 0.0], [1.0, 2.0], [4.0, 2.0]];
    let positions = line.iter().flat_map(|&[x, z]| [[x, -4.0, z], [x, 4.0, z]]);
    let quads = (0..3).flat_map(|i| [[2 * i, 2 * i + 2, 2 * i + 3], [2 * i, 2 * i + 3, 2 * i + 1]]);
    let caster = Caster::new(Mesh::new(positions.collect(), quads.collect()).unwrap());
    let casters = CasterGroup::new(vec![&caster]);
    let lamp: Lamp = "directional:0,0,-1,angle=30".parse().unwrap();
    let found = |fault| tally(&casters, &lamp, 3000, 64, 6, fault);
    let [right, wrong] = [None, Some(Fault::OwnLeftOut)].map(found);
    assert!(right.wrong == 0 && right.lit > 100 && wrong.wrong > 3, "{right:?} {wrong:?}");
}
