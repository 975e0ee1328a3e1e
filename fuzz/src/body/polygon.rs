//! Polygons to triangles, against all pairs in integers.

use std::collections::{BTreeMap, HashMap};

use umbrage::mesh::Mesh;
use umbrage::read::read_bytes;
use umbrage::testing::generate::{Bytes, Draw};

/// A corner in the plane, a small integer point.
pub(crate) type Point = [i64; 2];

/// A polygon, and what is known of it.
#[derive(Clone, Debug)]
pub(crate) struct Polygon {
    pub(crate) corners: Vec<Point>,
    /// How it lies in space.
    pub(crate) placed: Placed,
    /// Whether it can be pulled apart into a simple polygon, by its construction.
    pub(crate) simple: bool,
}

/// How a polygon lies in space.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Placed {
    /// In the plane z = a·x + b·y, the axes then turned around.
    Plane { slopes: [i8; 2], turns: u8 },
    /// On a saddle so flat that z stays the axis of the normal.
    Saddle,
}

impl Placed {
    pub(crate) fn point(self, [x, y]: Point) -> [f32; 3] {
        let (u, v) = (x as f32, y as f32);
        match self {
            Self::Plane { slopes: [a, b], turns } => {
                let mut point = [u, v, f32::from(a) * u + f32::from(b) * v];
                point.rotate_left(usize::from(turns % 3));
                point
            }
            Self::Saddle => [u, v, u * v / 128.0],
        }
    }
}

pub(crate) fn run(data: &[u8]) {
    let mut bytes = Bytes::new(data);
    let polygon = drawn(&mut bytes);
    judge(&polygon, cut);
    judge_sides(&uneven(&polygon, &mut bytes), cut);
}

/// The corners of a polygon at heights of their own: corners that are one along an axis are two in space.
pub(crate) fn uneven(polygon: &Polygon, draw: &mut impl Draw) -> Vec<[f32; 3]> {
    polygon.corners.iter().map(|&[x, y]| [x as f32, y as f32, draw.below(2) as f32]).collect()
}

/// The polygon that some bytes mean: any points of a small grid, or cells glued to a tree.
pub(crate) fn drawn(draw: &mut impl Draw) -> Polygon {
    let placed = match draw.below(4) {
        0 => Placed::Saddle,
        turns => {
            let slopes = [(); 2].map(|()| draw.below(7) as i8 - 3);
            Placed::Plane { slopes, turns: turns as u8 }
        }
    };
    if draw.below(2) == 0 {
        let side = 2 + draw.below(9);
        let n = 3 + draw.below(14);
        let corners = (0..n).map(|_| [(); 2].map(|()| i64::from(draw.below(side)))).collect();
        return Polygon { corners, placed, simple: false };
    }
    let cells = 1 + draw.below(20);
    Polygon { corners: around_a_tree(draw, cells), placed, simple: true }
}

/// The walk around cells of a grid, each glued to one before: neighbors that are not glued are parted by a
/// side walked there and back, so that bridges, holes, touching corners and runs on one line are the rule.
/// Sheared, so that nothing is parallel to an axis.
fn around_a_tree(draw: &mut impl Draw, cells: u32) -> Vec<Point> {
    const STEPS: [Point; 4] = [[1, 0], [0, 1], [-1, 0], [0, -1]];
    let step = |[x, y]: Point, way: usize| [x + STEPS[way][0], y + STEPS[way][1]];
    let mut placed: Vec<Point> = vec![[0, 0]];
    let mut glued: BTreeMap<(usize, usize), usize> = BTreeMap::new();
    for _ in 1..cells {
        let (from, way) = (draw.below(placed.len() as u32) as usize, draw.below(4) as usize);
        let cell = step(placed[from], way);
        if !placed.contains(&cell) {
            glued.insert((from, way), placed.len());
            glued.insert((placed.len(), (way + 2) % 4), from);
            placed.push(cell);
        }
    }
    // Side `way` of a cell runs from corner `way` to the next one; the walk turns into glued cells.
    const CORNERS: [Point; 4] = [[1, 0], [1, 1], [0, 1], [0, 0]];
    let shear = [draw.below(3), draw.below(3)].map(i64::from);
    let (mut walk, start) = (Vec::new(), (0, 0));
    let (mut cell, mut way) = start;
    loop {
        if let Some(&next) = glued.get(&(cell, way)) {
            (cell, way) = (next, (way + 2 + 1) % 4);
        } else {
            let ([x, y], [i, j]) = (placed[cell], CORNERS[way]);
            let [x, y] = [x + i, y + j];
            walk.push([x + shear[0] * y, y + shear[1] * (x + shear[0] * y)]);
            way = (way + 1) % 4;
        }
        if (cell, way) == start && !walk.is_empty() {
            return walk;
        }
    }
}

