//! A lamp: where its light comes from, how large it is, how strong, how far and into which cone it shines.

mod horizon;
mod patch;
mod syntax;

use glam::DVec3;

pub(crate) use patch::concentric;

use crate::geom::{Light, LightError};

/// A lamp of a scene, in world space.
///
/// ```
/// use umbrage::scene::Lamp;
/// let lamp: Lamp = "spot:0,5,0:0,-1,0:30,20,range=12".parse()?;
/// assert_eq!(lamp.light().to_string(), "point:0,5,0");
/// assert_eq!(lamp.range, Some(12.0));
/// assert_eq!(lamp.to_string(), "spot:0,5,0:0,-1,0:30,20,range=12");
/// # Ok::<(), umbrage::scene::LampError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Lamp {
    /// The name in the file; may be empty.
    pub name: String,
    /// Position and extent.
    pub shape: LampShape,
    /// Linear red, green, blue; 1 is white.
    pub color: [f32; 3],
    /// As the file gives it: candela for lamps at a position, lux for directional ones.
    pub intensity: f32,
    /// The distance from the lamp at which its light ends, in mesh units; `None`: it does not end.
    pub range: Option<f32>,
    /// The cone of a spot light; it shades, and casts no shadow.
    pub cone: Option<SpotCone>,
}

/// Position and extent of a lamp.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum LampShape {
    /// A point or a direction, without extent: hard shadows.
    Hard(Light),
    /// A sphere, taken as the disk that faces whatever point it lights.
    Disk {
        /// Its center, a point light.
        center: Light,
        /// Above 0, in mesh units.
        radius: f32,
    },
    /// A round patch of the sky, such as the sun.
    Sun {
        /// Its center, a directional light.
        center: Light,
        /// Half the angle that it takes up in the sky, radians; more than 0, at most π/2. The sun: 0.0046.
        half_angle_rad: f32,
    },
    /// A parallelogram that shines to both sides.
    Rectangle(Rectangle),
}

/// A parallelogram in space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rectangle {
    corner: [f32; 3],
    edges: [[f32; 3]; 2],
    center: Light,
}

/// The cone of a spot light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpotCone {
    /// Where the light shines, unit length.
    pub direction: [f32; 3],
    /// Half-angle of full light, radians.
    pub inner_rad: f32,
    /// Half-angle where light ends, radians.
    pub outer_rad: f32,
}

