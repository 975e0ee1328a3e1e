//! The fraction against exact rays, on meshes with holes, seams, sheets in one another and edges of many
//! faces, and faults of the chain that the rays catch.

use super::fault::{Fault, Faults};
use super::*;
use crate::random::SplitMix64;
use crate::testing::shapes;

const RAYS: u32 = 4096;

/// Six times the error of this many rays.
fn noise() -> f64 {
    6.0 * 0.4 * f64::from(RAYS).powf(-0.75)
}

fn lights(random: &mut SplitMix64, size: f32) -> Vec<AreaLight> {
    let mut vector = |most: f32| [(); 3].map(|()| (random.unit() as f32 * 2.0 - 1.0) * most * size);
    let mut above = || {
        let [x, y, z] = vector(1.0);
        [x, y, z + 4.0 * size]
    };
    let corners = [above(), above(), above()];
    let edge = |i: usize| [0, 1, 2].map(|k| corners[i][k] - corners[0][k]);
    let arrow = {
        // A dart: a polygon that is not convex.
        let at = |a: f32, b: f32| [0, 1, 2].map(|k| corners[0][k] + a * edge(1)[k] + b * edge(2)[k]);
        [at(0.0, 0.0), at(1.0, 0.0), at(0.3, 0.3), at(0.0, 1.0)]
    };
    vec![
        AreaLight::parallelogram(corners[0], edge(1), edge(2)).unwrap(),
        AreaLight::polygon(&arrow).unwrap(),
        AreaLight::disk(corners[0], edge(1), edge(2)).unwrap(),
        AreaLight::facing_disk(corners[1], size).unwrap(),
        AreaLight::sun(corners[2], 0.2).unwrap(),
        AreaLight::sky_parallelogram(corners[0], edge(1), edge(2)).unwrap(),
    ]
}

/// The number of points at which rays and fraction differ by more than noise, and of those in penumbra.
fn apart(soft: &SoftOracle<'_>, points: usize, seed: u64) -> [usize; 2] {
    let mut random = SplitMix64(seed);
    let bounds = soft.oracle().bounds();
    let size = 0.5 * bounds.diagonal() as f32;
    let [mut apart, mut penumbra] = [0; 2];
    for light in lights(&mut random, size) {
        for _ in 0..points {
            let mut offset = || (random.unit() as f32 * 2.0 - 1.0) * 1.5 * size;
            let center = bounds.center();
            let p = [center[0] + offset(), center[1] + offset(), center[2] + offset() - size];
            let Some(found) = soft.visible(p, &light) else { continue };
            let sampled = soft.sampled(p, &light, RAYS, 7).unwrap();
            penumbra += usize::from(found.fraction > 0.0 && found.fraction < 1.0);
            apart += usize::from((found.fraction - sampled.fraction).abs() > noise() + found.bound);
        }
    }
    [apart, penumbra]
}

fn meshes() -> Vec<(&'static str, Mesh)> {
    vec![
        ("torus", shapes::torus(24, 12, 2.0, 0.75)),
        ("knot", shapes::torus_knot(2, 3, 40, 6, 0.4)),
        ("sponge", shapes::menger_sponge(1)),
        ("sponge soup", shapes::soup(&shapes::menger_sponge(1))),
        ("open", shapes::open_cube()),
        ("misoriented", shapes::misoriented_cube()),
        ("duplicate", shapes::duplicated_face()),
        ("sheets", shapes::double_sheet()),
        ("band", shapes::mobius(24)),
        ("book", shapes::book(5)),
        ("shared edge", shapes::cubes_sharing_edge()),
        ("eight", shapes::figure_eight_prism()),
        ("nested", shapes::nested_cubes(3)),
        ("small", shapes::scaled(&shapes::torus(24, 12, 2.0, 0.75), 0.002)),
        ("far", shapes::translated(&shapes::icosphere(2), [3000.0, -500.0, 20.0])),
    ]
}

#[test]
fn rays_agree_on_every_mesh_and_light() {
    let mut in_penumbra = 0;
    for (name, mesh) in meshes() {
        let [apart, penumbra] = apart(&SoftOracle::build(&mesh), 6, 3);
        assert_eq!(apart, 0, "{name}");
        in_penumbra += penumbra;
    }
    assert!(in_penumbra > 150, "{in_penumbra}");
}

#[test]
fn rays_catch_what_a_chain_does_wrong() {
    let caught = |mesh: &Mesh, fault: &dyn Fn(&mut SoftOracle<'_>)| {
        let mut soft = SoftOracle::build(mesh);
        fault(&mut soft);
        apart(&soft, 6, 3)[0]
    };
    let torus = shapes::torus(24, 12, 2.0, 0.75);
    // Vertices joined that are not equal.
    let coarse = |soft: &mut SoftOracle<'_>| {
        soft.corners = welded(&soft.oracle.triangles, |x| x.map(|x| (x * 1e3).round() * 1e-3));
    };
    assert!(caught(&shapes::scaled(&torus, 0.002), &coarse) > 0);
    // Some faces with two of their ids exchanged.
    let reversed = |soft: &mut SoftOracle<'_>| {
        soft.corners.iter_mut().step_by(7).for_each(|ids| ids.swap(0, 1));
    };
    assert!(caught(&torus, &reversed) > 0);
    for fault in [Fault::NoMultiplicity, Fault::NoLeft, Fault::NoClosing, Fault::Sum] {
        let sets = |soft: &mut SoftOracle<'_>| soft.faults = Faults(Some(fault));
        assert!(
            caught(&shapes::double_sheet(), &sets) + caught(&shapes::nested_cubes(3), &sets) > 0,
            "{fault:?}"
        );
    }
}
