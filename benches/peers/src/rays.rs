//! Is anything between a point and the light?

use std::time::Duration;

use glam::Vec3A;
use obvhs::BvhBuildParams;
use obvhs::bvh2::builder::build_bvh2_from_tris;
use obvhs::cwbvh::builder::build_cwbvh_from_tris;
use obvhs::ray::Ray;
use obvhs::triangle::Triangle;
use parry3d::math::Vector;
use parry3d::query::RayCast as _;
use umbrage::geom::{Aabb, Light};
use umbrage::mesh::Mesh;
use umbrage::oracle::{Oracle, Verdict};

use crate::edges::parry;
use crate::measure::{Bench, Contender, Group, Scatter, Target, timed};
use crate::obvhs_triangles::obvhs_triangles;

pub(crate) fn run(bench: &mut Bench<'_>, mesh: &Mesh) {
    let triangles = obvhs_triangles(mesh);
    if bench.wants("tree") {
        trees(bench, mesh, &triangles);
    }
    if bench.wants("shadow rays") {
        shadow_rays(bench, mesh, &triangles);
    }
}

fn trees(bench: &mut Bench<'_>, mesh: &Mesh, triangles: &[Triangle]) {
    let spent = &mut Duration::default();
    let units = mesh.face_count();
    let all = |count: usize| format!("triangles={count}");
    let bvh2 = |params| build_bvh2_from_tris(triangles, params, &mut Duration::default());
    let contenders = vec![
        Contender::new("obvhs Bvh2, fastest", || {
            timed(|| bvh2(BvhBuildParams::fastest_build()), |tree| all(tree.primitive_indices.len()))
        })
        .expects(all(units)),
        Contender::new("obvhs Bvh2, medium", || {
            timed(|| bvh2(BvhBuildParams::medium_build()), |tree| all(tree.primitive_indices.len()))
        })
        .expects(all(units)),
        Contender::new("obvhs CwBvh, medium", || {
            timed(
                || build_cwbvh_from_tris(triangles, BvhBuildParams::medium_build(), spent),
                |tree| all(tree.primitive_indices.len()),
            )
        })
        .expects(all(units)),
        Contender::new("parry3d TriMesh::new", || timed(|| parry(mesh), |mesh| all(mesh.num_triangles())))
            .expects(all(units)),
        Contender::new("Oracle::build", || timed(|| Oracle::build(mesh), |_| all(units))),
    ];
    bench.run(Group { stage: "tree", mesh: mesh.name.clone(), units, unit: "triangle", contenders });
}

fn shadow_rays(bench: &mut Bench<'_>, mesh: &Mesh, triangles: &[Triangle]) {
    let [low, high] = mesh.bounds().expect("there are faces");
    let bounds = Aabb { low, high };
    let (center, reach) = (bounds.center(), 0.5 * bounds.diagonal() as f32);
    let away = |by: [f32; 3]| [0, 1, 2].map(|i| center[i] + reach * by[i]);
    let light = Light::point(away([1.1, 1.5, 1.8])).expect("finite");
    let mut scatter = Scatter(2);
    let count = if bench.quick { 500 } else { 100_000 };
    let scattered: Vec<[f32; 3]> = (0..count).map(|_| away(scatter.point(1.0))).collect();
    // As far behind a vertex as the light is before it: the way to the light runs past an edge or two by less than
    // the rounding.
    let behind = |vertex: &[f32; 3]| [0, 1, 2].map(|i| 2.0 * vertex[i] - light.xyz()[i]);
    let step = mesh.vertex_count().div_ceil(count);
    let aimed: Vec<[f32; 3]> = mesh.positions().iter().step_by(step).map(behind).collect();

    let spent = &mut Duration::default();
    // The best trees that obvhs makes, and its triangles in the order of the leaves.
    let leaves = |order: &[u32]| -> Vec<Triangle> { order.iter().map(|&i| triangles[i as usize]).collect() };
    let best = BvhBuildParams::very_slow_build();
    let bvh2 = build_bvh2_from_tris(triangles, best, spent);
    let bvh2_leaves = leaves(&bvh2.primitive_indices);
    let cwbvh = build_cwbvh_from_tris(triangles, best, spent);
    let cwbvh_leaves = leaves(&cwbvh.primitive_indices);
    let (theirs, oracle) = (parry(mesh), Oracle::build(mesh));
    let towards = light.xyz();
    let ray = |&p: &[f32; 3]| {
        let origin = Vec3A::from(p);
        Ray::new(origin, Vec3A::from(towards) - origin, 0.0, 1.0)
    };
    for (points, what) in [(scattered, "scattered points"), (aimed, "aimed at vertices")] {
        let expected: Vec<Verdict> = points.iter().map(|&p| oracle.crossings(p, &light).verdict()).collect();
        // Of a grazing ray both answers are right.
        let judge = |found: &Vec<bool>| {
            let shadowed = found.iter().filter(|&&found| found).count();
            let wrong = found.iter().zip(&expected).filter(|&(&found, &verdict)| {
                verdict != Verdict::Grazing && found != (verdict == Verdict::Shadowed)
            });
            format!("shadowed={shadowed} wrong={}", wrong.count())
        };
        let through_bvh2 =
            |p: &[f32; 3]| !bvh2.ray_traverse_miss(ray(p), |ray, i| bvh2_leaves[i].intersect(ray));
        let through_cwbvh =
            |p: &[f32; 3]| !cwbvh.ray_traverse_miss(ray(p), |ray, i| cwbvh_leaves[i].intersect(ray));
        let through_parry = |&p: &[f32; 3]| {
            let origin = Vector::from(p);
            let ray = parry3d::query::Ray::new(origin, Vector::from(towards) - origin);
            theirs.intersects_local_ray(&ray, 1.0)
        };
        let all = |found: &dyn Fn(&[f32; 3]) -> bool| -> Vec<bool> { points.iter().map(found).collect() };
        let contenders = vec![
            Contender::new("obvhs CwBvh, f32", || {
                timed(|| points.iter().map(through_cwbvh).collect(), judge)
            }),
            Contender::new("obvhs Bvh2, f32", || timed(|| points.iter().map(through_bvh2).collect(), judge)),
            Contender::new("parry3d TriMesh, f32", || timed(|| all(&through_parry), judge)),
            Contender::new("Oracle::verdict, exact", || {
                let work = || points.iter().map(|&p| oracle.verdict(p, &light)).collect::<Vec<_>>();
                timed(work, |found| {
                    assert!(*found == expected, "a verdict differs from that of all crossings");
                    let count = |wanted| found.iter().filter(|&&verdict| verdict == wanted).count();
                    let [shadowed, grazing] = [Verdict::Shadowed, Verdict::Grazing].map(count);
                    format!("shadowed={shadowed} wrong=0 grazing={grazing}")
                })
            })
            .aims_at(Target::Ratio(1.25)),
        ];
        let (name, units) = (format!("{} · {what}", mesh.name), points.len());
        bench.run(Group { stage: "shadow rays", mesh: name, units, unit: "ray", contenders });
    }
}
