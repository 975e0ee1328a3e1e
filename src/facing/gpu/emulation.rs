//! Every result that WGSL permits a device for the shader's filter, at once, on faces and lights that are
//! nearly ties.
//!
//! WGSL lets a device round every `+` and `×` up or down, reassociate sums, fuse a product with the sum that
//! it goes into, and flush subnormal inputs and outputs of an operation to 0. Here each value is a range.
//!
//! - *Roundings.* A sum grows with its terms, rounded up or rounded down, and so does flushing. So of one
//!   tree of sums the largest outcome is that with every operation rounded up, the smallest that with every
//!   one rounded down, and every mixture lies between: two evaluations bound them all.
//! - *Flushing.* A range that holds a subnormal end is extended to 0; a stored number that is subnormal may
//!   be 0.
//! - *Fusing.* A fused product is not rounded, so it lies between the product rounded down and rounded up: no
//!   range grows.
//! - *Reassociation.* A sum of four terms has 15 trees; all are evaluated, and their ranges joined.
//!
//! The bound is taken as small as any device may find it, whatever it found for the side. A device may even
//! evaluate the side twice, once to compare it and once for its sign (a compiler that contracts one use of a
//! value and not the other does): a pair is right only if, where any evaluation passes the bound, *every*
//! evaluation has the true sign.

use super::{ALWAYS_EDGE_ON, EVALUATION, Filter, LightParameters};
use crate::facing::planes::{EVALUATION as EVALUATION_OF_PLANES, UNDERFLOW};
use crate::facing::{FacePlanes, classify};
use crate::geom::{Light, predicate};
use crate::mesh::{FaceId, Mesh};
use crate::random::SplitMix64;
use crate::testing::shapes;

/// All that a device may find for a value.
#[derive(Clone, Copy, Debug)]
struct Range {
    low: f32,
    high: f32,
}

impl Range {
    /// Around `exact`, rounded to nearest as `near`: rounded up, rounded down, flushed.
    #[inline]
    fn around(near: f32, above: bool, below: bool) -> Self {
        let low = if above { near.next_down() } else { near };
        let high = if below { near.next_up() } else { near };
        Self {
            low: if low > 0.0 { flushed(low) } else { low },
            high: if high < 0.0 { flushed(high) } else { high },
        }
    }

    /// Of two stored numbers.
    #[inline]
    fn product(a: f32, b: f32) -> Self {
        let exact = f64::from(a) * f64::from(b); // 48 bits at most
        let near = exact as f32;
        let range = Self::around(near, f64::from(near) > exact, f64::from(near) < exact);
        if flushed(a) == 0.0 || flushed(b) == 0.0 {
            return Self { low: range.low.min(0.0), high: range.high.max(0.0) };
        }
        range
    }

    #[inline]
    fn plus(self, other: Self) -> Self {
        Self { low: sum(self.low, other.low).low, high: sum(self.high, other.high).high }
    }

    #[inline]
    fn join(self, other: Self) -> Self {
        Self { low: self.low.min(other.low), high: self.high.max(other.high) }
    }

    /// The smallest magnitude in it.
    #[inline]
    fn smallest(self) -> f32 {
        if self.low > 0.0 { self.low } else { (-self.high).max(0.0) }
    }
}

#[inline]
fn flushed(x: f32) -> f32 {
    if x.abs() < f32::MIN_POSITIVE { 0.0 } else { x }
}

/// Of two numbers that may be flushed as inputs (as they may have been as outputs).
#[inline]
fn sum(a: f32, b: f32) -> Range {
    let near = a + b;
    let virtual_b = near - a;
    let error = (a - (near - virtual_b)) + (b - virtual_b); // exact (Knuth's two-sum)
    Range::around(near, error < 0.0, error > 0.0)
}

/// Joins what all 15 trees of a sum of four may give.
#[inline]
fn any_order(x: [Range; 4]) -> Range {
    let [ab, ac, ad, bc, bd, cd] =
        [(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)].map(|(i, j): (usize, usize)| x[i].plus(x[j]));
    let mut all = ab.plus(cd).join(ac.plus(bd)).join(ad.plus(bc));
    for (pair, rest) in [(ab, [2, 3]), (ac, [1, 3]), (ad, [1, 2]), (bc, [0, 3]), (bd, [0, 2]), (cd, [0, 1])] {
        for [third, fourth] in [rest, [rest[1], rest[0]]] {
            all = all.join(pair.plus(x[third]).plus(x[fourth]));
        }
    }
    all
}

