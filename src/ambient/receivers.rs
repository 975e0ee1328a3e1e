//! The points that ambient occlusion is worked out for.

use glam::DVec3;

use super::inside::Solids;
use super::sides::Sides;
use super::smooth::{CornerNormal, FaceNormal, corner_normals, normalized, towards_middle};
use crate::mesh::{FaceId, Mesh, Weld, weld_in_place};
use crate::topology::Topology;

/// A surface point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Receiver {
    /// The point.
    pub point: [f32; 3],
    /// The normal, of length 1. `None` where two sides of a sheet meet: the mean over the whole sphere
    /// counts.
    pub normal: Option<[f32; 3]>,
    /// The face whose middle this is, among those of all meshes in sequence. It hides nothing from itself.
    pub face: Option<FaceId>,
}

/// What gets one value.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Per {
    /// Each position: one normal over all of its faces.
    Vertex,
    /// Each position and normal: a hard edge has one value on each side.
    #[default]
    Corner,
    /// Each face, at its middle.
    Face,
}

/// The receivers of some meshes, and which one each corner of a face takes its value from.
#[derive(Clone, Debug, Default)]
pub struct Receivers {
    pub(super) list: Vec<Receiver>,
    pub(super) corners: Vec<[u32; 3]>,
    pub(super) sides: Sides,
    pub(super) solids: Solids,
}

impl Receivers {
    /// The receivers of meshes in one space. Positions are joined over all meshes where they are equal.
    ///
    /// The normal of a corner is that of the faces around its vertex which are connected across edges with a
    /// dihedral angle below 60 degrees, weighted by their angles. A corner of a face without area takes the
    /// value of another one at its position.
    ///
    /// Time: n log n. Memory: about 150 bytes per face at the peak.
    ///
    /// # Panics
    ///
    /// Panics if the meshes together have more than [`MAX_TRIANGLES`](crate::mesh::MAX_TRIANGLES) faces.
    ///
    /// ```
    /// use umbrage::ambient::{Per, Receivers};
    /// use umbrage::testing::shapes;
    /// let count = |per| Receivers::of(&[&shapes::cube()], per).list().len();
    /// // The edges of a cube are hard: three normals at each of its vertices.
    /// assert_eq!((count(Per::Vertex), count(Per::Corner), count(Per::Face)), (8, 24, 12));
    /// ```
    #[must_use]
    pub fn of(meshes: &[&Mesh], per: Per) -> Self {
        let joined = Joined::of(meshes);
        if per == Per::Face { joined.per_face() } else { joined.receivers(&joined.normals(per)) }
    }

    /// As [`Receivers::of`], per corner, with the normals of the three corners that `given` has for a face of
    /// the mesh of an index. Where there are none, a normal is computed, and so it is in place of one that is
    /// zero or not finite; the number of the latter comes second.
    ///
    /// # Panics
    ///
    /// As [`Receivers::of`].
    ///
    /// ```
    /// use umbrage::ambient::Receivers;
    /// use umbrage::testing::shapes;
    /// let (up, none) = ([0.0, 0.0, 2.0], [f32::NAN, 0.0, 0.0]);
    /// let (all, _) = Receivers::with_normals(&[&shapes::cube()], |_, _| Some([up; 3]));
    /// assert_eq!((all.list().len(), all.list()[0].normal), (8, Some([0.0, 0.0, 1.0])));
    /// let (all, bad) = Receivers::with_normals(&[&shapes::cube()], |_, _| Some([none; 3]));
    /// assert_eq!((all.list().len(), bad), (24, 36));
    /// ```
    #[must_use]
    pub fn with_normals(
        meshes: &[&Mesh],
        given: impl Fn(usize, FaceId) -> Option<[[f32; 3]; 3]>,
    ) -> (Self, usize) {
        let joined = Joined::of(meshes);
        let mut normals = joined.normals(Per::Corner);
        let (mut face, mut replaced) = (0, 0);
        for (index, mesh) in meshes.iter().enumerate() {
            for own in (0..mesh.face_count()).map(FaceId::new) {
                // A face without area is not seen.
                if let (Some(_), Some(theirs)) = (joined.faces[face], given(index, own)) {
                    for (normal, theirs) in normals[3 * face..].iter_mut().zip(theirs) {
                        match normalized(theirs) {
                            Some(unit) => *normal = CornerNormal::Known(unit),
                            None => replaced += 1,
                        }
                    }
                }
                face += 1;
            }
        }
        (joined.receivers(&normals), replaced)
    }

    /// The receivers, without two that are equal.
    #[must_use]
    pub fn list(&self) -> &[Receiver] {
        &self.list
    }

    /// For each face of all meshes, in sequence, the indices of its corners' receivers.
    #[must_use]
    pub fn corners(&self) -> &[[u32; 3]] {
        &self.corners
    }
}

/// All faces of some meshes over joined vertices.
struct Joined {
    mesh: Mesh,
    topology: Topology,
    faces: Vec<Option<FaceNormal>>,
}

