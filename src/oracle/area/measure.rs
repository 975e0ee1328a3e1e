//! Areas of trapezoids within a light, in parts of the square u, v in 0 ..= 1.

use super::fault::Faults;
use super::frame::EPSILON;
use super::light::Shape;
use super::sweep::{AtLeft, Edge, Kind, Sink, Sweep, Trapezoid};

/// The area of the covered parts.
#[derive(Debug)]
pub(super) struct Area {
    round: bool,
    sum: f64,
    /// What [`Area::sum`] lost to rounding so far (Neumaier, 1974).
    lost: f64,
    /// A bound of what single areas are off by.
    pub(super) error: f64,
}

impl Area {
    pub(super) fn new(shape: &Shape) -> Self {
        Self { round: *shape == Shape::Disk, sum: 0.0, lost: 0.0, error: 0.0 }
    }

    pub(super) fn total(&self) -> f64 {
        self.sum + self.lost
    }

    pub(super) fn add(&mut self, Trapezoid { v, left, right }: Trapezoid) {
        let height = v[1] - v[0];
        let area = if self.round {
            // Each integral adds up at most five terms below 2, and there are two of them.
            self.error += 32.0 * EPSILON;
            left_of(v, right) - left_of(v, left)
        } else {
            self.error += 8.0 * EPSILON * height;
            0.5 * height * ((right[0] - left[0]) + (right[1] - left[1]))
        };
        let sum = self.sum + area;
        self.lost +=
            if self.sum.abs() >= area.abs() { (self.sum - sum) + area } else { (area - sum) + self.sum };
        self.sum = sum;
    }
}

impl Sink for Area {
    fn covered(&mut self, part: Trapezoid) {
        self.add(part);
    }

    fn visible(&mut self, _: Trapezoid) {}
}

/// The area of the light itself.
pub(super) fn area_of(shape: &Shape) -> f64 {
    match shape {
        Shape::Full => 1.0,
        Shape::Disk => std::f64::consts::FRAC_PI_4,
        Shape::Polygon(outline) => {
            // All of it is hidden.
            let mut edges: Vec<Edge> = outline_edges(outline, Kind::Light).collect();
            let at_left = AtLeft { chain: 1, light: 0, horizon: 1 };
            let mut area = Area::new(shape);
            Sweep::default().run(&mut edges, &mut [], at_left, Faults::default(), &mut area);
            area.total()
        }
    }
}

/// The edges of a closed chain.
pub(super) fn outline_edges(outline: &[[f64; 2]], kind: Kind) -> impl Iterator<Item = Edge> + '_ {
    let next = outline.iter().cycle().skip(1);
    outline.iter().zip(next).filter_map(move |(&from, &to)| Edge::between(from, to, 1, kind))
}

/// The integral over the heights of a slab of u(v), no farther left or right than the disk within the square:
/// the area between the line and the upright axis of the disk, within the disk.
fn left_of(v: [f64; 2], u: [f64; 2]) -> f64 {
    let area = |piece: Piece| {
        let [from, to] = piece.ends;
        match piece.rim {
            None => 0.5 * (from[0] + to[0]) * (to[1] - from[1]),
            Some(side) => side * (half_disk(to[1]) - half_disk(from[1])),
        }
    };
    0.25 * pieces(v, u).into_iter().flatten().map(area).sum::<f64>()
}

/// A piece of a line that is kept within the unit disk.
#[derive(Clone, Copy, Debug)]
pub(super) struct Piece {
    /// Both ends, (x, y).
    pub(super) ends: [[f64; 2]; 2],
    /// Along the rim, at the right (1) or left (−1); `None` for a straight piece.
    pub(super) rim: Option<f64>,
}

/// A line through a slab, from its lower end up, moved into the disk at equal heights.
pub(super) fn pieces(v: [f64; 2], u: [f64; 2]) -> [Option<Piece>; 3] {
    let [y, x] = [v, u].map(|t| t.map(|t| 2.0 * t - 1.0));
    let at =
        |t: f64| if t == 1.0 { [x[1], y[1]] } else { [x[0] + t * (x[1] - x[0]), y[0] + t * (y[1] - y[0])] };
    let [t0, t1] = inside(x, y);
    let rim = |from: f64, to: f64| {
        let ends = [at(from), at(to)];
        let side = 1_f64.copysign(ends[0][0] + ends[1][0]);
        // An end inside the slab is on the circle already, as close as its numbers tell.
        let on = |t: f64, [x, y]: [f64; 2]| [if t == 0.0 || t == 1.0 { side * half_width(y) } else { x }, y];
        Piece { ends: [on(from, ends[0]), on(to, ends[1])], rim: Some(side) }
    };
    [
        (t0 > 0.0).then(|| rim(0.0, t0)),
        (t0 < t1).then(|| Piece { ends: [at(t0), at(t1)], rim: None }),
        (t1 < 1.0).then(|| rim(t1, 1.0)),
    ]
}

/// The parameters between which a segment lies in the unit disk, within 0 ..= 1; both 1 if nowhere.
///
/// Where it barely touches the circle the parameters are off by √ε, and the area by ε: line and circle are
/// that close there.
fn inside(x: [f64; 2], y: [f64; 2]) -> [f64; 2] {
    let (dx, dy) = (x[1] - x[0], y[1] - y[0]);
    let (size, along) = (dx * dx + dy * dy, x[0] * dx + y[0] * dy);
    // The distance of the line from the center, rather than a discriminant that cancels.
    let across = x[0] * dy - y[0] * dx;
    let half = size - across * across;
    if !(half > 0.0) {
        return [1.0; 2];
    }
    let root = half.sqrt();
    [(-along - root) / size, (-along + root) / size].map(|t| t.clamp(0.0, 1.0))
}

/// Half the width of the unit disk at height y.
pub(super) fn half_width(y: f64) -> f64 {
    ((1.0 - y) * (1.0 + y)).max(0.0).sqrt()
}

/// The area of the unit disk between its axis and its rim, from height 0 to y.
fn half_disk(y: f64) -> f64 {
    0.5 * (y * half_width(y) + y.clamp(-1.0, 1.0).asin())
}
