//! The cosine-weighted measure: the share of a receiver's hemisphere that a part of the light takes up, each
//! direction weighted by the cosine to the receiver's normal.
//!
//! By Stokes' theorem it is an integral along the outline of the part (Lambert, *Photometria*, 1760): for a
//! straight piece from a to b, the angle between them times the component along the normal of the unit vector
//! a × b. The angle by `atan2`: `acos` loses half of the digits of small angles.

use std::f64::consts::TAU;

use glam::DVec3;

use super::measure::{half_width, pieces};
use super::pyramid::Pyramid;
use super::sweep::{Edge, Kind, Trapezoid};

#[derive(Debug)]
pub(super) struct Form<'a> {
    pyramid: &'a Pyramid,
    /// Unit length, turned with the order of the pyramid.
    normal: DVec3,
    round: bool,
    sum: f64,
}

impl<'a> Form<'a> {
    pub(super) fn new(pyramid: &'a Pyramid, normal: DVec3, round: bool) -> Self {
        let normal = if pyramid.mirrored { -normal } else { normal };
        Self { pyramid, normal, round, sum: 0.0 }
    }

    pub(super) fn total(&self) -> f64 {
        (self.sum / TAU).clamp(0.0, 1.0)
    }

    pub(super) fn add(&mut self, Trapezoid { v, left, right }: Trapezoid) {
        if left == right {
            return;
        }
        if !self.round {
            let corners = [[left[0], v[0]], [right[0], v[0]], [right[1], v[1]], [left[1], v[1]]]
                .map(|[u, v]| self.pyramid.towards(u, v));
            for i in 0..4 {
                self.sum += self.straight(corners[i], corners[(i + 1) % 4]);
            }
            return;
        }
        let y = v.map(|v| 2.0 * v - 1.0);
        let within = |u: f64, y: f64| (2.0 * u - 1.0).clamp(-half_width(y), half_width(y));
        let row = |end: usize| [left[end], right[end]].map(|u| self.on_disk([within(u, y[end]), y[end]]));
        let ([a, b], [d, c]) = (row(0), row(1));
        self.sum +=
            self.straight(a, b) + self.straight(c, d) + self.upwards(v, right) - self.upwards(v, left);
    }

    /// Along a line through a slab, kept within the disk.
    fn upwards(&self, v: [f64; 2], u: [f64; 2]) -> f64 {
        let along = |piece: super::measure::Piece| {
            let [from, to] = piece.ends;
            match piece.rim {
                None => self.straight(self.on_disk(from), self.on_disk(to)),
                Some(side) => self.arc(side, [from, to].map(|[x, y]| y.atan2(side * x))),
            }
        };
        pieces(v, u).into_iter().flatten().map(along).sum()
    }

    /// The vector to the point (x, y) of the plane in which the light is the unit disk.
    fn on_disk(&self, [x, y]: [f64; 2]) -> DVec3 {
        self.pyramid.towards(0.5 * (x + 1.0), 0.5 * (y + 1.0))
    }

    fn straight(&self, a: DVec3, b: DVec3) -> f64 {
        let across = a.cross(b);
        let size = across.length();
        if size == 0.0 { 0.0 } else { self.normal.dot(across) / size * size.atan2(a.dot(b)) }
    }

    /// Along r(t), x = side·cos t and y = sin t: the integral of n·(r × r′)/|r|².
    ///
    /// Sixteen points of Gauss on pieces that are short against their distance. The integrand has no pole
    /// where |r(t) − r(middle)| < (√2 − 1)·|r(middle)|. With half a piece at most 0.4 and at most a sixth of
    /// that distance over the speed, a pole is more than twice as far as the ends: the rule is off by less
    /// than 4⁻³² of the integral.
    fn arc(&self, side: f64, ends: [f64; 2]) -> f64 {
        let center = self.on_disk([0.0, 0.0]);
        let (u, v) = (0.5 * side * self.pyramid.frame.e1, 0.5 * self.pyramid.frame.e2);
        let speed = u.length() + v.length();
        let (mut sum, mut open) = (0.0, vec![(ends, 0)]);
        while let Some((ends, depth)) = open.pop() {
            let (middle, half) = (0.5 * (ends[0] + ends[1]), 0.5 * (ends[1] - ends[0]));
            let at = |t: f64| center + t.cos() * u + t.sin() * v;
            let short = half.abs() <= 0.4 && 6.0 * half.abs() * speed <= at(middle).length();
            if !short && depth < MOST_DEPTH {
                open.extend([([ends[0], middle], depth + 1), ([middle, ends[1]], depth + 1)]);
                continue;
            }
            for (x, weight) in GAUSS {
                for t in [middle - half * x, middle + half * x] {
                    let r = at(t);
                    let moves = t.cos() * v - t.sin() * u;
                    sum += half * weight * self.normal.dot(r.cross(moves)) / r.length_squared();
                }
            }
        }
        sum
    }
}

/// At this depth a piece is shorter than the spacing of its ends.
const MOST_DEPTH: u32 = 60;

/// The rule of sixteen points on −1 ..= 1: the positive points and their weights.
const GAUSS: [(f64, f64); 8] = [
    (0.095_012_509_837_637_44, 0.189_450_610_455_068_5),
    (0.281_603_550_779_258_9, 0.182_603_415_044_923_6),
    (0.458_016_777_657_227_4, 0.169_156_519_395_002_54),
    (0.617_876_244_402_643_7, 0.149_595_988_816_576_73),
    (0.755_404_408_355_003, 0.124_628_971_255_533_87),
    (0.865_631_202_387_831_7, 0.095_158_511_682_492_78),
    (0.944_575_023_073_232_6, 0.062_253_523_938_647_89),
    (0.989_400_934_991_649_9, 0.027_152_459_411_754_095),
];

/// The part of the square above the receiver's horizon: all of it, nothing, or what edges enclose.
pub(super) fn horizon(pyramid: &Pyramid, normal: DVec3, edges: &mut Vec<Edge>) -> bool {
    let square = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    let heights = square.map(|[u, v]| normal.dot(pyramid.towards(u, v)));
    if heights.iter().all(|&height| height >= 0.0) {
        return true;
    }
    let mut above = Vec::with_capacity(6);
    for i in 0..4 {
        let (here, there) = (heights[i], heights[(i + 1) % 4]);
        let (from, to) = (square[i], square[(i + 1) % 4]);
        if here >= 0.0 {
            above.push(from);
        }
        if (here < 0.0) != (there < 0.0) {
            let t = here / (here - there);
            above.push([from[0] + t * (to[0] - from[0]), from[1] + t * (to[1] - from[1])]);
        }
    }
    edges.extend(super::measure::outline_edges(&above, Kind::Horizon));
    false
}

#[cfg(test)]
mod tests {
    use super::GAUSS;

    #[test]
    fn gauss_of_sixteen_points_integrates_powers() {
        for power in 0..16 {
            let sum: f64 = GAUSS.iter().map(|(x, weight)| 2.0 * weight * x.powi(2 * power)).sum();
            assert!((sum - 2.0 / f64::from(2 * power + 1)).abs() < 1e-15, "{power}: {sum}");
        }
        // The sabotage: a power too high for the rule.
        let sum: f64 = GAUSS.iter().map(|(x, weight)| 2.0 * weight * x.powi(32)).sum();
        assert!((sum - 2.0 / 33.0).abs() > 1e-13);
    }
}