impl Joined {
    fn of(meshes: &[&Mesh]) -> Self {
        let mut positions =
            Vec::with_capacity(3 * meshes.iter().map(|mesh| mesh.face_count()).sum::<usize>());
        for mesh in meshes {
            let corners = mesh.triangles().as_flattened();
            positions.extend(corners.iter().map(|&vertex| mesh.positions()[vertex as usize]));
        }
        let triangles = (0..positions.len() as u32 / 3).map(|face| [3 * face, 3 * face + 1, 3 * face + 2]);
        let soup = Mesh::new(positions, triangles.collect()).expect("no more faces than fit a mesh");
        let mesh = weld_in_place(soup, Weld::Exact).mesh;
        let faces =
            (0..mesh.face_count()).map(|face| FaceNormal::of(mesh.corners(FaceId::new(face)))).collect();
        Self { topology: Topology::of(&mesh), mesh, faces }
    }

    fn normals(&self, per: Per) -> Vec<CornerNormal> {
        corner_normals(&self.mesh, &self.topology, &self.faces, per)
    }

    /// One receiver for each vertex and normal, in this order.
    fn receivers(&self, normals: &[CornerNormal]) -> Receivers {
        // Bits that are not those of a number stand for no normal, and come last.
        const CANCELLED: [u32; 3] = [u32::MAX - 1; 3];
        const FLAT: [u32; 3] = [u32::MAX; 3];
        let mut order: Vec<(u32, [u32; 3], u32)> = (0..)
            .zip(self.mesh.triangles().as_flattened())
            .zip(normals)
            .map(|((corner, &vertex), normal)| match normal {
                CornerNormal::Known(normal) => (vertex, normal.map(f32::to_bits), corner),
                CornerNormal::Cancelled => (vertex, CANCELLED, corner),
                CornerNormal::Flat => (vertex, FLAT, corner),
            })
            .collect();
        order.sort_unstable();
        let mut corners = vec![[0; 3]; self.mesh.face_count()];
        let mut list: Vec<Receiver> = Vec::with_capacity(self.mesh.vertex_count());
        let (mut inward, mut last_vertex, mut first) = (Vec::with_capacity(list.capacity()), None, 0);
        for same in order.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
            let (vertex, bits, _) = same[0];
            let is_new_vertex = last_vertex.replace(vertex) != Some(vertex);
            if is_new_vertex {
                first = list.len();
            }
            if is_new_vertex || bits != FLAT {
                let normal = (bits < CANCELLED).then(|| bits.map(f32::from_bits));
                list.push(Receiver { point: self.mesh.positions()[vertex as usize], normal, face: None });
                inward.push(self.inward(same.iter().map(|&(_, _, corner)| corner as usize)));
            }
            let receiver = if bits == FLAT { first } else { list.len() - 1 };
            for &(_, _, corner) in same {
                corners.as_flattened_mut()[corner as usize] = receiver as u32; // at most one per corner
            }
        }
        Receivers { list, sides: Sides::new(inward, &corners), corners, solids: self.solids() }
    }

    /// A direction into the faces of these corners, which share a vertex; 0 if the faces surround it, that
    /// is, if their edges leave it as often as they arrive.
    fn inward(&self, corners: impl Iterator<Item = usize> + Clone) -> [f32; 3] {
        let neighbors = |step: usize| {
            let of = |corner: usize| self.mesh.triangles()[corner / 3][(corner % 3 + step) % 3];
            let mut vertices: Vec<u32> = corners.clone().map(of).collect();
            vertices.sort_unstable();
            vertices
        };
        if neighbors(1) == neighbors(2) {
            return [0.0; 3];
        }
        let mut into =
            corners.map(|corner| towards_middle(self.mesh.corners(FaceId::new(corner / 3)), corner % 3));
        let first = into.next().unwrap_or_default();
        let sum = first + into.sum::<DVec3>();
        // Faces of one plane on opposite sides of the vertex cancel out: then into the first.
        let into = if sum.length() < 1.0 { first } else { sum };
        into.normalize_or_zero().to_array().map(|x| x as f32)
    }

    fn per_face(&self) -> Receivers {
        let middle = |corners: [[f32; 3]; 3]| -> [f32; 3] {
            std::array::from_fn(|i| {
                (corners.iter().map(|corner| f64::from(corner[i])).sum::<f64>() / 3.0) as f32
            })
        };
        let receiver = |(face, normal): (FaceId, &Option<FaceNormal>)| Receiver {
            point: middle(self.mesh.corners(face)),
            normal: normal.map(|normal| normal.rounded()),
            face: Some(face),
        };
        Receivers {
            list: self.topology.faces().zip(&self.faces).map(receiver).collect(),
            corners: self.topology.faces().map(|face| [face.0; 3]).collect(),
            sides: Sides::default(),
            solids: self.solids(),
        }
    }

    fn solids(&self) -> Solids {
        Solids::of(&self.mesh, &self.topology)
    }
}

#[cfg(test)]
#[path = "receivers_tests.rs"]
mod tests;
