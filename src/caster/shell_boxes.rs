//! Bounding boxes of the shells of a mesh, and of blocks of their faces.

use crate::built::{self, Part};
use crate::geom::Aabb;
use crate::mesh::{FaceId, Mesh};
use crate::topology::{FacesByShell, Shells};

/// Boxes around every shell and around blocks of 32 of its faces, so that a shell far from a light or from a
/// segment costs one test. Made once for a mesh at rest. Holds 4 bytes per face, 28 per block and 28 per
/// shell.
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
        assert_eq!(shells.of_face.len(), mesh.face_count(), "one shell per face");
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

    /// How many shells there are.
    #[must_use]
    pub fn shell_count(&self) -> usize {
        self.shells.len()
    }

    /// The blocks of a shell, each with its faces.
    pub(crate) fn blocks_of(&self, shell: usize) -> impl Iterator<Item = (&Aabb, &[FaceId])> {
        let first = self.first_block(shell);
        let mut start = self.first_face(first);
        self.blocks[first..self.shells[shell].end as usize].iter().map(move |block| {
            let faces = &self.faces[start..block.end as usize];
            start = block.end as usize;
            (&block.bounds, faces)
        })
    }

    /// The faces of a shell, ascending.
    pub(crate) fn faces_of(&self, shell: usize) -> &[FaceId] {
        let ends = [self.first_block(shell), self.shells[shell].end as usize].map(|b| self.first_face(b));
        &self.faces[ends[0]..ends[1]]
    }

    fn first_block(&self, shell: usize) -> usize {
        shell.checked_sub(1).map_or(0, |before| self.shells[before].end as usize)
    }

    fn first_face(&self, block: usize) -> usize {
        block.checked_sub(1).map_or(0, |before| self.blocks[before].end as usize)
    }
}