/// The triangles, as numbers of corners, and whether the reader says that the polygon crosses itself.
pub(crate) type Answer = (Vec<[u32; 3]>, bool);

/// What the reader makes of a polygon.
pub(crate) fn cut(positions: &[[f32; 3]]) -> Answer {
    let mut file = String::new();
    for [x, y, z] in positions {
        file.push_str(&format!("v {x} {y} {z}\n"));
    }
    file.push('f');
    (1..=positions.len()).for_each(|vertex| file.push_str(&format!(" {vertex}")));
    let scene = read_bytes(file.as_bytes(), "polygon.obj").expect("it is well formed");
    let crosses = scene.notes.iter().any(|note| note.contains("crosses itself"));
    (Mesh::triangles(&scene.meshes[0]).to_vec(), crosses)
}

/// Panics unless the triangles that `cut` makes of a polygon, from each corner and in both directions, are as
/// they should be.
pub(crate) fn judge(polygon: &Polygon, cut: impl Fn(&[[f32; 3]]) -> Answer) {
    let positions: Vec<[f32; 3]> = polygon.corners.iter().map(|&p| polygon.placed.point(p)).collect();
    let (triangles, crosses) = judge_sides(&positions, cut);
    let strictly = positions.len() > 3 && is_strictly_simple(&polygon.corners);
    let simple = strictly || polygon.simple;
    assert!(!(simple && crosses), "said to cross itself: {polygon:?}");
    if !crosses && (simple || polygon.placed != Placed::Saddle) {
        do_not_overlap(&polygon.corners, &triangles, simple);
    }
}

/// What `cut` makes of a polygon. Panics unless there are two triangles fewer than corners, their sides cancel
/// to the polygon's, and they are the same whichever corner is the first, and turn with the polygon.
pub(crate) fn judge_sides(positions: &[[f32; 3]], cut: impl Fn(&[[f32; 3]]) -> Answer) -> Answer {
    let n = positions.len();
    let (triangles, crosses) = cut(positions);
    assert_eq!(triangles.len(), n - 2, "{positions:?}");
    sides_are_used_once(n as u32, &triangles);
    let sorted = |triangles: &[[u32; 3]], at: &dyn Fn(usize) -> usize| {
        let of = |triangle: &[u32; 3]| {
            let mut corners = triangle.map(|corner| positions[at(corner as usize)].map(f32::to_bits));
            corners.sort_unstable();
            corners
        };
        let mut all: Vec<[[u32; 3]; 3]> = triangles.iter().map(of).collect();
        all.sort_unstable();
        all
    };
    let wanted = sorted(&triangles, &|corner| corner);
    for start in 0..n {
        let ahead = |corner: usize| (start + corner) % n;
        let back = |corner: usize| (start + n - corner) % n;
        for at in [&ahead as &dyn Fn(usize) -> usize, &back] {
            let turned: Vec<[f32; 3]> = (0..n).map(|corner| positions[at(corner)]).collect();
            let (triangles, again) = cut(&turned);
            assert_eq!((sorted(&triangles, at), again), (wanted.clone(), crosses), "{start} {positions:?}");
        }
    }
    (triangles, crosses)
}

