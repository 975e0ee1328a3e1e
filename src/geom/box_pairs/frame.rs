//! Oriented boxes around the nodes of a tree: where long thin faces lie aslant, their upright boxes all
//! overlap, and oriented ones do not.
//!
//! Two oriented boxes are compared along the three axes of each, as in Stefan Gottschalk, Ming C. Lin and
//! Dinesh Manocha, *OBBTree: A Hierarchical Structure for Rapid Interference Detection*, 1996, without the
//! nine cross products of edges. That keeps some pairs that do not overlap, and loses none that does.

type Vector = [f64; 3];

/// An oriented box: three axes, perpendicular up to rounding, and the interval along each.
#[derive(Clone, Copy, Debug)]
pub(super) struct Frame {
    axes: [Vector; 3],
    center: Vector,
    half: Vector,
    /// How far rounding can move a projection.
    slack: f64,
}

/// Rounding of a projection onto an axis, in units of the largest coordinate.
///
/// With u = 2⁻⁵³: an axis has length 1 within 8 u and is perpendicular to the others within 16 u (each is
/// orthogonalized twice), so writing a point in the frame and back errs by at most 3·(8 + 2·16) u of its
/// length, and the length is at most 2 of the largest coordinate. The dot products of three terms add 4 u per
/// term for the interval, for the center and for each half length. Together below 512 u.
const SLACK: f64 = 512.0 * (f64::EPSILON / 2.0);

impl Frame {
    /// The box around points: along the longest distance found from their mean, then along the longest one
    /// perpendicular to that. No points have no box, which is apart from nothing.
    pub(super) fn around(points: impl Iterator<Item = [f32; 3]> + Clone) -> Self {
        let wide = points.map(|p| p.map(f64::from));
        let (sum, count) = wide.clone().fold(([0.0; 3], 0_u32), |(sum, count), p| (add(sum, p), count + 1));
        let mean = sum.map(|x| x / f64::from(count.max(1)));
        let farthest = |from: Vector, distance: &dyn Fn(Vector) -> f64| {
            let far = |best: (f64, Vector), p: Vector| {
                let d = distance(sub(p, from));
                if d > best.0 { (d, p) } else { best }
            };
            wide.clone().fold((-1.0, from), far).1
        };
        let length = |v: Vector| dot(v, v);
        let end = farthest(mean, &length);
        let other = farthest(end, &length);
        let first = unit(sub(other, end), &[]).unwrap_or([1.0, 0.0, 0.0]);
        let across = |v: Vector| length(sub(v, first.map(|x| x * dot(v, first))));
        let side = farthest(end, &across);
        let any = || {
            let axis = (0..3).fold(0, |low, i| if first[i].abs() < first[low].abs() { i } else { low });
            unit(std::array::from_fn(|i| if i == axis { 1.0 } else { 0.0 }), &[first])
        };
        let second = unit(sub(side, end), &[first]).or_else(any).unwrap_or([0.0, 1.0, 0.0]);
        let third = unit(cross(first, second), &[first, second]).unwrap_or([0.0, 0.0, 1.0]);
        let axes = [first, second, third];
        let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        let mut largest = 0.0_f64;
        for p in wide {
            largest = p.iter().fold(largest, |largest, x| largest.max(x.abs()));
            for i in 0..3 {
                let along = dot(p, axes[i]);
                (low[i], high[i]) = (low[i].min(along), high[i].max(along));
            }
        }
        let half = std::array::from_fn(|i| 0.5 * (high[i] - low[i]));
        let middle: Vector = std::array::from_fn(|i| 0.5 * (low[i] + high[i]));
        let center = (0..3).fold([0.0; 3], |sum, i| add(sum, axes[i].map(|x| x * middle[i])));
        Self { axes, center, half, slack: SLACK * largest }
    }

    /// Whether the two certainly have no point in common.
    pub(super) fn apart(&self, other: &Self) -> bool {
        let between = sub(other.center, self.center);
        self.parts(other, between) || other.parts(self, between)
    }

    /// Whether all points within `reach` of `point` are certainly outside.
    pub(super) fn excludes(&self, point: [f32; 3], reach: f64) -> bool {
        let wide = point.map(f64::from);
        let largest = wide.iter().fold(0.0_f64, |largest, x| largest.max(x.abs()));
        let (between, slack) = (sub(wide, self.center), self.slack + SLACK * largest);
        (0..3).any(|i| dot(between, self.axes[i]).abs() > self.half[i] + slack + reach * (1.0 + SLACK))
    }

    /// A fault for a test.
    #[cfg(test)]
    pub(super) fn shrink(&mut self, factor: f64) {
        self.half = self.half.map(|half| half * factor);
    }

    fn parts(&self, other: &Self, between: Vector) -> bool {
        (0..3).any(|i| {
            let axis = self.axes[i];
            let reach: f64 = (0..3).map(|k| other.half[k] * dot(other.axes[k], axis).abs()).sum();
            dot(between, axis).abs() > self.half[i] + reach + (self.slack + other.slack)
        })
    }
}

fn add(a: Vector, b: Vector) -> Vector {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

fn sub(a: Vector, b: Vector) -> Vector {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: Vector, b: Vector) -> Vector {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// The direction of `v` perpendicular to unit vectors: orthogonalized twice, after which rounding is all that
/// is left. `None` if nothing but rounding is left of `v` itself.
fn unit(mut v: Vector, perpendicular_to: &[Vector]) -> Option<Vector> {
    let before = dot(v, v).sqrt();
    for _ in 0..2 {
        for &other in perpendicular_to {
            let along = dot(v, other);
            v = sub(v, other.map(|x| x * along));
        }
    }
    let length = dot(v, v).sqrt();
    // Of a shorter rest, the second pass would leave more than rounding.
    (length > before / f64::from(1 << 20)).then(|| v.map(|x| x / length))
}
