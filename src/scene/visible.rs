//! Leaving out parts of a scene, by name or for being invisible.

use std::collections::HashMap;
use std::ops::Range;

use super::{Instance, Material, Scene, pick};
use crate::mesh::{Mesh, MeshError, Origins, Part};

/// A part of a mesh in one instance. A mesh without parts counts as one part.
#[derive(Clone, Copy, Debug)]
pub struct PlacedPart<'a> {
    /// The instance.
    pub instance: &'a Instance,
    /// The mesh of the instance.
    pub mesh: &'a Mesh,
    /// `None` if the mesh has no parts.
    pub part: Option<&'a Part>,
    /// The material, if the file names one.
    pub material: Option<&'a Material>,
}

impl<'a> PlacedPart<'a> {
    /// The names of node, mesh, part and material, without empty ones. A part of an OBJ file has several:
    /// those of its object, group and material.
    pub fn names(self) -> impl Iterator<Item = &'a str> {
        let part = self.part.map_or("", |part| part.name.as_str());
        let material = self.material.map_or("", |material| material.name.as_str());
        [self.instance.name.as_str(), self.mesh.name.as_str(), part, material]
            .into_iter()
            .chain(part.split(" / "))
            .filter(|name| !name.is_empty())
    }
}

impl Scene {
    /// The parts of all instances, instance by instance.
    pub fn placed_parts(&self) -> impl Iterator<Item = PlacedPart<'_>> {
        self.instances.iter().flat_map(|instance| self.parts_of(instance))
    }

    /// Leaves out the parts that `keep` is false for, and instances and meshes of which nothing is left.
    ///
    /// Linear in the faces of all meshes that something is left out of; instances of a mesh that differ in
    /// what is left out get meshes of their own.
    ///
    /// # Errors
    ///
    /// None that a scene that was read can cause: [`MeshError`] as [`Mesh::new`].
    pub fn retain(&mut self, keep: impl Fn(&PlacedPart<'_>) -> bool) -> Result<(), MeshError> {
        let kept: Vec<Vec<bool>> = (self.instances.iter())
            .map(|instance| self.parts_of(instance).map(|part| keep(&part)).collect())
            .collect();
        if kept.iter().flatten().all(|&keep| keep) {
            return Ok(());
        }
        let mut meshes: Vec<Mesh> = Vec::new();
        let mut slots: HashMap<(usize, &[bool]), usize> = HashMap::new();
        let mut instances = Vec::new();
        for (instance, kept) in self.instances.iter().zip(&kept).filter(|(_, kept)| kept.contains(&true)) {
            let slot = match slots.get(&(instance.mesh, kept.as_slice())) {
                Some(&slot) => slot,
                None => {
                    meshes.push(subset(&self.meshes[instance.mesh], kept)?);
                    slots.insert((instance.mesh, kept), meshes.len() - 1);
                    meshes.len() - 1
                }
            };
            instances.push(Instance { mesh: slot, ..instance.clone() });
        }
        let kept: Vec<bool> = kept.iter().map(|parts| parts.contains(&true)).collect();
        self.rig.retain(&kept);
        (self.meshes, self.instances) = (meshes, instances);
        Ok(())
    }

    fn parts_of<'a>(&'a self, instance: &'a Instance) -> impl Iterator<Item = PlacedPart<'a>> {
        let mesh = &self.meshes[instance.mesh];
        let parts = mesh.parts().iter().map(Some);
        let whole = mesh.parts().is_empty().then_some(None);
        parts.chain(whole).map(move |part| {
            let material = part.and_then(|part| self.materials.get(part.material? as usize));
            PlacedPart { instance, mesh, part, material }
        })
    }
}

