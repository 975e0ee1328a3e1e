//! The depth map of a lamp with an extent, as all soft techniques read it.

use glam::DVec3;

use super::pyramid::Pyramid;
use crate::caster::CasterGroup;
use crate::oracle::PrimaryHit;
use crate::scene::Lamp;
use crate::shadow::map::{
    DepthSource, LightSpace, MapError, PolygonOffset, ShadowMap, Spread, unit_normal, wide,
};

/// Texels of slack of each comparison: a face smaller than a texel may end at its center.
pub(super) const SLACK: f64 = 0.5;
/// The penumbra scale along one axis of the map is at least this part of that along the other one. A lamp
/// that is seen edge-on has a penumbra in one direction alone.
const LEAST_ASPECT: f64 = 1.0 / 1024.0;

/// A map fitted to the scene, its pyramid, and the lamp.
#[derive(Debug)]
pub(super) struct LightMap<'a> {
    pub(super) casters: &'a CasterGroup<'a>,
    pub(super) lamp: Lamp,
    pub(super) map: ShadowMap<f32>,
    pub(super) pyramid: Pyramid,
}

/// A visible point in the space of the map, with what the map is asked for it.
#[derive(Debug)]
pub(super) struct Receiver<'a> {
    pub(super) map: &'a LightMap<'a>,
    pub(super) place: Place,
    /// Number of texels read.
    pub(super) reads: u32,
}

/// A visible point in the space of a map.
///
/// All positions are texels of the receiver's own layer, whose plane is continued beyond its rim: on a cube a
/// texel beyond the rim is the one of the other layer in the same direction.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    pub(super) layer: usize,
    /// Column and row.
    pub(super) at: [f64; 2],
    /// Reversed depth.
    pub(super) d: f64,
    /// Depth of the receiver's plane at column 0 and row 0, and its change per texel.
    origin: f64,
    pub(super) slope: [f64; 2],
    /// Slack and rounding.
    pub(super) bias: f64,
    /// The penumbra law's K along columns and rows: texels of half-width per difference of depth.
    pub(super) k: [f64; 2],
    /// The same for the box around the lamp.
    pub(super) k_box: [f64; 2],
    pub(super) is_round: bool,
}

impl std::ops::Deref for Receiver<'_> {
    type Target = Place;

    fn deref(&self) -> &Place {
        &self.place
    }
}

impl<'a> LightMap<'a> {
    pub(super) fn prepare(casters: &'a CasterGroup<'a>, lamp: &Lamp, size: u32) -> Result<Self, MapError> {
        let space = LightSpace::of_scene(casters, lamp, size)?;
        let offset = PolygonOffset::default();
        let map = ShadowMap::draw(casters, lamp.light(), space, DepthSource::Plane, offset)?;
        let pyramid = Pyramid::of(&map);
        Ok(Self { casters, lamp: lamp.clone(), map, pyramid })
    }

    pub(super) fn space(&self) -> &LightSpace {
        self.map.space()
    }

    pub(super) fn bytes(&self) -> usize {
        self.map.bytes() + self.pyramid.bytes()
    }

    /// Side of a texel in mesh units, in the middle of what is seen.
    pub(super) fn texel_world(&self) -> f64 {
        self.space().texel_world(wide(self.casters.bounds().center()))
    }

    /// The bias of a plane that meets the light at 45° in the worst direction, in mesh units along the light.
    pub(super) fn bias_world(&self) -> f64 {
        self.texel_world() * SLACK * std::f64::consts::SQRT_2
    }

    /// The receiver at a visible point; `None` outside the map.
    pub(super) fn receiver(&self, hit: &PrimaryHit) -> Option<Receiver<'_>> {
        Some(Receiver { map: self, place: Place::of(self.space(), &self.lamp, hit)?, reads: 0 })
    }
}

impl Place {
    /// `None` outside the map.
    pub(super) fn of(space: &LightSpace, lamp: &Lamp, hit: &PrimaryHit) -> Option<Self> {
        let point = wide(hit.point);
        let at = space.at(point)?;
        let side = f64::from(space.size());
        if space.layers() == 1 && !((0.0..side).contains(&at.tx) && (0.0..side).contains(&at.ty)) {
            return None;
        }
        // A face of which rounding leaves no normal, or that contains the direction to the light, is edge-on:
        // the map cannot tell what lies before it.
        let slope = unit_normal(hit.corners).map_or([f64::NAN; 2], |n| space.slope(at.layer, n, point));
        let [k, k_box] = penumbra_scale(space, lamp, hit.point, at.layer);
        Some(Self {
            layer: at.layer,
            at: [at.tx, at.ty],
            d: at.d,
            origin: at.d - slope[0] * at.tx - slope[1] * at.ty,
            slope,
            bias: SLACK * (slope[0].abs() + slope[1].abs()) + space.rounding(at.d),
            k,
            k_box,
            is_round: lamp.patch(hit.point).is_some_and(|patch| patch.is_round),
        })
    }

    /// Whether the map can tell anything here: the receiver is not edge-on to the light.
    pub(super) fn is_sound(&self) -> bool {
        (self.origin + self.bias).is_finite()
    }

    /// Depth of the receiver's plane at a texel's center.
    pub(super) fn plane(&self, i: i64, j: i64) -> f64 {
        self.origin + self.slope[0] * (i as f64 + 0.5) + self.slope[1] * (j as f64 + 0.5)
    }
}

