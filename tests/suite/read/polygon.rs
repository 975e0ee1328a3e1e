//! Polygons: cut as they are, whichever corner is the first.

use umbrage::check::CrackReport;
use umbrage::geom::Light;
use umbrage::mesh::{Mesh, Weld, weld};
use umbrage::oracle::{Oracle, Verdict};
use umbrage::read::read_bytes;
use umbrage::testing::generate::Bytes;
use umbrage::topology::Topology;

use super::outlines::{comb, plate, spiral, star, u_shape};
use super::scene;
use crate::fuzz::body::polygon::{Answer, Placed, Point, Polygon, cut, drawn, judge, judge_sides, uneven};

const FLAT: Placed = Placed::Plane { slopes: [0, 0], turns: 0 };

fn polygon(corners: Vec<Point>, placed: Placed, simple: bool) -> Polygon {
    Polygon { corners, placed, simple }
}

/// Random bytes from a seed.
fn bytes(seed: u64) -> Vec<u8> {
    let mut state = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;
    let mut next = || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 24) as u8
    };
    (0..160).map(|_| next()).collect()
}

#[test]
fn polygon_outlines_are_cut_alike_from_every_corner() {
    let tilted = Placed::Plane { slopes: [2, -1], turns: 1 };
    for corners in [u_shape(1), u_shape(3), star(7, 40.0), comb(6), spiral(9), plate()] {
        for placed in [FLAT, tilted, Placed::Plane { slopes: [0, 1], turns: 2 }] {
            judge(&polygon(corners.clone(), placed, true), cut);
        }
    }
    judge(&polygon(u_shape(2), Placed::Saddle, true), cut);
    judge(&polygon(spiral(5), Placed::Saddle, true), cut);
}

#[test]
fn polygon_random_ones_are_cut_as_all_pairs_say() {
    let (mut met, mut crossed) = ([0; 2], 0);
    for seed in 0..3000 {
        let polygon = drawn(&mut Bytes::new(&bytes(seed)));
        judge(&polygon, cut);
        met[usize::from(polygon.simple)] += 1;
        let flat: Vec<[f32; 3]> = polygon.corners.iter().map(|&[x, y]| [x as f32, y as f32, 0.0]).collect();
        crossed += usize::from(cut(&flat).1);
    }
    assert!(met[0] > 1000 && met[1] > 1000, "{met:?}");
    assert!(crossed > 500 && crossed < met[0] - 100, "{crossed} of {met:?}");
}

#[test]
fn polygon_uneven_ones_use_every_side_once() {
    // These cross themselves as they are, and do not once their spikes are cut off: what the first try has
    // made must be forgotten, or triangles are lost.
    let spiked: [&[[f32; 3]]; 2] = [
        &[
            [2.0, 3.0, 0.0],
            [0.0, 0.0, 0.0],
            [2.0, 1.0, 1.0],
            [2.0, 3.0, 1.0],
            [0.0, 3.0, 0.0],
            [2.0, 1.0, 1.0],
            [2.0, 2.0, 0.0],
            [4.0, 1.0, 1.0],
        ],
        &[
            [2.0, 1.0, 0.0],
            [4.0, 1.0, 1.0],
            [2.0, 1.0, 1.0],
            [4.0, 2.0, 1.0],
            [4.0, 2.0, 0.0],
            [3.0, 1.0, 1.0],
            [1.0, 2.0, 0.0],
            [1.0, 3.0, 1.0],
            [1.0, 3.0, 0.0],
        ],
    ];
    for positions in spiked {
        assert!(!judge_sides(positions, cut).1, "{positions:?}");
    }
    for seed in 0..2000 {
        let bytes = bytes(seed);
        let mut bytes = Bytes::new(&bytes);
        let polygon = drawn(&mut bytes);
        judge_sides(&uneven(&polygon, &mut bytes), cut);
    }
}

