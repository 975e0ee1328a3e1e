//! Receivers that are buried in another closed shell.

use crate::geom::Aabb;
use crate::mesh::Mesh;
use crate::topology::Topology;

/// The closed shells of some meshes. Empty if there are fewer than two.
#[derive(Clone, Debug, Default)]
pub(super) struct Solids {
    /// The closed shell of each face, or [`OPEN`].
    of_face: Vec<u32>,
    boxes: Vec<Aabb>,
}

/// Marks a face of a shell that is not closed.
const OPEN: u32 = u32::MAX;

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
            if let Some(shell) = shell {
                let solid = number[*shell as usize];
                of_face[face.index()] = solid;
                if let Some(around) = boxes.get_mut(solid as usize) {
                    *around = around.join(&Aabb::around(mesh.corners(face)));
                }
            }
        }
        Self { of_face, boxes }
    }
}
