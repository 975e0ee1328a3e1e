//! Model parts to a scene: every mesh where the build has it.

use std::collections::HashMap;

use glam::{DAffine3, DMat3, DVec3};

use super::model::Reference;
use super::{Parts, error};
use crate::read::ReadError;
use crate::read::text::counted;
use crate::scene::{Instance, Scene};

/// Components inside of components at most: more are taken for a circle.
const DEEPEST: usize = 64;
/// Components and items followed at most: groups of groups may name more than memory holds.
const MOST_FOLLOWED: usize = 1 << 22;
/// Instances at most; the faces that they have together are bounded when they are placed.
const MOST_INSTANCES: usize = 1 << 20;

struct Placing {
    parts: Parts,
    /// The mesh in the scene of each object that has one, by part and object.
    meshes: HashMap<(usize, u32), usize>,
    scene: Scene,
    /// Components and items followed so far.
    followed: usize,
}

/// The scene that the first part builds.
pub(super) fn scene(mut parts: Parts) -> Result<Scene, ReadError> {
    let (mut meshes, mut scene) = (HashMap::new(), Scene::default());
    for (index, (_, model)) in parts.models.iter_mut().enumerate() {
        scene.notes.append(&mut model.notes);
        let mut objects: Vec<_> = model.objects.iter_mut().collect();
        objects.sort_by_key(|(_, object)| object.order);
        for (id, object) in objects {
            if let Some(mesh) = object.mesh.take() {
                meshes.insert((index, *id), scene.meshes.len());
                scene.meshes.push(mesh.with_name(object.name.clone()));
            }
        }
    }
    let build = std::mem::take(&mut parts.models[0].1.build);
    let mut placing = Placing { parts, meshes, scene, followed: 0 };
    for item in &build {
        placing.place(0, item, DAffine3::IDENTITY, 0)?;
    }
    let Placing { meshes, mut scene, .. } = placing;
    if build.is_empty() && !meshes.is_empty() {
        scene.notes.push(format!(
            "the file builds nothing: all {} placed",
            counted(meshes.len() as u64, "mesh object")
        ));
        let whole = |mesh| Instance { mesh, name: String::new(), world_from_mesh: glam::Mat4::IDENTITY };
        scene.instances = (0..scene.meshes.len()).map(whole).collect();
    }
    Ok(scene)
}

impl Placing {
    /// Places what `reference` of part `from` names.
    fn place(
        &mut self,
        from: usize,
        reference: &Reference,
        world_from_parent: DAffine3,
        depth: usize,
    ) -> Result<(), ReadError> {
        let id = reference.object;
        let fail = |problem: String| Err(error(&self.parts.models[from].0, problem));
        if depth == DEEPEST {
            return fail(format!("object {id} is a component of itself, or {DEEPEST} deep"));
        }
        self.followed += 1;
        if self.followed > MOST_FOLLOWED {
            return Err(error(
                &self.parts.models[from].0,
                format!("the file places more than {MOST_FOLLOWED} objects"),
            ));
        }
        let part = match &reference.part {
            None => Some(from),
            Some(name) => self.parts.index.get(name).copied(),
        };
        let Some((part, object)) =
            part.and_then(|part| Some((part, self.parts.models[part].1.objects.get(&id)?)))
        else {
            return fail(format!("object {id} is used, but not there"));
        };
        let world = world_from_parent * affine(&reference.transform);
        if let Some(&mesh) = self.meshes.get(&(part, id)) {
            if self.scene.instances.len() == MOST_INSTANCES {
                return fail(format!("the file places more than {MOST_INSTANCES} meshes"));
            }
            let name = object.name.clone();
            let world_from_mesh = glam::DMat4::from(world).as_mat4();
            self.scene.instances.push(Instance { mesh, name, world_from_mesh });
        }
        let components = object.components.len();
        for index in 0..components {
            let object = &self.parts.models[part].1.objects[&id];
            let Reference { object, part: other, transform } = &object.components[index];
            let component = Reference { object: *object, part: other.clone(), transform: *transform };
            self.place(part, &component, world, depth + 1)?;
        }
        Ok(())
    }
}

/// 3MF has row vectors: x' = x·m00 + y·m10 + z·m20 + m30.
fn affine(rows: &[f32; 12]) -> DAffine3 {
    let row = |at: usize| DVec3::from([0, 1, 2].map(|i| f64::from(rows[3 * at + i])));
    DAffine3 { matrix3: DMat3::from_cols(row(0), row(1), row(2)), translation: row(3) }
}