/// Why a text or numbers make no [`Lamp`].
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LampError {
    /// The text does not begin with a kind of light.
    #[error("`{0}` is not a light; write {any}", any = syntax::ANY)]
    Kind(String),
    /// Part of the text is not what its syntax asks for.
    #[error("`{text}`: {problem}; write {remedy}")]
    Syntax {
        /// The whole text.
        text: String,
        /// The wrong part, and what is wrong about it.
        problem: String,
        /// The syntax.
        remedy: &'static str,
    },
    /// The center is no light.
    #[error(transparent)]
    Light(#[from] LightError),
    /// The edges of a rectangle are parallel, or one has length zero.
    #[error("the edges {0:?} and {1:?} span no area")]
    NoArea([f32; 3], [f32; 3]),
}

impl Lamp {
    /// A white lamp of intensity 1, without a name, a range or a cone.
    #[must_use]
    pub fn new(shape: LampShape) -> Self {
        Self { name: String::new(), shape, color: [1.0; 3], intensity: 1.0, range: None, cone: None }
    }

    /// The light that casts hard shadows: the lamp's center.
    #[must_use]
    pub fn light(&self) -> &Light {
        match &self.shape {
            LampShape::Hard(center) | LampShape::Disk { center, .. } | LampShape::Sun { center, .. } => {
                center
            }
            LampShape::Rectangle(rectangle) => &rectangle.center,
        }
    }

    /// Whether the lamp has an extent, so that its shadows have a penumbra.
    #[must_use]
    pub fn has_extent(&self) -> bool {
        !matches!(self.shape, LampShape::Hard(_))
    }
}

/// A white lamp of intensity 1.
impl From<Light> for Lamp {
    fn from(light: Light) -> Self {
        Self::new(LampShape::Hard(light))
    }
}

impl Rectangle {
    /// The parallelogram of a corner and the two edges that leave it.
    ///
    /// # Errors
    ///
    /// [`LampError::Light`] if a number, or the center, is not a finite `f32`; [`LampError::NoArea`] if the
    /// edges are parallel.
    pub fn new(corner: [f32; 3], edges: [[f32; 3]; 2]) -> Result<Self, LampError> {
        // −0 becomes 0.
        let [corner, a, b] = [corner, edges[0], edges[1]].map(|v| v.map(|x| x + 0.0));
        for v in [corner, a, b] {
            Light::point(v)?;
        }
        let center = Light::point(
            [0, 1, 2].map(|i| (f64::from(corner[i]) + 0.5 * (f64::from(a[i]) + f64::from(b[i]))) as f32),
        )?;
        // Products of two f32 are exact in f64, and none underflows: a cross product of 0 is of parallel
        // vectors, or of vectors so close to parallel that f64 does not separate them.
        let wide = |v: [f32; 3]| DVec3::from(v.map(f64::from));
        if wide(a).cross(wide(b)) == DVec3::ZERO {
            return Err(LampError::NoArea(a, b));
        }
        Ok(Self { corner, edges: [a, b], center })
    }

    /// One corner.
    #[must_use]
    pub fn corner(&self) -> [f32; 3] {
        self.corner
    }

    /// The two edges that leave the corner.
    #[must_use]
    pub fn edges(&self) -> [[f32; 3]; 2] {
        self.edges
    }

    /// The center, rounded to `f32`.
    #[must_use]
    pub fn center(&self) -> Light {
        self.center
    }
}

/// `v` at unit length, and unchanged if it already is one, as far as `f32` can say; `None` of the null
/// vector.
///
/// Rounding a unit vector moves each component by at most 2⁻²⁵, so its length by less than 2⁻²⁴ and the
/// square of its length by less than 2⁻²². What is within that bound is kept, so that a direction survives
/// being written and read.
fn unit(v: [f32; 3]) -> Option<[f32; 3]> {
    let wide = DVec3::from(v.map(f64::from));
    let squared = wide.length_squared();
    if (squared - 1.0).abs() <= (-22_f64).exp2() {
        return Some(v);
    }
    // The square of any f32 but 0 is a normal f64.
    wide.try_normalize().map(|unit| unit.as_vec3().to_array())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unit_is_idempotent_and_keeps_no_direction_out() {
        for i in 0..10_000_u32 {
            let noise = |k: u32| f32::from_bits(i.wrapping_mul(k) & 0xbfff_ffff); // below 2 in size
            let v = [noise(2_654_435_761), noise(2_246_822_519), noise(3_266_489_917)];
            let Some(once) = unit(v) else { continue };
            assert_eq!(unit(once), Some(once), "{v:?}");
        }
        assert_eq!(unit([0.0, -3.0, 0.0]), Some([0.0, -1.0, 0.0]));
        assert_eq!(unit([f32::from_bits(1), 0.0, 0.0]), Some([1.0, 0.0, 0.0]));
        assert_eq!(unit([0.0; 3]), None);
    }

    #[test]
    fn rectangle_has_its_center_and_an_area() {
        let (a, b) = ([2.0, 0.0, 0.0], [0.0, 0.0, 4.0]);
        let rectangle = Rectangle::new([1.0, 5.0, 1.0], [a, b]).unwrap();
        assert_eq!(rectangle.center().xyz(), [2.0, 5.0, 3.0]);
        let lamp = Lamp::new(LampShape::Rectangle(rectangle));
        assert!(lamp.has_extent() && lamp.light().xyz() == [2.0, 5.0, 3.0]);
        assert_eq!(Rectangle::new([0.0; 3], [a, a]), Err(LampError::NoArea(a, a)));
        assert!(matches!(Rectangle::new([f32::NAN; 3], [a, b]), Err(LampError::Light(_))));
        assert!(matches!(Rectangle::new([f32::MAX; 3], [[f32::MAX; 3], b]), Err(LampError::Light(_))));
    }
}