/// A face as the shader reads it.
#[derive(Clone, Copy, Debug)]
struct Stored {
    plane: [f32; 4],
    error: f32,
}

/// Every side that `facing_by_planes` may compute, and the smallest bound.
#[inline]
fn side_and_bound(face: Stored, light: &LightParameters, evaluation: f32) -> (Range, f32) {
    let [x, y, z] = light.xyz;
    let l = [x, y, z, light.w];
    let products = [0, 1, 2, 3].map(|i| Range::product(face.plane[i], l[i]));
    let side = any_order(products);
    let magnitudes = any_order(products.map(|x| Range { low: x.smallest(), high: x.smallest() })).low;
    let terms = [Range::product(evaluation, magnitudes), Range::product(face.error, light.reach)]
        .map(|x| Range { low: x.low, high: x.low });
    let floor = Range { low: light.floor, high: light.floor };
    let bound = (terms[0].plus(terms[1]).plus(floor).low)
        .min(terms[0].plus(floor).plus(terms[1]).low)
        .min(terms[1].plus(floor).plus(terms[0]).low);
    (side, bound)
}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Tally {
    pairs: u64,
    /// Some device takes the side for certain; every device is right.
    certified: u64,
    unsure: u64,
    /// Some device takes the side for certain, and some device is wrong.
    wrong: u64,
}

/// What a test may take away from the filter.
#[derive(Clone, Copy, Debug)]
struct Terms {
    evaluation: f32,
    floor: bool,
    error: bool,
}

const WHOLE: Terms = Terms { evaluation: EVALUATION, floor: true, error: true };

impl Tally {
    fn look(&mut self, face: Stored, light: &LightParameters, terms: Terms, sign: impl FnOnce() -> i32) {
        let face = Stored { error: if terms.error { face.error } else { face.error.min(0.0) }, ..face };
        let light = LightParameters { floor: if terms.floor { light.floor } else { 0.0 }, ..*light };
        let (side, bound) = side_and_bound(face, &light, terms.evaluation);
        self.pairs += 1;
        if side.high <= bound && side.low >= -bound {
            self.unsure += 1;
            return;
        }
        let right = match sign() {
            1 => side.low > 0.0,
            -1 => side.high < 0.0,
            _ => face.error == ALWAYS_EDGE_ON && side.low == 0.0 && side.high == 0.0,
        };
        if right { self.certified += 1 } else { self.wrong += 1 }
    }

    fn plus(self, other: Self) -> Self {
        Self {
            pairs: self.pairs + other.pairs,
            certified: self.certified + other.certified,
            unsure: self.unsure + other.unsure,
            wrong: self.wrong + other.wrong,
        }
    }
}

/// Meshes whose faces tempt the filter: CAD parts, planes through the local origin, slivers, all sizes.
fn tempting(random: &mut SplitMix64) -> Mesh {
    let kind = random.below(7);
    let mut soup = |corner: &mut dyn FnMut(&mut SplitMix64) -> [[f32; 3]; 3]| {
        let mut positions = Vec::new();
        for _ in 0..32 {
            let corners = corner(random);
            positions.extend(corners);
            // Mirrored, so that the local origin is the origin.
            positions.extend(corners.map(|p| p.map(|x| -x)));
        }
        let triangles = (0..positions.len() as u32 / 3).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        Mesh::new(positions, triangles).expect("finite")
    };
    let unit = |random: &mut SplitMix64| (2.0 * random.unit() - 1.0) as f32;
    let grid = |random: &mut SplitMix64| (random.below(513) as f32 - 256.0) / 256.0;
    let anywhere = |random: &mut SplitMix64| [(); 3].map(|()| unit(random));
    let mesh = match kind {
        0 => soup(&mut |random| [(); 3].map(|()| anywhere(random))),
        // Planes exactly through the origin.
        1 | 2 => soup(&mut |random| {
            let (a, b) = ([(); 3].map(|()| grid(random)), [(); 3].map(|()| grid(random)));
            [a, b, [0, 1, 2].map(|i| -(a[i] + b[i]))]
        }),
        // Slivers.
        3 => soup(&mut |random| {
            let (a, b) = (anywhere(random), anywhere(random));
            let t = random.unit();
            let near = |i: usize| f64::from(a[i]) + t * (f64::from(b[i]) - f64::from(a[i]));
            let off = 0.5_f64.powi(random.below(26) as i32);
            [a, b, [0, 1, 2].map(|i| (near(i) + off * (random.unit() - 0.5)) as f32)]
        }),
        // Small, far from the middle of the mesh.
        4 => soup(&mut |random| {
            let at = anywhere(random);
            [(); 3].map(|()| at.map(|x| x + unit(random) / 64.0))
        }),
        // Tenths on a grid, axis-aligned and not.
        5 => shapes::scaled(&shapes::menger_sponge(1), 0.1),
        _ => soup(&mut |random| [(); 3].map(|()| [(); 3].map(|()| (grid(random) * 256.0) * 0.1))),
    };
    let scales = [1.0, 1.0, 1.0, 1e-3, 1e3, 1e-19, 1e19, 1e-30, 1e-36, f32::MIN_POSITIVE, 1e-41, 1e30, 1e36];
    shapes::scaled(&mesh, scales[random.below(scales.len())])
}

