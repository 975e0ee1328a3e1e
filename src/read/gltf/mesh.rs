//! One glTF mesh as one mesh: each primitive brings its own vertices and becomes a part.

use gltf::json::mesh as code;

use super::accessor;
use super::asset::Asset;
use super::document::Kind;
use super::notes::Notes;
use super::object::Object;
use super::skin::Numbers;
use crate::mesh::{Mesh, Part};
use crate::read::{Place, ReadError};

/// What is said of a mesh that is not posed.
pub(super) const DEFAULT_WEIGHTS: &str = "default morph weights ignored, read at rest";

/// How a primitive's indices are to be taken.
#[derive(Clone, Copy)]
enum Mode {
    List,
    Strip,
    Fan,
}

impl Mode {
    /// `None` for points and lines.
    fn of(primitive: &Object) -> Result<Option<Self>, ReadError> {
        let stated = primitive.whole("mode")?.unwrap_or(code::TRIANGLES as usize);
        Ok(match u32::try_from(stated) {
            Ok(code::TRIANGLES) => Some(Self::List),
            Ok(code::TRIANGLE_STRIP) => Some(Self::Strip),
            Ok(code::TRIANGLE_FAN) => Some(Self::Fan),
            Ok(code::POINTS..=code::LINE_STRIP) => None,
            _ => return Err(primitive.error(format!("has the mode {stated}, which glTF does not know"))),
        })
    }
}

/// The geometry of one primitive.
pub(super) struct Primitive {
    pub(super) positions: Vec<[f32; 3]>,
    pub(super) triangles: Vec<[u32; 3]>,
    /// One a morph target; `None` where the target leaves positions alone.
    displacements: Vec<Option<Vec<[f32; 3]>>>,
}

/// Reads mesh `index` of the document; with `skin` if some node moves it by one.
pub(super) fn read(asset: &Asset, index: usize, mut skin: Option<&mut Numbers>) -> Result<Mesh, ReadError> {
    let notes = asset.notes;
    let object = asset.document.item(Kind::Mesh, index)?;
    if is_morphed(&object) {
        notes.add(DEFAULT_WEIGHTS, &object.place);
    }
    let mut primitives = Vec::new();
    for (index, primitive) in object.objects("primitives", "primitive")?.enumerate() {
        let primitive = primitive?;
        if let Some(geometry) = read_primitive(asset, &primitive)? {
            if let Some(skin) = skin.as_deref_mut() {
                skin.add(asset, &primitive, geometry.positions.len());
            }
            let what = "material that does not exist left out";
            let material = primitive.link_or_note("material", asset.document, Kind::Material, what, notes);
            primitives.push((part_name(asset, material, index)?, material, geometry));
        }
    }

    // Each frame holds as many positions as the mesh, whichever primitives the target moves.
    let vertices: usize = primitives.iter().map(|(.., primitive)| primitive.positions.len()).sum();
    let targets = primitives.iter().map(|(.., primitive)| primitive.displacements.len()).max().unwrap_or(0);
    asset.charge(vertices.saturating_mul(targets), &object)?;
    let mut positions: Vec<[f32; 3]> = Vec::with_capacity(vertices);
    let mut frames: Vec<Vec<[f32; 3]>> = (0..targets).map(|_| Vec::with_capacity(vertices)).collect();
    let mut triangles: Vec<[u32; 3]> = Vec::new();
    let mut parts = Vec::with_capacity(primitives.len());
    for (name, material, primitive) in primitives {
        for (target, frame) in frames.iter_mut().enumerate() {
            match primitive.displacements.get(target) {
                Some(Some(displacements)) => {
                    let moved = primitive.positions.iter().zip(displacements);
                    frame.extend(moved.map(|(p, d)| [p[0] + d[0], p[1] + d[1], p[2] + d[2]]));
                }
                _ => frame.extend_from_slice(&primitive.positions),
            }
        }
        // Counts beyond 32 bits wrap here and are refused by `Mesh::new`.
        let (vertex, face) = (positions.len() as u32, triangles.len() as u32);
        positions.extend_from_slice(&primitive.positions);
        triangles.extend(primitive.triangles.iter().map(|t| t.map(|corner| corner.wrapping_add(vertex))));
        // A JSON list of more than 2³² materials does not fit the memory.
        let material = material.map(|index| index as u32);
        parts.push(Part { name, faces: face..triangles.len() as u32, material });
    }
    Mesh::new(positions, triangles)
        .and_then(|mesh| mesh.with_parts(parts).with_name(object.name()).with_frames(frames))
        .map(|mesh| mesh.with_skin(skin.map(|skin| skin.take().into())))
        .map_err(|error| object.error(error.to_string()))
}

/// Whether an object, a mesh or a node, has morph weights that are not all 0.
pub(super) fn is_morphed(object: &Object) -> bool {
    object.list("weights").is_ok_and(|weights| weights.iter().any(|weight| weight.as_f64() != Some(0.0)))
}

