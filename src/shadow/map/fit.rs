//! Fitting a light space to a scene.

use glam::{DVec3, DVec4};

use super::clip::clip;
use super::space::{CUBE, LightSpace, Spread, frame_of, wide};
use super::{MAX_SIZE, MapError};
use crate::caster::CasterGroup;
use crate::geom::Light;
use crate::geom::predicate::{side_of_light, side_of_point};
use crate::scene::Lamp;

/// Texels left free around the scene, so that filters at its rim stay on the map.
const PAD: u32 = 2;
/// Part of the depth range left free at each end of a parallel projection.
const SLACK: f64 = 0.001;
/// Ratio of the near distance to the least depth of a caster.
const NEAR: f64 = 0.99;

impl LightSpace {
    /// The space that shows all that casts or is seen, with `size` texels a side.
    ///
    /// A lamp with a cone gets one layer around the cone, unless that is so wide that a cube with texels as
    /// small on the axis has fewer of them: from a half-angle of 67.8°, with a tangent of √6. Any other lamp
    /// at a position gets a cube.
    ///
    /// # Errors
    ///
    /// [`MapError::Size`] if `size` is 0 or more than [`MAX_SIZE`].
    pub fn of_scene(casters: &CasterGroup<'_>, lamp: &Lamp, size: u32) -> Result<Self, MapError> {
        if !(1..=MAX_SIZE).contains(&size) {
            return Err(MapError::Size { size });
        }
        let light = lamp.light();
        Ok(if light.is_directional() { parallel(casters, light, size) } else { central(casters, lamp, size) })
    }
    /// The same central space with its near distance fitted to the casters.
    fn with_near(self, casters: &CasterGroup<'_>) -> Self {
        let Spread::Central { tan, .. } = self.spread else { return self };
        let (mut least, mut farthest) = (f64::INFINITY, 0.0_f64);
        for layer in 0..self.layers {
            for_each_face(casters, |corners, casts| {
                let at = corners.map(|p| DVec4::from(self.homogeneous(layer, wide(p))));
                if is_outside(at) {
                    return;
                }
                for p in clip(at, 1.0, 0.0).corners() {
                    farthest = farthest.max(p.z);
                    if casts {
                        least = least.min(p.z);
                    }
                }
            });
        }
        // The near distance is a mere unit of depth, which floats of 24 bits hold at any scale; its lower
        // bound leaves a device room to clip at it.
        let lowest = farthest * (-12_f64).exp2();
        let near = if least.is_finite() { (NEAR * least).max(lowest) } else { lowest };
        Self { spread: Spread::Central { tan, near: positive(near, 1.0) }, ..self }
    }
}

/// Whether a face lies beside the map's square pyramid, or behind the light, by one of its planes.
pub(super) fn is_outside(corners: [DVec4; 3]) -> bool {
    let all = |beyond: fn(DVec4) -> bool| corners.iter().all(|&p| beyond(p));
    all(|p| p.z <= 0.0)
        || all(|p| p.x > p.z)
        || all(|p| -p.x > p.z)
        || all(|p| p.y > p.z)
        || all(|p| -p.y > p.z)
}

/// Side of the map over the side that the scene takes up.
pub(super) fn padding(size: u32) -> f64 {
    let pad = PAD.min(size / 4);
    f64::from(size) / f64::from(size - 2 * pad)
}

fn positive(x: f64, otherwise: f64) -> f64 {
    if x > 0.0 && x.is_finite() { x } else { otherwise }
}

/// Calls `visit` with every face that casts or is seen, and whether it casts.
fn for_each_face(casters: &CasterGroup<'_>, mut visit: impl FnMut([[f32; 3]; 3], bool)) {
    let casting = casters.casters().iter().map(|caster| (caster.mesh(), true));
    let seen = casters.seen_caster().map(|caster| (caster.mesh(), false));
    for (mesh, casts) in casting.chain(seen) {
        for triangle in mesh.triangles() {
            visit(triangle.map(|vertex| mesh.positions()[vertex as usize]), casts);
        }
    }
}

/// A box along the axes of a frame.
#[derive(Clone, Copy)]
struct Extent {
    low: DVec3,
    high: DVec3,
}

impl Extent {
    const EMPTY: Self = Self { low: DVec3::INFINITY, high: DVec3::NEG_INFINITY };

    fn add(&mut self, p: DVec3) {
        (self.low, self.high) = (self.low.min(p), self.high.max(p));
    }

    fn around(corners: [DVec3; 3]) -> Self {
        let mut found = Self::EMPTY;
        corners.into_iter().for_each(|p| found.add(p));
        found
    }

