//! A scene: meshes and their instances, materials, lamps and cameras; baked once into world space.

mod format;
mod lamp;
mod material;
mod own_space;
mod pattern;
mod pose;
mod visible;

#[cfg(test)]
mod bake_tests;

use glam::Mat4;

pub use format::Format;
pub(crate) use lamp::concentric;
pub use lamp::{Lamp, LampError, LampShape, Rectangle, SpotCone};
pub use material::{AlphaMode, Material};
pub use own_space::OwnSpace;
pub use pattern::Pattern;
pub use visible::PlacedPart;

use crate::animate::{AtRest, Rig};
use crate::mesh::{Mesh, MeshError, Origins, Part, moved_positions};
use crate::view::{Camera, Up};

/// The content of a file.
#[derive(Clone, Debug, Default)]
pub struct Scene {
    /// What the file was read as; `None` for a generated scene.
    pub format: Option<Format>,
    /// The axis that points up.
    pub up: Up,
    /// The meshes, each once, in their own space.
    pub meshes: Vec<Mesh>,
    /// The meshes placed in the world.
    pub instances: Vec<Instance>,
    /// What the parts of meshes are made of.
    pub materials: Vec<Material>,
    /// The file's own lamps, in world space.
    pub lamps: Vec<Lamp>,
    /// The file's own cameras, in world space.
    pub cameras: Vec<NamedCamera>,
    /// Cameras of the file that cannot be used.
    pub left_out_cameras: Vec<LeftOutCamera>,
    /// What the reader changed or left out, for people: n-gons cut into triangles, lines ignored.
    pub notes: Vec<String>,
    /// How far a coordinate moved at most, in mesh units, when the numbers of the file were rounded to `f32`;
    /// 0 where the file itself stores `f32`.
    pub rounding: f64,
    /// What moves it; see [`Scene::pose`].
    pub rig: Rig,
}

/// A camera of a file.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedCamera {
    /// The name in the file, or else that of the node; may be empty.
    pub name: String,
    /// The camera.
    pub camera: Camera,
}

/// A camera of a file that cannot be used.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LeftOutCamera {
    /// The name in the file, or else that of the node; may be empty.
    pub name: String,
    /// Where it stands among all cameras of the file, from 1.
    pub number: usize,
    /// Why it cannot be used.
    pub problem: String,
}

/// A mesh placed in the world.
#[derive(Clone, Debug)]
pub struct Instance {
    /// Index into [`Scene::meshes`].
    pub mesh: usize,
    /// The name of the node in the file; may be empty.
    pub name: String,
    /// Column-major, column vectors; may mirror and scale unevenly.
    pub world_from_mesh: Mat4,
}

/// The extent of one mesh in welding and counting.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Scope {
    /// Every part (primitive, group) of a mesh is a mesh of its own.
    Primitive,
    /// Every instance is a mesh of its own.
    #[default]
    Mesh,
    /// The whole file as one mesh.
    Scene,
}

/// The most triangles, or vertices, that a scene may have through instancing: 2²⁷, some gigabytes.
pub const MOST_INSTANCED: usize = 1 << 27;

impl Scene {
    /// A scene of one mesh, in place.
    #[must_use]
    pub fn of(mesh: Mesh) -> Self {
        let instance = Instance { mesh: 0, name: String::new(), world_from_mesh: Mat4::IDENTITY };
        Self { meshes: vec![mesh], instances: vec![instance], ..Self::default() }
    }

