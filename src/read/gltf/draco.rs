//! KHR_draco_mesh_compression, by the crate draco-core: the positions and triangles of a primitive.
//!
//! What the accessors say of their counts bounds what is decoded.

use draco_core::{DecodeLimits, DecoderBuffer, Mesh, MeshDecoder};

use super::asset::Asset;
use super::component::Component;
use super::document::Kind;
use super::object::Object;
use super::view;
use crate::read::ReadError;

/// Bytes that a vertex may have in all its attributes: a position, and fifteen more of four floats.
const VERTEX_BYTES: usize = 256;

/// Bytes that decoding takes for a triangle: its corners, their neighbors, and where it stands in the order.
const TRIANGLE_BYTES: usize = 64;

/// Positions of a primitive, and the indices of its triangles. `position` and `indices` are its accessors,
/// which have no data of their own.
pub(super) fn read(
    asset: &Asset,
    compressed: &Object,
    position: usize,
    indices: Option<usize>,
) -> Result<(Vec<[f32; 3]>, Vec<u32>), ReadError> {
    let document = asset.document;
    let view = compressed.link("bufferView", document, Kind::BufferView)?;
    let stream = view::bytes(asset, compressed.required("bufferView", view)?)?;
    let attributes = compressed.required("attributes", compressed.object("attributes")?)?;
    let id = attributes.required("POSITION", attributes.whole("POSITION")?)?;
    let accessor = document.item(Kind::Accessor, position)?;
    let count = |accessor: &Object| accessor.required("count", accessor.whole("count")?);
    let vertices = count(&accessor)?;
    let corners = match indices {
        Some(index) => count(&document.item(Kind::Accessor, index)?)?,
        None => vertices,
    };
    let bytes =
        vertices.saturating_mul(VERTEX_BYTES).saturating_add(corners.saturating_mul(TRIANGLE_BYTES / 3));
    asset.charge_bytes(bytes, compressed)?;

    let limits = DecodeLimits::default()
        .with_max_points(vertices as u64)
        .with_max_faces((corners / 3) as u64)
        .with_max_decoded_bytes((vertices * VERTEX_BYTES) as u64);
    let mut mesh = Mesh::new();
    MeshDecoder::new()
        .decode(&mut DecoderBuffer::new(stream).with_limits(limits), &mut mesh)
        .map_err(|error| compressed.error(format!("does not decode: {error}")))?;
    let attribute = u32::try_from(id).ok().and_then(|id| mesh.attribute_by_unique_id(id));
    let attribute = attribute.ok_or_else(|| compressed.error(format!("has no attribute {id}")))?;
    if attribute.num_components() != 3 {
        let problem = format!("has {} numbers a position, not 3", attribute.num_components());
        return Err(compressed.error(problem));
    }
    if mesh.num_points() != vertices || mesh.num_faces() != corners / 3 {
        let (points, faces) = (mesh.num_points(), mesh.num_faces());
        let problem = format!(
            "has {points} vertices and {faces} triangles, but its accessors say {vertices} and {}",
            corners / 3
        );
        return Err(compressed.error(problem));
    }
    let (component, normalized) = (Component::of(&accessor)?, accessor.flag("normalized")?);
    let number = |x: f32| if normalized { component.normalize(x) } else { x };
    let numbers = attribute.read_f32s(vertices, 3);
    let positions: Vec<[f32; 3]> = numbers.as_chunks().0.iter().map(|p: &[f32; 3]| p.map(number)).collect();
    if let Some(at) = positions.iter().position(|p| p.iter().any(|x| !x.is_finite())) {
        return Err(compressed.error(format!("vertex {at} has a coordinate that is not a finite number")));
    }
    Ok((positions, mesh.faces().iter().flatten().map(|corner| corner.0).collect()))
}
