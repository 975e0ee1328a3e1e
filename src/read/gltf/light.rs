//! Lights of KHR_lights_punctual: a node carries one, and it shines along the node's −z.

use std::f32::consts::{FRAC_PI_2, FRAC_PI_4};

use glam::{DMat4, DVec3};

use super::document::{Document, Kind};
use super::node::direction;
use super::notes::Notes;
use super::object::Object;
use crate::geom::Light;
use crate::read::ReadError;
use crate::scene::{Lamp, SpotCone};

/// The node's light in world space, if it has one. One that is no light is noted, and casts no doubt on
/// anything else.
pub(super) fn read(document: &Document, node: &Object, world: DMat4, notes: &Notes) -> Option<Lamp> {
    let extension = node.extension("KHR_lights_punctual")?;
    let link = extension.link("light", document, Kind::Light);
    let object = link.and_then(|link| document.item(Kind::Light, extension.required("light", link)?));
    let place = object.as_ref().map_or_else(|_| node.place.clone(), |object| object.place.clone());
    let lamp = object.and_then(|object| lamp(&object, node, world, notes));
    lamp.map_err(|error| notes.because("light left out", &place, || error.problem)).ok()
}

fn lamp(object: &Object, node: &Object, world: DMat4, notes: &Notes) -> Result<Lamp, ReadError> {
    let kind = object.required("type", object.text("type")?)?;
    let direction = direction(world, DVec3::NEG_Z);
    if direction.is_none() && kind != "point" {
        return Err(node.error("its node is flattened to no direction"));
    }
    let position = world.w_axis.truncate().as_vec3().to_array();
    let travel = direction.unwrap_or_default().to_array();
    let (light, cone) = match kind {
        "directional" => (Light::directional(travel), None),
        "point" => (Light::point(position), None),
        "spot" => (Light::point(position), Some(spot_cone(object, travel, notes)?)),
        _ => return Err(object.error("its type is not directional, point or spot")),
    };
    let name = object.given_name().unwrap_or_else(|| node.name());
    let channel = |value: f64| value as f32;
    let color = object.numbers::<3>("color")?.unwrap_or([1.0; 3]).map(channel);
    if color.iter().any(|channel| !(*channel >= 0.0 && channel.is_finite())) {
        return Err(object.error(format!("its color is {color:?}, but must be from 0 within 32-bit floats")));
    }
    let intensity = object.number("intensity")?.unwrap_or(1.0);
    if intensity < 0.0 {
        return Err(object.error(format!("its intensity is {intensity}, but must not be below 0")));
    }
    let range = object.number("range")?;
    if let Some(range) = range.filter(|range| *range <= 0.0) {
        return Err(object.error(format!("its range is {range}, but must be more than 0")));
    }
    // Of no meaning for light from a direction.
    let range = range.filter(|_| kind != "directional");
    let light = light.map_err(|error| node.error(error.to_string()))?;
    Ok(Lamp { name, color, intensity, range, cone, ..Lamp::from(light) })
}

/// The cone of a spot light. Angles outside of 0 ≤ inner ≤ outer ≤ π/2 are moved inside: they only shade.
fn spot_cone(light: &Object, direction: [f32; 3], notes: &Notes) -> Result<SpotCone, ReadError> {
    let Some(spot) = light.object("spot")? else {
        notes.add("spot light without a cone given the default one", &light.place);
        return Ok(SpotCone { direction, inner_rad: 0.0, outer_rad: FRAC_PI_4 });
    };
    let outer = spot.number("outerConeAngle")?.unwrap_or(FRAC_PI_4);
    let inner = spot.number("innerConeAngle")?.unwrap_or(0.0);
    let outer_rad = outer.clamp(0.0, FRAC_PI_2);
    let inner_rad = inner.clamp(0.0, outer_rad);
    if (inner, outer) != (inner_rad, outer_rad) {
        let why = || format!("they are {inner} and {outer}, taken as {inner_rad} and {outer_rad}");
        notes.because("cone angles of a spot light moved inside their range", &spot.place, why);
    }
    Ok(SpotCone { direction, inner_rad, outer_rad })
}
