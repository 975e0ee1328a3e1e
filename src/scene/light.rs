//! A light as a file describes it: the geometry that casts shadows, and what shading adds.

use crate::geom::Light;

/// A light with what shading needs.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneLight {
    /// What the file calls it; may be empty.
    pub name: String,
    /// What casts the shadow. A spot light is a point light here.
    pub light: Light,
    /// Linear red, green, blue; 1 is white.
    pub color: [f32; 3],
    /// As the file gives it: candela for point and spot lights, lux for directional ones.
    pub intensity: f32,
    /// The cone of a spot light; for shading only.
    pub spot: Option<SpotCone>,
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
