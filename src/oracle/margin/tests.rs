//! Moves within the margin change no verdict; a margin that is too large is caught; and it is not much less
//! than it could be.

use glam::DVec3;

use super::distance::{Points, ROUNDING, apart_less, nearest};
use super::*;
use crate::mesh::{FaceId, Mesh};
use crate::oracle::intersect;
use crate::random::SplitMix64;
use crate::testing::shapes;

fn meshes() -> Vec<Mesh> {
    let mut random = SplitMix64(5);
    let mut number = || (random.below(33) as f32 - 16.0) / 8.0;
    let soup = |faces: u32, number: &mut dyn FnMut() -> f32| {
        let positions = (0..3 * faces).map(|_| [number(), number(), number()]).collect();
        Mesh::new(positions, (0..faces).map(|face| [3 * face, 3 * face + 1, 3 * face + 2]).collect()).unwrap()
    };
    vec![
        shapes::icosphere(1),
        shapes::torus(12, 8, 2.0, 0.7),
        shapes::menger_sponge(1),
        soup(1, &mut number),
        soup(6, &mut number),
        soup(40, &mut number),
        shapes::translated(&shapes::icosphere(1), [3000.0, -50.0, 0.25]),
        shapes::scaled(&shapes::torus(12, 8, 2.0, 0.7), 1e-20),
        shapes::scaled(&shapes::icosphere(1), 1e30),
        shapes::double_sheet(),
    ]
}

/// Points and lights around a mesh.
fn queries(mesh: &Mesh, random: &mut SplitMix64, count: usize) -> Vec<([f32; 3], Light)> {
    let [low, high] = mesh.bounds().unwrap();
    let mut near = |spread: f64| -> [f32; 3] {
        std::array::from_fn(|i| {
            let [low, high] = [low[i], high[i]].map(f64::from);
            ((low + high) / 2.0 + (random.unit() - 0.5) * spread * (high - low).max(1e-30)) as f32
        })
    };
    let mut queries = Vec::new();
    for k in 0..count {
        let (p, at, far) = (near(1.6), near(3.0), near(1e6));
        let light = match k % 4 {
            0 => Light::point(far),
            1 => Light::directional([0, 1, 2].map(|i| p[i] - at[i])),
            _ => Light::point(at),
        };
        queries.push((p, light.unwrap()));
    }
    queries
}

/// The margin by every face, and the directions towards or from what limits it.
fn naive(mesh: &Mesh, oracle: &Oracle, p: [f32; 3], light: &Light) -> (f64, Vec<DVec3>) {
    let view = View::of(oracle, p, light).unwrap();
    let segment = Points::of(&[[0.0; 3], view.end]);
    let faces = (0..mesh.face_count()).map(|face| mesh.corners(FaceId::new(face)));
    let meetings: Vec<_> = faces.map(|face| (face, intersect(p, light, face))).collect();
    let crossed = meetings.iter().filter(|(_, meeting)| matches!(meeting, Intersection::Crossing(_)));
    let crossed: Vec<_> = crossed.map(|(face, _)| *face).collect();
    if crossed.is_empty() {
        if meetings.iter().any(|(_, meeting)| *meeting == Intersection::Touching) {
            return (0.0, Vec::new());
        }
        let all = meetings.iter().map(|(face, _)| (view.stays_clear_of(face), *face));
        let (least, face) = all.min_by(|a, b| a.0.total_cmp(&b.0)).unwrap();
        return (least, vec![nearest(&segment, &Points::of(&view.seen(&face)))]);
    }
    let all = crossed.iter().map(|face| (view.keeps_crossing(face), *face));
    let (largest, face) = all.max_by(|a, b| a.0.total_cmp(&b.0)).unwrap();
    let [a, b, c] = view.seen(&face);
    let ends = [[0.0; 3], view.end].map(|end| nearest(&Points::of(&[end]), &Points::of(&[a, b, c])));
    let edges = [[a, b], [b, c], [c, a]].map(|edge| nearest(&segment, &Points::of(&edge)));
    (largest, ends.into_iter().chain(edges).collect())
}

fn moved(p: [f32; 3], by: DVec3) -> [f32; 3] {
    [0, 1, 2].map(|i| (f64::from(p[i]) + by[i]) as f32)
}

/// How far `q` is from `p`; the difference and its length round up by less than the factor.
fn distance(p: [f32; 3], q: [f32; 3]) -> f64 {
    DVec3::from([0, 1, 2].map(|i| f64::from(p[i]) - f64::from(q[i]))).length() * (1.0 + 1e-15)
}

/// The verdict after point and light have moved, if they could by less than `most`.
fn verdict_moved(oracle: &Oracle, p: [f32; 3], light: &Light, by: DVec3, most: f64) -> Option<Verdict> {
    let q = moved(p, by);
    let mut there = *light;
    if !light.is_directional() {
        let at = moved(light.xyz(), by);
        if distance(at, light.xyz()) >= most {
            return None;
        }
        there = Light::point(at).ok()?;
    }
    (distance(p, q) < most).then(|| oracle.verdict(q, &there))
}

#[derive(Default, Debug)]
struct Found {
    /// Moves that were made, and those after which the verdict was another one.
    moves: usize,
    wrong: usize,
    /// Queries that are lit, and that one face shadows; and those of them whose verdict a move by less than
    /// twice the margin changes.
    count: [usize; 2],
    tight: [usize; 2],
}

