//! Lights with an extent: a parallelogram, a planar polygon, a disk, a disk that faces the receiver, a round
//! or straight-sided patch of the sky.

use glam::DVec3;

use super::frame::{Frame, Plane, wide};
use super::measure::area_of;
use super::polygon;
use crate::geom::predicate::{Homogeneous, directions_turn};
use crate::scene::{Lamp, LampShape};

/// A light with an area, finite or on the sky. It shines to both sides.
///
/// ```
/// use umbrage::oracle::area::AreaLight;
/// let light = AreaLight::parallelogram([-1.0, 4.0, -1.0], [2.0, 0.0, 0.0], [0.0, 0.0, 2.0])?;
/// let sun = AreaLight::sun([0.3, 1.0, 0.2], 0.00465)?;
/// let narrow = AreaLight::parallelogram([0.0; 3], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0]);
/// assert!(narrow.unwrap_err().to_string().contains("no area"));
/// # Ok::<(), umbrage::oracle::area::AreaLightError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct AreaLight {
    kind: Kind,
    /// The share of its parallelogram that shines.
    pub(super) share: f64,
}

#[derive(Clone, Debug, PartialEq)]
enum Kind {
    /// A part of a parallelogram that is the same for every receiver.
    Fixed(Frame, Shape),
    /// A disk of this center and radius, perpendicular to the line from the receiver.
    Facing([f32; 3], f64),
}

/// The part of the parallelogram u, v in 0 ..= 1 that shines.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Shape {
    /// All of it.
    Full,
    /// The ellipse that it circumscribes.
    Disk,
    /// What this closed chain of (u, v) winds around.
    Polygon(Vec<[f64; 2]>),
}

/// Why numbers or a lamp make no [`AreaLight`].
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum AreaLightError {
    /// A coordinate is NaN or infinite.
    #[error("a light needs finite coordinates, not {0}")]
    NotFinite(f32),
    /// The edges are parallel or null, the corners lie on one line, or the radius is not above 0.
    #[error("the light has no area: {0}; use a point light or a directional light")]
    NoArea(&'static str),
    /// A corner of a polygon lies farther from the plane of the others than rounding explains.
    #[error("corner {corner} lies {distance} from the plane of the light; divide the polygon into triangles")]
    NotPlanar {
        /// The index of the corner.
        corner: usize,
        /// Its distance from the plane.
        distance: f64,
    },
    /// The half-angle is not above 0 and below 90°.
    #[error(
        "half the angle of a sun is above 0 and below 90 degrees, not {0} radians; use ambient light for the sky"
    )]
    Angle(f32),
}

impl AreaLight {
    /// The parallelogram of a corner and the two edges that leave it.
    ///
    /// # Errors
    ///
    /// [`AreaLightError`] if a number is not finite or the edges are parallel.
    pub fn parallelogram(corner: [f32; 3], e1: [f32; 3], e2: [f32; 3]) -> Result<Self, AreaLightError> {
        let frame = spanned(corner, e1, e2, DVec3::ZERO, 1.0)?;
        Ok(Self::fixed(frame, Shape::Full))
    }

    /// The disk, or ellipse, of the points `center` + a·`u` + b·`v` with a² + b² ≤ 1.
    ///
    /// # Errors
    ///
    /// [`AreaLightError`] if a number is not finite or `u` and `v` are parallel.
    pub fn disk(center: [f32; 3], u: [f32; 3], v: [f32; 3]) -> Result<Self, AreaLightError> {
        let frame = spanned(center, u, v, -wide(u) - wide(v), 2.0)?;
        Ok(Self::fixed(frame, Shape::Disk))
    }

    /// The planar polygon of these corners; what its outline winds around shines. A hole is reached by a cut
    /// from the outline and back.
    ///
    /// # Errors
    ///
    /// [`AreaLightError`] if a number is not finite, the polygon has no area, or a corner lies farther from
    /// the plane of the others than rounding to `f32` explains.
    pub fn polygon(corners: &[[f32; 3]]) -> Result<Self, AreaLightError> {
        corners.iter().try_for_each(|&corner| finite(corner))?;
        let (frame, outline) = polygon::planar(corners)?;
        let light = Self::fixed(frame, Shape::Polygon(outline));
        if light.share > 0.0 {
            Ok(light)
        } else {
            Err(AreaLightError::NoArea("its outline winds around nothing"))
        }
    }

    /// The disk around `center` that faces whatever point it lights: a sphere, taken as its middle disk.
    ///
    /// # Errors
    ///
    /// [`AreaLightError`] if a number is not finite or the radius is not above 0.
    pub fn facing_disk(center: [f32; 3], radius: f32) -> Result<Self, AreaLightError> {
        finite(center)?;
        finite([radius; 3])?;
        if radius <= 0.0 {
            return Err(AreaLightError::NoArea("its radius is not above 0"));
        }
        Ok(Self { kind: Kind::Facing(center, f64::from(radius)), share: area_of(&Shape::Disk) })
    }

