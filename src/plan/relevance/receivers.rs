//! The samples that a lamp may light, in tiles.

use super::reach::Reach;
use crate::oracle::PrimaryHit;
use crate::scene::Lamp;
use crate::shadow::tiles::Tiles;
use crate::shadow::{Samples, is_front_lit};

/// Which samples a lamp may light, and the boxes of tiles of them.
#[derive(Clone, Debug)]
pub(super) struct Receivers<'a> {
    samples: &'a Samples,
    /// Whether the lamp may light each sample.
    asked: Vec<bool>,
    /// How many it may light.
    pub(super) count: usize,
    /// How many see a surface that turns away from the lamp, or lies out of its reach.
    pub(super) turned_away: usize,
    /// How many see no surface.
    pub(super) sky: usize,
    pub(super) tiles: Tiles,
}

impl<'a> Receivers<'a> {
    pub(super) fn of(samples: &'a Samples, lamp: &Lamp, reach: &Reach) -> Self {
        // A lamp with an extent may reach a face from behind whose center does not.
        let faces_lamp = |hit: &PrimaryHit| lamp.has_extent() || is_front_lit(hit, lamp.light());
        let is_asked = |hit: &PrimaryHit| reach.may_light(hit.point) && faces_lamp(hit);
        let asked: Vec<bool> = samples.hits().iter().map(|hit| hit.as_ref().is_some_and(is_asked)).collect();
        let count = asked.iter().filter(|&&asked| asked).count();
        let sky = samples.hits().iter().filter(|hit| hit.is_none()).count();
        let point = |index: usize| samples.hits()[index].filter(|_| asked[index]).map(|hit| hit.point);
        let tiles = Tiles::of(samples.row_len(), samples.len(), point);
        Self { samples, count, turned_away: samples.len() - sky - count, sky, tiles, asked }
    }

    /// A sample, if the lamp may light it.
    pub(super) fn hit(&self, sample: usize) -> Option<&'a PrimaryHit> {
        self.samples.hits()[sample].as_ref().filter(|_| self.asked[sample])
    }

    /// The samples that the lamp may light, in sample order.
    pub(super) fn hits(&self) -> impl Iterator<Item = &'a PrimaryHit> + Clone + '_ {
        let hits = self.samples.hits().iter().zip(&self.asked);
        hits.filter_map(|(hit, &asked)| hit.as_ref().filter(|_| asked))
    }
}
