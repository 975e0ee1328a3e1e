//! How much of an even sky a surface point sees: the six sides of a cube around it, each a light at infinity.
//!
//! The cube's edges run along the axes, so that its sides meet without a gap in numbers that were never
//! rounded. The measure of a part is Lambert's (`form.rs`), over all of the hemisphere above the receiver;
//! or, without a normal, the solid angle over that of the whole sphere. The mean open direction (`bent.rs`)
//! has the same weights.

use std::f64::consts::{PI, TAU};

use glam::DVec3;
use multiversion::multiversion;

use super::bent::Bent;
use super::chain::{ASIDE, Chain, NADIR};
use super::fault::Fault;
use super::form::{Form, horizon};
use super::frame::{EPSILON, Frame, Plane, wide};
use super::pyramid::Pyramid;
use super::sweep::{AtLeft, Sink, Trapezoid};
use super::{Scratch, SoftOracle};
use crate::geom::predicate::{on_triangle, side_of_point};
use crate::mesh::FaceId;
use crate::oracle::sorted_corners;

/// A surface point.
#[derive(Clone, Copy, Debug)]
pub(crate) struct UnderSky {
    pub(crate) point: [f32; 3],
    /// Of any length but 0. `None`: every direction counts alike.
    pub(crate) normal: Option<[f32; 3]>,
    /// The face whose middle this is. It hides nothing from the point, nor does a face of the same corners.
    pub(crate) face: Option<FaceId>,
}

/// How receivers at hard edges lie off faces through their points that are not their own; each by its index.
#[derive(Clone, Copy)]
pub(crate) struct HardEdges<'a> {
    /// The direction in place of the normal, if it is another one.
    pub(crate) off: &'a (dyn Fn(usize) -> Option<[f32; 3]> + Sync),
    pub(crate) is_own: &'a (dyn Fn(usize, FaceId) -> bool + Sync),
}

/// Faces through a receiver that are not like others.
#[derive(Debug, Default)]
struct Around {
    /// The face whose middle it is.
    middle_of: Option<[u32; 3]>,
    /// The direction off faces that are not `own`.
    off: Option<[f32; 3]>,
    /// Ascending.
    own: Vec<[[u32; 3]; 3]>,
}

/// The open share of the sky.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Open {
    pub(crate) share: f64,
    /// The true share differs by no more than this.
    pub(crate) bound: f64,
    /// The mean over all directions of the open ones, with the weights of the share; 0 unless asked for. The
    /// true one is no farther away than the bound.
    pub(crate) bent: DVec3,
}

/// Receivers per run; each run has buffers of its own.
const RUN: usize = 16;