    /// The parallelogram of the directions `towards` + a·`e1` + b·`e2`, a and b from 0 to 1.
    ///
    /// # Errors
    ///
    /// [`AreaLightError`] if a number is not finite or the three vectors lie in a plane.
    pub fn sky_parallelogram(towards: [f32; 3], e1: [f32; 3], e2: [f32; 3]) -> Result<Self, AreaLightError> {
        let frame = sky(towards, e1, e2, DVec3::ZERO, 1.0)?;
        Ok(Self::fixed(frame, Shape::Full))
    }

    /// The disk of the directions `towards` + a·`u` + b·`v` with a² + b² ≤ 1.
    ///
    /// # Errors
    ///
    /// As [`AreaLight::sky_parallelogram`].
    pub fn sky_disk(towards: [f32; 3], u: [f32; 3], v: [f32; 3]) -> Result<Self, AreaLightError> {
        let frame = sky(towards, u, v, -wide(u) - wide(v), 2.0)?;
        Ok(Self::fixed(frame, Shape::Disk))
    }

    /// The round patch of the sky around the direction `towards` the sun; `half_angle` in radians. Its parts
    /// count by their area in the plane that touches the sky at its center.
    ///
    /// # Errors
    ///
    /// [`AreaLightError`] if a number is not finite, the direction is null, or the angle is not between 0
    /// and 90°.
    pub fn sun(towards: [f32; 3], half_angle: f32) -> Result<Self, AreaLightError> {
        finite(towards)?;
        let tangent = f64::from(half_angle).tan();
        let in_range = half_angle > 0.0 && f64::from(half_angle) < std::f64::consts::FRAC_PI_2;
        if !in_range || tangent <= 0.0 {
            return Err(AreaLightError::Angle(half_angle));
        }
        // The square of any f32 but 0 is a normal f64.
        let direction =
            wide(towards).try_normalize().ok_or(AreaLightError::NoArea("its direction is null"))?;
        Ok(Self::fixed(Frame::round(direction, tangent, true), Shape::Disk))
    }

    /// The extent of a lamp; `None` for one that casts hard shadows.
    ///
    /// # Errors
    ///
    /// [`AreaLightError`] if the lamp's numbers make no light with an area.
    pub fn of_lamp(lamp: &Lamp) -> Result<Option<Self>, AreaLightError> {
        Ok(Some(match &lamp.shape {
            LampShape::Hard(_) => return Ok(None),
            LampShape::Disk { center, radius } => Self::facing_disk(center.xyz(), *radius)?,
            LampShape::Sun { center, half_angle_rad } => {
                // Half of the sky has no disk: the largest angle below it stands for it.
                Self::sun(center.xyz(), half_angle_rad.min(std::f32::consts::FRAC_PI_2.next_down()))?
            }
            LampShape::Rectangle(rectangle) => {
                let [e1, e2] = rectangle.edges();
                Self::parallelogram(rectangle.corner(), e1, e2)?
            }
        }))
    }

    fn fixed(frame: Frame, shape: Shape) -> Self {
        let share = area_of(&shape);
        Self { kind: Kind::Fixed(frame, shape), share }
    }

    /// The light as the receiver at `p` sees it; `None` at the center of a disk that faces its receiver.
    #[inline(always)]
    pub(super) fn seen_from(&self, p: [f32; 3]) -> Option<(Frame, &Shape)> {
        match &self.kind {
            Kind::Fixed(frame, shape) => Some((*frame, shape)),
            Kind::Facing(center, radius) => {
                let ahead = (wide(*center) - wide(p)).try_normalize()?;
                let round = Frame::round(ahead, *radius, false);
                Some((Frame { anchor: *center, ..round }, &Shape::Disk))
            }
        }
    }
}

pub(super) fn finite(v: [f32; 3]) -> Result<(), AreaLightError> {
    match v.into_iter().find(|x| !x.is_finite()) {
        Some(x) => Err(AreaLightError::NotFinite(x)),
        None => Ok(()),
    }
}

const PARALLEL: AreaLightError = AreaLightError::NoArea("its edges are parallel or null");

fn spanned(
    anchor: [f32; 3],
    e1: [f32; 3],
    e2: [f32; 3],
    offset: DVec3,
    times: f64,
) -> Result<Frame, AreaLightError> {
    [anchor, e1, e2].into_iter().try_for_each(finite)?;
    // Products of two f32 are exact in f64 and their difference is 0 only if they are equal.
    if wide(e1).cross(wide(e2)) == DVec3::ZERO {
        return Err(PARALLEL);
    }
    let plane = Plane::Spanned(e1, e2);
    let [e1, e2] = [e1, e2].map(|e| times * wide(e));
    Ok(Frame { anchor, offset, e1, e2, plane, at_infinity: false, rounding: 0.0 })
}

fn sky(
    towards: [f32; 3],
    e1: [f32; 3],
    e2: [f32; 3],
    offset: DVec3,
    times: f64,
) -> Result<Frame, AreaLightError> {
    [towards, e1, e2].into_iter().try_for_each(finite)?;
    if directions_turn([e1, e2, towards].map(Homogeneous::point)).is_zero() {
        return Err(AreaLightError::NoArea("its direction and its edges lie in a plane"));
    }
    let offset = offset + wide(towards);
    let [e1, e2] = [e1, e2].map(|e| times * wide(e));
    Ok(Frame { anchor: [0.0; 3], offset, e1, e2, plane: Plane::Infinite, at_infinity: true, rounding: 0.0 })
}
