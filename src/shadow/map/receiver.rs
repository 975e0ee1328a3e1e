//! Receivers: points to shade, and the texels that a filter reads for them.

use glam::DVec3;

use super::space::{LightSpace, Lookup};

/// A point of a face in light space.
#[derive(Clone, Copy, Debug)]
pub struct Receiver<'a> {
    space: &'a LightSpace,
    point: DVec3,
    normal: DVec3,
    lookup: Lookup,
    slope: [f64; 2],
}

/// A texel read for a receiver, and the receiver's plane in that texel's layer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tap {
    /// The texel's layer.
    pub layer: usize,
    /// The texel's column.
    pub i: i64,
    /// The texel's row.
    pub j: i64,
    /// The receiver's depth in that layer.
    pub d: f64,
    /// Change of depth per texel on the receiver's plane in that layer.
    pub slope: [f64; 2],
    /// The texel's center less the receiver's position, in texels of that layer.
    pub away: [f64; 2],
    /// Whether the layer is another one than the receiver's, across the seam of a cube.
    pub is_across: bool,
}

impl Tap {
    /// Depth of the receiver's plane at the texel's center.
    #[must_use]
    pub fn plane(&self) -> f64 {
        self.d + self.slope[0] * self.away[0] + self.slope[1] * self.away[1]
    }
}

impl<'a> Receiver<'a> {
    /// The receiver at a point of a face with this normal. `None` where the map has no position for the
    /// point: behind a spot.
    #[must_use]
    pub fn new(space: &'a LightSpace, point: DVec3, normal: DVec3) -> Option<Self> {
        let lookup = space.at(point)?;
        Some(Self { space, point, normal, lookup, slope: space.slope(lookup.layer, normal, point) })
    }

    /// The space.
    #[must_use]
    pub fn space(&self) -> &LightSpace {
        self.space
    }

    /// Position and depth.
    #[must_use]
    pub fn lookup(&self) -> &Lookup {
        &self.lookup
    }

    /// Change of depth per texel on the receiver's plane.
    #[must_use]
    pub fn slope(&self) -> [f64; 2] {
        self.slope
    }

    /// Allowance for rounding at a depth.
    #[must_use]
    pub fn rounding(&self, d: f64) -> f64 {
        self.space.rounding(d)
    }

    /// Texel (i, j) of the receiver's layer. Beside a cube's layer it is the texel of another layer in the
    /// same direction, with the receiver's depth and plane in that layer, so that depths along the same axis
    /// are compared. `None` outside any other map.
    #[must_use]
    pub fn tap(&self, i: i64, j: i64) -> Option<Tap> {
        let side = i64::from(self.space.size());
        let Lookup { layer, tx, ty, d } = self.lookup;
        let [x, y] = [i, j].map(|i| i as f64 + 0.5);
        if (0..side).contains(&i) && (0..side).contains(&j) {
            return Some(Tap { layer, i, j, d, slope: self.slope, away: [x - tx, y - ty], is_across: false });
        }
        if self.space.layers() == 1 {
            return None;
        }
        let at = self.space.at(self.space.point(layer, x, y, 1.0))?;
        let [i, j] = [at.tx, at.ty].map(|t| (t.floor() as i64).clamp(0, side - 1));
        let own = self.space.at_layer(at.layer, self.point)?;
        let away = [i as f64 + 0.5 - own.tx, j as f64 + 0.5 - own.ty];
        let slope = self.space.slope(at.layer, self.normal, self.point);
        Some(Tap { layer: at.layer, i, j, d: own.d, slope, away, is_across: at.layer != layer })
    }
}