/// A light in the plane of a face, or as near to it as `f32` lets it be.
fn near_plane([a, b, c]: [[f32; 3]; 3], random: &mut SplitMix64) -> Option<Light> {
    let point = random.below(3) != 0;
    let far = [1.0, 1.0, 4.0, 1000.0, 1e6][random.below(5)];
    let (s, t) = match random.below(4) {
        0 => (random.below(9) as f64 - 4.0, random.below(9) as f64 - 4.0),
        _ => (far * (2.0 * random.unit() - 1.0), far * (2.0 * random.unit() - 1.0)),
    };
    let mut at = [0, 1, 2].map(|i| {
        let [a, b, c] = [a, b, c].map(|p| f64::from(p[i]));
        (if point { a } else { 0.0 } + s * (b - a) + t * (c - a)) as f32
    });
    match random.below(4) {
        0 => at[random.below(3)] = at[random.below(3)].next_up(),
        1 => {
            let i = random.below(3);
            at[i] = at[i].next_down();
        }
        _ => {}
    }
    if point { Light::point(at).ok() } else { Light::directional(at.map(|x| 0.0 - x)).ok() }
}

/// `pairs` faces and lights, the same ones for the same `seed`.
fn some_pairs(seed: u64, pairs: u64, terms: Terms) -> Tally {
    let mut random = SplitMix64(seed);
    random.0 = random.next();
    let mut tally = Tally::default();
    while tally.pairs < pairs {
        let mesh = tempting(&mut random);
        let planes = FacePlanes::new(&mesh);
        let (filter, values) = Filter::new(&mesh, &planes);
        let groups = values.len() / 5;
        let stored = |face: usize| Stored {
            plane: [0, 1, 2, 3].map(|i| values[i * groups + face / 4][face % 4]),
            error: values[4 * groups + face / 4][face % 4],
        };
        for _ in 0..1024 {
            let face = random.below(mesh.face_count());
            let corners = mesh.corners(FaceId::new(face));
            let light = match random.below(8) {
                0 => Light::point(planes.origin()).ok(),
                1 => Light::point(mesh.positions()[random.below(mesh.vertex_count())]).ok(),
                _ => near_plane(corners, &mut random),
            };
            let Some(light) = light else { continue };
            tally.look(stored(face), &filter.light(&light), terms, || {
                predicate::side_of_light(corners, &light).value()
            });
        }
    }
    tally
}

/// On all cores; the sum does not depend on how many there are.
fn pairs(count: u64, terms: Terms) -> Tally {
    const CHUNK: u64 = 1 << 14;
    let next = std::sync::atomic::AtomicU64::new(0);
    let work = || {
        let mut tally = Tally::default();
        loop {
            let seed = next.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
            if seed * CHUNK >= count {
                return tally;
            }
            tally = tally.plus(some_pairs(seed, CHUNK, terms));
        }
    };
    let threads = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
    std::thread::scope(|scope| {
        let workers: Vec<_> = (0..threads).map(|_| scope.spawn(work)).collect();
        workers.into_iter().map(|worker| worker.join().expect("no panic")).fold(Tally::default(), Tally::plus)
    })
}