/// `mesh` without the parts that are not kept, and without the vertices that only those use. Faces of no part
/// stay.
fn subset(mesh: &Mesh, kept: &[bool]) -> Result<Mesh, MeshError> {
    if kept.iter().all(|&keep| keep) {
        return Ok(mesh.clone());
    }
    let mut faces: Vec<[u32; 3]> = Vec::new();
    let mut origins = Origins::default();
    let mut add = |range: Range<u32>| {
        let first = faces.len() as u32; // no more than before
        origins.append(mesh, range.clone(), first);
        faces.extend_from_slice(&mesh.triangles()[range.start as usize..range.end as usize]);
        first..faces.len() as u32
    };
    let (mut parts, mut next) = (Vec::new(), 0);
    for (part, &keep) in mesh.parts().iter().zip(kept) {
        add(next..part.faces.start);
        if keep {
            parts.push(Part { faces: add(part.faces.clone()), ..part.clone() });
        }
        next = part.faces.end;
    }
    add(next..mesh.face_count() as u32);
    let picked = pick(mesh, &faces, &mut vec![u32::MAX; mesh.vertex_count()])?;
    Ok(picked.with_name(mesh.name.clone()).with_parts(parts).with_origins(origins))
}

#[cfg(test)]
mod tests {
    use glam::Mat4;

    use super::*;
    use crate::scene::{AlphaMode, Scope};
    use crate::testing::shapes;

    /// Two instances of a mesh of a cube and a sphere, the sphere of glass, and a sheet without parts.
    fn scene() -> Scene {
        let both = Mesh::concat(&[shapes::cube().with_name("cube"), shapes::icosphere(1).with_name("ball")])
            .unwrap();
        let mut parts = both.parts().to_vec();
        parts[1].material = Some(0);
        let glass = Material {
            alpha: 0.0,
            alpha_mode: AlphaMode::Blend,
            name: "glass".to_owned(),
            ..Material::default()
        };
        let instance =
            |mesh, name: &str| Instance { mesh, name: name.to_owned(), world_from_mesh: Mat4::IDENTITY };
        Scene {
            meshes: vec![both.with_parts(parts).with_name("both"), shapes::sheet(1).with_name("sheet")],
            instances: vec![instance(0, "left"), instance(0, "right"), instance(1, "floor")],
            materials: vec![glass],
            ..Scene::default()
        }
    }

    /// (name, faces, vertices) of each baked mesh.
    fn counts(scene: Scene) -> Vec<(String, usize, usize)> {
        let baked = scene.bake(Scope::Mesh).unwrap();
        baked.into_iter().map(|mesh| (mesh.name.clone(), mesh.face_count(), mesh.vertex_count())).collect()
    }

    #[test]
    fn retain_leaves_out_parts_instances_and_vertices() {
        let all = counts(scene());
        assert_eq!(all[0], ("left / both".to_owned(), 12 + 80, 8 + 42));
        let left = |keep: &dyn Fn(&PlacedPart<'_>) -> bool| {
            let mut scene = scene();
            scene.retain(keep).unwrap();
            counts(scene)
        };
        assert_eq!(left(&|_| true), all);
        assert_eq!(left(&|_| false), []);
        let cube = |name: &str| (format!("{name} / both"), 12, 8);
        let visible = left(&|part| !part.material.is_some_and(Material::is_invisible));
        assert_eq!(visible, [cube("left"), cube("right"), all[2].clone()]);
        let without_left_ball = left(&|part| part.instance.name != "left" || part.material.is_none());
        assert_eq!(without_left_ball, [cube("left"), all[1].clone(), all[2].clone()]);
        let floor = left(&|part| part.names().any(|name| name == "floor"));
        assert_eq!(floor, [all[2].clone()]);
    }

    #[test]
    fn retain_keeps_what_is_kept_where_it_is() {
        let mut scene = scene();
        let ball = scene.meshes[0].triangles()[12..].to_vec();
        let corners = |mesh: &Mesh, faces: &[[u32; 3]]| -> Vec<_> {
            faces.iter().map(|face| face.map(|vertex| mesh.positions()[vertex as usize])).collect()
        };
        let wanted = corners(&scene.meshes[0], &ball);
        scene.retain(|part| part.names().any(|name| name == "glass")).unwrap();
        assert_eq!((scene.meshes.len(), scene.instances.len()), (1, 2), "one mesh for both instances");
        let mesh = &scene.meshes[0];
        assert_eq!(corners(mesh, mesh.triangles()), wanted);
        assert_eq!(mesh.parts(), [Part { name: "ball".to_owned(), faces: 0..80, material: Some(0) }]);
    }
}
