//! The grid against the exact ray cast: what it proves is true, on any mesh, and each rule that is broken is
//! caught.

use super::fault::{Fault, Faults};
use super::*;
use crate::caster::{Caster, CasterGroup};
use crate::geom::predicate::side_of_light;
use crate::geom::{Aabb, Light};
use crate::mesh::Mesh;
use crate::oracle::{PrimaryHit, Verdict};
use crate::random::SplitMix64;
use crate::scene::Lamp;
use crate::testing::generate;
use crate::testing::shapes;

/// What became of the points.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Tally {
    pub(super) wrong: u64,
    pub(super) decided: u64,
    pub(super) all: u64,
}

impl Tally {
    pub(super) fn add(&mut self, verdict: GridVerdict, truth: Verdict) {
        self.all += 1;
        self.decided += u64::from(verdict != GridVerdict::Undecided);
        self.wrong += u64::from(matches!(
            (verdict, truth),
            (GridVerdict::Lit, Verdict::Shadowed) | (GridVerdict::Dark, Verdict::Lit)
        ));
    }
}

/// A generated mesh, a shape or a scene of several, with a light that is hard for it.
pub(super) fn case(random: &mut SplitMix64) -> (Vec<Mesh>, Light) {
    let meshes = match random.below(8) {
        0 => vec![shapes::torus(13, 9, 2.0, 0.75)],
        1 => vec![shapes::book(4 + random.below(5) as u32)],
        2 => vec![shapes::mobius(16), shapes::sheet(5)],
        3 => vec![shapes::icosphere(2), shapes::translated(&shapes::open_cube(), [0.5, 1.5, -2.0])],
        4 => vec![shapes::sheet(6), generate::mesh(random)],
        _ => vec![generate::mesh(random)],
    };
    let among = random.below(meshes.len());
    let light = match random.below(3) {
        0 => generate::light(random, &meshes[among]),
        1 => {
            let travel = [(); 3].map(|()| random.unit() as f32 - 0.5);
            Light::directional(travel).unwrap()
        }
        _ => Light::point([(); 3].map(|()| 12.0 * random.unit() as f32 - 6.0)).unwrap(),
    };
    (meshes, light)
}

/// A point of a box that is enlarged about its center.
fn within(random: &mut SplitMix64, bounds: &Aabb, enlarged: f64) -> [f32; 3] {
    let center = bounds.center();
    [0, 1, 2].map(|i| {
        let side = f64::from(bounds.high[i]) - f64::from(bounds.low[i]) + 0.5;
        (f64::from(center[i]) + enlarged * (random.unit() - 0.5) * side) as f32
    })
}

/// A generated mesh of moderate size, and a lamp with an extent near it.
pub(super) fn scattered(random: &mut SplitMix64) -> (Mesh, Lamp) {
    loop {
        let mesh = generate::mesh(random);
        let most = mesh.positions().iter().flatten().fold(0.0_f32, |most, x| most.max(x.abs()));
        if !(0.1..100.0).contains(&most) {
            continue;
        }
        let [x, y, z] = [(); 3].map(|()| most * (6.0 * random.unit() as f32 - 3.0));
        let size = 10.0_f64.powf(-2.0 * random.unit() - 0.5);
        let text = match random.below(2) {
            0 => format!("point:{x},{y},{z},radius={}", f64::from(most) * size),
            _ => format!("directional:{x},{y},{z},angle={}", 20.0 * size),
        };
        if let Ok(lamp) = text.parse() {
            return (mesh, lamp);
        }
    }
}

