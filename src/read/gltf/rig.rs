//! What moves a scene: its node tree, skins and clips.
//!
//! Read last, and nothing in it refuses the file: a scene that is not posed needs none of it. What is wrong
//! is kept as the problem of the skin or clip, and met by whoever poses it.

use std::collections::HashMap;
use std::sync::Arc;

use glam::DMat4;

use super::accessor;
use super::animation;
use super::asset::Asset;
use super::document::Kind;
use super::instancing;
use super::node;
use super::notes::Notes;
use super::object::Object;
use super::skin::Numbers;
use crate::animate::{Influences, Node, Placing, Rig, Skin};
use crate::mesh::Mesh;
use crate::read::ReadError;

/// An instance of the scene as the reader met it.
pub(super) struct Hung {
    /// Index into the nodes of the scene; `None` in a file without nodes.
    pub(super) node: Option<usize>,
    /// Index in the document.
    pub(super) mesh: usize,
    pub(super) skin: Option<usize>,
    /// Its number among those of a node that places its mesh many times.
    pub(super) copy: Option<usize>,
}

/// What in the scene hangs on which node.
#[derive(Default)]
pub(super) struct Hanging {
    pub(super) instances: Vec<Hung>,
    pub(super) lamp_nodes: Vec<usize>,
    pub(super) camera_nodes: Vec<usize>,
}

/// `morphs` says of each mesh of the document whether it has morph targets. Notes of the reader are those of
/// the file at rest until here, and those of posing it from here on.
pub(super) fn read(
    asset: &Asset,
    placed: Vec<node::Placed>,
    hanging: Hanging,
    numbers: &Numbers,
    morphs: &[bool],
) -> Rig {
    let document = asset.document;
    let is_posable = |hung: &Hung| hung.skin.is_some() || morphs[hung.mesh];
    if !has_animations(asset) && !hanging.instances.iter().any(is_posable) {
        return Rig::default();
    }
    let mut of_document = vec![None; document.list(Kind::Node).len()];
    placed.iter().enumerate().for_each(|(index, placed)| of_document[placed.index] = Some(index));

    let indices: Vec<usize> = placed.iter().map(|placed| placed.index).collect();
    let mut nodes: Vec<Node> = placed
        .into_iter()
        .map(|placed| {
            let place = Object::place(Kind::Node, placed.index);
            Node { parent: placed.parent, local: placed.local, weights: Vec::new(), place }
        })
        .collect();
    // The number of morph targets decides how many weights a clip has for each key.
    let mut targets = vec![0; nodes.len()];
    for hung in &hanging.instances {
        let Some(at) = hung.node.filter(|_| morphs[hung.mesh] && hung.copy.unwrap_or(0) == 0) else {
            continue;
        };
        targets[at] = target_count(asset, hung.mesh);
        // Every node has weights of its own, though the targets stand in the file once.
        if let Err(error) = charge(asset, indices[at], targets[at]) {
            return Rig { problem: Some(animation::problem(&error)), ..unposable(hanging) };
        }
        nodes[at].weights = rest_weights(asset, indices[at], hung.mesh, targets[at]);
    }
    let mut slots: Vec<Option<usize>> = vec![None; document.list(Kind::Skin).len()];
    let mut skins = Vec::new();
    for skin in hanging.instances.iter().filter_map(|hung| hung.skin) {
        if slots[skin].is_none() {
            slots[skin] = Some(skins.len());
            skins.push(read_skin(asset, skin, &of_document));
        }
    }
    let placings = hanging.instances.iter().map(|hung| Placing {
        node: hung.node,
        skin: hung.skin.and_then(|skin| slots[skin]),
        node_from_mesh: hung.copy.map(|_| DMat4::IDENTITY),
    });
    let mut placings: Vec<Placing> = placings.collect();
    let clips = animation::read(asset, &of_document, &mut nodes, &targets);
    if !clips.is_empty()
        && let Err(error) = place_copies(asset, &indices, &hanging.instances, &mut placings)
    {
        return Rig { problem: Some(animation::problem(&error)), ..unposable(hanging) };
    }
    let (influences, slips) = Influences::new(numbers.lists().iter().map(Vec::as_slice));
    for (what, times) in [
        ("weights that do not add up to 1 divided by their sum", slips.sums),
        ("vertex that no joint has a weight for left where it is at rest", slips.weightless),
        ("weight below 0 taken as it is", slips.negative),
    ] {
        asset.notes.add_many(what, "skins", times);
    }
    Rig {
        nodes,
        skins,
        clips,
        influences: Arc::new(influences),
        placings,
        lamp_nodes: hanging.lamp_nodes,
        camera_nodes: hanging.camera_nodes,
        ..Rig::default()
    }
}

fn charge(asset: &Asset, node: usize, targets: usize) -> Result<(), ReadError> {
    asset.charge(targets, &asset.document.item(Kind::Node, node)?)
}

/// A rig that only says that something moves.
fn unposable(hanging: Hanging) -> Rig {
    let still = |_: &Hung| Placing { node: None, skin: None, node_from_mesh: None };
    Rig { placings: hanging.instances.iter().map(still).collect(), ..Rig::default() }
}

