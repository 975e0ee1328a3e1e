//! The nearest change between blocked and open texels, in half-widths of its penumbra.
//!
//! The search is that of single-sample soft shadows. It gives the *darkest* answer: of all changes the one
//! that is least far in terms of its own width. Tiles of the map are left out by their least and greatest
//! depth: by the penumbra law a tile at a distance of g texels matters only if something in it lies above the
//! receiver's plane by more than g/K.

use super::light_map::Receiver;
use super::offsets::FARTHEST;
#[cfg(test)]
use super::offsets::offsets;
use super::pyramid::TILE;

/// Farther than the centers of two texels are from the points of them that are nearest to one another.
const CENTERS: f64 = std::f64::consts::SQRT_2;

/// A search around one receiver.
#[derive(Debug)]
pub(super) struct EdgeSearch<'r, 'a> {
    receiver: &'r mut Receiver<'a>,
    /// Whether the receiver's own texel blocks.
    is_inner: bool,
    own: [i64; 2],
    /// K along the axis with the wider penumbra, and by how much distances along each axis are longer.
    k: f64,
    aspect: [f64; 2],
    /// The width of the own blocker's penumbra, for a blocked receiver.
    own_width: f64,
    /// Texels up to this distance are searched.
    radius: f64,
    /// Distance to the nearest change over its width; 1 outside the penumbra.
    q: f64,
}

impl<'r, 'a> EdgeSearch<'r, 'a> {
    /// `is_inner`: whether the receiver is in the hard shadow.
    fn new(receiver: &'r mut Receiver<'a>, is_inner: bool, own_depth: f64) -> Self {
        let k = receiver.k[0].max(receiver.k[1]);
        let aspect = receiver.k.map(|own| if own > 0.0 { k / own } else { 1.0 });
        let own = receiver.at.map(|t| t.floor() as i64);
        let own_width = if is_inner { (k * (own_depth - receiver.d)).max(0.5) } else { 0.0 };
        let radius = match is_inner {
            true => own_width,
            false => receiver.search(receiver.k).into_iter().fold(0.0, f64::max),
        };
        Self { receiver, is_inner, own, k, aspect, own_width, radius: radius.min(FARTHEST), q: 1.0 }
    }

    /// The least distance between the receiver and a box of texels, in texels of the wider axis.
    fn gap(&self, low: [i64; 2], side: i64) -> f64 {
        let [x, y] = [0, 1].map(|axis| {
            let at = self.receiver.at[axis];
            let [low, high] = [low[axis] as f64, (low[axis] + side) as f64];
            (low - at).max(at - high).max(0.0) * self.aspect[axis]
        });
        x.hypot(y)
    }

    /// Whether a texel is near enough to be looked at.
    fn is_near(&self, i: i64, j: i64) -> bool {
        let [x, y] = [i - self.own[0], j - self.own[1]].map(|x| x as f64);
        x.hypot(y) <= self.radius + CENTERS
    }

    fn visit(&mut self, i: i64, j: i64) {
        if !self.is_near(i, j) || [i, j] == self.own {
            return;
        }
        let gap = self.gap([i, j], 1);
        // No width makes this the nearest.
        if self.is_inner && gap >= self.q * self.own_width {
            return;
        }
        let Some((depth, blocks)) = self.receiver.look(i, j) else { return };
        if blocks == self.is_inner {
            return;
        }
        let above = depth - self.receiver.plane(i, j);
        let width = if self.is_inner { self.own_width } else { (self.k * above).max(0.5) };
        self.q = self.q.min(gap / width);
    }

    /// The whole tile, if something in it may matter. A tile that lies on no layer as a whole is read.
    fn visit_tile(&mut self, column: i64, row: i64) {
        let (side, tile) = (TILE as i64, [column, row].map(|t| t * TILE as i64));
        let gap = self.gap(tile, side);
        if let Some([least, most]) = self.receiver.tile(column, row) {
            self.receiver.reads += 1;
            let [low, high] = self.receiver.plane_range(tile, side);
            let matters = match self.is_inner {
                true => f64::from(least) <= high + self.receiver.bias && gap < self.q * self.own_width,
                false => {
                    let width = (self.k * (f64::from(most) - low)).max(0.5);
                    f64::from(most) > low + self.receiver.bias && gap < self.q * width
                }
            };
            if !matters {
                return;
            }
        }
        for j in tile[1]..tile[1] + side {
            for i in tile[0]..tile[0] + side {
                self.visit(i, j);
            }
        }
    }

    /// Tiles in square rings around the own one, so that near changes come first.
    fn over_tiles(mut self) -> f64 {
        let side = TILE as i64;
        let own = self.own.map(|t| t.div_euclid(side));
        let rings = ((self.radius + CENTERS) / TILE as f64).ceil() as i64;
        for ring in 0..=rings {
            for row in -ring..=ring {
                let step = if row.abs() == ring || ring == 0 { 1 } else { 2 * ring };
                for column in (-ring..=ring).step_by(step as usize) {
                    self.visit_tile(own[0] + column, own[1] + row);
                }
            }
        }
        self.q
    }

    /// The same without tiles.
    #[cfg(test)]
    fn over_texels(mut self) -> f64 {
        for offset in offsets() {
            self.visit(self.own[0] + i64::from(offset.i), self.own[1] + i64::from(offset.j));
        }
        self.q
    }
}

impl Receiver<'_> {
    /// Whether the receiver's own texel blocks, and its depth; `None` outside the map.
    pub(super) fn own_texel(&mut self) -> Option<(f64, bool)> {
        let [i, j] = self.at.map(|t| t.floor() as i64);
        self.look(i, j)
    }

    /// Distance to the nearest change between blocked and open texels, in half-widths of its penumbra; at
    /// most 1. `own_depth` is the depth of the blocker over a receiver in the hard shadow.
    pub(super) fn nearest_change(&mut self, is_inner: bool, own_depth: f64) -> f64 {
        EdgeSearch::new(self, is_inner, own_depth).over_tiles()
    }

    /// The same by a loop over all texels.
    #[cfg(test)]
    pub(super) fn nearest_change_by_texels(&mut self, is_inner: bool, own_depth: f64) -> f64 {
        EdgeSearch::new(self, is_inner, own_depth).over_texels()
    }

    /// The visible part of the lamp at a signed distance from an edge, in half-widths of the penumbra: exact
    /// for a straight edge, and for a square lamp along the map's axes.
    pub(super) fn profile(&self, x: f64) -> f64 {
        let x = x.clamp(-1.0, 1.0);
        match self.is_round {
            true => 0.5 + (x.asin() + x * (1.0 - x * x).sqrt()) / std::f64::consts::PI,
            false => 0.5 + 0.5 * x,
        }
    }
}