/// Visible points that face the light, seen from random eyes, and points anywhere.
pub(super) fn points(
    random: &mut SplitMix64,
    casters: &CasterGroup<'_>,
    light: &Light,
    count: usize,
) -> (Vec<PrimaryHit>, Vec<[f32; 3]>) {
    let bounds = casters.bounds();
    let is_finite = |p: &[f32; 3]| p.iter().all(|x| x.is_finite());
    let mut hits = Vec::new();
    for _ in 0..2 * count {
        let (eye, target) = (within(random, &bounds, 3.0), within(random, &bounds, 0.8));
        let direction = [0, 1, 2].map(|i| target[i] - eye[i]);
        let hit =
            [eye, direction].iter().all(is_finite).then(|| casters.seen().first_visible(eye, direction));
        hits.extend(hit.flatten().filter(|hit| side_of_light(hit.corners, light) == hit.side));
    }
    let free = (0..count).map(|_| within(random, &bounds, 1.5)).filter(is_finite).collect();
    (hits, free)
}

fn tally(grid: &LightGrid<'_>, casters: &CasterGroup<'_>, hits: &[PrimaryHit], free: &[[f32; 3]]) -> Tally {
    let (oracle, light, mut tally) = (casters.oracle(), grid.chain.light(), Tally::default());
    for hit in hits {
        tally.add(grid.verdict(hit), oracle.verdict(hit.point, light));
    }
    for &p in free {
        tally.add(grid.verdict_at(p), oracle.verdict(p, light));
    }
    tally
}

fn grid_of<'a>(
    chain: &'a Chain<'a>,
    hits: &[PrimaryHit],
    free: &[[f32; 3]],
    side: u32,
    fault: Option<Fault>,
) -> LightGrid<'a> {
    let points = hits.iter().map(|hit| hit.point).chain(free.iter().copied());
    LightGrid::build_with(chain, points, side, 1 << 20, Faults(fault))
}

/// Random cases, each with grids of several sides.
fn over_cases(seed: u64, cases: usize, count: usize, fault: Option<Fault>) -> Tally {
    let (mut random, mut sum) = (SplitMix64(seed), Tally::default());
    for _ in 0..cases {
        let (meshes, light) = case(&mut random);
        let owned: Vec<Caster> = meshes.into_iter().map(Caster::new).collect();
        let casters = CasterGroup::new(owned.iter().collect());
        let chain = Chain::of(&casters, &light);
        let (hits, free) = points(&mut random, &casters, &light, count);
        for side in [1, 5, 32] {
            let found = tally(&grid_of(&chain, &hits, &free, side, fault), &casters, &hits, &free);
            assert!(fault.is_some() || found.wrong == 0, "{light} {side} {found:?} {:?}", owned[0].mesh());
            (sum.wrong, sum.decided, sum.all) =
                (sum.wrong + found.wrong, sum.decided + found.decided, sum.all + found.all);
        }
    }
    sum
}

#[test]
fn light_grid_proves_nothing_that_is_false() {
    let tally = over_cases(1, 120, 150, None);
    assert!(tally.wrong == 0 && tally.decided * 5 > tally.all * 2 && tally.all > 40_000, "{tally:?}");
}

/// 10⁸ decided points, some hours, or as many as `UMBRAGE_LONG` says: `tests/long.sh light_grid_long 1e7`.
#[test]
#[ignore = "some hours; tests/long.sh light_grid_long"]
fn light_grid_long_proves_nothing_that_is_false() {
    let asked = std::env::var("UMBRAGE_LONG").unwrap_or("1e8".to_owned());
    let most: f64 = asked.parse().expect("UMBRAGE_LONG is a number of points");
    let (mut seed, mut decided, mut all) = (1000, 0, 0);
    while (decided as f64) < most {
        let tally = over_cases(seed, 100, 4096, None);
        assert_eq!(tally.wrong, 0, "seed {seed}: {tally:?}");
        (seed, decided, all) = (seed + 1, decided + tally.decided, all + tally.all);
        eprintln!("light grid: {decided} decided of {all}, 0 wrong");
    }
    assert!(5 * decided > 2 * all);
}

#[test]
fn light_grid_without_outlines_is_caught() {
    assert!(over_cases(2, 30, 100, Some(Fault::NoOutline)).wrong > 100);
}

