//! Pieces: the connected shells of the casters, which are kept or dropped as a whole.

use std::sync::OnceLock;

use crate::caster::{Caster, CasterGroup};
use crate::geom::Aabb;
use crate::geom::bvh::Bvh;
use crate::geom::predicate::{Sign, side_of_point};
use crate::mesh::{FaceId, Mesh};

/// One shell of one caster.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Piece {
    /// The caster, by its index in the group.
    pub caster: usize,
    /// The shell, by its number in the caster.
    pub shell: usize,
    /// The number of its faces.
    pub faces: usize,
    /// Its bounding box.
    pub bounds: Aabb,
    /// Every edge has exactly two faces, in opposite directions.
    pub watertight: bool,
    /// No vertex lies in front of a face: the piece is convex, with its faces outwards. Not proven for more
    /// than 64 faces.
    pub nothing_in_front: bool,
    /// No vertex lies behind a face. Both are true of a flat piece.
    pub nothing_behind: bool,
}

/// Most faces of a piece that is tested for convexity.
const MOST_CONVEX: usize = 64;

/// All pieces of a group of casters, numbered caster by caster, and in each in the order of the shells.
///
/// ```
/// use umbrage::caster::{Caster, CasterGroup};
/// use umbrage::plan::relevance::Pieces;
/// use umbrage::testing::shapes;
/// let casters = [Caster::new(shapes::hollow_cube()), Caster::new(shapes::sheet(1))];
/// let pieces = Pieces::of(&CasterGroup::new(casters.iter().collect()));
/// assert_eq!(pieces.len(), 3);
/// assert!(pieces.piece(1).watertight && !pieces.piece(2).watertight);
/// assert_eq!((pieces.piece(2).caster, pieces.faces(2).len()), (1, 2));
/// ```
#[derive(Debug)]
pub struct Pieces {
    list: Vec<Piece>,
    /// Index of the first face of each piece; one more than there are pieces.
    starts: Vec<u32>,
    faces: Vec<FaceId>,
    /// The piece of each face of the group; `NONE` for a collapsed face.
    of_face: Vec<u32>,
    /// Number of the first face of each caster.
    first_faces: Vec<u32>,
    are_shells: bool,
    tree: OnceLock<Bvh>,
    pub(super) copies: OnceLock<Vec<bool>>,
}

/// No piece.
const NONE: u32 = u32::MAX;

impl Pieces {
    /// The pieces of a group. Builds topology, shells and their boxes of each caster where that is not done.
    /// Linear time: some 20 ns per face, and up to some microseconds for a piece of few faces. Memory: 8
    /// bytes per face, and 72 per piece.
    #[must_use]
    pub fn of(casters: &CasterGroup<'_>) -> Self {
        let mut pieces = Self::none();
        for (number, caster) in casters.casters().iter().enumerate() {
            pieces.add(number, caster);
        }
        pieces
    }

    fn add(&mut self, number: usize, caster: &Caster) {
        let (shells, boxes) = (caster.shells(), caster.shell_boxes());
        let first = self.list.len() as u32; // no more than faces
        self.first_faces.push(self.of_face.len() as u32);
        let of_face = |shell: &Option<u32>| shell.map_or(NONE, |shell| first + shell);
        self.of_face.extend(shells.of_face.iter().map(of_face));
        let watertight = watertight(caster);
        for (shell, bounds) in boxes.shells.iter().map(|shell| shell.bounds).enumerate() {
            let faces = boxes.faces_of(shell);
            let [nothing_in_front, nothing_behind] = free_sides(caster.mesh(), faces);
            self.faces.extend(faces);
            self.starts.push(self.faces.len() as u32);
            self.list.push(Piece {
                caster: number,
                shell,
                faces: faces.len(),
                bounds,
                watertight: watertight[shell],
                nothing_in_front,
                nothing_behind,
            });
        }
    }

    /// Each caster as one piece, whatever its shells. Costs the boxes of the meshes.
    pub(in crate::plan) fn whole(casters: &CasterGroup<'_>) -> Self {
        let mut pieces = Self::none();
        for (number, caster) in casters.casters().iter().enumerate() {
            let (mesh, first) = (caster.mesh(), pieces.of_face.len() as u32);
            pieces.first_faces.push(first);
            pieces.of_face.extend(std::iter::repeat_n(number as u32, mesh.face_count()));
            pieces.faces.extend((0..mesh.face_count()).map(FaceId::new));
            pieces.starts.push(pieces.faces.len() as u32);
            let [low, high] = mesh.bounds().unwrap_or_default();
            pieces.list.push(Piece {
                caster: number,
                shell: 0,
                faces: mesh.face_count(),
                bounds: Aabb { low, high },
                watertight: false,
                nothing_in_front: false,
                nothing_behind: false,
            });
        }
        pieces.are_shells = false;
        pieces
    }

