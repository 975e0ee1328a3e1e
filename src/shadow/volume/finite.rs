//! A volume that ends: for formats that hold no vertex at infinity, and programs that draw none.
//!
//! The volume of a face is a prism without end. It is cut off by a copy of the face:
//!
//! - Directional light: by the face moved by `D` along the light. The prism then holds the points of the
//!   shadow whose distance from the face, along the light, is at most `D`.
//! - Point light `L`: by the face scaled around `L` by a factor `t > 1`, the same for all faces. The prism
//!   then holds the points `L + s·(x − L)` with `x` on the face and `1 ≤ s ≤ t`. (A copy whose corners are
//!   moved by one distance each comes nearer to the light between its corners than at them.)
//!
//! Copies of neighboring faces share their edges, so the cut volume is closed wherever the infinite one is.
//!
//! # What it covers
//!
//! Let `p` be a point in shadow, at most `d` from a point `y` of a box that holds the caster, and `x` a point
//! of a casting face between `p` and the light.
//!
//! - Directional: the distance from `x` to `p` is at most `d` plus that from `x` to `y`, which is at most the
//!   box's diagonal. So `D = d + diagonal` covers `d`.
//! - Point light: `|p − L|` is at most `d` plus the distance `f` from the light to the farthest corner of the
//!   box; `|x − L|` is at least the distance `n` of the nearest casting face. So `t = (d + f)/n` covers `d`.
//!   No casting face contains the light, so `n > 0`.
//!
//! Vertices are rounded to `f32`: next to its sides the cut volume is as exact as these coordinates. A vertex
//! that would leave `f32` ends the volume earlier, and it covers less.

use std::ops::Range;

use glam::DVec3;

use super::ShadowVolume;
use crate::geom::Aabb;

/// A shadow volume without vertices at infinity.
#[derive(Clone, Debug, PartialEq)]
pub struct FiniteVolume {
    /// Positions: those of the caster first, then those of the far end.
    pub positions: Vec<[f32; 3]>,
    /// Triangles: light cap, then sides, then dark cap.
    pub triangles: Vec<[u32; 3]>,
    /// Range of the light cap.
    pub light_cap: Range<usize>,
    /// Range of the sides.
    pub sides: Range<usize>,
    /// Range of the dark cap.
    pub dark_cap: Range<usize>,
    /// Every shadowed point at most this far from the caster's box is in the volume: the distance that was
    /// asked for, or less where a vertex would leave `f32`. 0 if that is not even true within the box.
    pub covers: f64,
}

/// Bound of the relative error of a handful of `f64` operations.
const ROUNDING: f64 = 1.0 / (1_u64 << 40) as f64;

impl ShadowVolume {
    /// The same volume, cut off so far from the light that it holds every shadowed point within `distance` of
    /// `bounds`, the box around the caster.
    ///
    /// Closed if this volume has both caps. For a directional light the far end is a copy of the light cap,
    /// for a point light the dark cap moved in from infinity.
    ///
    /// ```
    /// use umbrage::caster::Caster;
    /// use umbrage::geom::Aabb;
    /// use umbrage::shadow::volume::Caps;
    /// use umbrage::testing::shapes;
    /// let caster = Caster::new(shapes::cube());
    /// let volume = caster.volume(&"directional:0.3,-1,0.1".parse()?, Caps::Both);
    /// let finite = volume.finite(100.0, &Aabb { low: [-1.0; 3], high: [1.0; 3] });
    /// assert_eq!((finite.covers, finite.dark_cap.len()), (100.0, finite.light_cap.len()));
    /// assert!(finite.positions.iter().any(|p| p[1] < -90.0));
    /// # Ok::<(), umbrage::geom::LightError>(())
    /// ```
    #[must_use]
    pub fn finite(&self, distance: f32, bounds: &Aabb) -> FiniteVolume {
        let bounds = bounds.join(&self.finite_bounds());
        match self.light.is_directional() {
            true => self.moved(f64::from(distance), &bounds),
            false => self.scaled(f64::from(distance), &bounds),
        }
    }

    /// Cut off by a copy that is moved along a directional light.
    fn moved(&self, distance: f64, bounds: &Aabb) -> FiniteVolume {
        let travel = -wide(self.light.xyz()).normalize();
        let diagonal = bounds.diagonal();
        let room = self.positions.iter().map(|&p| steps(wide(p), travel)).fold(f64::INFINITY, f64::min);
        let wanted = (distance + diagonal) * (1.0 + ROUNDING);
        let step = wanted.min(room);
        let covers = if step == wanted { distance } else { (step * (1.0 - ROUNDING) - diagonal).max(0.0) };

        // Vertex v of the caster is vertex count + v of the far end.
        let count = self.positions.len() as u32;
        let mut positions = self.positions.clone();
        positions.extend(self.positions.iter().map(|&p| narrow(wide(p) + step * travel)));
        let cap = &self.triangles[self.light_cap()];
        let mut triangles = cap.to_vec();
        for &corners in &self.triangles[self.sides()] {
            // The triangle's corner at infinity, then the edge.
            let far = corners.iter().position(|&corner| corner >= count).unwrap_or(0);
            let [a, b] = [corners[(far + 1) % 3], corners[(far + 2) % 3]];
            triangles.extend([[a, b, b + count], [a, b + count, a + count]]);
        }
        let sides = cap.len()..triangles.len();
        triangles.extend(cap.iter().map(|&[a, b, c]| [a + count, c + count, b + count]));
        let dark_cap = sides.end..triangles.len();
        FiniteVolume { positions, triangles, light_cap: self.light_cap(), sides, dark_cap, covers }
    }