/// Four pages of a book, two of them on each side of its spine as the light sees them: at the spine the
/// multiplicity is 0, so they make one sheet, and a ray crosses it twice.
#[test]
fn light_grid_that_allows_its_own_sheet_a_second_crossing_is_caught() {
    let caster = Caster::new(shapes::book(4));
    let casters = CasterGroup::new(vec![&caster]);
    let mut random = SplitMix64(3);
    let (mut right, mut wrong) = (Tally::default(), Tally::default());
    for _ in 0..40 {
        let travel = [0, 1, 2].map(|i| random.unit() as f32 - [0.5, 0.5, 0.1][i]);
        let light = Light::directional(travel).unwrap();
        let chain = Chain::of(&casters, &light);
        let (hits, _) = points(&mut random, &casters, &light, 200);
        for (sum, fault) in [(&mut right, None), (&mut wrong, Some(Fault::TwoCrossings))] {
            let found = tally(&grid_of(&chain, &hits, &[], 16, fault), &casters, &hits, &[]);
            (sum.wrong, sum.decided) = (sum.wrong + found.wrong, sum.decided + found.decided);
        }
    }
    assert!(right.wrong == 0 && right.decided > 500, "{right:?}");
    assert!(wrong.wrong > 20, "{wrong:?}");
}

/// Points one unit in the last place above and below a sheet, while a bound has fewer places.
#[test]
fn light_grid_that_rounds_a_bound_inwards_is_caught() {
    let mut random = SplitMix64(4);
    let (mut right, mut wrong) = (Tally::default(), Tally::default());
    for _ in 0..40 {
        let height = 0.1 + random.unit() as f32;
        let caster = Caster::new(shapes::translated(&shapes::sheet(4), [0.0, 0.0, height]));
        let casters = CasterGroup::new(vec![&caster]);
        let light = Light::directional([0.0, 0.0, -1.0]).unwrap();
        let chain = Chain::of(&casters, &light);
        let mut free: Vec<[f32; 3]> = (0..100)
            .map(|i| {
                let [x, y] = [(); 2].map(|()| random.unit() as f32);
                [x, y, if i % 2 == 0 { height.next_up() } else { height.next_down() }]
            })
            .collect();
        free.push([0.5, 0.5, -1000.0]); // moves the middle of the depths away
        for (sum, fault) in [(&mut right, None), (&mut wrong, Some(Fault::RoundedInwards))] {
            let found = tally(&grid_of(&chain, &[], &free, 8, fault), &casters, &[], &free);
            (sum.wrong, sum.all) = (sum.wrong + found.wrong, sum.all + found.all);
        }
    }
    assert!(right.wrong == 0 && right.all > 4000, "{right:?}");
    assert!(wrong.wrong > 500, "{wrong:?}");
}

/// Every sheet, by brute force: unmarked ones are crossed as often as they say by each of many rays, and none
/// holds faces that only a boundary connects. Numbers of rays asked, of other counts, and of wrong sheets.
fn sheets_by_brute_force(
    random: &mut SplitMix64,
    mesh: Mesh,
    light: &Light,
    side: u32,
    fault: Option<Fault>,
) -> [usize; 3] {
    let caster = Caster::new(mesh);
    let casters = CasterGroup::new(vec![&caster]);
    let chain = Chain::of(&casters, light);
    let (_, mut free) = points(random, &casters, light, 400);
    // Behind everything, as the light sees it.
    let bounds = casters.bounds();
    let reach = (4.0 * bounds.diagonal()) as f32;
    for p in &mut free {
        let l = light.xyz();
        let away = [0, 1, 2].map(|i| if light.is_directional() { -l[i] } else { p[i] - l[i] });
        let length = away.iter().map(|x| x * x).sum::<f32>().sqrt().max(1e-3);
        *p = [0, 1, 2].map(|i| p[i] + reach * away[i] / length);
    }
    let grid = grid_of(&chain, &[], &free, side, fault);
    let mut counts = [0; 3];
    for &p in &free {
        let Some(place) = grid.place(p) else { continue };
        let (mut crossed, mut touches) = (vec![0; place.sheets.len()], false);
        casters.oracle().for_each_meeting(p, light, |face, meeting| match meeting {
            crate::oracle::Intersection::Crossing(_) => {
                let index =
                    place.faces.binary_search(&face.0).expect("a face that is crossed is in the cell");
                crossed[(place.sheet_of[index] - place.first_sheet) as usize] += 1;
            }
            _ => touches = true,
        });
        let unmarked = place.sheets.iter().zip(&crossed).filter(|(sheet, _)| !sheet.is_outline);
        if !touches {
            counts[0] += 1;
            counts[1] += unmarked.filter(|(sheet, crossed)| sheet.crossings != **crossed).count();
        }
        counts[2] += disconnected(&chain, place.faces, place.sheet_of);
    }
    counts
}

