//! The exact ray cast compared with the inexact one of obvhs.

use std::time::Duration;

use obvhs::BvhBuildParams;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::builder::build_bvh2_from_tris;
use obvhs::ray::Ray;
use obvhs::triangle::Triangle;
use umbrage::geom::Light;
use umbrage::mesh::Mesh;
use umbrage::oracle::{Oracle, Verdict};

use crate::measure::{Bench, Contender, Group, Scatter, Target, timed};
use crate::obvhs_triangles::obvhs_triangles;

pub(crate) fn run(bench: &mut Bench<'_>) {
    let wanted = [BUILD, VERDICT].map(|stage| bench.wants(stage));
    if wanted == [false; 2] {
        return;
    }
    for mesh in [crate::ordered(bench.quick), crate::scattered(bench.quick), crate::head(bench.quick)] {
        let triangles = obvhs_triangles(&mesh);
        if wanted[0] {
            build(bench, &mesh, &triangles);
        }
        if wanted[1] {
            visibility(bench, &mesh, &triangles);
        }
    }
}

const BUILD: &str = "oracle build";
const VERDICT: &str = "oracle verdict";

fn theirs(triangles: &[Triangle], params: BvhBuildParams) -> Bvh2 {
    build_bvh2_from_tris(triangles, params, &mut Duration::default())
}

fn build(bench: &mut Bench<'_>, mesh: &Mesh, triangles: &[Triangle]) {
    let units = mesh.face_count();
    let contenders = vec![
        Contender::new("obvhs fast build", || {
            let work = || theirs(triangles, BvhBuildParams::fast_build());
            timed(work, |tree| primitives(tree.primitive_indices.len()))
        })
        .expects(primitives(units)),
        Contender::new("Oracle::build", || timed(|| Oracle::build(mesh), |_| primitives(units))),
    ];
    bench.run(Group { stage: BUILD, mesh: mesh.name.clone(), units, unit: "triangle", contenders });
}

fn visibility(bench: &mut Bench<'_>, mesh: &Mesh, triangles: &[Triangle]) {
    let oracle = Oracle::build(mesh);
    // The traversal of obvhs gets its better tree, with triangles in leaf order.
    let tree = theirs(triangles, BvhBuildParams::medium_build());
    let leaves: Vec<Triangle> = tree.primitive_indices.iter().map(|&i| triangles[i as usize]).collect();
    let (low, high) = (oracle.bounds().low, oracle.bounds().high);
    let reach = (0..3).map(|i| high[i] - low[i]).fold(0.0, f32::max);
    let place = |x: f32, y: f32, z: f32| -> [f32; 3] {
        let middle = oracle.bounds().center();
        [middle[0] + x * reach, middle[1] + y * reach, middle[2] + z * reach]
    };
    let near = Light::point(place(1.5, 2.0, 2.5)).expect("finite");
    let far = Light::directional([-0.3, -0.8, -0.5]).expect("finite");
    let mut scatter = Scatter(2);
    let count = if bench.quick { 500 } else { 200_000 };
    let scattered: Vec<[f32; 3]> =
        (0..count).map(|_| scatter.point(1.5)).map(|[x, y, z]| place(x, y, z)).collect();
    // As far behind a vertex as the light is in front of it, rounded: the segment to the light misses an edge
    // or two by less than the rounding.
    let behind = |vertex: &[f32; 3]| std::array::from_fn(|i| 2.0 * vertex[i] - near.xyz()[i]);
    let step = mesh.vertex_count().div_ceil(count);
    let aimed: Vec<[f32; 3]> = mesh.positions().iter().step_by(step).map(behind).collect();
    let corners: Vec<[f32; 3]> = mesh.positions().iter().copied().step_by(step).collect();
    let seen =
        visible(&oracle, place(0.4, 0.6, 1.4), oracle.bounds().center(), if bench.quick { 24 } else { 512 });
    for (kind, light, points) in [
        ("scattered, light near", near, &scattered),
        ("scattered, directional", far, &scattered),
        ("view, light near", near, &seen),
        ("view, directional", far, &seen),
        ("aimed at vertices", near, &aimed),
        ("from vertices, directional", far, &corners),
    ] {
        let name = format!("{} · {kind}", mesh.name);
        verdicts(bench, name, &oracle, (&tree, &leaves), &light, points);
    }
}

/// The visible points of the mesh, row by row of a square picture.
fn visible(oracle: &Oracle, eye: [f32; 3], target: [f32; 3], size: usize) -> Vec<[f32; 3]> {
    let (eye, target) = (glam::Vec3::from(eye), glam::Vec3::from(target));
    let ahead = target - eye;
    let right = 0.5 * ahead.length() * ahead.cross(glam::Vec3::Y).normalize();
    let up = 0.5 * ahead.length() * right.cross(ahead).normalize();
    let at = |i: usize| 2.0 * (i as f32 + 0.5) / size as f32 - 1.0;
    (0..size * size)
        .map(|pixel| ahead + at(pixel % size) * right - at(pixel / size) * up)
        .filter_map(|direction| oracle.first_visible(eye.into(), direction.into()))
        .map(|seen| seen.point)
        .collect()
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
    // Expected verdicts count every face on the segment, not only the first.
    let expected: Vec<Verdict> = points.iter().map(|&p| oracle.crossings(p, light).verdict()).collect();
    let of = |verdicts: &[Verdict]| {
        let count = |wanted| verdicts.iter().filter(|&&verdict| verdict == wanted).count();
        format!("shadowed={} grazing={}", count(Verdict::Shadowed), count(Verdict::Grazing))
    };
    let towards = glam::Vec3A::from(light.xyz());
    let shadowed = |&p: &[f32; 3]| {
        let origin = glam::Vec3A::from(p);
        let ray = if light.is_directional() {
            Ray::new_inf(origin, towards)
        } else {
            Ray::new(origin, towards - origin, 0.0, 1.0)
        };
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
        Contender::new("Oracle::verdicts_into", || {
            let work = || {
                let mut found = vec![Verdict::Lit; points.len()];
                oracle.verdicts_into(points, light, &mut found);
                found
            };
            timed(work, |found| {
                assert!(*found == expected, "a verdict of many differs from that of all crossings");
                of(found)
            })
        })
        .expects(of(&expected))
        .aims_at(Target::Ratio(1.25)),
    ];
    bench.run(Group { stage: VERDICT, mesh, units: points.len(), unit: "query", contenders });
}