/// "primitive 2", or "primitive 2 (Wheel)" after its material.
fn part_name(asset: &Asset, material: Option<usize>, index: usize) -> Result<String, ReadError> {
    let material = match material {
        Some(material) => asset.document.item(Kind::Material, material).ok(),
        None => None,
    };
    let material = material.and_then(|material| material.given_name());
    Ok(material.map_or_else(|| format!("primitive {index}"), |name| format!("primitive {index} ({name})")))
}

/// `None` for points, lines, and a primitive without positions.
pub(super) fn read_primitive(asset: &Asset, primitive: &Object) -> Result<Option<Primitive>, ReadError> {
    let notes = asset.notes;
    let within = |error: ReadError| match error.place {
        Place::Item(item) => {
            ReadError { place: Place::Item(format!("{}, {item}", primitive.place)), ..error }
        }
        _ => error,
    };
    let Some(mode) = Mode::of(primitive)? else {
        notes.add("primitive of points or lines left out", &primitive.place);
        return Ok(None);
    };
    let attributes = primitive.required("attributes", primitive.object("attributes")?)?;
    let Some(position) = attributes.link("POSITION", asset.document, Kind::Accessor)? else {
        notes.add("primitive without positions left out", &primitive.place);
        return Ok(None);
    };
    let indices = primitive.link("indices", asset.document, Kind::Accessor)?;
    let (mode, positions, indices) = match compressed(asset, primitive, position, indices)? {
        Some((positions, indices)) => (Mode::List, positions, indices),
        None => {
            let positions = accessor::vectors(asset, position, "a position").map_err(within)?;
            let indices = match indices {
                Some(index) => accessor::indices(asset, index).map_err(within)?,
                // Fits: a count beyond 32 bits would have needed 48 GB of positions.
                None => (0..positions.len()).map(|index| index as u32).collect(),
            };
            (mode, positions, indices)
        }
    };
    if let Some(at) = indices.iter().position(|&index| index as usize >= positions.len()) {
        let problem = format!("index {at} names vertex {}, but there are {}", indices[at], positions.len());
        return Err(primitive.error(problem));
    }
    let triangles = triangles(mode, &indices, primitive, notes);

    let mut displacements = Vec::new();
    for target in primitive.objects("targets", "morph target")? {
        let target = target?;
        let Some(index) = target.link("POSITION", asset.document, Kind::Accessor)? else {
            displacements.push(None);
            continue;
        };
        let displacement = accessor::vectors(asset, index, "a displacement").map_err(within)?;
        if displacement.len() != positions.len() {
            let (count, vertices) = (displacement.len(), positions.len());
            return Err(target.error(format!("moves {count} vertices, but the primitive has {vertices}")));
        }
        displacements.push(Some(displacement));
    }
    Ok(Some(Primitive { positions, triangles, displacements }))
}

/// Positions, and the indices of triangles one by one.
type List = (Vec<[f32; 3]>, Vec<u32>);

/// The positions and indices of a primitive, where the accessors have none of their own: what an extension of
/// the primitive decodes to, or an error that names the extension.
fn compressed(
    asset: &Asset,
    primitive: &Object,
    position: usize,
    indices: Option<usize>,
) -> Result<Option<List>, ReadError> {
    for accessor in [Some(position), indices].into_iter().flatten() {
        if !asset.document.item(Kind::Accessor, accessor)?.is_empty() {
            continue;
        }
        #[cfg(feature = "draco")]
        if let Some(extension) = primitive.extension("KHR_draco_mesh_compression") {
            return super::draco::read(asset, &extension, position, indices).map(Some);
        }
        if let Some(error) = primitive.stored_elsewhere() {
            return Err(error);
        }
    }
    Ok(None)
}

/// The triangles that indices describe, wound as §3.7.2.1 of the specification says.
fn triangles(mode: Mode, indices: &[u32], primitive: &Object, notes: &Notes) -> Vec<[u32; 3]> {
    match mode {
        Mode::List => {
            let (triangles, rest) = indices.as_chunks();
            if !rest.is_empty() {
                notes.add("last triangle incomplete and left out", &primitive.place);
            }
            triangles.to_vec()
        }
        Mode::Strip => {
            // Every second triangle is reversed, so that all of them face the same side.
            let strip = indices.windows(3).enumerate().map(|(index, corners)| match index % 2 {
                0 => [corners[0], corners[1], corners[2]],
                _ => [corners[0], corners[2], corners[1]],
            });
            // A strip turns a corner by naming a vertex twice; the resulting triangles are not faces.
            let is_face = |&[a, b, c]: &[u32; 3]| a != b && b != c && c != a;
            let triangles: Vec<_> = strip.filter(is_face).collect();
            let stitches = indices.len().saturating_sub(2) - triangles.len();
            notes.add_many("stitching triangle of a strip left out", &primitive.place, stitches);
            triangles
        }
        Mode::Fan => {
            let Some((&hub, rim)) = indices.split_first() else { return Vec::new() };
            rim.windows(2).map(|pair| [pair[0], pair[1], hub]).collect()
        }
    }
}