    /// The meshes in world space, one for each `scope`. From here on everything is exact with respect to
    /// these positions. A mirrored instance has its winding turned, so that its front stays its front.
    ///
    /// A mesh with a single instance, at the identity, is moved, not copied.
    ///
    /// # Errors
    ///
    /// [`MeshError`] if a transform carries a position beyond `f32`, if all instances together have more than
    /// [`MOST_INSTANCED`] triangles or vertices (those of all frames), or a sixteenth of that in parts, where
    /// the meshes themselves have fewer (a small file must not fill the memory), or if a scene-wide mesh has
    /// too many for 32-bit ids.
    pub fn bake(mut self, scope: Scope) -> Result<Vec<Mesh>, MeshError> {
        // Every frame has all vertices again.
        let vertices = |mesh: &Mesh| mesh.vertex_count() * (1 + mesh.frames().len());
        type Size = fn(&Mesh) -> usize;
        let sizes: [(&'static str, usize, Size); 3] = [
            ("triangles", MOST_INSTANCED, Mesh::face_count),
            ("vertices", MOST_INSTANCED, vertices),
            ("parts", MOST_INSTANCED / 16, |mesh| mesh.parts().len()), // with a name each
        ];
        for (what, most, size) in sizes {
            let own: usize = self.meshes.iter().map(size).sum();
            let placed = self.instances.iter().map(|instance| size(&self.meshes[instance.mesh]));
            let count = placed.fold(0, usize::saturating_add);
            if count > own.max(most) {
                return Err(MeshError::TooLarge { what, count, most: own.max(most) });
            }
        }
        let mut uses = vec![0_usize; self.meshes.len()];
        for instance in &self.instances {
            uses[instance.mesh] += 1;
        }
        let mut baked = Vec::with_capacity(self.instances.len());
        for (index, instance) in self.instances.iter().enumerate() {
            uses[instance.mesh] -= 1;
            let mesh = if uses[instance.mesh] == 0 {
                std::mem::take(&mut self.meshes[instance.mesh])
            } else {
                self.meshes[instance.mesh].clone()
            };
            baked.push(place(mesh, instance, self.rig.at_rest.get(index))?);
        }
        match scope {
            Scope::Mesh => Ok(baked),
            Scope::Primitive => baked.into_iter().map(split).try_fold(Vec::new(), |mut all, parts| {
                all.extend(parts?);
                Ok(all)
            }),
            Scope::Scene if baked.len() <= 1 => Ok(baked),
            Scope::Scene => Ok(vec![Mesh::concat(&baked)?.with_name("scene")]),
        }
    }
}

/// `mesh` transformed by `instance`, and named after the node (and the mesh, where the two differ). If the
/// scene is posed, `posed` says where the instance stands at rest.
fn place(mesh: Mesh, instance: &Instance, posed: Option<&AtRest>) -> Result<Mesh, MeshError> {
    let name = match (instance.name.as_str(), mesh.name.as_str()) {
        ("", name) | (name, "") => name.to_owned(),
        (node, mesh) if node == mesh => node.to_owned(),
        (node, mesh) => format!("{node} / {mesh}"),
    };
    let world_from_mesh = instance.world_from_mesh;
    let at_rest = posed.map_or(world_from_mesh, |at_rest| at_rest.world_from_mesh);
    let mover = posed.map_or(0, |posed| posed.mover);
    if (world_from_mesh, at_rest, mover) == (Mat4::IDENTITY, Mat4::IDENTITY, 0) {
        return Ok(mesh.with_name(name));
    }
    let (origins, mut skin) = (mesh.origins().cloned(), mesh.skin().cloned());
    if skin.is_none() && mover > 0 {
        skin = Some(vec![mover; mesh.vertex_count()].into());
    }
    let placed = |matrix: Mat4| move |p: [f32; 3]| -> [f32; 3] { matrix.transform_point3(p.into()).into() };
    // What moves is welded where it stands at rest.
    let here = (mover > 0 || at_rest != world_from_mesh).then(|| mesh.positions().to_vec().into());
    let rest = moved_positions(mesh.rest().cloned().or(here).as_ref(), placed(at_rest));
    let (mut positions, mut triangles, parts, mut frames) = mesh.into_parts();
    frames.iter_mut().flatten().for_each(|position| *position = placed(at_rest)(*position));
    positions.iter_mut().for_each(|position| *position = placed(world_from_mesh)(*position));
    if world_from_mesh.as_dmat4().determinant() < 0.0 {
        triangles.iter_mut().for_each(|corners| corners.swap(1, 2));
    }
    let placed = Mesh::new(positions, triangles)?.with_name(name).with_parts(parts);
    Ok(placed.with_origins_of(origins).with_skin(skin).with_frames(frames)?.with_rest(rest))
}

/// Each part of `mesh` as a mesh of its own, with only the vertices that it uses.
fn split(mesh: Mesh) -> Result<Vec<Mesh>, MeshError> {
    if mesh.parts().len() <= 1 {
        return Ok(vec![mesh]);
    }
    let mut new_of_old = vec![u32::MAX; mesh.vertex_count()];
    let mut pieces = Vec::with_capacity(mesh.parts().len());
    for part in mesh.parts() {
        let faces = &mesh.triangles()[part.faces.start as usize..part.faces.end as usize];
        let mut origins = Origins::default();
        origins.append(&mesh, part.faces.clone(), 0);
        let name = [mesh.name.as_str(), part.name.as_str()].into_iter().filter(|name| !name.is_empty());
        let piece = pick(&mesh, faces, &mut new_of_old)?
            .with_name(name.collect::<Vec<_>>().join(" / "))
            .with_parts(vec![Part { faces: 0..faces.len() as u32, ..part.clone() }])
            .with_origins(origins);
        pieces.push(piece);
    }
    Ok(pieces)
}

/// Some faces of `mesh` with only the vertices that they use, in the order of their first use. `new_of_old`
/// has an entry per vertex, `u32::MAX`, and is left so.
fn pick(mesh: &Mesh, faces: &[[u32; 3]], new_of_old: &mut [u32]) -> Result<Mesh, MeshError> {
    let mut old_of_new: Vec<u32> = Vec::new();
    let triangles = faces
        .iter()
        .map(|corners| {
            corners.map(|old| {
                let new = &mut new_of_old[old as usize];
                if *new == u32::MAX {
                    *new = old_of_new.len() as u32; // at most three per face, and faces fit 32 bits
                    old_of_new.push(old);
                }
                *new
            })
        })
        .collect();
    let pick = |from: &[[f32; 3]]| old_of_new.iter().map(|&old| from[old as usize]).collect::<Vec<_>>();
    let picked = Mesh::new(pick(mesh.positions()), triangles)?
        .with_frames(mesh.frames().iter().map(|frame| pick(frame)).collect())?;
    let skin = mesh.skin().map(|skin| old_of_new.iter().map(|&old| skin[old as usize]).collect::<Vec<_>>());
    let rest = mesh.rest().map(|rest| pick(rest).into());
    old_of_new.iter().for_each(|&old| new_of_old[old as usize] = u32::MAX);
    Ok(picked.with_skin(skin.map(Into::into)).with_rest(rest))
}
