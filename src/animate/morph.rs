//! Positions between frames, and positions that morph targets displace.

use super::fault::{Fault, Faults};

/// The positions at `frame` of a list of frames, between two of them along straight lines. At a frame itself
/// they are its own, bit for bit; beyond the ends, those at the ends.
///
/// # Panics
///
/// Panics if there is no frame.
pub(crate) fn between(frames: &[&[[f32; 3]]], frame: f64) -> Vec<[f32; 3]> {
    let last = frames.len() - 1;
    let frame = frame.clamp(0.0, last as f64);
    let (first, s) = (frame.floor() as usize, frame.fract());
    if s == 0.0 {
        return frames[first].to_vec();
    }
    let mix = |(a, b): (f32, f32)| ((1.0 - s) * f64::from(a) + s * f64::from(b)) as f32;
    let pairs = frames[first].iter().zip(frames[first + 1]);
    pairs.map(|(a, b)| [0, 1, 2].map(|axis| mix((a[axis], b[axis])))).collect()
}

/// A position that targets displace, each by its weight. A target is given by the position at full weight, as
/// a mesh stores it, so that a weight of 1 leads there.
pub(super) fn morphed(
    rest: [f32; 3],
    vertex: usize,
    targets: &[Vec<[f32; 3]>],
    weights: &[f64],
    faults: Faults,
) -> [f64; 3] {
    let rest = rest.map(f64::from);
    let mut position = rest;
    if faults.has(Fault::Morph) {
        return position;
    }
    for (target, &weight) in targets.iter().zip(weights) {
        if weight != 0.0 {
            for axis in 0..3 {
                position[axis] += weight * (f64::from(target[vertex][axis]) - rest[axis]);
            }
        }
    }
    position
}