#[test]
fn polygon_quads_take_the_diagonal_inside_and_else_the_shorter_one() {
    // An arrow head; a kite; a rectangle, whose diagonals are as long; two corners at one point; three on a
    // line.
    for corners in [
        [[0, 0], [4, 4], [0, 8], [1, 4]],
        [[0, 0], [3, -1], [9, 0], [3, 1]],
        [[0, 0], [5, 0], [5, 3], [0, 3]],
        [[0, 0], [5, 0], [5, 0], [0, 3]],
        [[0, 0], [2, 0], [5, 0], [0, 3]],
    ] {
        for slopes in [[0, 0], [1, -2]] {
            judge(
                &polygon(corners.to_vec(), Placed::Plane { slopes, turns: 1 }, corners[1] != corners[2]),
                cut,
            );
        }
    }
    let diagonal = |corners: [Point; 4]| {
        let flat = corners.map(|[x, y]| [x as f32, y as f32, 0.0]);
        let (triangles, _) = cut(&flat);
        let shared = (0..4).filter(|corner| triangles.iter().all(|triangle| triangle.contains(corner)));
        shared.map(|corner| corners[corner as usize]).collect::<Vec<_>>()
    };
    assert_eq!(diagonal([[0, 0], [4, 4], [0, 8], [1, 4]]), [[4, 4], [1, 4]], "the only one inside");
    assert_eq!(diagonal([[0, 0], [3, -1], [9, 0], [3, 1]]), [[3, -1], [3, 1]], "the shorter one");
    assert_eq!(diagonal([[5, 0], [5, 3], [0, 3], [0, 0]]), [[5, 3], [0, 0]], "the one with the least corner");
}

/// A prism over an outline of distinct corners (bridges share theirs), its caps begun at corner `first`.
fn prism(outline: &[Point], first: usize) -> String {
    let mut places: Vec<Point> = outline.to_vec();
    places.sort_unstable();
    places.dedup();
    let n = outline.len();
    let vertex = |corner: usize| places.binary_search(&outline[corner % n]).unwrap();
    let mut file = String::new();
    for [x, y] in &places {
        file += &format!("v {x} {y} 0\nv {x} {y} 3\n");
    }
    let cap = |corners: &mut dyn Iterator<Item = usize>, top: usize| -> String {
        corners.map(|corner| format!(" {}", 2 * vertex(corner) + top + 1)).collect()
    };
    file += &format!("f{}\n", cap(&mut (first..first + n), 1));
    file += &format!("f{}\n", cap(&mut (first..first + n).rev(), 0));
    for corner in 0..n {
        let (a, b) = (vertex(corner), vertex(corner + 1));
        // The walls of a bridge would be walked there and back.
        let is_bridge = |back: usize| vertex(back) == b && vertex(back + 1) == a;
        if !(0..n).any(is_bridge) {
            file += &format!("f {} {} {} {}\n", 2 * a + 1, 2 * b + 1, 2 * b + 2, 2 * a + 2);
        }
    }
    file
}

fn report(mesh: &Mesh) -> CrackReport {
    let topology = Topology::of(mesh);
    let mut report = CrackReport::of(mesh, &topology);
    report.add_self_intersections(mesh, &topology, 10);
    report
}

#[test]
fn polygon_prisms_are_sound_whichever_corner_their_caps_begin_at() {
    let area = |outline: &[Point]| -> i64 {
        let next = outline.iter().cycle().skip(1);
        outline.iter().zip(next).map(|(p, q)| p[0] * q[1] - p[1] * q[0]).sum()
    };
    for (outline, euler) in
        [(u_shape(1), 2), (u_shape(2), 2), (comb(4), 2), (spiral(6), 2), (star(5, 3.0), 2), (plate(), 0)]
    {
        let mut shadows = Vec::new();
        for first in 0..outline.len() {
            let scene = scene(prism(&outline, first), "prism.obj");
            let mesh = weld(&scene.meshes[0], Weld::Exact).mesh;
            let counts = report(&mesh).counts;
            assert!(counts.sound(), "corner {first} of {outline:?}: {counts:?}");
            assert_eq!(counts.euler_characteristic, euler, "corner {first} of {outline:?}");
            assert_eq!(
                (counts.self_intersections, counts.zero_area_faces),
                (Some(0), 0),
                "{first} {outline:?}"
            );
            assert_eq!(counts.signed_volume, 1.5 * area(&outline) as f64, "corner {first} of {outline:?}");
            let (oracle, light) = (Oracle::build(&mesh), Light::directional([0.25, 0.125, -1.0]).unwrap());
            let points = (0..400).map(|i| [(i % 20) as f32 - 3.3, (i / 20) as f32 - 3.7, -5.0]);
            shadows.push(points.map(|point| oracle.verdict(point, &light)).collect::<Vec<_>>());
        }
        assert!(shadows.iter().all(|shadow| *shadow == shadows[0]), "{outline:?}");
        assert!(shadows[0].contains(&Verdict::Shadowed) && shadows[0].contains(&Verdict::Lit), "{outline:?}");
    }
}

