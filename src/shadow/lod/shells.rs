//! The shells of all casters, each in full and simplified.

use std::sync::OnceLock;

use hashbrown::HashMap;

use super::bound::MoveBound;
use crate::caster::{Caster, CasterGroup};
use crate::facing::CasterFaces;
use crate::geom::{Aabb, Light};
use crate::mesh::{FaceId, Mesh, Weld, weld};
use crate::oracle::PrimaryHit;
use crate::shadow::stencil::ClosedVolume;
use crate::shadow::volume::Caps;
use crate::topology::has_collapsed;

/// A mesh with its shadow volume, once that is asked for.
#[derive(Debug)]
pub(super) struct Form {
    pub(super) mesh: Mesh,
    volume: OnceLock<ClosedVolume>,
}

/// A shell of a caster.
#[derive(Debug)]
pub(super) struct LodShell {
    pub(super) full: Form,
    /// `None` if welding merges nothing.
    pub(super) coarse: Option<Coarse>,
}

/// A simplified shell.
#[derive(Debug)]
pub(super) struct Coarse {
    pub(super) form: Form,
    /// What the simplification may change.
    pub(super) bound: MoveBound,
}

impl Form {
    fn new(mesh: Mesh) -> Self {
        Self { mesh, volume: OnceLock::new() }
    }

    /// The volume of all faces, whatever is proven of the caster in full.
    pub(super) fn volume(&self, light: &Light) -> &ClosedVolume {
        self.volume.get_or_init(|| {
            let caster = Caster::new(self.mesh.clone());
            let faces = caster.shell_faces(light, Some(CasterFaces::All));
            ClosedVolume::new(caster.volume_of(light, &faces, Caps::Both))
        })
    }

    fn bytes(&self) -> usize {
        size_of_val(self.mesh.positions())
            + size_of_val(self.mesh.triangles())
            + self.volume.get().map_or(0, ClosedVolume::bytes)
    }
}

impl LodShell {
    fn of(full: Mesh, light: &Light, fraction: f64) -> Self {
        let bounds = Aabb::around(full.positions().iter().copied());
        let distance = (fraction * bounds.diagonal()) as f32;
        let welded = weld(&full, Weld::Within(distance)).mesh;
        let is_simpler = welded.vertex_count() < full.vertex_count();
        let coarse = is_simpler.then(|| Coarse {
            bound: MoveBound::of(&full, light, distance.into()),
            form: Form::new(part_of(&welded, &all_faces(&welded))),
        });
        Self { full: Form::new(full), coarse }
    }

    pub(super) fn bytes(&self) -> usize {
        let of_coarse = |coarse: &Coarse| coarse.form.bytes() + coarse.bound.bytes();
        self.full.bytes() + self.coarse.as_ref().map_or(0, of_coarse)
    }
}

/// The shells of all casters, caster after caster, with vertices that move by at most `fraction` of their
/// shell's diagonal.
pub(super) fn lod_shells(casters: &CasterGroup<'_>, light: &Light, fraction: f64) -> Vec<LodShell> {
    let mut shells = Vec::new();
    for caster in casters.casters() {
        for faces in caster.shells().faces_by_shell().iter() {
            shells.push(LodShell::of(part_of(caster.mesh(), faces), light, fraction));
        }
    }
    shells
}

fn all_faces(mesh: &Mesh) -> Vec<FaceId> {
    (0..mesh.face_count()).map(FaceId::new).collect()
}

/// A mesh of some faces, without those that have collapsed.
fn part_of(mesh: &Mesh, faces: &[FaceId]) -> Mesh {
    let (mut new_of, mut positions, mut triangles) = (HashMap::new(), Vec::new(), Vec::new());
    for &face in faces {
        let corners = mesh.triangles()[face.index()];
        if has_collapsed(corners) {
            continue;
        }
        triangles.push(corners.map(|vertex| {
            *new_of.entry(vertex).or_insert_with(|| {
                positions.push(mesh.positions()[vertex as usize]);
                positions.len() as u32 - 1 // fewer than in the mesh
            })
        }));
    }
    Mesh::new(positions, triangles).expect("vertices of a mesh")
}

/// The shell of each visible face.
#[derive(Debug)]
pub(super) struct ShellOfFace<'a> {
    casters: &'a CasterGroup<'a>,
    /// The number of the first shell of each caster.
    first: Vec<u32>,
    /// By the corners, where more is seen than casts.
    by_corners: Option<HashMap<[[u32; 3]; 3], u32>>,
}

impl<'a> ShellOfFace<'a> {
    pub(super) fn new(casters: &'a CasterGroup<'a>) -> Self {
        let first = casters.casters().iter().scan(0, |next: &mut u32, caster| {
            let first = *next;
            *next += caster.shells().count as u32; // at most as many as faces
            Some(first)
        });
        let mut own = Self { casters, first: first.collect(), by_corners: None };
        own.by_corners = casters.seen_caster().map(|_| {
            let all = casters.casters().iter().enumerate();
            all.flat_map(|(number, caster)| {
                let shells = (0..).zip(&caster.shells().of_face);
                let first = own.first[number];
                shells.filter_map(move |(face, shell)| {
                    Some((key(caster.mesh().corners(FaceId(face))), first + (*shell)?))
                })
            })
            .collect()
        });
        own
    }

    /// `None` for a face that does not cast.
    pub(super) fn of(&self, hit: &PrimaryHit) -> Option<usize> {
        let shell = match &self.by_corners {
            Some(by_corners) => by_corners.get(&key(hit.corners)).copied(),
            None => {
                let (caster, face) = self.casters.oracle().mesh_face(hit.face);
                let shell = self.casters.casters()[caster].shells().of_face[face.index()];
                shell.map(|shell| self.first[caster] + shell)
            }
        };
        shell.map(|shell| shell as usize)
    }

    pub(super) fn bytes(&self) -> usize {
        self.by_corners.as_ref().map_or(0, |map| map.capacity() * size_of::<([[u32; 3]; 3], u32)>())
    }
}

fn key(corners: [[f32; 3]; 3]) -> [[u32; 3]; 3] {
    corners.map(|corner| corner.map(f32::to_bits))
}
