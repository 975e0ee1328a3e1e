//! The edit as a whole: which primitives get values, and from which faces.

use std::collections::HashMap;
use std::ops::Range;
use std::rc::Rc;

use glam::{DVec3, Mat4};
use serde_json::Value;

use super::document::{Document, whole};
use super::primitive::{BENT, OCCLUSION, Target};
use super::split::{NONE, Split, with_equal_values};
use super::{Form, Occlusion, OcclusionOptions, WriteError, material};
use crate::read::stored::{Primitive, Stored};

/// A primitive that gets values, where a node shows it.
pub(super) struct Planned {
    /// `None` in a file without nodes.
    node: Option<usize>,
    mesh: usize,
    world_from_mesh: Mat4,
    primitives: Rc<Vec<Primitive>>,
    /// Its position among `primitives`.
    at: usize,
    /// Its faces, among those of all that is planned.
    faces: Range<usize>,
    /// The set of texture coordinates that is free, for a texture.
    set: usize,
}

impl Planned {
    fn primitive(&self) -> &Primitive {
        &self.primitives[self.at]
    }

    fn pointer(&self, mesh: usize) -> String {
        format!("/meshes/{mesh}/primitives/{}", self.primitive().index)
    }

    /// The corners of a baked face, in the order of the file: where the node mirrors, they were turned.
    fn order(&self) -> [usize; 3] {
        if self.world_from_mesh.as_dmat4().determinant() < 0.0 { [0, 2, 1] } else { [0, 1, 2] }
    }
}

/// What gets values, in the order of the faces; with `options`, an error where something stands in the way.
pub(super) fn plan(
    stored: &Stored<'_>,
    kept: Option<&[bool]>,
    options: Option<&OcclusionOptions>,
) -> Result<Vec<Planned>, WriteError> {
    let (mut planned, mut flag, mut face) = (Vec::new(), 0, 0);
    let mut of_mesh: HashMap<usize, Rc<Vec<Primitive>>> = HashMap::new();
    let mut is_kept = || {
        flag += 1;
        kept.is_none_or(|kept| kept.get(flag - 1) == Some(&true))
    };
    for placed in stored.placed()? {
        let primitives = match of_mesh.get(&placed.mesh) {
            Some(primitives) => Rc::clone(primitives),
            None => {
                let primitives = Rc::new(stored.primitives(placed.mesh)?);
                of_mesh.insert(placed.mesh, Rc::clone(&primitives));
                primitives
            }
        };
        if primitives.is_empty() {
            is_kept(); // it counts as one part
        }
        for at in 0..primitives.len() {
            if !is_kept() {
                continue;
            }
            let count = primitives[at].triangles.len();
            let mut next = Planned {
                node: placed.node,
                mesh: placed.mesh,
                world_from_mesh: placed.world_from_mesh,
                primitives: Rc::clone(&primitives),
                at,
                faces: face..face + count,
                set: 0,
            };
            if placed.instanced {
                let problem = format!(
                    "node {} places its mesh many times (EXT_mesh_gpu_instancing), and each has other values",
                    placed.node.unwrap_or_default()
                );
                return Err(WriteError::new(problem, "export single nodes, or leave it out with --only"));
            }
            if let Some(options) = options {
                next.set = free(stored.root(), &next.pointer(placed.mesh), options)?;
            }
            face += count;
            planned.push(next);
        }
    }
    if kept.is_some_and(|kept| kept.len() != flag) {
        return Err(changed());
    }
    Ok(planned)
}

/// Refuses a primitive that cannot be added to; the set of texture coordinates that is free.
fn free(root: &Value, pointer: &str, options: &OcclusionOptions) -> Result<usize, WriteError> {
    let draco = "KHR_draco_mesh_compression";
    if root.pointer(&format!("{pointer}/extensions/{draco}")).is_some() {
        let problem = format!("{pointer} is compressed ({draco}), and cannot be added to");
        let remedy = "write the file without it: `gltf-transform cp IN.glb OUT.glb` does";
        return Err(WriteError::new(problem, remedy));
    }
    for name in [OCCLUSION, BENT] {
        if !options.replace && root.pointer(&format!("{pointer}/attributes/{name}")).is_some() {
            let problem = format!("{pointer} has an attribute {name} already");
            return Err(WriteError::new(problem, "replace it with --replace"));
        }
    }
    if options.form != Form::Texture {
        return Ok(0);
    }
    if !options.replace {
        material::refuse_replacing(root, pointer)?;
    }
    material::free_set(root, pointer)
}

fn changed() -> WriteError {
    WriteError::new("has other faces than those that were asked about", "read it again")
}

/// The document with values.
pub(super) struct Edited {
    pub(super) json: Vec<u8>,
    /// The binary chunk.
    pub(super) bytes: Vec<u8>,
    /// What there is to say.
    pub(super) notes: Vec<String>,
}

