//! Polygons of very many corners: in time, and still exact.

use std::time::{Duration, Instant};

use super::outlines::{comb, spiral, star};
use crate::fuzz::body::polygon::{Point, cut};

/// Panics unless the triangles of a flat polygon turn as it does and add up to its area, so that they cannot
/// overlap if its sides do not cross.
fn cut_exactly(corners: &[Point], what: &str) {
    let positions: Vec<[f32; 3]> = corners.iter().map(|&[x, y]| [x as f32, y as f32, 0.0]).collect();
    assert!(corners.iter().flatten().all(|x| x.abs() < 1 << 24), "{what} is exact in f32");
    let start = Instant::now();
    let (triangles, crosses) = cut(&positions);
    let time = start.elapsed();
    assert!(!crosses && triangles.len() == corners.len() - 2, "{what}");
    let turn = |[a, b, c]: [Point; 3]| (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    let areas: Vec<i64> =
        triangles.iter().map(|triangle| turn(triangle.map(|corner| corners[corner as usize]))).collect();
    assert!(areas.iter().all(|&area| area > 0), "{what} has a triangle without area, or turned over");
    let next = corners.iter().cycle().skip(1);
    let whole: i64 = corners.iter().zip(next).map(|(p, q)| p[0] * q[1] - p[1] * q[0]).sum();
    assert_eq!(areas.iter().sum::<i64>(), whole, "{what}");
    eprintln!("{what}: {} corners in {time:.1?}", corners.len());
    // Quadratic time would take hours.
    assert!(time < Duration::from_secs(100), "{what}: {time:?}");
}

#[test]
fn polygon_of_a_million_corners_is_cut_in_time() {
    const MANY: i64 = 1_000_000;
    cut_exactly(&comb(MANY / 2 - 1), "a comb");
    cut_exactly(&star(MANY as u32 / 40, 4e6), "a star");
    cut_exactly(&spiral(4000), "a spiral");
    // A convex one: a parabola.
    let parabola: Vec<Point> = (-4000..=4000).map(|x| [x, x * x]).collect();
    cut_exactly(&parabola, "a parabola");
    // A mountain range over a plain, as rough as can be.
    let mut state = 1_u64;
    let mut height = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        1 + (state >> 44) as i64
    };
    let range: Vec<Point> =
        [[0, 0], [MANY, 0]].into_iter().chain((0..=MANY).rev().map(|x| [x, height()])).collect();
    cut_exactly(&range, "a mountain range");
}
