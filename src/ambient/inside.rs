//! Receivers that are buried in the solid of another closed shell.

use glam::DVec3;

use super::Receivers;
use super::start::Start;
use crate::geom::bvh::Bvh;
use crate::geom::{Aabb, Facing, Light};
use crate::mesh::{FaceId, Mesh};
use crate::oracle::{Intersection, Oracle};
use crate::random::SplitMix64;
use crate::topology::Topology;

/// The closed shells of some meshes. Empty if there are fewer than two.
#[derive(Clone, Debug, Default)]
pub(super) struct Solids {
    /// The closed shell of each face, or [`OPEN`].
    of_face: Vec<u32>,
    /// Boxes around the closed shells.
    boxes: Vec<Aabb>,
    bvh: Bvh,
}

/// Marks a face of a shell that is not closed.
const OPEN: u32 = u32::MAX;

/// Directions that are tried before a receiver is taken for one outside.
const TRIES: u32 = 8;

impl Solids {
    /// A shell is closed if both directions of each of its edges are used equally often.
    pub(super) fn of(mesh: &Mesh, topology: &Topology) -> Self {
        let shells = topology.shells();
        let mut number = vec![0; shells.count];
        for edge in topology.edges() {
            let balance: i32 = topology.uses(edge).map(|(_, direction)| direction).sum();
            if balance != 0 {
                for shell in topology.uses(edge).filter_map(|(face, _)| shells.of_face[face.index()]) {
                    number[shell as usize] = OPEN;
                }
            }
        }
        let mut closed = 0;
        for number in number.iter_mut().filter(|number| **number != OPEN) {
            (*number, closed) = (closed, closed + 1);
        }
        if closed < 2 {
            return Self::default();
        }
        let mut boxes = vec![Aabb::EMPTY; closed as usize];
        let mut of_face = vec![OPEN; mesh.face_count()];
        for (face, shell) in topology.faces().zip(&shells.of_face) {
            let solid = shell.map_or(OPEN, |shell| number[shell as usize]);
            of_face[face.index()] = solid;
            if let Some(around) = boxes.get_mut(solid as usize) {
                *around = around.join(&Aabb::around(mesh.corners(face)));
            }
        }
        Self { of_face, bvh: Bvh::build(&boxes), boxes }
    }

    fn of_face(&self, face: FaceId) -> Option<u32> {
        self.of_face.get(face.index()).copied().filter(|&solid| solid != OPEN)
    }

    /// Whether a receiver that is moved off its faces by nothing lies in a solid: the winding number of all
    /// closed shells around it is positive. Asked only where the box of a shell that is not its own contains
    /// it.
    ///
    /// The shell of a room that is turned inwards is no solid, nor is a hollow in a wall.
    pub(super) fn hold(&self, oracle: &Oracle, receivers: &Receivers, index: usize, start: &Start) -> bool {
        let mut may_hold = false;
        self.bvh.for_each_overlapping(&Aabb::around([start.point]), |solid| {
            may_hold |= self.boxes[solid as usize].contains(start.point)
                && start.faces.iter().all(|&face| self.of_face(face) != Some(solid));
        });
        may_hold && self.winding(oracle, receivers, index, start).is_some_and(|winding| winding > 0)
    }

    /// The winding number around a receiver. Rays close to the normal are tried until one touches no edge and
    /// is not hidden by the faces through the receiver. `None` if each of them
    /// touches one.
    fn winding(&self, oracle: &Oracle, receivers: &Receivers, index: usize, start: &Start) -> Option<i32> {
        let normal = DVec3::from(receivers.list[index].normal.unwrap_or([0.0, 0.0, 1.0]).map(f64::from));
        let inward = DVec3::from(receivers.sides.inward(index).map(f64::from));
        let mut random = SplitMix64(0);
        for attempt in 0..TRIES {
            let tilt = inward / 4.0 + DVec3::from([(); 3].map(|()| random.unit() - 0.5)) / 4.0;
            let direction =
                (normal + f64::from(attempt) / f64::from(TRIES) * tilt).to_array().map(|x| x as f32);
            let Ok(end) = Light::directional(direction.map(|x| -x)) else { continue };
            if start.fan_hides(direction) {
                continue;
            }
            let (mut winding, mut touches) = (0, false);
            oracle.for_each_meeting(start.point, &end, |face, meeting| {
                if self.of_face(face).is_some() {
                    match meeting {
                        Intersection::Crossing(Facing::Front) => winding += 1,
                        Intersection::Crossing(_) => winding -= 1,
                        _ => touches = true,
                    }
                }
            });
            if !touches {
                return Some(winding);
            }
        }
        None
    }
}
