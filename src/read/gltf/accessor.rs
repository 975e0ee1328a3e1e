//! Accessors: elements in a buffer view, at a stride, some of them replaced by sparse values.
//!
//! Every range is checked against the view, and the view against the buffer, before a byte is read.

use gltf::json::accessor as code;

use super::asset::{Asset, compressed};
use super::document::{Kind, Object};
use crate::read::ReadError;

/// What one component of an element is stored as.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Component {
    I8,
    U8,
    I16,
    U16,
    U32,
    F32,
}

impl Component {
    fn of(object: &Object) -> Result<Self, ReadError> {
        let stated = object.required("componentType", object.whole("componentType")?)?;
        Ok(match u32::try_from(stated) {
            Ok(code::BYTE) => Self::I8,
            Ok(code::UNSIGNED_BYTE) => Self::U8,
            Ok(code::SHORT) => Self::I16,
            Ok(code::UNSIGNED_SHORT) => Self::U16,
            Ok(code::UNSIGNED_INT) => Self::U32,
            Ok(code::FLOAT) => Self::F32,
            _ => {
                return Err(
                    object.error(format!("has the component type {stated}, which glTF does not know"))
                );
            }
        })
    }

    fn bytes(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::U32 | Self::F32 => 4,
        }
    }

    /// The first component in `bytes`, which hold one at least; normalized as in §3.11 of the specification.
    fn float(self, bytes: &[u8], normalized: bool) -> f32 {
        let (value, scale) = match self {
            Self::I8 => (f32::from(bytes[0] as i8), 127.0),
            Self::U8 => (f32::from(bytes[0]), 255.0),
            Self::I16 => (f32::from(i16::from_le_bytes([bytes[0], bytes[1]])), 32767.0),
            Self::U16 => (f32::from(u16::from_le_bytes([bytes[0], bytes[1]])), 65535.0),
            Self::U32 => (self.whole(bytes) as f32, 1.0),
            Self::F32 => (f32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]), 1.0),
        };
        if normalized && self != Self::F32 { (value / scale).max(-1.0) } else { value }
    }

    /// The first component in `bytes` as an index; only unsigned types are indices.
    fn whole(self, bytes: &[u8]) -> u32 {
        match self {
            Self::U8 => u32::from(bytes[0]),
            Self::U16 => u32::from(u16::from_le_bytes([bytes[0], bytes[1]])),
            _ => u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]),
        }
    }
}

/// The positions, or the displacements of positions, that an accessor holds: finite, three a piece.
pub(super) fn positions(asset: &Asset, index: usize) -> Result<Vec<[f32; 3]>, ReadError> {
    let object = asset.document.item(Kind::Accessor, index)?;
    let component = Component::of(&object)?;
    expect_shape(&object, "VEC3", "a position")?;
    match component {
        Component::F32 => {}
        Component::U32 => {
            return Err(object.error("holds 32-bit integers, but a position is of 32-bit floats"));
        }
        _ if asset.document.uses("KHR_mesh_quantization") => {}
        _ => {
            let problem =
                "holds small integers as positions, but the file does not use KHR_mesh_quantization";
            return Err(object.error(problem));
        }
    }
    let normalized = object.flag("normalized")?;
    let size = component.bytes();
    let positions = elements(asset, &object, 3 * size, [0.0; 3], |bytes| {
        std::array::from_fn(|axis| component.float(&bytes[axis * size..], normalized))
    })?;
    for (element, position) in positions.iter().enumerate() {
        if let Some(value) = position.iter().find(|value| !value.is_finite()) {
            let problem =
                format!("element {element} has the coordinate {value}, which is not a finite number");
            return Err(object.error(problem));
        }
    }
    Ok(positions)
}

/// The vertex indices that an accessor holds.
pub(super) fn indices(asset: &Asset, index: usize) -> Result<Vec<u32>, ReadError> {
    let object = asset.document.item(Kind::Accessor, index)?;
    let component = index_component(&object)?;
    expect_shape(&object, "SCALAR", "an index")?;
    elements(asset, &object, component.bytes(), 0, |bytes| component.whole(bytes))
}

fn index_component(object: &Object) -> Result<Component, ReadError> {
    match Component::of(object)? {
        component @ (Component::U8 | Component::U16 | Component::U32) => Ok(component),
        _ => Err(object.error("holds numbers that are not unsigned integers, but an index is one")),
    }
}

fn expect_shape(object: &Object, wanted: &str, what: &str) -> Result<(), ReadError> {
    match object.required("type", object.text("type")?)? {
        shape if shape == wanted => Ok(()),
        shape => Err(object.error(format!("is of type {shape}, but {what} is a {wanted}"))),
    }
}