impl SoftOracle<'_> {
    /// The open share of the sky above each receiver, on several threads if the feature `parallel` is on.
    ///
    /// A receiver with a normal lies off its point by nothing at all, in the direction of the normal: a face
    /// with the point as a corner hides what is beyond its opposite side, and one that the point is on what
    /// is beyond any of its sides; `edges` may name another direction. Other faces whose plane goes through
    /// the point hide nothing.
    ///
    /// `bent`: whether [`Open::bent`] is wanted.
    pub(crate) fn open_sky(&self, receivers: &[UnderSky], edges: HardEdges<'_>, bent: bool) -> Vec<Open> {
        let slots = receivers.iter().any(|receiver| receiver.face.is_some()).then(|| self.slots());
        let own = |receiver: &UnderSky| {
            let slot = *slots.as_ref()?.get(receiver.face?.index())?;
            Some(ordered(self.corners[slot as usize]))
        };
        let mut found = vec![Open::default(); receivers.len()];
        crate::parallel::rows(&mut found, RUN, |run, found| {
            let mut scratch = Scratch::default();
            for (index, found) in (run * RUN..).zip(found) {
                let receiver = &receivers[index];
                let mut around =
                    Around { middle_of: own(receiver), off: (edges.off)(index), own: Vec::new() };
                if around.off.is_some() {
                    self.oracle.for_each_face_near(receiver.point, |face, corners| {
                        if (edges.is_own)(index, face) {
                            around.own.push(sorted_corners(corners));
                        }
                    });
                    around.own.sort_unstable();
                }
                *found = self.sky_above(receiver, &around, bent, &mut scratch);
            }
        });
        found
    }

    /// The slot of each face.
    fn slots(&self) -> Vec<u32> {
        let mut slots = vec![0; self.oracle.order.len()];
        for (slot, &face) in (0..).zip(&self.oracle.order) {
            slots[face as usize] = slot;
        }
        slots
    }

    fn sky_above(&self, receiver: &UnderSky, around: &Around, bent: bool, scratch: &mut Scratch) -> Open {
        if receiver.point.iter().any(|x| !x.is_finite()) {
            return Open { share: 1.0, bound: 1.0, bent: DVec3::ZERO };
        }
        let normal = receiver.normal.map(|normal| wide(normal).normalize_or_zero());
        let mut all = Open::default();
        for axis in 0..3 {
            for sign in [1.0, -1.0] {
                let Some(frame) = side(axis, sign, normal) else { continue };
                let open = self.side_above(receiver, normal, around, (frame, bent), scratch);
                all.share += open.share;
                all.bound += open.bound;
                all.bent += open.bent;
            }
        }
        Open { share: all.share.clamp(0.0, 1.0), ..all }
    }

    fn side_above(
        &self,
        receiver: &UnderSky,
        normal: Option<DVec3>,
        around: &Around,
        (frame, bent): (Frame, bool),
        scratch: &mut Scratch,
    ) -> Open {
        let reach = self.oracle.tree.reach(receiver.point);
        // A part of a side measures less than its area, over π or 4π, in a plane at distance 1.
        let per_area = frame.e1.length() * frame.e2.length() / if normal.is_some() { PI } else { 2.0 * TAU };
        // The edges of the frame are at right angles.
        let Ok(pyramid) = Pyramid::new(frame, receiver.point, reach) else {
            return Open { bound: per_area, ..Open::default() };
        };
        let Scratch { chain, sweep } = scratch;
        chain.clear();
        #[cfg(test)]
        {
            chain.faults = self.faults;
        }
        gather(self, &pyramid, reach, receiver, around, chain);
        chain.project(&pyramid);
        let above = normal.is_none_or(|normal| horizon(&pyramid, normal, &mut chain.edges));
        let at_left = AtLeft { chain: chain.at_left, light: 1, horizon: i32::from(above) };
        let mut measure = Measure {
            pyramid: &pyramid,
            form: normal.map(|n| Form::new(&pyramid, n, false)),
            bent: bent.then(|| Bent::new(&pyramid, normal)),
            sum: 0.0,
            parts: 0,
        };
        sweep.run(&mut chain.edges, &mut chain.left, at_left, chain.faults, &mut measure);
        let error = pyramid.least_error() + chain.moved + sweep.lost + 8.0 * EPSILON;
        // Four lines of a part, each off by less than 16ε, over 2π; triangles are better. Of the bent
        // direction as many lines, and two triangles, each off by less than 28ε, over 3π.
        let summed = f64::from(measure.parts) * 16.0 * EPSILON;
        let bent = measure.bent.as_ref().map_or(DVec3::ZERO, Bent::total);
        Open { share: measure.total(), bound: error * per_area + summed, bent }
    }
}

/// Of one side of the cube the rectangle that holds what is above the horizon; `None` if nothing is.
fn side(axis: usize, sign: f64, normal: Option<DVec3>) -> Option<Frame> {
    let [ahead, e1, e2] = [axis, (axis + 1) % 3, (axis + 2) % 3].map(|i| DVec3::AXES[i]);
    let ahead = sign * ahead;
    let [low, high] = match normal {
        None => [[-1.0; 2], [1.0; 2]],
        Some(normal) => above([ahead, e1, e2].map(|axis| normal.dot(axis)))?,
    };
    Some(Frame {
        anchor: [0.0; 3],
        offset: ahead + low[0] * e1 + low[1] * e2,
        e1: (high[0] - low[0]) * e1,
        e2: (high[1] - low[1]) * e2,
        plane: Plane::Infinite,
        at_infinity: true,
        rounding: 0.0,
    })
}

