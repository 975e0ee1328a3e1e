//! The search against a comparison of each face with each, and how many tests it takes.

use super::triangles::{Corners, intersect};
use super::*;
use crate::random::SplitMix64;
use crate::testing::shapes;

/// `count` triangles, each through all others, without a common vertex.
fn heap(count: u32) -> (Mesh, Topology) {
    let one = Mesh::new(vec![[0.0; 3], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]], vec![[0, 1, 2]]).unwrap();
    let mesh = shapes::soup(&Mesh::concat(&vec![one; count as usize]).unwrap());
    let topology = Topology::of(&mesh);
    (mesh, topology)
}

fn found(mesh: &Mesh, faces: &[FaceId], mut tests: u64) -> (Vec<[FaceId; 2]>, ControlFlow<()>) {
    let mut pairs = Vec::new();
    let end = for_each_intersection_among(mesh, faces, &mut tests, |pair| {
        pairs.push(pair);
        ControlFlow::Continue(())
    });
    (pairs, end)
}

#[test]
fn intersections_of_more_pairs_than_are_held_come_once_each() {
    let (mesh, topology) = heap(150);
    let all: Vec<[FaceId; 2]> =
        (0..150).flat_map(|f| (f + 1..150).map(move |g| [FaceId(f), FaceId(g)])).collect();
    assert!(all.len() > search::MOST_HELD, "one task holds them all");
    assert_eq!(self_intersections(&mesh, &topology), all);
    // With one face too few the comparison fails.
    let fewer: Vec<FaceId> = topology.faces().skip(1).collect();
    assert_ne!(found(&mesh, &fewer, u64::MAX).0.len(), all.len());
}

#[test]
fn intersections_end_where_tests_do() {
    for count in [20, 150] {
        let (mesh, topology) = heap(count);
        let faces: Vec<FaceId> = topology.faces().collect();
        let (all, end) = found(&mesh, &faces, u64::MAX);
        assert!(end.is_continue() && all.len() as u32 == count * (count - 1) / 2);
        let (some, end) = found(&mesh, &faces, 100);
        assert!(end.is_break() && some.len() <= 100, "{} pairs", some.len());
    }
}

/// Pairs by comparing each face with each.
fn naive(mesh: &Mesh, topology: &Topology) -> Vec<[FaceId; 2]> {
    let with_area = |&face: &FaceId| {
        let [a, b, c] = mesh.corners(face);
        !topology.is_collapsed(face) && !collinear(a, b, c)
    };
    let faces: Vec<FaceId> = topology.faces().filter(with_area).collect();
    let corners: Vec<Corners> = faces.iter().map(|&face| Corners::of(mesh, face)).collect();
    let mut pairs = Vec::new();
    for i in 0..faces.len() {
        pairs.extend(
            (i + 1..faces.len())
                .filter(|&j| intersect(&corners[i], &corners[j]))
                .map(|j| [faces[i], faces[j]]),
        );
    }
    pairs
}

/// Faces around one vertex, or most of them around one edge, on a coarse lattice: many touch or repeat.
fn lattice_fan(seed: u64, around_edge: bool) -> Mesh {
    let mut random = SplitMix64(seed);
    let mut whole = |most: usize| random.below(most) as f32 - (most / 2) as f32;
    let mut positions = vec![[0.0; 3], [0.0, 0.0, 6.0]];
    positions.extend((0..120).map(|_| [whole(17), whole(17), whole(17)]));
    let mut random = SplitMix64(seed ^ 0xfa4);
    let mut any = || 2 + random.below(120) as u32;
    let triangles = (0..140)
        .map(|i| match i % 8 {
            0 => [any(), any(), any()],
            1..6 if around_edge => [0, 1, any()],
            _ => [0, any(), any()],
        })
        .collect();
    Mesh::new(positions, triangles).unwrap()
}

#[test]
fn intersections_around_a_vertex_or_an_edge_are_those_of_all_pairs() {
    let mut met = 0;
    for seed in 0..60 {
        let mesh = lattice_fan(seed, seed % 2 == 1);
        let topology = Topology::of(&mesh);
        let faces: Vec<u32> = (0..140).collect();
        let corners = |face: u32| Corners::of(&mesh, FaceId(face));
        assert!(!fans::fans(&faces, &corners).is_empty(), "{seed}: no face is compared by direction");
        let expected = naive(&mesh, &topology);
        assert_eq!(self_intersections(&mesh, &topology), expected, "{seed}");
        met += expected.len();
    }
    assert!(met > 10_000, "{met} pairs");
}