/// Number of sheets that are not connected across edges of multiplicity 0.
fn disconnected(chain: &Chain<'_>, faces: &[u32], sheet_of: &[u32]) -> usize {
    let mut labels: Vec<usize> = (0..faces.len()).collect();
    for a in 0..faces.len() {
        for b in 0..a {
            let [(of_a, outline), (of_b, _)] = [faces[a], faces[b]].map(|face| chain.edges(face));
            if (0..3).any(|k| outline & (1 << k) == 0 && of_b.contains(&of_a[k])) {
                let (from, to) = (labels[a], labels[b]);
                labels.iter_mut().filter(|label| **label == from).for_each(|label| *label = to);
            }
        }
    }
    let mut pairs: Vec<(u32, usize)> = sheet_of.iter().copied().zip(labels).collect();
    pairs.sort_unstable();
    pairs.dedup();
    pairs.windows(2).filter(|pair| pair[0].0 == pair[1].0).count()
}

#[test]
fn sheets_are_crossed_as_often_as_they_say() {
    let mut random = SplitMix64(5);
    let (mut sum, mut spoiled) = ([0; 3], [[0; 3]; 2]);
    for number in 0..120 {
        let (mut meshes, light) = case(&mut random);
        let mesh = meshes.pop().unwrap();
        let far = mesh.positions().iter().flatten().any(|x| x.abs() > 1e4);
        if far || mesh.face_count() > 400 || light.xyz().iter().any(|x| x.abs() > 1e4) {
            continue; // points behind everything might leave the range of `f32`
        }
        let add = |sum: &mut [usize; 3], fault| {
            let found = sheets_by_brute_force(&mut SplitMix64(number), mesh.clone(), &light, 6, fault);
            for (sum, found) in sum.iter_mut().zip(found) {
                *sum += found;
            }
        };
        add(&mut sum, None);
        add(&mut spoiled[0], Some(Fault::NoOutline));
        add(&mut spoiled[1], Some(Fault::UnitedAcross));
    }
    assert!(sum[0] > 5000 && sum[1..] == [0, 0], "{sum:?}");
    assert!(spoiled[0][1] > 100 && spoiled[1][2] > 100, "{spoiled:?}");
}

/// The generic ray of the only cell passes through the tip of a pyramid.
#[test]
fn light_grid_that_takes_a_touched_vertex_for_a_crossing_is_caught() {
    let tip = [0.5 + 1.0 / 32.0, 0.5 - 3.0 / 64.0];
    let ring = [[-1.0, -1.0], [2.0, -1.0], [2.0, 2.0], [-1.0, 2.0]];
    let mut positions = vec![[tip[0], tip[1], 1.0]];
    positions.extend(ring.map(|[x, y]| [x, y, 0.0]));
    let mesh = Mesh::new(positions, vec![[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 1]]).unwrap();
    let caster = Caster::new(mesh);
    let casters = CasterGroup::new(vec![&caster]);
    let light = Light::directional([0.0, 0.0, -1.0]).unwrap();
    let chain = Chain::of(&casters, &light);
    let free = [[0.0, 0.0, -1.0], [1.0, 1.0, -1.0], [0.25, 0.5, -1.0]];
    let sheets = |fault| grid_of(&chain, &[], &free, 1, fault).place(free[2]).unwrap().sheets.to_vec();
    let [right, wrong] = [None, Some(Fault::TouchIsCrossing)].map(|fault| sheets(fault)[0]);
    assert!(right.is_outline && !wrong.is_outline, "{right:?} {wrong:?}");
    assert_eq!(casters.oracle().crossings(free[2], &light).front, 1);
    assert_eq!(wrong.crossings, 4); // of which each ray but this one has 1
}

