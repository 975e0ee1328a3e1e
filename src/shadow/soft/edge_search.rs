//! The nearest change between blocked and open texels, in half-widths of its penumbra.
//!
//! The search is that of single-sample soft shadows. It gives the *darkest* answer: of all changes the one
//! that is least far in terms of its own width. Tiles of the map are left out by their least and greatest
//! depth: by the penumbra law a tile at a distance of g texels matters only if something in it lies above the
//! receiver's plane by more than g/K. All is computed as [`Around`] says, so that a device finds the same.

use std::cmp::Ordering;

use super::around::{Around, Found, UNITS};
use super::light_map::{LightMap, Receiver, profile};
use super::offsets::FARTHEST;
#[cfg(test)]
use super::offsets::offsets;
use super::pyramid::{MOST_RATIO, TILE};

/// Farther, in units, than the centers of two texels are from the points of them that are nearest to one
/// another: √2 texels.
const CENTERS: i32 = 182;
/// The farthest that is searched, in units.
const MOST_RADIUS: i32 = FARTHEST as i32 * UNITS;
/// Farther than any map, in units.
const BEYOND: f32 = (1 << 22) as f32;

/// A search around one receiver.
#[derive(Debug)]
pub(super) struct EdgeSearch<'m, 'a> {
    map: &'m LightMap<'a>,
    here: Around,
    /// Whether the receiver's own texel blocks.
    is_inner: bool,
    /// Half-width of the own blocker's penumbra.
    own_width: u32,
    /// Texels up to this distance are searched.
    radius: i32,
    /// Squares of distance and width; both 1 outside the penumbra.
    best: [u32; 2],
    /// Number of texels and tiles read.
    reads: u32,
}

impl<'m, 'a> EdgeSearch<'m, 'a> {
    /// `None` where the map has no texel at the receiver.
    pub(super) fn new(map: &'m LightMap<'a>, here: Around) -> Option<Self> {
        let depth = map.stored(here.layer, here.own)?;
        Some(Self::from_depth(map, here, depth, depth > here.plane + here.bias))
    }

    /// With a depth of the own texel, and whether it blocks.
    fn from_depth(map: &'m LightMap<'a>, here: Around, depth: f32, is_inner: bool) -> Self {
        let own_width = here.width_of(depth - here.depth);
        let mut search = Self { map, here, is_inner, own_width, radius: 0, best: [1, 1], reads: 1 };
        search.radius = if is_inner { own_width as i32 } else { search.outer_radius() }.min(MOST_RADIUS);
        search
    }

    /// The half-side of the smallest box that holds all blockers: that of the greatest depth of the map, then
    /// of the greatest depth within that box, and so on.
    fn outer_radius(&mut self) -> i32 {
        // Most boxes are settled by the fourth; each costs a few cells of the pyramid.
        const ROUNDS: u32 = 6;
        let (pyramid, here) = (&self.map.pyramid, &self.here);
        let (size, is_cube) = (self.map.space().size() as i32, self.map.space().layers() > 1);
        // Of 18 binary digits, so that ratios of it are exact.
        let drawn = f32::from_bits((pyramid.most_drawn().to_bits() + 63) & !63);
        let mut most = if is_cube { MOST_RATIO as f32 * drawn } else { drawn };
        let mut half = [0; 2];
        for _ in 0..ROUNDS {
            half = here.k.map(|k| (k * (most - here.depth)).ceil().clamp(64.0, BEYOND) as i32);
            let at = [0, 1].map(|axis| here.own[axis] * UNITS + here.within[axis] as i32);
            let end = |axis: usize, by: i32| ((at[axis] + by) >> 7).clamp(-1, size);
            let ends = [0, 1].map(|axis| [end(axis, -half[axis]), end(axis, half[axis])]);
            let is_beyond = ends.iter().any(|&[low, high]| low < 0 || high >= size);
            let (found, cells) = if is_cube && is_beyond {
                // Sixteenths of half a side, rounded up.
                let middle = size * (UNITS / 2);
                let farthest = (0..2).map(|axis| (at[axis] - middle).abs() + half[axis]).max().unwrap_or(0);
                let ratio = (16 * farthest + middle - 1) / middle;
                (ratio.clamp(16, 48) as f32 * 0.0625 * drawn, 0)
            } else {
                pyramid.most_of_texels(here.layer as usize, ends)
            };
            self.reads += cells;
            if found >= most {
                break;
            }
            most = found;
        }
        half[0].max(half[1])
    }

    fn visit(&mut self, offset: [i32; 2]) {
        let far = self.radius + CENTERS;
        let [i, j] = offset;
        if offset == [0, 0] || UNITS * UNITS * (i * i + j * j) > far * far {
            return;
        }
        let gap = self.here.gap_to(offset, 1);
        // No width makes this the nearest.
        if self.is_inner && compared([gap, self.own_width.pow(2)], self.best).is_gt() {
            return;
        }
        self.reads += 1;
        let texel = [self.here.own[0] + i, self.here.own[1] + j];
        let Some(depth) = self.map.stored(self.here.layer, texel) else { return };
        let plane = self.here.plane_at(offset);
        if (depth > plane + self.here.bias) == self.is_inner {
            return;
        }
        let width = if self.is_inner { self.own_width } else { self.here.width_of(depth - plane) };
        let found = [gap, width.pow(2)];
        // A tie is decided, so that the order of the search does not matter.
        if compared(found, self.best).then(found[1].cmp(&self.best[1])).is_lt() {
            self.best = found;
        }
    }

