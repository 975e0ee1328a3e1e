//! The eye of a view, and the tiles of its picture.

use glam::DVec3;

use super::fault::{Fault, Faults};
use crate::geom::Light;
use crate::geom::predicate::Homogeneous;
use crate::oracle::PrimaryHit;
use crate::shadow::Samples;
use crate::view::Projection;

/// Bound of the error of a depth, relative to the magnitudes of its terms: see [`View::depth`].
const DEPTH_ERROR: f64 = 8.0 * f64::EPSILON;

/// An eye, which is a point or at infinity, like a light.
#[derive(Clone, Copy, Debug)]
pub(super) struct View {
    eye: Light,
    pub(super) origin: [f32; 3],
    forward: DVec3,
}

impl View {
    /// `None` if the projection is not of finite numbers.
    pub(super) fn of(projection: &Projection) -> Option<Self> {
        let eye = match projection.is_orthographic() {
            false => Light::point(projection.eye),
            true => Light::directional(projection.forward),
        };
        let forward = DVec3::from(projection.forward.map(f64::from));
        let origin = projection.eye;
        let is_finite = origin.iter().all(|x| x.is_finite()) && forward.is_finite();
        Some(Self { eye: eye.ok().filter(|_| is_finite)?, origin, forward })
    }

    /// The eye; `None` at infinity.
    pub(super) fn point(&self) -> Option<[f32; 3]> {
        (!self.eye.is_directional()).then(|| self.eye.xyz())
    }

    pub(super) fn eye(&self) -> Homogeneous {
        Homogeneous::light(&self.eye)
    }

    /// A point relative to the origin; every coordinate is rounded once.
    pub(super) fn local(&self, p: [f32; 3]) -> DVec3 {
        DVec3::from([0, 1, 2].map(|i| f64::from(p[i]) - f64::from(self.origin[i])))
    }

    /// The depth of a point or a direction, and a bound of its error: one rounding of each coordinate, one of
    /// each product, two of the sum.
    pub(super) fn depth(&self, at: DVec3) -> (f64, f64) {
        (self.forward.dot(at), DEPTH_ERROR * self.forward.abs().dot(at.abs()))
    }
}

/// Some samples as seen from the eye: a box of directions, and a range of depths.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cell {
    low: DVec3,
    high: DVec3,
    /// Middle and half of the box.
    pub(super) middle: DVec3,
    pub(super) half: DVec3,
    /// At least the sum of the magnitudes of a direction's terms.
    pub(super) reach: f64,
    /// The least and the greatest depth, by which directions are scaled.
    pub(super) depth: [f64; 2],
    /// The same with the errors of the depths.
    pub(super) bounds: [f64; 2],
    /// The direction of all rays, if they are parallel; a box then holds points at depth 0.
    pub(super) along: Option<DVec3>,
}

impl Cell {
    /// A cell of one sample; `None` if its point is not in front of the eye.
    fn of(view: &View, p: [f32; 3]) -> Option<Self> {
        let local = view.local(p);
        let (depth, error) = view.depth(local);
        let along = view.eye.is_directional().then_some(view.forward);
        let (at, reach) = match along {
            None => (local / depth, 0.0),
            Some(along) => (local - depth * along, (depth * along).abs().element_sum()),
        };
        let reach = reach + 2.0 * at.abs().element_sum();
        let is_finite = at.is_finite() && depth.is_finite();
        (is_finite && (along.is_some() || depth > 0.0)).then_some(Self {
            low: at,
            high: at,
            middle: at,
            half: DVec3::ZERO,
            reach,
            depth: [depth; 2],
            bounds: [depth - error, depth + error],
            along,
        })
    }

    fn join(&self, other: &Self) -> Self {
        let (low, high) = (self.low.min(other.low), self.high.max(other.high));
        let both = |a: [f64; 2], b: [f64; 2]| [a[0].min(b[0]), a[1].max(b[1])];
        Self {
            low,
            high,
            middle: 0.5 * (low + high),
            half: 0.5 * (high - low),
            reach: self.reach.max(other.reach),
            depth: both(self.depth, other.depth),
            bounds: both(self.bounds, other.bounds),
            along: self.along,
        }
    }
}

/// One row of tiles.
#[derive(Clone, Debug)]
pub(super) struct TileRow {
    /// All samples that are asked in this row.
    pub(super) all: Cell,
    /// `None` for a tile in which no sample is asked.
    pub(super) tiles: Vec<Option<Cell>>,
}

/// The tiles of a picture.
#[derive(Clone, Debug)]
pub(super) struct Tiles {
    /// `None` for a row in which no sample is asked.
    pub(super) rows: Vec<Option<TileRow>>,
    /// Samples whose point is not in front of the eye, by rounding: they are in no tile.
    pub(super) outside: Vec<usize>,
}

impl Tiles {
    /// Tiles of `side` by `side` samples.
    pub(super) fn of(samples: &Samples, asked: &[bool], view: &View, side: usize, faults: Faults) -> Self {
        let (width, mut outside) = (samples.row_len(), Vec::new());
        let row_of = |(number, hits): (usize, &[Option<PrimaryHit>])| {
            let first = number * width * side;
            let mut tiles: Vec<Option<Cell>> = vec![None; width.div_ceil(side)];
            for (index, hit) in hits.iter().enumerate() {
                let Some(hit) = hit.as_ref().filter(|_| asked[first + index]) else { continue };
                let Some(own) = Cell::of(view, hit.point) else {
                    outside.push(first + index);
                    continue;
                };
                let tile = &mut tiles[index % width / side];
                *tile = Some(tile.map_or(own, |tile| match faults.has(Fault::FirstDepth) {
                    false => tile.join(&own),
                    true => Cell { depth: tile.depth, bounds: tile.bounds, ..tile.join(&own) },
                }));
            }
            let all = tiles.iter().copied().flatten().reduce(|a, b| a.join(&b))?;
            Some(TileRow { all, tiles })
        };
        let rows = samples.hits().chunks(width * side).enumerate().map(row_of).collect();
        Self { rows, outside }
    }
}