/// Adds the values to the planned primitives.
pub(super) fn add(
    stored: &Stored<'_>,
    kept: Option<&[bool]>,
    occlusion: &Occlusion<'_>,
    options: &OcclusionOptions,
) -> Result<Edited, WriteError> {
    let planned = plan(stored, kept, Some(options))?;
    if planned.last().map_or(0, |last| last.faces.end) != occlusion.corners.len() {
        return Err(changed());
    }
    let mut notes = Vec::new();
    let mut document = Document::new(stored, &mut notes)?;
    let meshes = own_meshes(&mut document, &planned);
    let values = with_equal_values(occlusion);
    let mut sets = HashMap::new();
    // Primitives may share vertices, of which each uses some.
    let mut used: HashMap<usize, Vec<bool>> = HashMap::new();
    for (planned, mesh) in planned.iter().zip(meshes) {
        let pointer = planned.pointer(mesh);
        let order = planned.order();
        let corners = &occlusion.corners[planned.faces.clone()];
        let corners: Vec<[u32; 3]> =
            corners.iter().map(|face| order.map(|corner| values[face[corner] as usize])).collect();
        let primitive = planned.primitive();
        let split = Split::new(primitive.vertices, &primitive.triangles, &corners);
        let used = used.entry(primitive.position).or_insert_with(|| vec![false; primitive.vertices]);
        used.iter_mut().zip(&split.receivers).for_each(|(used, &receiver)| *used |= receiver != NONE);
        let color =
            whole(stored.root().pointer(&format!("{}/attributes/COLOR_0", planned.pointer(planned.mesh))));
        let target = Target { pointer: pointer.clone(), primitive, split, color };
        target.split(&mut document)?;
        target.add(&mut document, options.form, planned.set, occlusion)?;
        if let Some(bent) = occlusion.bent {
            target.add_bent(&mut document, bent, planned.world_from_mesh)?;
        }
        sets.insert(pointer, planned.set);
    }
    let unused = used.values().flatten().filter(|used| !**used).count();
    if unused > 0 {
        notes.push(format!("{unused} vertices without a face: written as open"));
    }
    if options.form == Form::Texture && !sets.is_empty() {
        let unlit = material::add(&mut document, &sets, options)?;
        if unlit > 0 {
            notes.push(format!(
                "{unlit} unlit materials (KHR_materials_unlit): viewers show no occlusion on them"
            ));
        }
    }
    let (json, bytes) = document.finish()?;
    Ok(Edited { json, bytes, notes })
}

/// The mesh of each planned primitive: its own, or a copy where other nodes show the mesh too.
fn own_meshes(document: &mut Document<'_, '_>, planned: &[Planned]) -> Vec<usize> {
    let mut nodes = vec![0_usize; document.list("meshes").len()];
    let nodes_of = |document: &mut Document<'_, '_>| -> Vec<Option<usize>> {
        document.root["nodes"].as_array().into_iter().flatten().map(|node| whole(node.get("mesh"))).collect()
    };
    for mesh in nodes_of(document).into_iter().flatten() {
        if let Some(count) = nodes.get_mut(mesh) {
            *count += 1;
        }
    }
    let mut meshes: Vec<usize> = Vec::with_capacity(planned.len());
    let mut last: Option<(usize, usize)> = None;
    for planned in planned {
        let mesh = match (planned.node, last) {
            (Some(node), Some((before, mesh))) if before == node => mesh,
            (Some(node), _) if nodes[planned.mesh] > 1 => {
                nodes[planned.mesh] -= 1;
                let copy = document.list("meshes")[planned.mesh].clone();
                let copy = document.push("meshes", copy);
                document.list("nodes")[node]["mesh"] = copy.into();
                copy
            }
            _ => planned.mesh,
        };
        last = planned.node.map(|node| (node, mesh));
        meshes.push(mesh);
    }
    meshes
}

/// The normals of the corners of all planned faces in the world, of any length; `None` where the file has
/// none.
pub(super) fn normals(
    stored: &Stored<'_>,
    kept: Option<&[bool]>,
) -> Result<Vec<Option<[[f32; 3]; 3]>>, WriteError> {
    let mut normals = Vec::new();
    for planned in plan(stored, kept, None)? {
        let (primitive, order) = (planned.primitive(), planned.order());
        let at = format!("{}/attributes/NORMAL", planned.pointer(planned.mesh));
        // Normals stay at right angles to their surface under the inverse transpose, if there is one.
        let world = planned.world_from_mesh.as_dmat4();
        let accessor = whole(stored.root().pointer(&at)).filter(|_| world.determinant() != 0.0);
        let Some(accessor) = accessor else {
            normals.resize(normals.len() + primitive.triangles.len(), None);
            continue;
        };
        let of_vertices = stored.numbers(accessor)?;
        let world = world.inverse().transpose();
        let placed = |vertex: u32| match of_vertices.get(vertex as usize) {
            None => [0.0; 3],
            Some(&[x, y, z, _]) => {
                let normal = world.transform_vector3(DVec3::new(x.into(), y.into(), z.into()));
                normal.try_normalize().map_or([0.0; 3], |unit| unit.as_vec3().to_array())
            }
        };
        normals.extend(primitive.triangles.iter().map(|face| Some(order.map(|corner| placed(face[corner])))));
    }
    Ok(normals)
}