    fn join(&mut self, other: &Self) {
        (self.low, self.high) = (self.low.min(other.low), self.high.max(other.high));
    }

    fn is_empty(&self) -> bool {
        self.low.x > self.high.x
    }

    /// The larger side across the light.
    fn side(&self) -> f64 {
        (self.high.x - self.low.x).max(self.high.y - self.low.y)
    }
}

fn central(casters: &CasterGroup<'_>, lamp: &Lamp, size: u32) -> LightSpace {
    let tan = lamp.cone.map(|cone| f64::from(cone.outer_rad)).map_or(f64::INFINITY, |outer| {
        if outer < std::f64::consts::FRAC_PI_2 { outer.tan().max(0.0) } else { f64::INFINITY }
    });
    let origin = wide(lamp.light().xyz());
    let unfitted = |frames, layers, tan| {
        let spread = Spread::Central { tan, near: 1.0 };
        LightSpace { origin, frames, layers, spread, size }
    };
    let space = match lamp.cone {
        Some(cone) if tan > 0.0 && tan * tan < 6.0 => {
            let axis = wide(cone.direction).normalize_or(DVec3::NEG_Z);
            unfitted([frame_of(axis, -1.0); 6], 1, tan * padding(size))
        }
        _ => unfitted(CUBE, 6, 1.0),
    };
    space.with_near(casters)
}

/// Faces looked at that may be a ground: the largest ones.
const GROUNDS: usize = 8;

/// A directional light's space. Across the light it shows the faces that can shadow anything: what lies
/// beside all of them is lit. Along the light it shows everything.
fn parallel(casters: &CasterGroup<'_>, light: &Light, size: u32) -> LightSpace {
    let frame = frame_of(wide(light.xyz()).normalize(), 1.0);
    let mut world = Extent::EMPTY;
    for_each_face(casters, |corners, _| world.join(&Extent::around(corners.map(wide))));
    if world.is_empty() {
        world.add(DVec3::ZERO);
    }
    let middle = 0.5 * world.low + 0.5 * world.high;
    let in_frame = |corners: [[f32; 3]; 3]| {
        Extent::around(corners.map(|p| {
            let q = wide(p) - middle;
            DVec3::new(q.dot(frame.right), q.dot(frame.up), q.dot(frame.axis))
        }))
    };
    let mut all = Extent::EMPTY;
    let mut largest: Vec<(f64, [[f32; 3]; 3])> = Vec::new();
    for_each_face(casters, |corners, casts| {
        let own = in_frame(corners);
        all.join(&own);
        if casts && largest.last().is_none_or(|last| largest.len() < GROUNDS || own.side() > last.0) {
            let at = largest.partition_point(|other| other.0 >= own.side());
            largest.insert(at, (own.side(), corners));
            largest.truncate(GROUNDS);
        }
    });
    let is_ground = |face: &[[f32; 3]; 3]| has_nothing_behind(*face, light, casters);
    let grounds: Vec<[[f32; 3]; 3]> =
        largest.into_iter().map(|(_, corners)| corners).filter(is_ground).collect();
    let mut shadowing = Extent::EMPTY;
    for_each_face(casters, |corners, casts| {
        if casts && !grounds.contains(&corners) {
            shadowing.join(&in_frame(corners));
        }
    });
    for extent in [&mut all, &mut shadowing] {
        if extent.is_empty() {
            extent.add(DVec3::ZERO);
        }
    }
    let (center, depth) = (0.5 * (shadowing.low + shadowing.high), all.high.z - all.low.z);
    let half = positive(0.5 * shadowing.side() * padding(size), positive(depth, 1.0));
    // Rows round coordinates as large as the map by 2⁻⁵³. A range of 2⁻²⁴ of the map's side keeps that far
    // below the units of a depth of 24 bits, also where the scene is flat and faces the light.
    let depth = depth.max(half * (-24_f64).exp2());
    LightSpace {
        origin: middle + center.x * frame.right + center.y * frame.up,
        frames: [frame; 6],
        layers: 1,
        spread: Spread::Parallel {
            half,
            lowest: all.low.z - SLACK * depth,
            range: (1.0 + 2.0 * SLACK) * depth,
        },
        size,
    }
}

/// Whether nothing lies behind the plane of a face, as seen from the light: such a face, the ground for a
/// light above it, shadows nothing.
fn has_nothing_behind(face: [[f32; 3]; 3], light: &Light, casters: &CasterGroup<'_>) -> bool {
    let side = side_of_light(face, light);
    let mut is_before = true;
    for_each_face(casters, |corners, _| {
        is_before = is_before
            && corners.iter().all(|&p| {
                let own = side_of_point(face, p);
                own.is_zero() || own == side
            });
    });
    is_before
}
