//! glTF 2.0, as JSON or binary: the meshes of the default scene, their instances, its materials, lamps and
//! cameras.
//!
//! Source: Khronos, *glTF 2.0 Specification*, and the extensions that [`extension`] lists as read. Only what
//! the scene shows is read: a mesh that no node names is noted, not decoded.
//!
//! A skinned mesh is read in its bind pose, and its node's transform is ignored, as the specification says
//! (§3.7.3). Its vertices have a number each, equal for equal joints and weights. Morph targets become frames
//! of the mesh, each target at full weight on its own. Where something moves, [`rig`] keeps what
//! [`Scene::pose`] needs.
//!
//! Work and memory are linear in the bytes of the file and its buffers: see [`asset`] for the bound.

mod accessor;
mod animation;
mod asset;
mod camera;
mod component;
mod container;
mod document;
#[cfg(feature = "draco")]
mod draco;
mod extension;
mod instancing;
mod light;
mod material;
mod mesh;
mod meshopt;
mod node;
mod notes;
mod object;
mod rig;
mod skin;
pub(crate) mod stored;
mod tree;
mod uri;
mod view;

use std::io::{BufRead, Read, Seek};
use std::path::Path;

use glam::Mat4;

use self::asset::Asset;
use self::document::{Document, Kind};
use self::notes::Notes;
use self::object::Object;
use self::rig::{Hanging, Hung};
use self::skin::Numbers;
use super::{Format, Place, ReadError, Source};
use crate::scene::{Instance, LeftOutCamera, Scene};

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
    let notes = Notes::default();
    let (json, bin) = match format {
        Format::Glb => container::split(&bytes, &notes)?,
        _ => (bytes.as_slice(), None),
    };
    let document = Document::parse(json, format, &notes)?;
    scene(&Asset::new(&document, &notes, bin, folder, bytes.len()))
}

/// What is said of a scene that is not posed.
const SKINNED: &str = "skinned node read in the bind pose, its own transform ignored";
const WEIGHTS: &str = "morph weights of the node ignored, its mesh read at rest";
const ANIMATION: &str = "animation ignored";
const AT_REST: [&str; 4] = [SKINNED, WEIGHTS, mesh::DEFAULT_WEIGHTS, ANIMATION];

/// The default scene, or else the first, or else all root nodes, or else every mesh once.
fn scene(asset: &Asset) -> Result<Scene, ReadError> {
    let (document, notes) = (asset.document, asset.notes);
    let mut scene = Scene::default();
    // Whether some node moves the mesh by a skin.
    let mut is_skinned = vec![false; document.list(Kind::Mesh).len()];
    // `mesh` is an index of the document until all that stands in the scene is known.
    let nodes = node::scene_nodes(document, notes)?;
    let meshes = 0..document.list(Kind::Mesh).len();
    let morphs: Vec<bool> = meshes.map(|mesh| rig::has_targets(asset, mesh)).collect();
    let may_move = rig::may_move(asset, &morphs);
    let mut hanging = Hanging::default();
    for (at, placed) in nodes.iter().enumerate() {
        let node = document.item(Kind::Node, placed.index)?;
        let world = placed.world_from_node;
        match camera::read(document, &node, world, notes) {
            Some(Ok(camera)) => {
                scene.cameras.push(camera);
                hanging.camera_nodes.push(at);
            }
            Some(Err(camera::Unusable { name, problem })) => {
                let number = scene.cameras.len() + scene.left_out_cameras.len() + 1;
                scene.left_out_cameras.push(LeftOutCamera { name, number, problem });
            }
            None => {}
        }
        if placed.hidden {
            continue;
        }
        scene.lamps.extend(light::read(document, &node, world, notes));
        hanging.lamp_nodes.resize(scene.lamps.len(), at);
        if let Some(mesh) = node.link("mesh", document, Kind::Mesh)? {
            let skin = node.link("skin", document, Kind::Skin)?;
            let skinned = skin.is_some();
            is_skinned[mesh] |= skinned;
            if skinned {
                notes.add(SKINNED, &node.place);
            }
            if mesh::is_morphed(&node) {
                notes.add(WEIGHTS, &node.place);
            }
            let world = if skinned { glam::DMat4::IDENTITY } else { world };
            match instancing::read(asset, &node, world)? {
                None => {
                    let instance = Instance { mesh, name: node.name(), world_from_mesh: world.as_mat4() };
                    scene.instances.push(instance);
                    if may_move {
                        hanging.instances.push(Hung { node: Some(at), mesh, skin, copy: None });
                    }
                }
                Some(transforms) => {
                    let name = node.name();
                    let instance = |(index, world_from_mesh): (usize, Mat4)| Instance {
                        mesh,
                        name: format!("{name} [{index}]"),
                        world_from_mesh,
                    };
                    let hung = |copy| Hung { node: Some(at), mesh, skin, copy: Some(copy) };
                    if may_move {
                        hanging.instances.extend((0..transforms.len()).map(hung));
                    }
                    scene.instances.extend(transforms.into_iter().enumerate().map(instance));
                }
            }
        }
    }
    if document.list(Kind::Node).is_empty() {
        for mesh in 0..document.list(Kind::Mesh).len() {
            let object = document.item(Kind::Mesh, mesh)?;
            notes.add("mesh placed at the origin, for the file has no nodes", &object.place);
            let name = object.name();
            scene.instances.push(Instance { mesh, name, world_from_mesh: Mat4::IDENTITY });
            if may_move {
                hanging.instances.push(Hung { node: None, mesh, skin: None, copy: None });
            }
        }
    }

    let mut numbers = Numbers::default();
    let mut slot_of_mesh = vec![None; document.list(Kind::Mesh).len()];
    scene.instances.iter().for_each(|instance| slot_of_mesh[instance.mesh] = Some(0));
    for (mesh, slot) in slot_of_mesh.iter_mut().enumerate() {
        if slot.is_some() {
            *slot = Some(scene.meshes.len());
            scene.meshes.push(mesh::read(asset, mesh, is_skinned[mesh].then_some(&mut numbers))?);
        } else {
            notes.add("mesh not read, for it stands nowhere in the scene", &Object::place(Kind::Mesh, mesh));
        }
    }
    for instance in &mut scene.instances {
        instance.mesh = slot_of_mesh[instance.mesh].expect("every mesh of an instance was read");
    }
    let materials = 0..document.list(Kind::Material).len();
    scene.materials = materials.map(|index| material::read(document, index, notes)).collect();
    let animations = document.object().list("animations").map_or(0, <[_]>::len);
    notes.add_many(ANIMATION, "animation 0", animations);
    scene.notes = notes.take_lines();
    if may_move {
        scene.rig = rig::read(asset, nodes, hanging, &numbers, &morphs);
        rig::note_parted(notes, &scene.meshes);
    }
    if !scene.rig.is_empty() {
        let is_at_rest = |note: &&String| AT_REST.iter().any(|text| note.contains(text));
        scene.rig.notes_at_rest = scene.notes.iter().filter(is_at_rest).cloned().collect();
        scene.rig.notes = notes.take_lines();
    }
    Ok(scene)
}