/// Panics unless the directed sides of all triangles cancel to the polygon's.
fn sides_are_used_once(n: u32, triangles: &[[u32; 3]]) {
    let mut uses: HashMap<(u32, u32), i32> = HashMap::new();
    let mut walk = |from: u32, to: u32, by: i32| {
        *uses.entry((from.min(to), from.max(to))).or_default() += if from < to { by } else { -by };
    };
    (0..n).for_each(|corner| walk(corner, (corner + 1) % n, -1));
    for &[a, b, c] in triangles {
        [(a, b), (b, c), (c, a)].into_iter().for_each(|(from, to)| walk(from, to, 1));
    }
    assert!(uses.values().all(|&uses| uses == 0), "{triangles:?}");
}

/// Panics unless the triangles turn as the polygon does, add up to its area, and have no point in common. With
/// `simple`, all of them have an area.
fn do_not_overlap(corners: &[Point], triangles: &[[u32; 3]], simple: bool) {
    let whole: i64 =
        corners.iter().zip(corners.iter().cycle().skip(1)).map(|(p, q)| p[0] * q[1] - p[1] * q[0]).sum();
    let sign = whole.signum();
    let solid: Vec<[Point; 3]> = triangles
        .iter()
        .map(|triangle| triangle.map(|corner| corners[corner as usize]))
        .filter(|&[a, b, c]| turn(a, b, c) != 0)
        .collect();
    assert!(!simple || solid.len() == triangles.len(), "without area: {corners:?} {triangles:?}");
    assert!(solid.iter().all(|&[a, b, c]| turn(a, b, c).signum() == sign), "{corners:?} {triangles:?}");
    let sum: i64 = solid.iter().map(|&[a, b, c]| turn(a, b, c)).sum();
    assert_eq!(sum, whole, "{corners:?} {triangles:?}");
    for (i, first) in solid.iter().enumerate() {
        for second in &solid[..i] {
            assert!(are_apart(first, second, sign), "{first:?} {second:?} of {corners:?}");
        }
    }
}

/// Twice the area of a triangle.
fn turn(a: Point, b: Point, c: Point) -> i64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

/// Whether a side of one of two triangles has the other one outside.
fn are_apart(first: &[Point; 3], second: &[Point; 3], sign: i64) -> bool {
    let parts = |one: &[Point; 3], other: &[Point; 3]| {
        (0..3).any(|i| other.iter().all(|&p| turn(one[i], one[(i + 1) % 3], p) * sign <= 0))
    };
    parts(first, second) || parts(second, first)
}

/// Whether no two sides have a point in common but the corner of two neighbors.
fn is_strictly_simple(corners: &[Point]) -> bool {
    let n = corners.len();
    let side = |i: usize| [corners[i], corners[(i + 1) % n]];
    let between = |p: Point, [a, b]: [Point; 2]| {
        turn(a, b, p) == 0 && (0..2).all(|i| p[i] >= a[i].min(b[i]) && p[i] <= a[i].max(b[i]))
    };
    let meet = |s: [Point; 2], t: [Point; 2]| {
        let turns = [turn(s[0], s[1], t[0]), turn(s[0], s[1], t[1])].map(i64::signum);
        let others = [turn(t[0], t[1], s[0]), turn(t[0], t[1], s[1])].map(i64::signum);
        turns[0] * turns[1] < 0 && others[0] * others[1] < 0
            || s.iter().any(|&p| between(p, t))
            || t.iter().any(|&p| between(p, s))
    };
    (0..n).all(|i| {
        let [a, b] = side(i);
        a != b
            && !between(side((i + 1) % n)[1], [a, b])
            && !between(a, side((i + 1) % n))
            && (0..n).all(|j| {
                let apart = (j + n - i) % n;
                (apart < 2 || apart == n - 1) || !meet(side(i), side(j))
            })
    })
}
