//! The fraction and its bound against rational arithmetic with big integers, on small random scenes.
//!
//! The reference unites triangles, where the oracle sums up edges: each face is clipped to the pyramid in
//! homogeneous integers, and the area of the union is found between all heights at which anything happens.

use num_bigint::BigInt;

use super::closed_tests::triangles;
use super::*;
use crate::random::SplitMix64;

type Point = [BigInt; 3];

fn cross(a: &Point, b: &Point) -> Point {
    let minor = |i: usize, j: usize| &a[i] * &b[j] - &a[j] * &b[i];
    [minor(1, 2), minor(2, 0), minor(0, 1)]
}

fn dot(a: &Point, b: &Point) -> BigInt {
    &a[0] * &b[0] + &a[1] * &b[1] + &a[2] * &b[2]
}

fn whole(v: [i32; 3]) -> Point {
    v.map(BigInt::from)
}

fn minus(a: [i32; 3], b: [i32; 3]) -> [i32; 3] {
    [0, 1, 2].map(|i| a[i] - b[i])
}

fn is_negative(x: &BigInt) -> bool {
    x.sign() == num_bigint::Sign::Minus
}

/// A fraction with a denominator above 0.
#[derive(Clone, Debug)]
struct Ratio(BigInt, BigInt);

impl Ratio {
    fn new(over: BigInt, under: BigInt) -> Self {
        if is_negative(&under) { Self(-over, -under) } else { Self(over, under) }
    }

    fn below(&self, other: &Self) -> bool {
        &self.0 * &other.1 < &other.0 * &self.1
    }

    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        (&self.0 * &other.1).cmp(&(&other.0 * &self.1))
    }
}

/// Units of the last place of areas.
const PLACES: u32 = 200;

/// The convex polygon of (u, v) that a face takes up in the light's square, as homogeneous integers.
fn clipped(face: &[[i32; 3]; 3], p: [i32; 3], [corner, e1, e2]: [[i32; 3]; 3]) -> Vec<Point> {
    let (e1, e2, d) = (whole(e1), whole(e2), whole(minus(corner, p)));
    let turn = dot(&e1, &cross(&e2, &d));
    let flip = if is_negative(&turn) { -1 } else { 1 };
    let rows = [cross(&e2, &d), cross(&d, &e1), cross(&e1, &e2)];
    let one = turn * flip;
    let mut polygon: Vec<Point> = face
        .iter()
        .map(|&x| {
            let from = whole(minus(x, p));
            [0, 1, 2].map(|i| dot(&rows[i], &from) * flip)
        })
        .collect();
    let [a, b, c] = [&polygon[0], &polygon[1], &polygon[2]];
    if dot(a, &cross(b, c)) == BigInt::ZERO {
        return Vec::new();
    }
    // Each point is scaled by a positive factor where it is cut, which the last side has to know.
    let mut scale = vec![BigInt::from(1); 3];
    for side in 0..5 {
        let value = |x: &Point, scale: &BigInt| match side {
            0 => x[0].clone(),
            1 => x[1].clone(),
            2 => &x[2] - &x[0],
            3 => &x[2] - &x[1],
            _ => &one * scale - &x[2],
        };
        let values: Vec<BigInt> = polygon.iter().zip(&scale).map(|(x, s)| value(x, s)).collect();
        let (mut kept, mut scales) = (Vec::new(), Vec::new());
        for i in 0..polygon.len() {
            let j = (i + 1) % polygon.len();
            if !is_negative(&values[i]) {
                kept.push(polygon[i].clone());
                scales.push(scale[i].clone());
            }
            if is_negative(&values[i]) != is_negative(&values[j]) {
                let (own, its) = if is_negative(&values[j]) {
                    (-&values[j], values[i].clone())
                } else {
                    (values[j].clone(), -&values[i])
                };
                kept.push([0, 1, 2].map(|k| &own * &polygon[i][k] + &its * &polygon[j][k]));
                scales.push(&own * &scale[i] + &its * &scale[j]);
            }
        }
        (polygon, scale) = (kept, scales);
    }
    polygon.retain(|x| x[2] != BigInt::ZERO);
    polygon
}