/// Asks all queries, with moves of less than `scale` times the margin.
fn survey(scale: f64) -> Found {
    let mut random = SplitMix64(17);
    let mut found = Found::default();
    for mesh in meshes() {
        let oracle = Oracle::build(&mesh);
        for (p, light) in queries(&mesh, &mut random, 60) {
            let margin = oracle.margin(p, &light);
            let verdict = oracle.verdict(p, &light);
            let (_, limits) = naive(&mesh, &oracle, p, &light);
            if margin == 0.0 {
                continue;
            }
            let mut ways: Vec<DVec3> = limits.iter().flat_map(|&way| [way, -way]).collect();
            ways.extend((0..6).map(|_| DVec3::from([(); 3].map(|()| random.unit() - 0.5))));
            let ways: Vec<DVec3> = ways.into_iter().filter_map(DVec3::try_normalize).collect();
            for by in ways.iter().flat_map(|&way| [0.5, 0.97, 0.9999].map(|part| part * scale * margin * way))
            {
                if let Some(after) = verdict_moved(&oracle, p, &light, by, scale * margin) {
                    found.moves += 1;
                    found.wrong += usize::from(after != verdict);
                }
            }
            // Where two faces are crossed, one of them keeps the shadow when the other is left.
            let crossings = oracle.crossings(p, &light);
            if crossings.front + crossings.back > 1 {
                continue;
            }
            let kind = usize::from(verdict == Verdict::Shadowed);
            found.count[kind] += 1;
            let flips = |way: &DVec3| {
                [1.01, 1.1, 1.4, 1.95].iter().any(|part| {
                    let after = verdict_moved(&oracle, p, &light, part * margin * *way, 2.0 * margin);
                    after.is_some_and(|after| after != verdict)
                })
            };
            found.tight[kind] += usize::from(ways.iter().any(flips));
        }
    }
    found
}

#[test]
fn margin_is_kept_by_every_move_within_it_and_a_larger_one_is_not() {
    let found = survey(1.0);
    assert_eq!(found.wrong, 0, "{found:?}");
    assert!(found.moves > 5000 && found.count.iter().all(|&count| count > 40), "{found:?}");
    // Not vacuous: for most lit queries, and for those of one face unless a neighbor of it takes over, less
    // than twice the margin changes the verdict.
    let [lit, shadowed] = [0, 1].map(|kind| found.tight[kind] as f64 / found.count[kind] as f64);
    assert!(lit > 0.8 && shadowed > 0.4, "{found:?}");
    // Fault injected: half as much again.
    let larger = survey(1.5);
    assert!(larger.wrong > 200, "{larger:?}");
}

#[test]
fn margin_by_the_tree_is_that_of_all_faces() {
    let mut random = SplitMix64(23);
    let (mut same, mut all) = (0, 0);
    for mesh in meshes() {
        let oracle = Oracle::build(&mesh);
        for (p, light) in queries(&mesh, &mut random, 40) {
            let (margin, (naive, _)) = (oracle.margin(p, &light), naive(&mesh, &oracle, p, &light));
            // The tree leaves out faces that are surely farther, whose bounds may be worse.
            assert!(margin >= naive, "{margin} {naive}");
            same += usize::from(margin == naive);
            all += 1;
        }
    }
    assert!(100 * same > 99 * all, "{same} of {all}");
    assert_eq!(
        Oracle::build(&Mesh::default()).margin([0.0; 3], &"point:1,2,3".parse().unwrap()),
        f64::INFINITY
    );
}

/// Points that lie exactly on faces in slanted planes: multiples of the sides added up, without rounding.
fn on_faces(apart: impl Fn(Points, Points) -> f64) -> (usize, usize) {
    let mut random = SplitMix64(3);
    let mut number = || random.below(4096) as f64 - 2048.0;
    let (mut apart_ones, mut all) = (0, 0);
    for _ in 0..2000 {
        let [a, u, v] = [(); 3].map(|()| [number(), number(), number()]);
        let at = |s: f64, t: f64| [0, 1, 2].map(|i| a[i] + s * u[i] + t * v[i]);
        let triangle = [at(0.0, 0.0), at(64.0, 0.0), at(0.0, 64.0)];
        let p = at(13.0, 29.0);
        // As the margin sees it: from the point, with a light on one side.
        let seen = triangle.map(|corner| [0, 1, 2].map(|i| corner[i] - p[i]));
        let light = [number(), number(), number()];
        apart_ones += usize::from(apart(Points::of(&[[0.0; 3], light]), Points::of(&seen)) > 0.0);
        all += 1;
    }
    (apart_ones, all)
}

#[test]
fn margin_of_a_point_on_a_face_is_zero_and_without_the_rounding_it_is_not() {
    assert_eq!(on_faces(|a, b| apart_less(a, b, ROUNDING)).0, 0);
    let (apart_ones, all) = on_faces(|a, b| apart_less(a, b, 0.0));
    assert!(apart_ones > all / 100, "{apart_ones} of {all}");
}

#[test]
fn margin_of_ties_is_zero_and_of_a_cube_what_can_be_told_by_hand() {
    let oracle = Oracle::build(&shapes::cube());
    let margin = |p, light: &str| oracle.margin(p, &light.parse().unwrap());
    let about = |value: f64, wanted: f64| value <= wanted && value > wanted * (1.0 - 1e-6);
    assert_eq!(margin([0.0, -2.0, 1.0], "directional:0,-1,0"), 0.0); // along a side
    assert_eq!(margin([0.0, 1.0, 0.0], "point:0,5,0"), 0.0); // on the top
    assert!(about(margin([0.25, 1.5, 0.0], "point:0.25,9,0"), 0.5)); // above the top
    assert!(about(margin([3.0, 0.0, 0.0], "directional:0,-1,0"), 2.0)); // beside it
    // Below the bottom by 1/2; the sides, and the diagonals, are farther.
    assert!(about(margin([0.0, -1.5, 0.6], "directional:0,-1,0"), 0.4));
}