#[test]
fn intersections_of_a_fan_without_the_bulge_of_its_arcs_would_be_lost() {
    // A long arc and a short one that cross at its highest point.
    let positions = vec![[0.0; 3], [8.0, 0.0, 8.0], [-8.0, 0.0, 8.0], [0.0, 1.0, 8.0], [0.0, -1.0, 8.0]];
    let mesh = Mesh::new(positions, vec![[0, 1, 2], [0, 3, 4]]).unwrap();
    let corners = [0, 1].map(|face| Corners::of(&mesh, FaceId(face)));
    assert!(intersect(&corners[0], &corners[1]));
    let [one, other] = corners.map(|corners| fans::arc_box(&corners, 0));
    assert!(one.overlaps(&other));
    // Fault injected: the box around the ends alone, in directions.
    let ends = |corners: &Corners| {
        let unit = |p: [f32; 3]| {
            let length = p.iter().map(|x| x * x).sum::<f32>().sqrt();
            p.map(|x| x / length)
        };
        crate::geom::Aabb::around([unit(corners.at[1]), unit(corners.at[2])])
    };
    assert!(!ends(&corners[0]).overlaps(&ends(&corners[1])));
}

/// A convex polygon of `count` corners on a parabola, all coordinates integers: nothing is rounded.
fn parabola(count: i32) -> Vec<[f32; 3]> {
    (0..count).map(|i| i - count / 2).map(|i| [i as f32, (i * i) as f32, 0.0]).collect()
}

/// The polygon as a cap cut from one corner, or zigzag; aslant, with integers.
fn cap(count: u32, zigzag: bool) -> Mesh {
    let positions = parabola(count as i32).into_iter().map(|[x, y, _]| [x + y, y - 2.0 * x, x - y]).collect();
    let fan = || (1..count - 1).map(|i| [0, i, i + 1]).collect();
    let strip = || {
        let (mut low, mut high) = (0, count - 1);
        (0..count - 2)
            .map(|step| {
                let corner = [low, if step % 2 == 0 { low + 1 } else { high - 1 }, high];
                if step % 2 == 0 {
                    low += 1;
                } else {
                    high -= 1;
                }
                corner
            })
            .collect()
    };
    Mesh::new(positions, if zigzag { strip() } else { fan() }).unwrap()
}

/// Two cones of `count` faces over a convex polygon; `lift` pulls every second corner of it up.
fn bipyramid(count: u32, lift: f32) -> Mesh {
    let mut positions = parabola(count as i32);
    positions.iter_mut().step_by(2).for_each(|p| p[2] = lift);
    let middle = (count * count / 8) as f32;
    positions.extend([[0.0, middle, middle], [1.0, middle, -middle]]);
    let side = |i: u32| (i, (i + 1) % count);
    let top = (0..count).map(side).map(|(i, j)| [i, j, count]);
    let bottom = (0..count).map(side).map(|(i, j)| [j, i, count + 1]);
    Mesh::new(positions, top.chain(bottom).collect()).unwrap()
}

/// The pairs, and the number of tests that they took.
fn counted(mesh: &Mesh) -> (usize, u64) {
    let (mut pairs, most) = (0, 1 << 40);
    let mut tests = most;
    let end = for_each_within(mesh, &Topology::of(mesh), &mut tests, |_| {
        pairs += 1;
        ControlFlow::Continue(())
    });
    assert!(end.is_continue());
    (pairs, most - tests)
}

/// The same with its last face gone, so that it is not closed.
fn opened(mesh: &Mesh) -> Mesh {
    let faces = mesh.triangles().len() - 1;
    Mesh::new(mesh.positions().to_vec(), mesh.triangles()[..faces].to_vec()).unwrap()
}

#[test]
fn intersections_around_poles_and_in_caps_take_few_tests() {
    let spike = |mesh: &Mesh, at: [f32; 3]| {
        let spike = shapes::translated(&shapes::scaled(&shapes::tetrahedron(), 0.25), at);
        Mesh::concat(&[mesh.clone(), spike]).unwrap()
    };
    for (name, mesh) in [
        ("cap", cap(2000, false)),
        ("zigzag cap", cap(2000, true)),
        ("bipyramid", bipyramid(2000, 0.0)),
        ("pleated bipyramid", bipyramid(2000, 2.0)),
        ("open bipyramid", opened(&bipyramid(2000, 0.0))),
        ("tilted bipyramid", opened(&bipyramid(1000, 7.0))),
    ] {
        let (pairs, tests) = counted(&mesh);
        let few = 300 * mesh.face_count() as u64;
        assert!(
            pairs == 0 && tests < few,
            "{name}: {pairs} pairs, {tests} tests of {} faces",
            mesh.face_count()
        );
        // Fault injected: a small solid through one of its faces is found, however many faces there are.
        let [a, b, c] = mesh.corners(FaceId::new(mesh.face_count() / 3));
        let middle = [0, 1, 2].map(|i| (a[i] + b[i] + c[i]) / 3.0);
        assert!(counted(&spike(&mesh, middle)).0 > 0, "{name}");
    }
}

