//! Lights of KHR_lights_punctual: a node carries one, and it shines along the node's −z.

use std::f32::consts::{FRAC_PI_2, FRAC_PI_4};

use glam::{DMat4, DVec3};

use super::Notes;
use super::document::{Document, Kind, Object};
use super::node::direction;
use crate::geom::Light;
use crate::read::ReadError;
use crate::scene::{Lamp, SpotCone};

/// The node's light in world space. One that shines nowhere, for its node has no extent along z, is noted.
pub(super) fn read(
    document: &Document,
    node: &Object,
    world: DMat4,
    notes: &mut Notes,
) -> Result<Option<Lamp>, ReadError> {
    let Some(extension) = node.extension("KHR_lights_punctual") else { return Ok(None) };
    let index = extension.required("light", extension.link("light", document, Kind::Light)?)?;
    let object = document.item(Kind::Light, index)?;
    let kind = object.required("type", object.text("type")?)?;
    let direction = direction(world, DVec3::NEG_Z);
    if direction.is_none() && kind != "point" {
        notes.add("light left out, for its node is flattened to no direction", &node.place);
        return Ok(None);
    }
    let position = world.w_axis.truncate().as_vec3().to_array();
    let travel = direction.unwrap_or_default().to_array();
    let (light, cone) = match kind {
        "directional" => (Light::directional(travel), None),
        "point" => (Light::point(position), None),
        "spot" => (Light::point(position), Some(spot_cone(&object, travel)?)),
        _ => return Err(object.error("has a type that is not directional, point or spot")),
    };
    let name = object.given_name().unwrap_or_else(|| node.name());
    let channel = |value: f64| value as f32;
    let color = object.numbers::<3>("color")?.unwrap_or([1.0; 3]).map(channel);
    if color.iter().any(|channel| !channel.is_finite()) {
        return Err(object.error("has a color beyond the range of 32-bit floats"));
    }
    let intensity = object.number("intensity")?.unwrap_or(1.0);
    let range = object.number("range")?;
    if range.is_some_and(|range| range <= 0.0) {
        return Err(object.error("has a range that is not above 0"));
    }
    // Of no meaning for light from a direction.
    let range = range.filter(|_| kind != "directional");
    let light = light.map_err(|error| node.error(error.to_string()))?;
    Ok(Some(Lamp { name, color, intensity, range, cone, ..Lamp::from(light) }))
}

/// The cone of a spot light. Angles outside of 0 ≤ inner ≤ outer ≤ π/2 are moved inside: they only shade.
fn spot_cone(light: &Object, direction: [f32; 3]) -> Result<SpotCone, ReadError> {
    let spot = light.required("spot", light.object("spot")?)?;
    let outer_rad = spot.number("outerConeAngle")?.unwrap_or(FRAC_PI_4).clamp(0.0, FRAC_PI_2);
    let inner_rad = spot.number("innerConeAngle")?.unwrap_or(0.0).clamp(0.0, outer_rad);
    Ok(SpotCone { direction, inner_rad, outer_rad })
}
