//! Boxes around the shells of a mesh and around blocks of their faces.

use crate::built::{self, Part};
use crate::geom::Aabb;
use crate::mesh::{FaceId, Mesh};
use crate::topology::{FacesByShell, Shells};

/// The faces of every shell in blocks with boxes around them, so that a shell far from the light's way to the camera
/// costs one test. Made once for a mesh that rests; 4 bytes a face and 32 a block.
#[derive(Clone, Debug)]
pub struct ShellBoxes {
    /// Faces by shell, ascending within each.
    pub(crate) faces: Vec<FaceId>,
    pub(crate) blocks: Vec<Block>,
    pub(crate) shells: Vec<ShellBox>,
}

/// Some faces of one shell: those before `end` that the block before it does not hold.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Block {
    pub(crate) bounds: Aabb,
    pub(crate) end: u32,
}

/// All blocks of one shell: those before `end` that the shell before it does not hold.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ShellBox {
    pub(crate) bounds: Aabb,
    pub(crate) end: u32,
}

/// Faces a block: neighbors in most files, so that their box is small.
const BLOCK: usize = 32;

impl ShellBoxes {
    /// Sorts the faces by shell and puts boxes around them. Linear time. Memory: 6 bytes a face at its peak, and 150 a
    /// shell.
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
