//! The chain of a light: the casting faces with their signs, and what is known of their edges.

use hashbrown::HashMap;

use crate::caster::{Caster, CasterGroup};
use crate::facing::CasterFaces;
use crate::geom::Light;
use crate::mesh::{FaceId, Mesh};
use crate::oracle::PrimaryHit;
use crate::silhouette::Silhouette;
use crate::topology::has_collapsed;

/// All faces of a group of casters with the side that the light is on, for one light and any camera.
///
/// The chain is `Σ s·face` over all faces, s = ±1 for the side that the light is on. Its boundary is the sum
/// of the edges, each times its multiplicity (see [`silhouette`](crate::silhouette)). Edge-on faces have
/// s = 0, are no part of it, and shadow nothing.
#[derive(Clone, Debug)]
pub struct Chain<'a> {
    light: Light,
    parts: Vec<Part<'a>>,
    edge_count: usize,
    /// The same corners in the chain, for each face that is seen: `None` if what is seen is what casts.
    of_seen: Option<Vec<Option<u32>>>,
}

/// The faces of one caster.
#[derive(Clone, Debug)]
struct Part<'a> {
    mesh: &'a Mesh,
    caster: &'a Caster,
    first_face: u32,
    signs: Vec<i8>,
    /// The edge of each half-edge, by a number that no other part has.
    edges: Vec<u32>,
    /// One bit per half-edge of a face: whether its edge belongs to the boundary.
    outline: Vec<u8>,
}

/// A face of the chain.
#[derive(Clone, Copy, Debug)]
pub(super) struct ChainFace {
    /// Its number, as in [`CasterGroup::oracle`].
    pub(super) face: u32,
    pub(super) corners: [[f32; 3]; 3],
    /// 1 or −1; 0 for an edge-on face.
    pub(super) sign: i8,
}

impl<'a> Chain<'a> {
    /// The chain of `light`. Cost: that of the facing, and some 20 ns per edge. Memory: 14 bytes per face.
    #[must_use]
    pub fn of(casters: &CasterGroup<'a>, light: &Light) -> Self {
        let (mut first_face, mut first_edge, mut parts) = (0, 0, Vec::new());
        for caster in casters.casters() {
            let part = Part::of(caster, light, first_face, first_edge);
            first_face += caster.mesh().face_count() as u32; // at most MAX_TRIANGLES, as in one ray cast
            first_edge += caster.topology().edge_count() as u32; // at most three per face, which fits
            parts.push(part);
        }
        let mut chain = Self { light: *light, parts, edge_count: first_edge as usize, of_seen: None };
        chain.of_seen = casters.seen_caster().map(|seen| chain.faces_of(seen.mesh()));
        chain
    }

    /// The light.
    #[must_use]
    pub fn light(&self) -> &Light {
        &self.light
    }

    /// Number of faces, edge-on ones included.
    #[must_use]
    pub fn face_count(&self) -> usize {
        self.parts.iter().map(|part| part.signs.len()).sum()
    }

    /// Number of edges: their numbers are below it.
    pub(super) fn edge_count(&self) -> usize {
        self.edge_count
    }

    /// Memory in bytes.
    #[must_use]
    pub fn bytes(&self) -> usize {
        let parts = self.parts.iter().map(|part| 2 * part.signs.len() + 4 * part.edges.len());
        parts.sum::<usize>() + self.of_seen.as_ref().map_or(0, |seen| size_of_val(&seen[..]))
    }

    /// The face of the chain with the corners of a visible face: none if this face does not cast.
    pub(crate) fn of_visible(&self, hit: &PrimaryHit) -> Option<u32> {
        let face = match &self.of_seen {
            None => Some(hit.face.0).filter(|&face| (face as usize) < self.face_count()),
            Some(seen) => seen.get(hit.face.index()).copied().flatten(),
        }?;
        (self.corners(face) == hit.corners).then_some(face)
    }

    /// The faces with a sign, ascending.
    pub(super) fn faces(&self) -> impl Iterator<Item = ChainFace> + '_ {
        self.all_faces().filter(|face| face.sign != 0)
    }

    /// The faces that have three corners, edge-on ones included, ascending.
    pub(super) fn all_faces(&self) -> impl Iterator<Item = ChainFace> + '_ {
        self.parts.iter().flat_map(|part| {
            let faces = part.signs.iter().enumerate();
            let faces = faces.filter(|(index, _)| !has_collapsed(part.mesh.triangles()[*index]));
            faces.map(|(index, &sign)| ChainFace {
                face: part.first_face + index as u32,
                corners: part.mesh.corners(FaceId::new(index)),
                sign,
            })
        })
    }

    /// The corners of a face.
    pub(super) fn corners(&self, face: u32) -> [[f32; 3]; 3] {
        let part = &self.parts[self.caster(face) as usize];
        part.mesh.corners(FaceId(face - part.first_face))
    }

    /// The caster and the shell of a face.
    pub(super) fn shell(&self, face: u32) -> [u32; 2] {
        let number = self.caster(face);
        let part = &self.parts[number as usize];
        [number, part.caster.shells().of_face[(face - part.first_face) as usize].unwrap_or(u32::MAX)]
    }

    /// The caster of a face.
    fn caster(&self, face: u32) -> u32 {
        if self.parts.len() == 1 {
            return 0;
        }
        self.parts.partition_point(|part| part.first_face <= face) as u32 - 1
    }

    /// The edges of a face, edge k from corner k to the next, and a bit per edge: whether it belongs to the
    /// boundary.
    pub(crate) fn edges(&self, face: u32) -> ([u32; 3], u8) {
        let part = &self.parts[self.caster(face) as usize];
        let index = (face - part.first_face) as usize;
        ([0, 1, 2].map(|k| part.edges[3 * index + k]), part.outline[index])
    }

    /// For each face of a mesh, a face of the chain with the same corners.
    fn faces_of(&self, mesh: &Mesh) -> Vec<Option<u32>> {
        let key = |corners: [[f32; 3]; 3]| corners.map(|corner| corner.map(f32::to_bits));
        let own: HashMap<_, u32> = self.faces().map(|face| (key(face.corners), face.face)).collect();
        (0..mesh.face_count()).map(|face| own.get(&key(mesh.corners(FaceId::new(face)))).copied()).collect()
    }
}

impl<'a> Part<'a> {
    fn of(caster: &'a Caster, light: &Light, first_face: u32, first_edge: u32) -> Self {
        let (mesh, topology) = (caster.mesh(), caster.topology());
        let signs = CasterFaces::All.signs(&caster.facing(light));
        // Collapsed faces have no edges, and as they have no side either, nobody asks for them.
        let mut edges = vec![u32::MAX; 3 * signs.len()];
        for edge in topology.edges() {
            for half_edge in topology.half_edges(edge) {
                edges[half_edge.index()] = first_edge + edge.0;
            }
        }
        let mut outline = vec![0; signs.len()];
        for edge in &Silhouette::extract(topology, &signs).edges {
            for half_edge in topology.half_edges(edge.edge) {
                outline[half_edge.index() / 3] |= 1 << (half_edge.index() % 3);
            }
        }
        Self { mesh, caster, first_face, signs, edges, outline }
    }
}