/// The lowest and the highest (u, v) in −1 ..= 1 with h + a·u + b·v ≥ 0.
fn above([h, a, b]: [f64; 3]) -> Option<[[f64; 2]; 2]> {
    let square = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
    let height = |[u, v]: [f64; 2]| h + a * u + b * v;
    let (mut low, mut high) = ([1.0_f64; 2], [-1.0_f64; 2]);
    let mut take = |x: [f64; 2]| {
        for i in 0..2 {
            low[i] = low[i].min(x[i]);
            high[i] = high[i].max(x[i]);
        }
    };
    for i in 0..4 {
        let (from, to) = (square[i], square[(i + 1) % 4]);
        let (here, there) = (height(from), height(to));
        if here >= 0.0 {
            take(from);
        }
        if (here < 0.0) != (there < 0.0) {
            let t = here / (here - there);
            take([0, 1].map(|i| from[i] + t * (to[i] - from[i])));
        }
    }
    (low[0] < high[0] && low[1] < high[1]).then_some([low, high])
}

fn ordered(mut corners: [u32; 3]) -> [u32; 3] {
    corners.sort_unstable();
    corners
}

/// The measure of what is visible.
struct Measure<'a> {
    pyramid: &'a Pyramid,
    form: Option<Form<'a>>,
    bent: Option<Bent<'a>>,
    /// Solid angles.
    sum: f64,
    parts: u32,
}

impl Measure<'_> {
    fn total(&self) -> f64 {
        match &self.form {
            Some(form) => form.total(),
            None => (self.sum / (2.0 * TAU)).max(0.0),
        }
    }
}

impl Sink for Measure<'_> {
    fn covered(&mut self, _: Trapezoid) {}

    fn visible(&mut self, part: Trapezoid) {
        self.parts += 1;
        if let Some(bent) = &mut self.bent {
            bent.add(part);
        }
        if let Some(form) = &mut self.form {
            return form.add(part);
        }
        let Trapezoid { v, left, right } = part;
        let [a, b, c, d] = [[left[0], v[0]], [right[0], v[0]], [right[1], v[1]], [left[1], v[1]]]
            .map(|[u, v]| self.pyramid.towards(u, v).normalize());
        self.sum += solid_angle([a, b, c]) + solid_angle([a, c, d]);
    }
}

/// The solid angle of a triangle with unit vectors to its corners (van Oosterom and Strackee, *The Solid
/// Angle of a Plane Triangle*, 1983).
pub(super) fn solid_angle([a, b, c]: [DVec3; 3]) -> f64 {
    let height = a.dot(b.cross(c)).abs();
    2.0 * height.atan2(1.0 + a.dot(b) + b.dot(c) + c.dot(a))
}

/// Whether a point lies on a face.
#[inline(always)]
fn goes_through(corners: [[f32; 3]; 3], p: [f32; 3]) -> bool {
    let within = |i: usize| {
        let [a, b, c] = corners.map(|x| x[i]);
        a.min(b).min(c) <= p[i] && p[i] <= a.max(b).max(c)
    };
    (0..3).all(within) && side_of_point(corners, p).is_zero() && on_triangle(corners, p)
}

/// The traversal, with AVX2 instructions where the processor has them.
#[multiversion(targets("x86_64+avx2+bmi1+bmi2+lzcnt"))]
fn gather(
    soft: &SoftOracle<'_>,
    pyramid: &Pyramid,
    reach: [f64; 3],
    receiver: &UnderSky,
    around: &Around,
    chain: &mut Chain,
) {
    let (sides, count) = pyramid.sides(reach);
    let down = receiver.normal.map(|normal| normal.map(|x| -x));
    let p = receiver.point;
    soft.oracle.tree.walk_within(p, reach, &sides[..count], |slot| {
        let (corners, ids) = (soft.oracle.triangles[slot], soft.corners[slot]);
        if around.middle_of.is_some_and(|own| own == ordered(ids)) {
            return;
        }
        match down {
            _ if !goes_through(corners, p) => chain.add(pyramid, corners, ids),
            Some(down) if !chain.faults.has(Fault::NoFan) => {
                let is_own = || around.own.binary_search(&sorted_corners(corners)).is_ok();
                let below = match around.off {
                    Some(off) if !is_own() => (off.map(|x| -x), ASIDE),
                    _ => (down, NADIR),
                };
                // A side through the point subtends nothing with the direction down.
                for i in 0..3 {
                    let side = [i, (i + 1) % 3];
                    chain.add_below(pyramid, side.map(|i| corners[i]), side.map(|i| ids[i]), below);
                }
            }
            _ => {}
        }
    });
}