/// The hidden area in units of 2^−PLACES.
fn hidden(polygons: &[Vec<Point>]) -> BigInt {
    let heights = |x: &Point| Ratio::new(x[1].clone(), x[2].clone());
    let edges: Vec<[&Point; 2]> = polygons
        .iter()
        .flat_map(|polygon| (0..polygon.len()).map(|i| [&polygon[i], &polygon[(i + 1) % polygon.len()]]))
        .collect();
    let mut levels: Vec<Ratio> = polygons.iter().flatten().map(heights).collect();
    for (i, a) in edges.iter().enumerate() {
        for b in &edges[..i] {
            let at = cross(&cross(a[0], a[1]), &cross(b[0], b[1]));
            if at[2] != BigInt::ZERO {
                levels.push(heights(&at));
            }
        }
    }
    levels.sort_by(Ratio::cmp);
    levels.dedup_by(|a, b| a.cmp(b).is_eq());
    let (zero, one) = (Ratio::new(0.into(), 1.into()), Ratio::new(1.into(), 1.into()));
    levels.retain(|level| !level.below(&zero) && !one.below(level));
    let mut area = BigInt::ZERO;
    for pair in levels.windows(2) {
        let [low, high] = [&pair[0], &pair[1]];
        let middle = Ratio(&low.0 * &high.1 + &high.0 * &low.1, 2 * &low.1 * &high.1);
        let line = [BigInt::ZERO, middle.1.clone(), -&middle.0];
        // Nothing crosses within, so that the width in the middle is the mean width.
        let mut spans: Vec<[Ratio; 2]> = Vec::new();
        for polygon in polygons {
            let mut at: Vec<Ratio> = Vec::new();
            for i in 0..polygon.len() {
                let (a, b) = (&polygon[i], &polygon[(i + 1) % polygon.len()]);
                if heights(a).below(&middle) != heights(b).below(&middle) {
                    let x = cross(&cross(a, b), &line);
                    at.push(Ratio::new(x[0].clone(), x[2].clone()));
                }
            }
            at.sort_by(Ratio::cmp);
            if let [left, .., right] = &at[..] {
                spans.push([left.clone(), right.clone()]);
            }
        }
        spans.sort_by(|a, b| a[0].cmp(&b[0]));
        let mut end: Option<Ratio> = None;
        let height = Ratio(&high.0 * &low.1 - &low.0 * &high.1, &low.1 * &high.1);
        for [left, right] in spans {
            let from = match &end {
                Some(end) if left.below(end) => end.clone(),
                _ => left,
            };
            if from.below(&right) {
                let width = Ratio(&right.0 * &from.1 - &from.0 * &right.1, &right.1 * &from.1);
                area += ((&width.0 * &height.0) << PLACES) / (&width.1 * &height.1);
                end = Some(right);
            }
        }
    }
    area
}

/// How far a fraction is from the truth.
fn off(fraction: f64, hidden: &BigInt) -> f64 {
    // A multiple of 2^−60 or finer stays exact in units of 2^−200.
    let found = (BigInt::from((fraction * 2f64.powi(100)) as i128)) << (PLACES - 100);
    let miss: BigInt = (BigInt::from(1) << PLACES) - hidden - found;
    let miss: BigInt = miss >> (PLACES - 120);
    i128::try_from(miss).map_or(f64::INFINITY, |miss| (miss as f64 * 2f64.powi(-120)).abs())
}

/// The largest error over the bound, and the number of scenes in penumbra.
fn worst(scenes: usize, seed: u64) -> (f64, usize) {
    let mut random = SplitMix64(seed);
    let (mut worst, mut all, mut penumbra) = (0.0_f64, 0, 0);
    while all < scenes {
        let most = [4, 9, 1000][random.below(3)];
        let mut vector = || [(); 3].map(|()| random.below(2 * most + 1) as i32 - most as i32);
        let light = [vector(), vector(), vector()];
        let p = vector();
        let faces: Vec<[[i32; 3]; 3]> = (0..4).map(|_| [vector(), vector(), vector()]).collect();
        let float = |v: [i32; 3]| v.map(|x| x as f32);
        let Ok(area) = AreaLight::parallelogram(float(light[0]), float(light[1]), float(light[2])) else {
            continue;
        };
        let soft = SoftOracle::build(&triangles(&[0, 1, 2, 3].map(|i| faces[i].map(float))));
        let Some(found) = soft.visible(float(p), &area) else { continue };
        all += 1;
        let polygons: Vec<_> =
            faces.iter().map(|face| clipped(face, p, light)).filter(|x| !x.is_empty()).collect();
        penumbra += usize::from(found.fraction > 0.0 && found.fraction < 1.0);
        let off = off(found.fraction, &hidden(&polygons));
        worst = worst.max(off / found.bound);
        assert!(off <= found.bound, "{off} {found:?} of {faces:?} {light:?} {p:?}");
    }
    (worst, penumbra)
}

#[test]
fn fraction_is_within_its_bound_of_whole_numbers_and_a_thousandth_of_the_bound_is_not() {
    let (worst, penumbra) = worst(10_000, 2);
    assert!(worst > 1e-3 && penumbra > 4000, "{worst} {penumbra}");
}