/// Notes vertices that coincide with others at rest, and that their skin moves otherwise: there a pose is
/// open.
pub(super) fn note_parted(notes: &Notes, meshes: &[Mesh]) {
    for mesh in meshes {
        let Some(numbers) = mesh.skin() else { continue };
        let mut first: HashMap<[u32; 3], u32> = HashMap::new();
        let mut parted = |(position, &number): (&[f32; 3], &u32)| {
            *first.entry(position.map(f32::to_bits)).or_insert(number) != number
        };
        let count = mesh.positions().iter().zip(&**numbers).filter(|&pair| parted(pair)).count();
        let what = "vertices that coincide at rest and that the skin moves apart: no pose is closed there";
        if count > 0 {
            notes.because(what, &mesh.name, || format!("{count} of {}", mesh.vertex_count()));
        }
    }
}

/// The most morph targets of a primitive of a mesh.
fn target_count(asset: &Asset, mesh: usize) -> usize {
    let count = || -> Result<usize, ReadError> {
        let mut most = 0;
        for primitive in asset.document.item(Kind::Mesh, mesh)?.objects("primitives", "primitive")? {
            most = most.max(primitive?.list("targets")?.len());
        }
        Ok(most)
    };
    count().unwrap_or(0) // read before without an error
}

/// The weights of the morph targets of a node without a clip: its own, or else those of its mesh.
fn rest_weights(asset: &Asset, node: usize, mesh: usize, targets: usize) -> Vec<f32> {
    let document = asset.document;
    let of = |kind, index| -> Option<Vec<f32>> {
        let object = document.item(kind, index).ok()?;
        if !object.has("weights") {
            return None;
        }
        let numbers = object.list("weights").map(|list| {
            list.iter().map(|x| x.as_f64().map(|x| x as f32).filter(|x| x.is_finite())).collect()
        });
        let weights: Option<Vec<f32>> = numbers.ok().flatten();
        if weights.is_none() {
            asset.notes.add("morph weights that are not numbers taken as 0", &object.place);
        }
        weights
    };
    let mut weights = of(Kind::Node, node).or_else(|| of(Kind::Mesh, mesh)).unwrap_or_default();
    if !weights.is_empty() && weights.len() != targets {
        let why = || format!("there are {} for {targets} targets", weights.len());
        let what = "morph weights without a target left out, missing ones taken as 0";
        asset.notes.because(what, &Object::place(Kind::Node, node), why);
    }
    weights.resize(targets, 0.0);
    weights
}

/// A skin; one that cannot be used has a problem.
fn read_skin(asset: &Asset, index: usize, of_document: &[Option<usize>]) -> Skin {
    skin(asset, index, of_document)
        .unwrap_or_else(|error| Skin { problem: Some(animation::problem(&error)), ..Skin::default() })
}

fn skin(asset: &Asset, index: usize, of_document: &[Option<usize>]) -> Result<Skin, ReadError> {
    let document = asset.document;
    let object = document.item(Kind::Skin, index)?;
    let listed = object.links("joints", document, Kind::Node)?;
    if listed.is_empty() {
        return Err(object.error("has no joints, but must have one at least"));
    }
    let mut joints = Vec::with_capacity(listed.len());
    for (joint, &node) in listed.iter().enumerate() {
        joints.push(of_document[node].ok_or_else(|| {
            let problem = format!("its joint {joint} is node {node}, which is not in the scene");
            object.error(problem).remedy("add the root of the joints to the scene")
        })?);
    }
    let inverse_binds = match object.link("inverseBindMatrices", document, Kind::Accessor)? {
        None => None,
        Some(accessor) => {
            let matrices = accessor::matrices(asset, accessor, "an inverse bind matrix")?;
            if matrices.len() < joints.len() {
                let (count, joints) = (matrices.len(), joints.len());
                let problem = format!("has {count} inverse bind matrices for {joints} joints");
                return Err(object.error(problem));
            }
            Some(matrices)
        }
    };
    Ok(Skin { joints, inverse_binds, place: object.place, problem: None })
}

/// Fills in where the copies of a node stand below it.
fn place_copies(
    asset: &Asset,
    indices: &[usize],
    instances: &[Hung],
    placings: &mut [Placing],
) -> Result<(), ReadError> {
    let document = asset.document;
    let mut last: Option<(usize, Vec<glam::Mat4>)> = None;
    for (hung, placing) in instances.iter().zip(placings) {
        let (Some(at), Some(copy)) = (hung.node, hung.copy) else { continue };
        if last.as_ref().is_none_or(|&(node, _)| node != at) {
            let node = document.item(Kind::Node, indices[at])?;
            last = Some((at, instancing::read(asset, &node, DMat4::IDENTITY)?.unwrap_or_default()));
        }
        let copies = last.as_ref().map_or(&[][..], |(_, copies)| copies);
        placing.node_from_mesh = copies.get(copy).map(glam::Mat4::as_dmat4);
    }
    Ok(())
}

fn has_animations(asset: &Asset) -> bool {
    // A list that is none is the problem of a clip.
    asset.document.object().list("animations").map_or(true, |list| !list.is_empty())
}

/// Whether anything in the document may move, so that there is something to keep.
pub(super) fn may_move(asset: &Asset, morphs: &[bool]) -> bool {
    has_animations(asset) || !asset.document.list(Kind::Skin).is_empty() || morphs.contains(&true)
}

/// Whether a mesh of the document has morph targets.
pub(super) fn has_targets(asset: &Asset, mesh: usize) -> bool {
    target_count(asset, mesh) > 0
}