    /// The whole tile, if something in it may matter. A tile that lies on no layer as a whole is read.
    fn visit_tile(&mut self, tile: [i32; 2]) {
        let (here, side) = (self.here, TILE as i32);
        let low = [0, 1].map(|axis| tile[axis] * side - here.own[axis]);
        let tiles = self.map.pyramid.side() as i32;
        if tile.iter().all(|t| (0..tiles).contains(t)) {
            self.reads += 1;
            let [least, most] =
                self.map.pyramid.tile(here.layer as usize, tile[0] as usize, tile[1] as usize);
            // Sums round in the order of what is summed: a bound of the plane is exact.
            let plane_to =
                |sign: f32| {
                    here.plane_at([0, 1].map(|axis| {
                        if sign * here.slope[axis] > 0.0 { low[axis] + side - 1 } else { low[axis] }
                    }))
                };
            let width = if self.is_inner {
                if least > plane_to(1.0) + here.bias {
                    return;
                }
                self.own_width
            } else {
                let lowest = plane_to(-1.0);
                if most <= lowest + here.bias {
                    return;
                }
                here.width_of(most - lowest)
            };
            if compared([here.gap_to(low, side), width.pow(2)], self.best).is_gt() {
                return;
            }
        } else if self.map.space().layers() == 1 {
            return;
        }
        for j in low[1]..low[1] + side {
            for i in low[0]..low[0] + side {
                self.visit([i, j]);
            }
        }
    }

    /// Tiles in square rings around the own one, so that near changes come first.
    fn over_tiles(&mut self) -> Found {
        let own = self.here.own.map(|t| t.div_euclid(TILE as i32));
        let rings = (self.radius + CENTERS + TILE as i32 * UNITS - 1) / (TILE as i32 * UNITS);
        for ring in 0..=rings {
            for row in -ring..=ring {
                let step = if row.abs() == ring { 1 } else { 2 * ring };
                for column in (-ring..=ring).step_by(step as usize) {
                    self.visit_tile([own[0] + column, own[1] + row]);
                }
            }
        }
        Found::new(self.best, self.is_inner)
    }

    /// The same without tiles.
    #[cfg(test)]
    fn over_texels(&mut self) -> Found {
        for offset in offsets() {
            self.visit([offset.i.into(), offset.j.into()]);
        }
        Found::new(self.best, self.is_inner)
    }
}

/// The order of two quotients.
fn compared(a: [u32; 2], b: [u32; 2]) -> Ordering {
    (u64::from(a[0]) * u64::from(b[1])).cmp(&(u64::from(b[0]) * u64::from(a[1])))
}

impl LightMap<'_> {
    /// The stored depth of a texel in terms of a layer; `None` outside the map. Beyond the rim of a cube's
    /// layer it is the depth of the texel in the same direction, found with integers.
    pub(super) fn stored(&self, layer: u32, [i, j]: [i32; 2]) -> Option<f32> {
        let (space, side) = (self.space(), self.space().size() as i32);
        if let Some(&depth) = self.map.texel(layer as usize, i.into(), j.into()) {
            return Some(depth);
        }
        if space.layers() == 1 {
            return None;
        }
        // The rows of a cube are axes.
        let rows = |layer: usize| {
            let frame = space.frame(layer);
            [frame.right, frame.up, frame.axis].map(|row| row.as_ivec3())
        };
        let [right, up, axis] = rows(layer as usize);
        let towards = (2 * i + 1 - side) * right + (side - 1 - 2 * j) * up + side * axis;
        let size = towards.abs();
        let widest = (1..3).fold(0, |best, i| if size[i] > size[best] { i } else { best });
        let other = 2 * widest + usize::from(towards[widest] < 0);
        let [right, up, _] = rows(other);
        let (x, y, z) = (towards.dot(right), towards.dot(up), size[widest]);
        let [i, j] = [z + x, z - y].map(|t| (t * side / (2 * z)).min(side - 1));
        // Along a ray from the light, depths of two layers have a constant ratio.
        let depth = *self.map.texel(other, i.into(), j.into())?;
        Some(depth * z as f32 * (1.0 / side as f32))
    }

    /// The nearest change around a receiver, and the number of texels and tiles read.
    pub(super) fn change_around(&self, here: Around) -> Option<(Found, u32)> {
        let mut search = EdgeSearch::new(self, here)?;
        Some((search.over_tiles(), search.reads))
    }
}

impl Receiver<'_> {
    /// Whether the receiver's own texel blocks, and its depth; `None` outside the map.
    pub(super) fn own_texel(&mut self) -> Option<(f64, bool)> {
        let [i, j] = self.at.map(|t| t.floor() as i64);
        self.look(i, j)
    }

    /// The nearest change between blocked and open texels; `None` outside the map.
    pub(super) fn change(&mut self) -> Option<Found> {
        let (found, reads) = self.map.change_around(Around::of(&self.place, 0.0)?)?;
        self.reads += reads;
        Some(found)
    }

    /// Distance to the nearest open texel, in half-widths of the penumbra of a blocker at a depth; at most 1.
    pub(super) fn nearest_open(&mut self, own_depth: f64) -> f64 {
        let Some(here) = Around::of(&self.place, 0.0) else { return 1.0 };
        let mut search = EdgeSearch::from_depth(self.map, here, own_depth as f32, true);
        let found = search.over_tiles();
        self.reads += search.reads;
        found.distance()
    }

    /// The nearest change by a loop over all texels.
    #[cfg(test)]
    pub(super) fn change_by_texels(&mut self) -> Option<Found> {
        let mut search = EdgeSearch::new(self.map, Around::of(&self.place, 0.0)?)?;
        let found = search.over_texels();
        self.reads += search.reads;
        Some(found)
    }

    /// The visible part of the lamp at a signed distance from an edge, in half-widths of the penumbra.
    pub(super) fn profile(&self, x: f64) -> f64 {
        profile(self.is_round, x)
    }
}
