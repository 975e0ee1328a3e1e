//! The mean over a receiver and its neighbors: less noise for the same rays.
//!
//! Only those neighbors share that noise alone may have set apart. So an edge in the openness stays one, on
//! coarse meshes too, and where many rays leave little noise the mean changes little. (A mean over all
//! neighbors is better on scans with few rays, and up to twelve times worse on machine parts:
//! `benches/record/2026-12-01-ambient-ring.txt`.)

use glam::DVec3;

use super::rays::Sample;
use super::{Receiver, Receivers};

/// Least cosine between the normals of neighbors that share: 26 degrees.
const ALIKE: f64 = 0.9;

/// With more rays the mean costs as much in blur as it saves in noise.
const MOST_RAYS: u32 = 64;

/// Values farther apart than this, in errors that rays have, differ by more than their noise: measured, see
/// the record. Of two values with that error, as many are farther apart as lie beyond 2.1 standard
/// deviations.
const NOISE: f64 = 3.0;

/// Whether the mean brings values closer to the truth.
pub(super) fn helps(rays: u32) -> bool {
    rays <= MOST_RAYS
}

/// Pairs of receivers that a face connects: each in both orders, ascending.
#[derive(Clone, Debug)]
pub(super) struct Pairs(Vec<[u32; 2]>);

impl Pairs {
    pub(super) fn of(receivers: &Receivers) -> Self {
        let sides =
            receivers.corners.iter().flat_map(|&[a, b, c]| [[a, b], [b, a], [b, c], [c, b], [c, a], [a, c]]);
        let mut pairs: Vec<[u32; 2]> = sides.filter(|[a, b]| a != b).collect();
        pairs.sort_unstable();
        pairs.dedup();
        Self(pairs)
    }

    /// Replaces each value by the mean over itself and the neighbors with a similar normal and a value that
    /// differs by no more than noise explains, where `error` is that of one value. Buried ones keep out.
    pub(super) fn smooth(&self, list: &[Receiver], samples: &[Sample], error: f64) -> Vec<Sample> {
        let mut means = samples.to_vec();
        let apart = |a: usize, b: usize| f64::from((samples[a].openness - samples[b].openness).abs());
        for ring in self.0.chunk_by(|a, b| a[0] == b[0]) {
            let own = ring[0][0] as usize;
            if samples[own].buried {
                continue;
            }
            let like = |other: usize| {
                !samples[other].buried
                    && apart(own, other) <= NOISE * error
                    && are_alike(&list[own], &list[other])
            };
            let others = ring.iter().map(|pair| pair[1] as usize).filter(|&other| like(other));
            let (mut open, mut bent, mut count) = (0.0, DVec3::ZERO, 0.0);
            for Sample { openness, bent: of_one, .. } in
                std::iter::once(own).chain(others).map(|i| samples[i])
            {
                open += f64::from(openness);
                bent += DVec3::from(of_one.map(f64::from));
                count += 1.0;
            }
            means[own].openness = (open / count) as f32;
            means[own].bent = (bent / count).to_array().map(|x| x as f32);
        }
        means
    }
}

fn are_alike(a: &Receiver, b: &Receiver) -> bool {
    let cosine = |a: [f32; 3], b: [f32; 3]| (0..3).map(|i| f64::from(a[i]) * f64::from(b[i])).sum::<f64>();
    a.normal.zip(b.normal).is_some_and(|(a, b)| cosine(a, b) > ALIKE)
}
