//! The mean over a receiver and its neighbors: less noise for the same rays, where a mesh is fine.

use glam::DVec3;

use super::rays::Sample;
use super::{Receiver, Receivers};
use crate::geom::Aabb;

/// Least cosine between the normals of neighbors that share: 26 degrees.
const ALIKE: f64 = 0.9;

/// More rays than these are better off without the mean, which also blurs.
const MOST_RAYS: u32 = 64;

/// Longest median edge, as a share of the diagonal.
const FINE: f64 = 0.015;

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

    /// Whether the mean brings values closer to the truth: few rays, and a mesh so fine that neighbors see
    /// nearly the same.
    pub(super) fn help(&self, receivers: &Receivers, rays: u32) -> bool {
        let at = |index: u32| DVec3::from(receivers.list[index as usize].point.map(f64::from));
        let mut lengths: Vec<f64> =
            self.0.iter().filter(|[a, b]| a < b).map(|&[a, b]| at(a).distance(at(b))).collect();
        if rays > MOST_RAYS || lengths.is_empty() {
            return false;
        }
        let middle = lengths.len() / 2;
        let (_, median, _) = lengths.select_nth_unstable_by(middle, f64::total_cmp);
        *median < FINE * Aabb::around(receivers.list.iter().map(|receiver| receiver.point)).diagonal()
    }

    /// Replaces each value by the mean over itself and the neighbors with a similar normal. Buried ones keep
    /// out.
    pub(super) fn smooth(&self, list: &[Receiver], samples: &[Sample]) -> Vec<Sample> {
        let mut means = samples.to_vec();
        for ring in self.0.chunk_by(|a, b| a[0] == b[0]) {
            let own = ring[0][0] as usize;
            if samples[own].buried {
                continue;
            }
            let like = |other: usize| !samples[other].buried && are_alike(&list[own], &list[other]);
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
