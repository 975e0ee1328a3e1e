//! Sorted points against the exact ray cast.

use super::fault::{Fault, Faults};
use super::sorted::verdicts_with;
use super::tests::{Tally, case, points};
use super::*;
use crate::caster::{Caster, CasterGroup};
use crate::geom::Light;
use crate::mesh::Mesh;
use crate::oracle::Verdict;
use crate::random::SplitMix64;
use crate::testing::shapes;

fn sorted_tally(
    chain: &Chain<'_>,
    casters: &CasterGroup<'_>,
    points: &[[f32; 3]],
    side: u32,
    fault: Option<Fault>,
) -> Tally {
    let mut tally = Tally::default();
    let verdicts = verdicts_with(chain, points, side, 1 << 24, Faults(fault));
    for (&p, verdict) in points.iter().zip(verdicts) {
        tally.add(verdict, casters.oracle().verdict(p, chain.light()));
    }
    tally
}

#[test]
fn sorted_points_have_the_verdicts_of_the_exact_ray_cast() {
    let (mut random, mut all) = (SplitMix64(8), 0);
    for _ in 0..100 {
        let (meshes, light) = case(&mut random);
        let owned: Vec<Caster> = meshes.into_iter().map(Caster::new).collect();
        let casters = CasterGroup::new(owned.iter().collect());
        let chain = Chain::of(&casters, &light);
        let (hits, mut free) = points(&mut random, &casters, &light, 150);
        free.extend(hits.iter().map(|hit| hit.point));
        // Borders of the sides of the cube around the light, and the light itself.
        let l = light.xyz();
        free.extend([1.0, -2.0].map(|by| [l[0] + by, l[1] - by, l[2] + by]));
        free.push(l);
        for side in [1, 7, 64] {
            let found = sorted_tally(&chain, &casters, &free, side, None);
            assert!(found.wrong == 0 && found.decided == found.all, "{light} {side} {found:?}");
            all += found.all;
        }
    }
    assert!(all > 50_000, "{all}");
}

/// Faces that end a little before the border of a column, and points that round onto the border.
#[test]
fn sorted_points_without_their_error_box_are_caught() {
    let (mut positions, mut triangles, mut points) =
        (Vec::new(), Vec::new(), vec![[0.0, 0.0, 0.0], [1024.0, 1.0, 0.0]]);
    for column in 1..40_u32 {
        let border = 0.25 * column as f32; // of 4096 over 1024
        let first = 3 * (column - 1);
        positions.extend([[border - 0.1, -1.0, 1.0], [border - 3e-6, -1.0, 1.0], [border - 3e-6, 9.0, 1.0]]);
        triangles.push([first, first + 1, first + 2]);
        points.extend((0..8).map(|i| [border - 4e-6 - 1e-6 * i as f32, 0.1 * i as f32, 0.0]));
    }
    let caster = Caster::new(Mesh::new(positions, triangles).unwrap());
    let casters = CasterGroup::new(vec![&caster]);
    let light = Light::directional([0.0, 0.0, -1.0]).unwrap();
    let chain = Chain::of(&casters, &light);
    let [right, wrong] =
        [None, Some(Fault::NoErrorBox)].map(|fault| sorted_tally(&chain, &casters, &points, 4096, fault));
    assert!(right.wrong == 0 && right.all > 300, "{right:?}");
    assert!(wrong.wrong > 50, "{wrong:?}");
}

/// Too much work: what is dark is right, and the rest is left undecided.
#[test]
fn sorted_points_give_up_rather_than_hang() {
    let sheets: Vec<Mesh> = (0..50)
        .map(|i| shapes::translated(&shapes::scaled(&shapes::sheet(1), 4.0), [0.0, 0.0, i as f32]))
        .collect();
    let caster = Caster::new(Mesh::concat(&sheets).unwrap());
    let casters = CasterGroup::new(vec![&caster]);
    let light = Light::directional([0.0, 0.1, -1.0]).unwrap();
    let chain = Chain::of(&casters, &light);
    let mut random = SplitMix64(9);
    let (_, free) = points(&mut random, &casters, &light, 1000);
    let verdicts = verdicts_with(&chain, &free, 32, 5000, Faults::default());
    assert!(!verdicts.contains(&GridVerdict::Lit) && verdicts.contains(&GridVerdict::Undecided));
    for (&p, verdict) in free.iter().zip(verdicts) {
        assert!(verdict != GridVerdict::Dark || casters.oracle().verdict(p, &light) != Verdict::Lit);
    }
}