    fn none() -> Self {
        Self {
            list: Vec::new(),
            starts: vec![0],
            faces: Vec::new(),
            of_face: Vec::new(),
            first_faces: Vec::new(),
            are_shells: true,
            tree: OnceLock::new(),
            copies: OnceLock::new(),
        }
    }

    /// Whether the pieces are shells: not made by [`Pieces::whole`].
    pub(in crate::plan) fn are_shells(&self) -> bool {
        self.are_shells
    }

    /// How many pieces there are.
    #[must_use]
    pub fn len(&self) -> usize {
        self.list.len()
    }

    /// Whether nothing casts.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.list.is_empty()
    }

    /// A piece.
    ///
    /// # Panics
    ///
    /// Panics if there is no such piece.
    #[must_use]
    pub fn piece(&self, index: usize) -> &Piece {
        &self.list[index]
    }

    /// All pieces, in order.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = &Piece> {
        self.list.iter()
    }

    /// The faces of a piece, ascending, as its caster numbers them.
    ///
    /// # Panics
    ///
    /// Panics if there is no such piece.
    #[must_use]
    pub fn faces(&self, index: usize) -> &[FaceId] {
        &self.faces[self.starts[index] as usize..self.starts[index + 1] as usize]
    }

    /// The piece of a face, by the face's number in the ray cast of the group; `None` for a collapsed face.
    ///
    /// # Panics
    ///
    /// Panics if there is no such face.
    #[must_use]
    pub fn of_face(&self, face: FaceId) -> Option<u32> {
        Some(self.of_face[face.index()]).filter(|&piece| piece != NONE)
    }

    /// The faces of a piece, as the ray cast of the group numbers them.
    pub(super) fn numbers(&self, index: usize) -> impl Iterator<Item = u32> + '_ {
        let first = self.first_faces[self.list[index].caster];
        self.faces(index).iter().map(move |face| first + face.0)
    }

    /// The corners of the faces of a piece.
    pub(super) fn corners<'a>(
        &'a self,
        casters: &'a CasterGroup<'_>,
        index: usize,
    ) -> impl Iterator<Item = [[f32; 3]; 3]> + Clone + 'a {
        let mesh = casters.casters()[self.list[index].caster].mesh();
        self.faces(index).iter().map(move |&face| mesh.corners(face))
    }

    /// A tree over the boxes of all pieces, built on first use.
    pub(super) fn tree(&self) -> &Bvh {
        self.tree.get_or_init(|| {
            let boxes: Vec<Aabb> = self.list.iter().map(|piece| piece.bounds).collect();
            Bvh::build(&boxes)
        })
    }
}

/// Whether each shell is watertight.
fn watertight(caster: &Caster) -> Vec<bool> {
    let (topology, shells) = (caster.topology(), caster.shells());
    let mut watertight = vec![true; shells.count];
    for edge in topology.edges() {
        let mut uses = topology.uses(edge);
        let is_closed = uses.len() == 2 && uses.clone().map(|(_, direction)| direction).sum::<i32>() == 0;
        if !is_closed && let Some((face, _)) = uses.next() {
            // Faces that share an edge are of one shell.
            if let Some(shell) = shells.of_face[face.index()] {
                watertight[shell as usize] = false;
            }
        }
    }
    watertight
}

/// Whether no vertex of these faces lies in front of one of them, and whether none lies behind.
fn free_sides(mesh: &Mesh, faces: &[FaceId]) -> [bool; 2] {
    if faces.len() > MOST_CONVEX {
        return [false; 2];
    }
    let mut vertices = [0; 3 * MOST_CONVEX];
    let mut count = 0;
    for face in faces {
        for vertex in mesh.triangles()[face.index()] {
            if !vertices[..count].contains(&vertex) {
                vertices[count] = vertex;
                count += 1;
            }
        }
    }
    let mut free = [true; 2];
    for &face in faces {
        for &vertex in &vertices[..count] {
            match side_of_point(mesh.corners(face), mesh.positions()[vertex as usize]) {
                Sign::Positive => free[0] = false,
                Sign::Negative => free[1] = false,
                Sign::Zero => {}
            }
        }
        if free == [false; 2] {
            break;
        }
    }
    free
}