/// The penumbra scale along columns and rows, for the lamp and for the box around it.
///
/// The lamp's surface is projected from the receiver onto the plane through its center that is parallel
/// to the map. There a rectangle is taken as the upright one with the same mean squares along both axes
/// of the map: itself, if its edges run along them. Zero for a lamp without an extent.
fn penumbra_scale(space: &LightSpace, lamp: &Lamp, point: [f32; 3], layer: usize) -> [[f64; 2]; 2] {
    let Some(patch) = lamp.patch(point) else { return [[0.0; 2]; 2] };
    let frame = space.frame(layer);
    let q = wide(point) - space.origin();
    let beside = |v: DVec3, row: DVec3| match space.spread() {
        Spread::Parallel { .. } => v.dot(row),
        // To first order in the depth of the lamp over that of the receiver; exact for a parallel lamp.
        Spread::Central { .. } => v.dot(row) - v.dot(frame.axis) * q.dot(row) / q.dot(frame.axis),
    };
    let scale = |joined: fn(f64, f64) -> f64| {
        let k = [frame.right, frame.up]
            .map(|row| joined(beside(patch.across, row).abs(), beside(patch.along, row).abs()))
            .map(|extent| space.penumbra_scale(extent));
        let least = LEAST_ASPECT * k[0].max(k[1]);
        // A lamp so large that numbers end covers any map.
        k.map(|k| if k.is_finite() { k.max(least) } else { f64::MAX.sqrt() })
    };
    let is_round = patch.is_round;
    [scale(f64::hypot), if is_round { scale(f64::hypot) } else { scale(|a, b| a + b) }]
}

impl Receiver<'_> {
    /// Columns, or rows, that there are: from, and up to but without.
    pub(super) fn limits(&self) -> [i64; 2] {
        let side = i64::from(self.map.space().size());
        // The layers beyond the rim of a cube's layer are as far away as is worth a search.
        if self.map.space().layers() == 1 { [0, side] } else { [-side, 2 * side] }
    }

    /// The stored depth of a texel, in terms of the receiver's layer; `None` outside the map.
    pub(super) fn depth(&mut self, i: i64, j: i64) -> Option<f64> {
        self.reads += 1;
        let (map, space) = (&self.map.map, self.map.space());
        if let Some(&depth) = map.texel(self.layer, i, j) {
            return Some(f64::from(depth));
        }
        if space.layers() == 1 {
            return None;
        }
        let toward = space.point(self.layer, i as f64 + 0.5, j as f64 + 0.5, 1.0);
        let other = space.at(toward)?;
        let most = i64::from(space.size()) - 1;
        let [i, j] = [other.tx, other.ty].map(|t| (t.floor() as i64).clamp(0, most));
        // Along a ray from the light, depths of two layers have a constant ratio: 1 here, `other.d` there.
        Some(f64::from(*map.texel(other.layer, i, j)?) / other.d)
    }

    /// Depth of a texel, and whether it lies before the receiver's plane; `None` outside the map.
    pub(super) fn look(&mut self, i: i64, j: i64) -> Option<(f64, bool)> {
        let threshold = self.plane(i, j) + self.bias;
        self.depth(i, j).map(|depth| (depth, depth > threshold))
    }

    /// Least depth of the plane between two corners of a box.
    pub(super) fn least_plane(&self, low: [f64; 2], high: [f64; 2]) -> f64 {
        let at = |axis: usize| (self.slope[axis] * low[axis]).min(self.slope[axis] * high[axis]);
        self.origin + at(0) + at(1)
    }

    /// Allowance for the rounding of a depth.
    pub(super) fn rounding(&self) -> f64 {
        self.map.space().rounding(self.d)
    }

    /// The depth of a texel that lies before the receiver's plane.
    pub(super) fn blocker(&mut self, i: i64, j: i64) -> Option<f64> {
        self.look(i, j).and_then(|(depth, blocks)| blocks.then_some(depth))
    }

    /// Half-widths of the penumbra of a blocker at this depth, along columns and rows.
    pub(super) fn widths(&self, depth: f64) -> [f64; 2] {
        self.k.map(|k| k * (depth - self.d))
    }

    /// Half-sides of the smallest box that holds all blockers, at least half a texel each: those of the
    /// greatest depth of the map, then of the greatest depth within that box, and so on.
    pub(super) fn search(&mut self, k: [f64; 2]) -> [f64; 2] {
        // Most boxes are settled by the fourth; each costs a few cells of the pyramid.
        const ROUNDS: u32 = 6;
        let mut most = self.map.pyramid.most();
        let mut half = [0.5; 2];
        for _ in 0..ROUNDS {
            half = k.map(|k| (k * (most - self.d)).max(0.5));
            let (found, cells) = self.map.pyramid.most_within(self.layer, self.at, half);
            self.reads += cells;
            if found >= most {
                break;
            }
            most = found;
        }
        half
    }
}

/// The visible part of a lamp at a signed distance from an edge, in half-widths of the penumbra: exact for a
/// straight edge, and for a square lamp along the map's axes.
pub(super) fn profile(is_round: bool, x: f64) -> f64 {
    let x = x.clamp(-1.0, 1.0);
    match is_round {
        true => 0.5 + (x.asin() + x * (1.0 - x * x).sqrt()) / std::f64::consts::PI,
        false => 0.5 + 0.5 * x,
    }
}