/// All elements of an accessor, each decoded from `size` bytes; `zero` stands for absent data.
fn elements<T: Clone>(
    asset: &Asset,
    object: &Object,
    size: usize,
    zero: T,
    decode: impl Fn(&[u8]) -> T,
) -> Result<Vec<T>, ReadError> {
    let count = object.required("count", object.whole("count")?)?;
    let sparse = object.object("sparse")?;
    let view = object.link("bufferView", asset.document, Kind::BufferView)?;
    let dense = view.map(|view| Strided::new(asset, object, view, count, size)).transpose()?;
    asset.charge(count, object)?;
    let mut elements = match dense {
        Some(dense) => (0..count).map(|index| decode(dense.get(index))).collect(),
        None => vec![zero; count],
    };
    if let Some(sparse) = sparse {
        replace(asset, &sparse, &mut elements, size, decode)?;
    }
    Ok(elements)
}

/// Replaces the elements that a sparse accessor lists.
fn replace<T>(
    asset: &Asset,
    sparse: &Object,
    elements: &mut [T],
    size: usize,
    decode: impl Fn(&[u8]) -> T,
) -> Result<(), ReadError> {
    let part = |key: &str| -> Result<(Object<'_>, usize), ReadError> {
        let part = sparse.required(key, sparse.object(key)?)?;
        let view = part.link("bufferView", asset.document, Kind::BufferView)?;
        let view = part.required("bufferView", view)?;
        Ok((part, view))
    };
    let count = sparse.required("count", sparse.whole("count")?)?;
    let (at, at_view) = part("indices")?;
    let component = index_component(&at)?;
    let places = Strided::new(asset, &at, at_view, count, component.bytes())?;
    let (by, by_view) = part("values")?;
    let values = Strided::new(asset, &by, by_view, count, size)?;
    let mut previous = None;
    for index in 0..count {
        let place = component.whole(places.get(index)) as usize;
        if previous.is_some_and(|previous| place <= previous) {
            return Err(at.error(format!("{place} does not ascend at index {index}")));
        }
        previous = Some(place);
        let length = elements.len();
        let element = elements.get_mut(place);
        *element
            .ok_or_else(|| at.error(format!("{place} is out of range, for there are {length} elements")))? =
            decode(values.get(index));
    }
    Ok(())
}

/// Elements of one size at one stride, all of them inside the buffer.
struct Strided<'a> {
    bytes: &'a [u8],
    stride: usize,
    size: usize,
}

impl<'a> Strided<'a> {
    /// The elements of `object` (an accessor, or a list of a sparse one) in a buffer view.
    fn new(
        asset: &'a Asset,
        object: &Object,
        view: usize,
        count: usize,
        size: usize,
    ) -> Result<Self, ReadError> {
        let view = asset.document.item(Kind::BufferView, view)?;
        let buffer = view.required("buffer", view.link("buffer", asset.document, Kind::Buffer)?)?;
        let bytes = asset.buffer(buffer).map_err(|error| match view.compression() {
            Some(extension) => compressed(&view, extension),
            None => error,
        })?;
        let start = view.whole("byteOffset")?.unwrap_or(0);
        let length = view.required("byteLength", view.whole("byteLength")?)?;
        let bytes = start.checked_add(length).and_then(|end| bytes.get(start..end)).ok_or_else(|| {
            view.error(format!(
                "is {length} bytes from byte {start}, but buffer {buffer} has {} bytes",
                bytes.len()
            ))
        })?;

        let stride = view.whole("byteStride")?.unwrap_or(size);
        if stride < size {
            return Err(view.error(format!("has a stride of {stride} bytes, but an element has {size}")));
        }
        let offset = object.whole("byteOffset")?.unwrap_or(0);
        let end = match count.checked_sub(1) {
            None => Some(offset),
            Some(gaps) => gaps
                .checked_mul(stride)
                .and_then(|bytes| bytes.checked_add(size))
                .and_then(|bytes| bytes.checked_add(offset)),
        };
        let elements = end.and_then(|end| bytes.get(offset..end)).ok_or_else(|| {
            object.error(format!(
                "{count} elements of {size} bytes, {stride} apart from byte {offset}, do not fit {}, which has {length} bytes",
                view.place
            ))
        })?;
        Ok(Self { bytes: elements, stride, size })
    }

    fn get(&self, index: usize) -> &'a [u8] {
        &self.bytes[index * self.stride..][..self.size]
    }
}