    /// Cut off by a copy that is scaled around a point light.
    fn scaled(&self, distance: f64, bounds: &Aabb) -> FiniteVolume {
        let light = wide(self.light.xyz());
        let (near, far) = (self.nearest(light), farthest(bounds, light));
        let wanted = (distance + far) * (1.0 + ROUNDING) / near;
        let room = self.positions.iter().map(|&p| steps(light, wide(p) - light));
        let room = room.fold(f64::INFINITY, f64::min).max(1.0);
        let factor = if self.positions.is_empty() { 1.0 } else { wanted.min(room) };
        let covers = match factor == wanted || self.positions.is_empty() {
            true => distance,
            false => (factor * near * (1.0 - ROUNDING) - far).max(0.0),
        };
        let mut positions = self.positions.clone();
        let bases = self.extruded.iter().map(|&base| self.positions[base as usize]);
        positions.extend(bases.map(|p| narrow(light + factor * (wide(p) - light))));
        FiniteVolume {
            positions,
            triangles: self.triangles.clone(),
            light_cap: self.light_cap(),
            sides: self.sides(),
            dark_cap: self.dark_cap(),
            covers,
        }
    }

    /// A lower bound of the distance from a point to the finite triangles of the light cap, and to the edges
    /// of the sides.
    fn nearest(&self, point: DVec3) -> f64 {
        let at = |vertex: u32| self.positions.get(vertex as usize).map(|&p| wide(p) - point);
        let finite = self.triangles[..self.light_cap + self.sides].iter();
        let distance = |corners: &[u32; 3]| {
            let corners: Vec<DVec3> = corners.iter().filter_map(|&corner| at(corner)).collect();
            match corners[..] {
                [a, b, c] => to_triangle([a, b, c]),
                [a, b] => to_segment(a, b),
                _ => f64::INFINITY,
            }
        };
        let nearest = finite.map(distance).fold(f64::INFINITY, f64::min) * (1.0 - ROUNDING);
        // Distances below the rounding of their coordinates are not known; the volume then ends where f32
        // does.
        nearest.max(f64::from(f32::MIN_POSITIVE))
    }
}

/// The distance from a point to the farthest corner of a box; 0 for an empty box.
fn farthest(bounds: &Aabb, point: DVec3) -> f64 {
    match bounds.is_empty() {
        true => 0.0,
        false => (wide(bounds.low) - point).abs().max((wide(bounds.high) - point).abs()).length(),
    }
}

/// How many steps from a point stay within `f32`.
fn steps(from: DVec3, step: DVec3) -> f64 {
    let most = f64::from(f32::MAX);
    let axes = (0..3).filter(|&axis| step[axis] != 0.0);
    axes.map(|axis| (most - from[axis] * step[axis].signum()) / step[axis].abs())
        .fold(f64::INFINITY, f64::min)
}

/// The distance of the origin from a triangle: from its plane where the foot of the perpendicular lies in the
/// triangle, else from its nearest side.
fn to_triangle([a, b, c]: [DVec3; 3]) -> f64 {
    let normal = (b - a).cross(c - a);
    let sides = [(a, b), (b, c), (c, a)];
    let least = sides.map(|(p, q)| to_segment(p, q)).into_iter().fold(f64::INFINITY, f64::min);
    let within = sides.iter().all(|&(p, q)| (q - p).cross(-p).dot(normal) >= 0.0);
    match within && normal != DVec3::ZERO {
        true => least.min(a.dot(normal.normalize()).abs()),
        false => least,
    }
}

/// The distance of the origin from a segment.
fn to_segment(a: DVec3, b: DVec3) -> f64 {
    let along = b - a;
    let squared = along.length_squared();
    let t = if squared > 0.0 { (-a.dot(along) / squared).clamp(0.0, 1.0) } else { 0.0 };
    (a + t * along).length()
}

fn wide(p: [f32; 3]) -> DVec3 {
    DVec3::from(p.map(f64::from))
}

fn narrow(p: DVec3) -> [f32; 3] {
    let most = DVec3::splat(f64::from(f32::MAX));
    p.clamp(-most, most).as_vec3().into()
}
