//! glTF 2.0, as JSON or binary: the meshes of the default scene, their instances, its materials, lamps and
//! cameras.
//!
//! Source: Khronos, *glTF 2.0 Specification*, and the extensions KHR_lights_punctual and
//! KHR_mesh_quantization. Only what the scene shows is read: a mesh that no node names is noted, not decoded.
//!
//! A skinned mesh is read in its bind pose, and its node's transform is ignored, as the specification says
//! (§3.7.3). Morph targets become frames of the mesh, each target at full weight on its own.
//!
//! Work and memory are linear in the bytes of the file and its buffers: see [`asset`] for the bound.

mod accessor;
mod asset;
mod camera;
mod container;
mod document;
mod light;
mod material;
mod mesh;
mod node;
mod uri;

use std::io::{BufRead, Read, Seek};
use std::path::Path;

use glam::Mat4;

use self::asset::Asset;
use self::document::{Document, Kind, Object};
use super::{Format, Place, ReadError, Source};
use crate::scene::{Instance, Scene};

/// Reads a glTF or GLB. `folder` is where external buffers lie, or `None` if they cannot be reached.
pub(super) fn read<R: BufRead + Seek>(
    source: Source<R>,
    format: Format,
    folder: Option<&Path>,
) -> Result<Scene, ReadError> {
    read_untagged(source, format, folder).map_err(|error| ReadError { format: Some(format), ..error })
}

fn read_untagged<R: BufRead>(
    source: Source<R>,
    format: Format,
    folder: Option<&Path>,
) -> Result<Scene, ReadError> {
    let mut bytes = Vec::new();
    source.reader.take(source.len).read_to_end(&mut bytes).map_err(|error| {
        ReadError::new(None, Place::File, format!("cannot be read: {error}"))
            .remedy("check that the file can be read")
    })?;
    let (json, bin) = match format {
        Format::Glb => container::split(&bytes)?,
        _ => (bytes.as_slice(), None),
    };
    let document = Document::parse(json, format)?;
    scene(&Asset::new(&document, bin, folder, bytes.len()))
}

/// The default scene, or else the first, or else all root nodes, or else every mesh once.
fn scene(asset: &Asset) -> Result<Scene, ReadError> {
    let document = asset.document;
    let mut scene = Scene::default();
    let mut notes = Notes::default();
    // (mesh of the document, name, transform)
    let mut standing = Vec::new();
    for (index, world) in node::scene_nodes(document, &mut notes)? {
        let node = document.item(Kind::Node, index)?;
        if let Some(mesh) = node.link("mesh", document, Kind::Mesh)? {
            let skinned = node.link("skin", document, Kind::Skin)?.is_some();
            if skinned {
                notes.add("skinned node read in the bind pose, its own transform ignored", &node.place);
            }
            if node.extension("EXT_mesh_gpu_instancing").is_some() {
                notes.add("node with EXT_mesh_gpu_instancing read as a single instance", &node.place);
            }
            let world_from_mesh = if skinned { Mat4::IDENTITY } else { world.as_mat4() };
            standing.push((mesh, node.name(), world_from_mesh));
        }
        scene.lamps.extend(light::read(document, &node, world, &mut notes)?);
        scene.cameras.extend(camera::read(document, &node, world, &mut notes)?);
    }
    if document.list(Kind::Node).is_empty() {
        for mesh in 0..document.list(Kind::Mesh).len() {
            let object = document.item(Kind::Mesh, mesh)?;
            notes.add("mesh placed at the origin, for the file has no nodes", &object.place);
            standing.push((mesh, object.name(), Mat4::IDENTITY));
        }
    }

    let mut slot_of_mesh = vec![None; document.list(Kind::Mesh).len()];
    standing.iter().for_each(|&(mesh, ..)| slot_of_mesh[mesh] = Some(0));
    for (mesh, slot) in slot_of_mesh.iter_mut().enumerate() {
        if slot.is_some() {
            *slot = Some(scene.meshes.len());
            scene.meshes.push(mesh::read(asset, mesh, &mut notes)?);
        } else {
            notes.add("mesh not read, for it stands nowhere in the scene", &Object::place(Kind::Mesh, mesh));
        }
    }
    let instance = |(mesh, name, world_from_mesh): (usize, String, Mat4)| {
        let mesh = slot_of_mesh[mesh].expect("every mesh of an instance was read");
        Instance { mesh, name, world_from_mesh }
    };
    let materials = 0..document.list(Kind::Material).len();
    scene.materials = materials.map(|index| material::read(document, index, &mut notes)).collect();
    scene.instances = standing.into_iter().map(instance).collect();
    notes.add_many("animation ignored", "animation 0", document.object().list("animations")?.len());
    scene.notes = notes.into_lines();
    Ok(scene)
}

/// Notes for people, one line per kind, however often it occurs.
#[derive(Default)]
struct Notes {
    /// (what, where first, how often), in order of first occurrence.
    kinds: Vec<(&'static str, String, usize)>,
}

impl Notes {
    fn add(&mut self, what: &'static str, place: &str) {
        self.add_many(what, place, 1);
    }

    fn add_many(&mut self, what: &'static str, place: &str, times: usize) {
        match self.kinds.iter_mut().find(|(kind, ..)| *kind == what) {
            _ if times == 0 => {}
            Some((.., count)) => *count += times,
            None => self.kinds.push((what, place.to_owned(), times)),
        }
    }

    fn into_lines(self) -> Vec<String> {
        let line = |(what, place, count): (&str, String, usize)| match count {
            1 => format!("{place}: {what}"),
            _ => format!("{place} and {} more: {what}", count - 1),
        };
        self.kinds.into_iter().map(line).collect()
    }
}