#[test]
fn intersections_of_copies_and_of_pages_are_counted_not_tested() {
    // A triangle 3000 times, and one through it: each copy meets that one, and none another.
    let positions =
        vec![[0.0; 3], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0], [1.0, 1.0, -1.0], [1.0, 1.0, 1.0], [9.0, 9.0, 1.0]];
    let mut triangles = vec![[0, 1, 2]; 3000];
    triangles.push([3, 4, 5]);
    let (pairs, tests) = counted(&Mesh::new(positions, triangles).unwrap());
    assert!(pairs == 3000 && tests < 100, "{pairs} pairs, {tests} tests");
    // 3000 pages on one edge, all in other directions, and two in one.
    let mut positions = vec![[0.0; 3], [0.0, 0.0, 1.0]];
    positions.extend((0..3000).map(|i| [(i - 1500) as f32, 2000.0, 0.0]));
    positions.extend([[0.0, -1.0, 0.0], [0.0, -2.0, 5.0]]);
    let pages =
        |count: u32| Mesh::new(positions.clone(), (2..2 + count).map(|i| [0, 1, i]).collect()).unwrap();
    let [all, fewer] = [3002, 3001].map(|count| counted(&pages(count)));
    assert!(all.0 == 1 && fewer.0 == 0 && all.1 < 10_000, "{all:?} {fewer:?}");
}

/// Faces around the origin in one plane, aslant: blades apart from each other, all with the hub in common.
fn windmill(count: u32) -> Mesh {
    let at = |i: u32| {
        let angle = f64::from(i) / f64::from(2 * count) * std::f64::consts::TAU;
        // Integer coordinates, so that the plane is exact.
        let [x, y] = [angle.cos(), angle.sin()].map(|x| (1e5 * x).round() as f32);
        [x, y, x + y]
    };
    let positions = std::iter::once([0.0; 3]).chain((0..2 * count).map(at)).collect();
    Mesh::new(positions, (0..count).map(|i| [0, 1 + 2 * i, 2 + 2 * i]).collect()).unwrap()
}

/// Two fans in one plane, aslant, on both sides of a straight row of vertices: faces of the one have a vertex
/// and the plane in common with faces of the other, and their upright boxes overlap those of all of them.
fn butterfly(count: u32, middle: f32) -> Mesh {
    let row = (0..=count).map(|i| [i as f32, i as f32, 0.0]);
    let hubs = [[middle, middle + 900.0, 900.0], [middle, middle - 900.0, -900.0]];
    let positions = hubs.into_iter().chain(row).collect();
    let faces = (0..count).flat_map(|i| [[0, 2 + i, 3 + i], [1, 3 + i, 2 + i]]).collect();
    Mesh::new(positions, faces).unwrap()
}

#[test]
fn intersections_of_flat_fans_take_few_tests() {
    for (name, small, large) in [
        ("windmill", windmill(250), windmill(1000)),
        ("butterfly", butterfly(250, 0.0), butterfly(1000, 0.0)),
        ("butterfly of two sides", butterfly(250, 125.0), butterfly(1000, 500.0)),
    ] {
        let [few, many] = [&small, &large].map(counted);
        assert!(few.0 == 0 && many.0 == 0, "{name}: {few:?} {many:?}");
        // Four times as many faces: sixteen times as many tests would be a comparison of all pairs.
        assert!(many.1 < 300 * large.face_count() as u64, "{name}: {many:?}");
        assert!(many.1 < 8 * few.1.max(1000), "{name}: {few:?} {many:?}");
        // Fault injected: a face of another fan on the first one.
        let [hub, a, b] = large.triangles()[0];
        let mut positions = large.positions().to_vec();
        let moved = large.positions()[a as usize].map(|x| 0.5 * x);
        positions.push(moved);
        let mut triangles = large.triangles().to_vec();
        triangles.push([hub, positions.len() as u32 - 1, b]);
        assert!(counted(&Mesh::new(positions, triangles).unwrap()).0 > 0, "{name}");
    }
}
