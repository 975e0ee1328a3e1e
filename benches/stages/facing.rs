//! The side of every face on which a light lies.

use std::ops::Range;

use umbrage::facing::{FaceClusters, FacePlanes, FacingRanges, classify};
use umbrage::geom::{Facing, Light};
use umbrage::mesh::Mesh;

use crate::measure::{Bench, Contender, Group, Target, timed};

pub(crate) fn run(bench: &mut Bench<'_>) {
    if !bench.wants("facing") {
        return;
    }
    let point = Light::point([3.0, 4.0, 5.0]).expect("finite");
    let axis = Light::directional([0.0, 0.0, -1.0]).expect("not zero");
    let corner = Light::point([0.0; 3]).expect("finite");
    facing(bench, &crate::ordered(bench.quick), &point, "point light");
    facing(bench, &crate::scattered(bench.quick), &point, "point light");
    let tied = crate::tied(bench.quick);
    facing(bench, &tied, &axis, "light along an axis");
    facing(bench, &tied, &corner, "light on a corner");
}

fn facing(bench: &mut Bench<'_>, mesh: &Mesh, light: &Light, what: &str) {
    let expected = classify(mesh, light);
    let planes = FacePlanes::new(mesh);
    let (clusters, mut ranges) = (FaceClusters::new(mesh, &planes), FacingRanges::default());
    let of = |sides: &[Facing]| {
        let count = |side| sides.iter().filter(|&&other| other == side).count();
        format!("front={} edge_on={}", count(Facing::Front), count(Facing::EdgeOn))
    };
    let right = of(&expected);
    let mut sides = vec![Facing::EdgeOn; mesh.face_count()];
    let (mut naive_sides, mut plain_sides) = (sides.clone(), sides.clone());
    let plain = plain_planes(mesh);
    let contenders = vec![
        Contender::new("f32 cross product", || {
            timed(
                || naive(mesh, light, &mut naive_sides),
                |sides| {
                    let wrong = sides.iter().zip(&expected).filter(|(a, b)| a != b).count();
                    format!("{} wrong={wrong}", of(sides))
                },
            )
        })
        // Reads three indices of 4 and half a position of 12; writes 1.
        .moves(12.0 + 6.0 + 1.0),
        Contender::new("FacePlanes::classify_into", || {
            timed(
                || {
                    let exact = planes.classify_into(mesh, light, &mut sides);
                    (exact, &sides)
                },
                |(exact, sides)| {
                    assert!(**sides == expected, "the sides differ from the predicate's");
                    format!("{} by_predicate={exact}", of(sides))
                },
            )
        })
        // Reads four numbers of 2; writes 1.
        .moves(8.0 + 1.0)
        .aims_at(Target::Time(0.35)),
        Contender::new("FaceClusters::find", || {
            timed(
                || {
                    clusters.find(mesh, &planes, light, &mut ranges);
                    &ranges
                },
                |ranges| {
                    let single = |side| ranges.single.iter().filter(|single| single.1 == side).count();
                    let all = |list: &[Range<u32>]| list.iter().map(|range| range.len()).sum::<usize>();
                    let front = all(&ranges.front) + single(Facing::Front);
                    let back = all(&ranges.back) + single(Facing::Back);
                    assert_eq!(format!("front={front} edge_on={}", mesh.face_count() - front - back), right);
                    let count = ranges.front.len() + ranges.back.len();
                    format!("ranges={count} single={}", ranges.single.len())
                },
            )
        }),
        Contender::new("f32 planes without a filter", || {
            timed(
                || unfiltered(&plain, light, &mut plain_sides),
                |sides| {
                    let wrong = sides.iter().zip(&expected).filter(|(a, b)| a != b).count();
                    format!("{} wrong={wrong}", of(sides))
                },
            )
        })
        .moves(16.0 + 1.0),
        Contender::new("classify (f64 filter)", || timed(|| classify(mesh, light), |sides| of(sides)))
            .expects(&*right)
            .moves(12.0 + 6.0 + 1.0),
        Contender::new("FacePlanes::new", || timed(|| FacePlanes::new(mesh), |_| String::new()))
            .moves(12.0 + 6.0 + 28.0),
        Contender::new("FaceClusters::new", || timed(|| FaceClusters::new(mesh, &planes), |_| String::new())),
    ];
    let name = format!("{}, {what}", mesh.name).replace(',', " ·");
    bench.run(Group { stage: "facing", mesh: name, units: mesh.face_count(), unit: "triangle", contenders });
}

/// The usual method of shadow-volume demos: fast, and wrong where rounding decides.
fn naive<'a>(mesh: &Mesh, light: &Light, sides: &'a mut [Facing]) -> &'a [Facing] {
    let [x, y, z, w] = light.homogeneous();
    for (side, &corners) in sides.iter_mut().zip(mesh.triangles()) {
        let [a, b, c] = corners.map(|vertex| mesh.positions()[vertex as usize]);
        let (u, v) = ([b[0] - a[0], b[1] - a[1], b[2] - a[2]], [c[0] - a[0], c[1] - a[1], c[2] - a[2]]);
        let n = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
        let s = n[0] * (x - w * a[0]) + n[1] * (y - w * a[1]) + n[2] * (z - w * a[2]);
        *side = if s > 0.0 {
            Facing::Front
        } else if s < 0.0 {
            Facing::Back
        } else {
            Facing::EdgeOn
        };
    }
    sides
}

/// Normals and offsets of the face planes, one array per component, relative to the world's origin.
fn plain_planes(mesh: &Mesh) -> [Vec<f32>; 4] {
    let mut planes = [(); 4].map(|()| Vec::with_capacity(mesh.face_count()));
    for &corners in mesh.triangles() {
        let [a, b, c] =
            corners.map(|vertex| glam::DVec3::from(mesh.positions()[vertex as usize].map(f64::from)));
        let normal = (b - a).cross(c - a).normalize_or_zero();
        for (list, number) in planes.iter_mut().zip([normal.x, normal.y, normal.z, -normal.dot(a)]) {
            list.push(number as f32);
        }
    }
    planes
}

/// The usual loop over planes: no error bound, wrong where rounding decides.
fn unfiltered<'a>([x, y, z, d]: &[Vec<f32>; 4], light: &Light, sides: &'a mut [Facing]) -> &'a [Facing] {
    let l = light.homogeneous();
    for ((((side, x), y), z), d) in sides.iter_mut().zip(x).zip(y).zip(z).zip(d) {
        let s = (x * l[0] + y * l[1]) + (z * l[2] + d * l[3]);
        *side = if s > 0.0 { Facing::Front } else { Facing::Back };
    }
    sides
}