/// Scaling by a power of two scales every coordinate exactly: the same verdicts.
#[test]
fn light_grid_of_a_scaled_scene_has_the_same_verdicts() {
    let scaled = |p: [f32; 3], by: f32| p.map(|x| by * x);
    let (mut random, mut lit, mut dark) = (SplitMix64(6), 0, 0);
    for mesh in [shapes::torus(16, 9, 2.0, 0.75), shapes::book(5), shapes::torus_knot(2, 3, 40, 6, 0.4)] {
        let free: Vec<[f32; 3]> =
            (0..500).map(|_| [(); 3].map(|()| 6.0 * random.unit() as f32 - 3.0)).collect();
        let verdicts = |by: f32| {
            let caster = Caster::new(shapes::scaled(&mesh, by));
            let casters = CasterGroup::new(vec![&caster]);
            let chain = Chain::of(&casters, &Light::point(scaled([1.0, 5.0, 2.0], by)).unwrap());
            let free: Vec<[f32; 3]> = free.iter().map(|&p| scaled(p, by)).collect();
            let grid = LightGrid::build(&chain, free.iter().copied(), 32);
            free.iter().map(|&p| grid.verdict_at(p)).collect::<Vec<_>>()
        };
        let plain = verdicts(1.0);
        assert!([0.0625, 1024.0].iter().all(|&by| verdicts(by) == plain));
        lit += plain.iter().filter(|verdict| **verdict == GridVerdict::Lit).count();
        dark += plain.iter().filter(|verdict| **verdict == GridVerdict::Dark).count();
    }
    assert!(lit > 500 && dark > 50, "{lit} {dark}");
}

/// Where pairs would not fit, cells are larger: less is decided, and nothing wrong.
#[test]
fn light_grid_is_coarser_where_memory_would_not_do() {
    let mesh = Mesh::concat(&vec![shapes::scaled(&shapes::sheet(1), 3.0); 40]).unwrap();
    let lifted = (0..).zip(mesh.positions()).map(|(i, &[x, y, z])| [x, y, z + (i / 4) as f32]);
    let caster = Caster::new(Mesh::new(lifted.collect(), mesh.triangles().to_vec()).unwrap());
    let casters = CasterGroup::new(vec![&caster]);
    let light = Light::directional([0.1, 0.2, -1.0]).unwrap();
    let chain = Chain::of(&casters, &light);
    let mut random = SplitMix64(7);
    let (hits, free) = points(&mut random, &casters, &light, 2000);
    let all = || hits.iter().map(|hit| hit.point).chain(free.iter().copied());
    let built = |most| LightGrid::build_with(&chain, all(), 256, most, Faults::default());
    let [fine, coarse] = [1 << 20, 4000].map(built);
    assert_eq!(fine.sides(), [256]);
    assert!(coarse.sides()[0] < 128 && coarse.pair_count() <= 4000 && coarse.bytes() < fine.bytes());
    let [fine, coarse] = [fine, coarse].map(|grid| tally(&grid, &casters, &hits, &free));
    assert!(fine.wrong == 0 && coarse.wrong == 0 && coarse.decided < fine.decided, "{coarse:?} {fine:?}");
}
