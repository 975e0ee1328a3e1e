//! Cameras: a node carries one, and it looks along the node's −z with +y up.

use std::f32::consts::PI;

use glam::{DMat4, DVec3, Vec3};

use super::document::{Document, Kind};
use super::node::direction;
use super::notes::Notes;
use super::object::Object;
use crate::read::ReadError;
use crate::scene::NamedCamera;
use crate::view::{Camera, Lens};

/// A camera that cannot be used: its name, and why.
pub(super) struct Unusable {
    pub(super) name: String,
    pub(super) problem: String,
}

/// The node's camera in world space, if it has one. A perspective camera has the vertical field of view of
/// the file, an orthographic one its height; how wide the picture is decides its size. The far plane is not
/// read. One that is no camera is noted, and casts no doubt on anything else.
pub(super) fn read(
    document: &Document,
    node: &Object,
    world: DMat4,
    notes: &Notes,
) -> Option<Result<NamedCamera, Unusable>> {
    let link = node.link("camera", document, Kind::Camera).transpose()?;
    let object = link.and_then(|index| document.item(Kind::Camera, index));
    let (name, place) = match &object {
        Ok(object) => (object.given_name().unwrap_or_else(|| node.name()), object.place.clone()),
        Err(_) => (node.name(), node.place.clone()),
    };
    let camera = object.and_then(|object| camera(&object, node, world, notes));
    Some(camera.map(|camera| NamedCamera { name: name.clone(), camera }).map_err(|error| {
        notes.because("camera left out", &place, || error.problem.clone());
        Unusable { name, problem: error.problem }
    }))
}

fn camera(object: &Object, node: &Object, world: DMat4, notes: &Notes) -> Result<Camera, ReadError> {
    let (lens, planes) = match (object.object("perspective")?, object.object("orthographic")?) {
        (Some(perspective), _) => {
            let fov_y_rad = perspective.required("yfov", perspective.number("yfov")?)?;
            if !(fov_y_rad > 0.0 && fov_y_rad < PI) {
                let problem = format!("its yfov is {fov_y_rad}, but must be more than 0 and less than pi");
                return Err(perspective.error(problem));
            }
            (Lens::Perspective { fov_y_rad }, perspective)
        }
        (None, Some(orthographic)) => {
            let half = orthographic.required("ymag", orthographic.number("ymag")?)?;
            let height = 2.0 * half;
            if !(height > 0.0 && height.is_finite()) {
                let problem =
                    format!("its ymag is {half:?}, but must be more than 0 and within 32-bit floats");
                return Err(orthographic.error(problem));
            }
            (Lens::Orthographic { height }, orthographic)
        }
        (None, None) => return Err(object.error("it is neither perspective nor orthographic")),
    };
    let eye = world.w_axis.truncate().as_vec3();
    match (direction(world, DVec3::NEG_Z), direction(world, DVec3::Y)) {
        (Some(forward), Some(up)) if forward.cross(up) != Vec3::ZERO => {
            Ok(Camera { eye, forward, up, lens, near: near(&planes, lens, notes) })
        }
        _ => Err(node.error("its node is flattened to no direction")),
    }
}

/// The distance of the near plane; scale does not reach it (§3.10.1 of the specification). One that is no
/// distance is noted, and left to the program.
fn near(planes: &Object, lens: Lens, notes: &Notes) -> Option<f32> {
    if planes.has("zfar") {
        notes.add("far plane of the camera not applied", &planes.place);
    }
    let why = match planes.number("znear") {
        Ok(Some(near)) if near > 0.0 => return Some(near),
        // Parallel rays may begin at the eye.
        Ok(Some(0.0)) if matches!(lens, Lens::Orthographic { .. }) => return None,
        Ok(Some(near)) => format!("znear is {near}, but must be more than 0"),
        Ok(None) => "znear is missing".to_owned(),
        Err(error) => error.problem,
    };
    notes.because("near plane of the camera left open", &planes.place, || why);
    None
}
