//! Cameras: a node carries one, and it looks along the node's −z with +y up.

use std::f32::consts::PI;

use glam::{DMat4, DVec3, Vec3};

use super::Notes;
use super::document::{Document, Kind, Object};
use super::node::direction;
use crate::read::ReadError;
use crate::view::Camera;

/// The node's perspective camera in world space. Others are noted.
pub(super) fn read(
    document: &Document,
    node: &Object,
    world: DMat4,
    notes: &mut Notes,
) -> Result<Option<Camera>, ReadError> {
    let Some(index) = node.link("camera", document, Kind::Camera)? else { return Ok(None) };
    let object = document.item(Kind::Camera, index)?;
    let Some(perspective) = object.object("perspective")? else {
        notes.add("camera that is not a perspective one left out", &object.place);
        return Ok(None);
    };
    let fov_y_rad = perspective.required("yfov", perspective.number("yfov")?)?;
    if !(fov_y_rad > 0.0 && fov_y_rad < PI) {
        return Err(
            perspective.error(format!("yfov is {fov_y_rad}, but must be more than 0 and less than pi"))
        );
    }
    let eye = world.w_axis.truncate().as_vec3();
    match (direction(world, DVec3::NEG_Z), direction(world, DVec3::Y)) {
        (Some(forward), Some(up)) if forward.cross(up) != Vec3::ZERO => {
            Ok(Some(Camera { eye, forward, up, fov_y_rad }))
        }
        _ => {
            notes.add("camera left out, for its node is flattened to no direction", &node.place);
            Ok(None)
        }
    }
}
