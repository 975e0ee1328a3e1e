//! Shells: faces connected through edges. Union-find, in near-linear time.

use super::components::Components;
use super::{Topology, has_collapsed};
use crate::mesh::FaceId;

/// The shells of a mesh: faces connected through edges (not through single vertices).
///
/// ```
/// use umbrage::testing::shapes;
/// use umbrage::topology::Topology;
/// let shells = Topology::of(&shapes::hollow_cube()).shells();
/// assert_eq!(shells.count, 2);
/// assert_eq!(shells.of_face.iter().filter(|&&shell| shell == Some(1)).count(), 12);
/// ```
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Shells {
    /// The shell of each face; `None` for a collapsed face.
    pub of_face: Vec<Option<u32>>,
    /// The number of shells, which are numbered in the order of their first faces.
    pub count: usize,
}

impl Shells {
    /// The faces of each shell, without collapsed ones. A counting sort.
    pub(crate) fn faces_by_shell(&self) -> FacesByShell {
        let mut ends = vec![0; self.count];
        self.of_face.iter().flatten().for_each(|&shell| ends[shell as usize] += 1);
        let mut sum = 0;
        for end in &mut ends {
            (sum, *end) = (sum + *end, sum);
        }
        let mut faces = vec![FaceId::new(0); sum];
        for (face, shell) in self.of_face.iter().enumerate() {
            if let Some(shell) = shell {
                let slot = &mut ends[*shell as usize];
                faces[*slot] = FaceId::new(face);
                *slot += 1;
            }
        }
        FacesByShell { faces, ends }
    }
}

/// The faces of each shell, ascending: one list, and the end of each shell's faces.
#[derive(Clone, Debug)]
pub(crate) struct FacesByShell {
    pub(crate) faces: Vec<FaceId>,
    pub(crate) ends: Vec<usize>,
}

impl FacesByShell {
    pub(crate) fn iter(&self) -> impl Iterator<Item = &[FaceId]> {
        let starts = std::iter::once(0).chain(self.ends.iter().copied());
        starts.zip(&self.ends).map(|(start, &end)| &self.faces[start..end])
    }
}

impl Topology {
    /// The shells: the connected components of the faces through edges.
    ///
    /// Memory: 8 bytes per face, 12 at its peak. The first call on a table also surveys the one-rings of its
    /// vertices: about the time of the build, and 28 to 34 bytes per face of a closed mesh for that time.
    #[must_use]
    pub fn shells(&self) -> Shells {
        let survey = self.survey();
        if survey.components <= 1 && survey.fans.is_empty() {
            // If every vertex has a single fan, vertex-connected components are also edge-connected.
            let of_face =
                self.triangles.iter().map(|&corners| (!has_collapsed(corners)).then_some(0)).collect();
            return Shells { of_face, count: survey.components };
        }
        let mut faces = Components::new(self.face_count());
        for edge in self.edges() {
            let mut uses = self.half_edges(edge);
            let Some(first) = uses.next() else { continue };
            for other in uses {
                faces.join(self.face(first).0, self.face(other).0);
            }
        }
        let (of_face, count) = faces.number(|face| !self.is_collapsed(FaceId(face)));
        Shells { of_face, count }
    }
}
