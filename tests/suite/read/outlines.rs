//! Outlines to cut, in integers, counter-clockwise.

use crate::fuzz::body::polygon::Point;

/// A U of any width, its sides in `steps` pieces each, so that corners lie on one line.
pub(super) fn u_shape(steps: i64) -> Vec<Point> {
    let corners = [[0, 0], [5, 0], [5, 4], [4, 4], [4, 1], [1, 1], [1, 4], [0, 4]];
    pieces(&corners.map(|[x, y]| [x * steps, y * steps]), steps)
}

/// Each side in pieces.
fn pieces(corners: &[Point], steps: i64) -> Vec<Point> {
    let next = corners.iter().cycle().skip(1);
    let between = |(&[a, b], &[c, d]): (&Point, &Point)| {
        (0..steps).map(move |i| [a + (c - a) / steps * i, b + (d - b) / steps * i])
    };
    corners.iter().zip(next).flat_map(between).collect()
}

/// A star of `2 n` corners on a grid: spikes that reach out to twice the radius.
pub(super) fn star(n: u32, radius: f64) -> Vec<Point> {
    (0..2 * n)
        .map(|i| {
            let (sin, cos) = (f64::from(i) * std::f64::consts::PI / f64::from(n)).sin_cos();
            let reach = if i % 2 == 0 { 2.0 * radius } else { radius };
            [(reach * cos).round() as i64, (reach * sin).round() as i64]
        })
        .collect()
}

/// A comb of `n` teeth, pointing up.
pub(super) fn comb(n: i64) -> Vec<Point> {
    let teeth = (0..n).rev().flat_map(|i| [[4 * i + 3, 9], [4 * i + 2, 1]]);
    [[0, 0], [4 * n, 0]].into_iter().chain(teeth).collect()
}

/// A corridor that winds outwards in `arms` straight pieces, two wide, with walls two apart.
pub(super) fn spiral(arms: i64) -> Vec<Point> {
    const AHEAD: [Point; 4] = [[1, 0], [0, 1], [-1, 0], [0, -1]];
    const LEFT: [Point; 4] = [[0, 1], [-1, 0], [0, -1], [1, 0]];
    let ([mut x, mut y], mut walls) = ([0, 0], [vec![[0, -1]], vec![[0, 1]]]);
    for arm in 0..arms {
        let (way, length) = ((arm % 4) as usize, 4 * (arm / 2 + 1));
        [x, y] = [x + AHEAD[way][0] * length, y + AHEAD[way][1] * length];
        let [mut i, mut j] = LEFT[way];
        if arm + 1 < arms {
            [i, j] = [i + LEFT[(way + 1) % 4][0], j + LEFT[(way + 1) % 4][1]];
        }
        walls[0].push([x - i, y - j]);
        walls[1].push([x + i, y + j]);
    }
    let [right, left] = walls;
    right.into_iter().chain(left.into_iter().rev()).collect()
}

/// A plate with a hole, its boundary one walk: round the outside, over a
/// bridge, round the hole and back over the bridge. The corners of the bridge are met twice.
pub(super) fn plate() -> Vec<Point> {
    let outside = [[0, 0], [9, 0], [9, 7], [0, 7], [0, 0]];
    let hole = [[3, 2], [3, 5], [6, 5], [6, 2], [3, 2]];
    [&outside[..], &hole].concat()
}