/// `UMBRAGE_FILTER_PAIRS=100000000` tests that number of pairs.
#[test]
fn filter_certifies_no_wrong_side_however_a_device_evaluates_it() {
    let count =
        std::env::var("UMBRAGE_FILTER_PAIRS").ok().map_or(1 << 20, |count| count.parse().expect("a number"));
    let start = std::time::Instant::now();
    let tally = pairs(count, WHOLE);
    eprintln!("{tally:?} in {:.1} s", start.elapsed().as_secs_f64());
    assert_eq!(tally.wrong, 0, "{tally:?}");
    assert!(tally.certified > tally.pairs / 20 && tally.unsure > tally.pairs / 20, "{tally:?}");
}

#[test]
fn filter_that_lacks_a_term_is_caught() {
    let evaluation = 1.25 * f32::EPSILON;
    for terms in
        [Terms { evaluation, ..WHOLE }, Terms { floor: false, ..WHOLE }, Terms { error: false, ..WHOLE }]
    {
        let tally = pairs(1 << 18, terms);
        assert!(tally.wrong > 100, "{terms:?}: {tally:?}");
    }
}

/// Every order, fused or not, rounded to nearest, flushed or not, lies in the range; and there are several
/// outcomes.
#[test]
fn filter_ranges_hold_every_evaluation() {
    let mut random = SplitMix64(3);
    let mut differ = 0;
    for round in 0..100_000 {
        let scale = if round % 2 == 0 { 1.0 } else { 1e-38 };
        let mut unit = || (2.0 * random.unit() - 1.0) as f32;
        let n = [(); 4].map(|()| unit());
        let mut l = [(); 4].map(|()| unit() * scale);
        // The last term nearly cancels the others.
        l[3] = (0..3).map(|i| f64::from(n[i]) * f64::from(l[i])).sum::<f64>() as f32;
        let n = [n[0], n[1], n[2], -1.0];
        let range = any_order([0, 1, 2, 3].map(|i| Range::product(n[i], l[i])));
        let flush = random.below(2) == 0;
        let done = |x: f32| if flush { flushed(x) } else { x };
        let product = |i: usize| done(done(n[i]) * done(l[i]));
        let order = random.permutation(4).into_iter().map(|i| i as usize).collect::<Vec<_>>();
        let chain = order[1..].iter().fold(product(order[0]), |sum, &i| {
            let fused = random.below(2) == 0;
            done(if fused { done(n[i]).mul_add(done(l[i]), sum) } else { sum + product(i) })
        });
        let balanced =
            done(done(product(order[0]) + product(order[1])) + done(product(order[2]) + product(order[3])));
        for side in [chain, balanced] {
            assert!(range.low <= side && side <= range.high, "{side:e} in {range:?}: {n:?} {l:?}");
        }
        differ += usize::from(chain != balanced);
    }
    assert!(differ > 10_000, "{differ}");
}

/// The processor's filter on the same meshes and lights: how many faces are wrong with each of these bounds.
fn wrong_on_the_processor(evaluation: f32, underflow: f32, error: bool) -> usize {
    let mut random = SplitMix64(6);
    let (mut facing, mut wrong) = (Vec::new(), 0);
    for _ in 0..400 {
        let mesh = tempting(&mut random);
        let mut planes = FacePlanes::new(&mesh);
        if !error {
            planes.forget_errors();
        }
        for _ in 0..32 {
            let corners = mesh.corners(FaceId::new(random.below(mesh.face_count())));
            let light = match random.below(8) {
                0 => Light::point(planes.origin()).ok(),
                _ => near_plane(corners, &mut random),
            };
            let Some(light) = light else { continue };
            planes.classify_with(&mesh, &light, &mut facing, evaluation, underflow);
            wrong += facing.iter().zip(classify(&mesh, &light)).filter(|(a, b)| **a != *b).count();
        }
    }
    wrong
}

#[test]
fn facing_bounds_of_planes_hold_and_smaller_ones_are_caught() {
    let units = |units: f32| units * f32::EPSILON / 2.0;
    let wrong = [8.0, 4.0, 3.0, 2.0, 1.0].map(|u| wrong_on_the_processor(units(u), UNDERFLOW, true));
    let (underflow, error) =
        (wrong_on_the_processor(units(8.0), 0.0, true), wrong_on_the_processor(units(8.0), UNDERFLOW, false));
    assert_eq!((units(8.0), wrong[0]), (EVALUATION_OF_PLANES, 0));
    assert!(wrong[4] > 0 && underflow > 0 && error > 0, "{wrong:?} {underflow} {error}");
}
