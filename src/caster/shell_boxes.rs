//! Bounding boxes of the shells of a mesh, and of blocks of their faces.

use crate::built::{self, Part};
use crate::geom::Aabb;
use crate::mesh::{FaceId, Mesh};
use crate::topology::{FacesByShell, Shells};

/// The faces of every shell in blocks with bounding boxes, so that a shell far from the pyramid between light
/// and camera costs one test. Built once for a mesh that does not move. Memory: 4 bytes per face and 32 per
/// block.
#[derive(Clone, Debug)]
pub struct ShellBoxes {
    /// Faces sorted by shell, ascending within each shell.
    pub(crate) faces: Vec<FaceId>,
    pub(crate) blocks: Vec<Block>,
    pub(crate) shells: Vec<ShellBox>,
}

/// A block of faces of one shell. It ends before the index `end`, and starts where the previous block ends.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Block {
    pub(crate) bounds: Aabb,
    pub(crate) end: u32,
}

/// The range of blocks of one shell. It ends before the index `end`, and starts where the previous shell's
/// range ends.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ShellBox {
    pub(crate) bounds: Aabb,
    pub(crate) end: u32,
}

/// Faces per block. Consecutive faces are neighbors in most files, so a block's box is small.
const BLOCK: usize = 32;

impl ShellBoxes {
    /// Sorts the faces by shell and computes the boxes. Linear time. Memory: at its peak 6 bytes per face and
    /// 150 per shell.
    ///
    /// # Panics
    ///
    /// Panics if `shells` belongs to another mesh.
    #[must_use]
    pub fn new(mesh: &Mesh, shells: &Shells) -> Self {
        assert_eq!(shells.of_face.len(), mesh.face_count(), "one shell a face");
        built::note(Part::ShellBoxes, mesh);
        let FacesByShell { faces, ends } = shells.faces_by_shell();
        let mut boxes = Self { faces: Vec::new(), blocks: Vec::new(), shells: Vec::new() };
        let mut end = 0;
        for &shell_end in &ends {
            let mut bounds = Aabb::EMPTY;
            for block in faces[end..shell_end].chunks(BLOCK) {
                let around = Aabb::around(block.iter().flat_map(|&face| mesh.corners(face)));
                bounds = bounds.join(&around);
                end += block.len();
                boxes.blocks.push(Block { bounds: around, end: end as u32 }); // face ids are 32 bits
            }
            boxes.shells.push(ShellBox { bounds, end: boxes.blocks.len() as u32 });
        }
        Self { faces, ..boxes }
    }
}
