//! Keys over time, and the value between two of them.

use glam::{DQuat, DVec4};

use super::fault::{Fault, Faults};

/// How a value goes from one key to the next.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Interpolation {
    /// The value of a key holds until the next one.
    Step,
    /// Along a straight line; rotations along the shortest arc, at constant speed.
    #[default]
    Linear,
    /// A cubic Hermite spline with tangents of the file; rotations are brought to unit length afterwards.
    CubicSpline,
}

/// Keys of one value over time.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Track {
    /// In seconds, finite, ascending, one at least. Two equal times are a jump.
    pub(crate) times: Vec<f32>,
    /// `width` numbers a key, finite; with cubic splines three times as many: the tangent before the key, the
    /// value, the tangent behind it.
    pub(crate) values: Vec<f32>,
    /// Numbers of a value.
    pub(crate) width: usize,
    pub(crate) interpolation: Interpolation,
}

/// Parts of a key of a cubic spline, in their order in the file.
const BEFORE: usize = 0;
const VALUE: usize = 1;
const BEHIND: usize = 2;

impl Track {
    /// First and last time.
    pub(super) fn span(&self) -> [f64; 2] {
        [self.times[0], self.times[self.times.len() - 1]].map(f64::from)
    }

    /// The numbers of a part of a key; tracks that are no splines have values only.
    fn part(&self, key: usize, part: usize) -> &[f32] {
        let first = match self.interpolation {
            Interpolation::CubicSpline => 3 * key + part,
            _ => key,
        };
        &self.values[first * self.width..][..self.width]
    }

    /// The value of a key.
    pub(super) fn key(&self, key: usize) -> Vec<f64> {
        self.part(key, VALUE).iter().copied().map(f64::from).collect()
    }

    /// Whether all numbers of the value of a key are 0.
    pub(crate) fn is_zero(&self, key: usize) -> bool {
        self.part(key, VALUE).iter().all(|&number| number == 0.0)
    }

    /// The value at `time`: that of the nearest key outside of the span. Logarithmic in the keys.
    pub(super) fn at(&self, time: f64, is_rotation: bool, faults: Faults) -> Vec<f64> {
        let last = self.times.len() - 1;
        // The last key that is not after the time.
        let key = self.times.partition_point(|&key| f64::from(key) <= time).saturating_sub(1);
        let [first, end] = self.span();
        let outside = time <= first || time >= end;
        let key = match outside {
            false => key,
            true if faults.has(Fault::Clamp) && last > 0 => key.min(last - 1),
            true => return self.key(if time <= first { 0 } else { last }),
        };
        let [start, next] = [key, key + 1].map(|key| f64::from(self.times[key]));
        let duration = next - start;
        let s = (time - start) / duration;
        match self.interpolation {
            Interpolation::Step => self.key(if faults.has(Fault::StepAhead) { key + 1 } else { key }),
            Interpolation::Linear if is_rotation => {
                let [from, to] = [key, key + 1].map(|key| quaternion(&self.key(key)));
                slerp(from, to, s, faults).to_array().to_vec()
            }
            Interpolation::Linear => {
                let pairs = self.part(key, VALUE).iter().zip(self.part(key + 1, VALUE));
                pairs.map(|(&a, &b)| (1.0 - s) * f64::from(a) + s * f64::from(b)).collect()
            }
            Interpolation::CubicSpline => {
                let scale = if faults.has(Fault::TangentScale) { 1.0 } else { duration };
                self.hermite(key, s, scale)
            }
        }
    }

    /// Appendix C.5 of the specification. Tangents are per second, hence the scale by the duration.
    fn hermite(&self, key: usize, s: f64, duration: f64) -> Vec<f64> {
        let (s2, s3) = (s * s, s * s * s);
        let (from, out) = (2.0 * s3 - 3.0 * s2 + 1.0, duration * (s3 - 2.0 * s2 + s));
        let (to, into) = (-2.0 * s3 + 3.0 * s2, duration * (s3 - s2));
        let (value, behind) = (self.part(key, VALUE), self.part(key, BEHIND));
        let (next, before) = (self.part(key + 1, VALUE), self.part(key + 1, BEFORE));
        let number = |i: usize| {
            let [v, b, n, a] = [value[i], behind[i], next[i], before[i]].map(f64::from);
            from * v + out * b + to * n + into * a
        };
        (0..self.width).map(number).collect()
    }
}

/// Four numbers as a rotation of unit length; none at all where they are 0.
pub(super) fn quaternion(xyzw: &[f64]) -> DQuat {
    let vector = DVec4::from_slice(xyzw).try_normalize();
    vector.map_or(DQuat::IDENTITY, DQuat::from_vec4)
}

/// The rotation the part `s` of the shortest arc from `a` to `b`, at constant speed (Shoemake, *Animating
/// Rotation with Quaternion Curves*, 1985).
///
/// The angle comes from the chord and its complement, so that it is exact to rounding however small it is,
/// and the quotient of sines needs no threshold: they are 0 only if the rotations are equal.
fn slerp(a: DQuat, b: DQuat, s: f64, faults: Faults) -> DQuat {
    let (a, mut b) = (DVec4::from(a), DVec4::from(b));
    // q and −q are the same rotation: the nearer one is the shorter way.
    let is_far = a.dot(b) < 0.0;
    if is_far != faults.has(Fault::LongArc) {
        b = -b;
    }
    let angle = 2.0 * (b - a).length().atan2((b + a).length());
    let sine = angle.sin();
    let between = match sine == 0.0 {
        true => a,
        false => (a * ((1.0 - s) * angle).sin() + b * (s * angle).sin()) / sine,
    };
    quaternion(&between.to_array())
}
