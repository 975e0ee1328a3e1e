//! Cameras: a node carries one, and it looks along the node's −z with +y up.

use std::f32::consts::PI;

use glam::{DMat4, DVec3, Vec3};

use super::Notes;
use super::document::{Document, Kind, Object};
use super::node::direction;
use crate::read::ReadError;
use crate::scene::NamedCamera;
use crate::view::{Camera, Lens};

/// The node's camera in world space. A perspective camera has the vertical field of view of the file, an
/// orthographic one its height; how wide the picture is decides its size. The planes of the file are not
/// read.
pub(super) fn read(
    document: &Document,
    node: &Object,
    world: DMat4,
    notes: &mut Notes,
) -> Result<Option<NamedCamera>, ReadError> {
    let Some(index) = node.link("camera", document, Kind::Camera)? else { return Ok(None) };
    let object = document.item(Kind::Camera, index)?;
    let lens = match (object.object("perspective")?, object.object("orthographic")?) {
        (Some(perspective), _) => {
            let fov_y_rad = perspective.required("yfov", perspective.number("yfov")?)?;
            if !(fov_y_rad > 0.0 && fov_y_rad < PI) {
                let problem = format!("yfov is {fov_y_rad}, but must be more than 0 and less than pi");
                return Err(perspective.error(problem));
            }
            Lens::Perspective { fov_y_rad }
        }
        (None, Some(orthographic)) => {
            let half = orthographic.required("ymag", orthographic.number("ymag")?)?;
            let height = 2.0 * half;
            if !(height > 0.0 && height.is_finite()) {
                return Err(orthographic.error(format!("ymag is {half}, but must be more than 0")));
            }
            Lens::Orthographic { height }
        }
        (None, None) => {
            notes.add("camera that is neither perspective nor orthographic left out", &object.place);
            return Ok(None);
        }
    };
    let eye = world.w_axis.truncate().as_vec3();
    match (direction(world, DVec3::NEG_Z), direction(world, DVec3::Y)) {
        (Some(forward), Some(up)) if forward.cross(up) != Vec3::ZERO => {
            let name = object.given_name().unwrap_or_else(|| node.name());
            Ok(Some(NamedCamera { name, camera: Camera { eye, forward, up, lens, near: None } }))
        }
        _ => {
            notes.add("camera left out, for its node is flattened to no direction", &node.place);
            Ok(None)
        }
    }
}