#[test]
fn polygon_that_crosses_itself_is_said_to_with_its_place() {
    let bow_tie = "v 0 0 0\nv 4 4 0\nv 4 0 0\nv 0 4 0\n";
    let pentagram = "v 0 9 0\nv 6 -8 0\nv -9 3 0\nv 9 3 0\nv -6 -8 0\n";
    let text = format!("{bow_tie}{pentagram}f 1 3 2\nf 5 6 7 8 9\nf 1 2 3 4\n");
    let notes = |text: &str| read_bytes(text.as_bytes(), "a.obj").unwrap().notes;
    let [count, crossed] = notes(&text).try_into().unwrap();
    assert_eq!(count, "2 n-gons cut into triangles");
    assert_eq!(
        crossed,
        "2 polygons cross themselves, so that triangles overlap; the first: line 11, polygon 1"
    );
    let [_, one] = notes(&format!("{bow_tie}f 1 2 3 4\n")).try_into().unwrap();
    assert_eq!(one, "1 polygon crosses itself, so that triangles overlap; the first: line 5, polygon 0");
    // The same corners in another sequence cross nothing; nor does what has no area.
    assert_eq!(notes(&format!("{bow_tie}{pentagram}f 5 8 6 9 7\nf 1 3 2 4\n")).len(), 1);
    assert_eq!(notes("v 0 0 0\nv 1 1 1\nv 3 3 3\nf 1 2 3 2 3\nf 1 2 3 2\n").len(), 1);
}

#[test]
fn polygon_wrong_triangles_fail_the_judge() {
    let fails = |polygon: &Polygon, wrong: &dyn Fn(&[[f32; 3]]) -> Answer| {
        std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| judge(polygon, wrong))).is_err()
    };
    let u = polygon(u_shape(1), FLAT, true);
    let bridged = polygon(plate(), FLAT, true);
    let runs = polygon(u_shape(3), FLAT, true);
    let fan = |points: &[[f32; 3]]| ((1..points.len() as u32 - 1).map(|i| [0, i, i + 1]).collect(), false);
    for polygon in [&u, &bridged, &runs] {
        assert!(!fails(polygon, &cut));
        assert!(fails(polygon, &fan), "a fan around the first corner");
        assert!(fails(polygon, &|points| (cut(points).0, true)), "said to cross itself");
        let without_one = |points: &[[f32; 3]]| {
            let (mut triangles, crosses) = cut(points);
            triangles[0] = triangles[1];
            (triangles, crosses)
        };
        assert!(fails(polygon, &without_one), "a side without a triangle");
        let turned = |points: &[[f32; 3]]| {
            let (mut triangles, crosses) = cut(points);
            triangles[0].swap(0, 1);
            (triangles, crosses)
        };
        assert!(fails(polygon, &turned), "a triangle turned over");
    }
    // The other diagonal, where the first corner happens to be another one.
    let square = polygon(vec![[0, 0], [4, 0], [4, 4], [0, 4]], FLAT, true);
    assert!(!fails(&square, &cut) && fails(&square, &fan), "a square, cut from its first corner");
    let pentagon = polygon(vec![[0, 0], [4, 0], [5, 3], [2, 6], [0, 3]], FLAT, true);
    assert!(!fails(&pentagon, &cut) && fails(&pentagon, &fan), "a convex one, cut from its first corner");
    let pentagram = polygon(vec![[0, 9], [6, -8], [-9, 3], [9, 3], [-6, -8]], FLAT, false);
    assert!(!fails(&pentagram, &cut));
    assert!(fails(&pentagram, &|points| (cut(points).0, false)), "its crossing not said");
}
