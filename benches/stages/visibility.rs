//! The exact ray cast beside the inexact one of the library that its tree comes from.

use std::time::Duration;

use obvhs::BvhBuildParams;
use obvhs::bvh2::{Bvh2, builder::build_bvh2_from_tris};
use obvhs::ray::Ray;
use obvhs::triangle::Triangle;
use umbrage::geom::Light;
use umbrage::mesh::Mesh;
use umbrage::oracle::{Oracle, Verdict};

use crate::measure::{Bench, Contender, Group, Scatter, Target, timed};

pub(crate) fn run(bench: &mut Bench<'_>) {
    if !bench.wants("oracle") {
        return;
    }
    for mesh in [crate::ordered(bench.quick), crate::scattered(bench.quick)] {
        visibility(bench, &mesh);
    }
}

fn visibility(bench: &mut Bench<'_>, mesh: &Mesh) {
    let units = mesh.face_count();
    let triangles: Vec<Triangle> = mesh
        .triangles()
        .iter()
        .map(|corners| corners.map(|vertex| mesh.positions()[vertex as usize].into()))
        .map(|[v0, v1, v2]| Triangle { v0, v1, v2 })
        .collect();
    let theirs = |params| build_bvh2_from_tris(&triangles, params, &mut Duration::default());
    let name = mesh.name.clone();
    let contenders = vec![
        Contender::new("obvhs fast build", || {
            timed(|| theirs(BvhBuildParams::fast_build()), |tree| primitives(tree.primitive_indices.len()))
        })
        .expects(primitives(units)),
        Contender::new("Oracle::build", || timed(|| Oracle::build(mesh), |_| primitives(units))),
    ];
    bench.run(Group { stage: "oracle build", mesh: name.clone(), units, unit: "triangle", contenders });

    let oracle = Oracle::build(mesh);
    // Their traversal gets the better tree, and triangles in the order of its leaves.
    let tree = theirs(BvhBuildParams::medium_build());
    let leaves: Vec<Triangle> = tree.primitive_indices.iter().map(|&i| triangles[i as usize]).collect();
    drop(triangles);
    let light = Light::point([3.0, 4.0, 5.0]).expect("finite");
    let mut scatter = Scatter(2);
    let count = if bench.quick { 500 } else { 200_000 };
    let scattered: Vec<[f32; 3]> = (0..count).map(|_| scatter.point(3.0)).collect();
    verdicts(bench, format!("{name} · scattered points"), &oracle, (&tree, &leaves), &light, &scattered);
    // As far behind a vertex as the light is before it, rounded: the way to the light runs past an edge or
    // two by less than the rounding.
    let behind = |vertex: &[f32; 3]| std::array::from_fn(|i| 2.0 * vertex[i] - light.xyz()[i]);
    let step = mesh.vertex_count().div_ceil(count);
    let aimed: Vec<[f32; 3]> = mesh.positions().iter().step_by(step).map(behind).collect();
    verdicts(bench, format!("{name} · aimed at vertices"), &oracle, (&tree, &leaves), &light, &aimed);
}

fn primitives(count: usize) -> String {
    format!("primitives={count}")
}

fn verdicts(
    bench: &mut Bench<'_>,
    mesh: String,
    oracle: &Oracle,
    (tree, leaves): (&Bvh2, &[Triangle]),
    light: &Light,
    points: &[[f32; 3]],
) {
    // By looking at every face on the way, not only the first.
    let expected: Vec<Verdict> = points.iter().map(|&p| oracle.crossings(p, light).verdict()).collect();
    let of = |verdicts: &[Verdict]| {
        let count = |wanted| verdicts.iter().filter(|&&verdict| verdict == wanted).count();
        format!("shadowed={} grazing={}", count(Verdict::Shadowed), count(Verdict::Grazing))
    };
    let towards = glam::Vec3A::from(light.xyz());
    let shadowed = |&p: &[f32; 3]| {
        let origin = glam::Vec3A::from(p);
        let ray = Ray::new(origin, towards - origin, 0.0, 1.0);
        !tree.ray_traverse_miss(ray, |ray, slot| leaves[slot].intersect(ray))
    };
    let contenders = vec![
        Contender::new("obvhs in f32", || {
            let work = || points.iter().map(shadowed).collect::<Vec<bool>>();
            timed(work, |found| {
                let wrong = |&(&found, &verdict): &(&bool, &Verdict)| match verdict {
                    Verdict::Grazing => false, // both answers are right
                    _ => found != (verdict == Verdict::Shadowed),
                };
                let shadowed = found.iter().filter(|&&found| found).count();
                format!("shadowed={shadowed} wrong={}", found.iter().zip(&expected).filter(wrong).count())
            })
        }),
        Contender::new("Oracle::verdict", || {
            let work = || points.iter().map(|&p| oracle.verdict(p, light)).collect::<Vec<_>>();
            timed(work, |found| {
                assert!(*found == expected, "a verdict differs from that of all crossings");
                of(found)
            })
        })
        .expects(of(&expected))
        .aims_at(Target::Ratio(1.25)),
    ];
    bench.run(Group { stage: "oracle verdict", mesh, units: points.len(), unit: "query", contenders });
}
