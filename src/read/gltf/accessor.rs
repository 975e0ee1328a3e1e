//! Accessors: elements in a buffer view, some of them replaced by sparse values.

use glam::DMat4;

use super::asset::Asset;
use super::component::Component;
use super::document::Kind;
use super::object::Object;
use super::view::Strided;
use crate::read::ReadError;

/// Vectors of `N` finite numbers, each called `what` in errors.
pub(super) fn vectors<const N: usize>(
    asset: &Asset,
    index: usize,
    what: &str,
) -> Result<Vec<[f32; N]>, ReadError> {
    let object = asset.document.item(Kind::Accessor, index)?;
    let component = Component::of(&object)?;
    expect_shape(&object, &format!("VEC{N}"), what)?;
    match component {
        Component::F32 => {}
        Component::U32 => {
            let problem = format!("holds 32-bit integers, but {what} is of 32-bit floats");
            return Err(object.error(problem));
        }
        // Rotations may be small integers without it.
        _ if N == 4 || asset.document.quantized => {}
        _ => {
            let note = "small integers read as if the file used KHR_mesh_quantization";
            asset.notes.once(note, &object.place, String::new);
        }
    }
    let normalized = object.flag("normalized")?;
    let size = component.bytes();
    let vectors = elements(asset, &object, N * size, [0.0; N], |bytes| {
        std::array::from_fn(|axis| component.float(&bytes[axis * size..], normalized))
    })?;
    for (element, vector) in vectors.iter().enumerate() {
        if let Some(value) = vector.iter().find(|value| !value.is_finite()) {
            let problem =
                format!("element {element} has the coordinate {value}, which is not a finite number");
            return Err(object.error(problem));
        }
    }
    Ok(vectors)
}

/// Finite numbers; small integers are fractions of their largest where the accessor says so.
pub(super) fn scalars(asset: &Asset, index: usize, what: &str) -> Result<Vec<f32>, ReadError> {
    let object = asset.document.item(Kind::Accessor, index)?;
    let component = Component::of(&object)?;
    expect_shape(&object, "SCALAR", what)?;
    let normalized = object.flag("normalized")?;
    let numbers =
        elements(asset, &object, component.bytes(), 0.0, |bytes| component.float(bytes, normalized))?;
    match numbers.iter().position(|number: &f32| !number.is_finite()) {
        None => Ok(numbers),
        Some(element) => {
            let value = numbers[element];
            Err(object.error(format!("element {element} is {value}, which is not a finite number")))
        }
    }
}

/// Matrices of 32-bit floats, all finite.
pub(super) fn matrices(asset: &Asset, index: usize, what: &str) -> Result<Vec<DMat4>, ReadError> {
    let object = asset.document.item(Kind::Accessor, index)?;
    expect_shape(&object, "MAT4", what)?;
    if Component::of(&object)? != Component::F32 {
        return Err(object.error(format!("holds integers, but {what} is of 32-bit floats")));
    }
    let count = object.required("count", object.whole("count")?)?;
    // A matrix takes more bytes than an element is charged as.
    asset.charge_bytes(count.saturating_mul(size_of::<DMat4>()), &object)?;
    let matrices = elements(asset, &object, 64, DMat4::IDENTITY, |bytes| {
        let column = |at: usize| f64::from(Component::F32.float(&bytes[4 * at..], false));
        DMat4::from_cols_array(&std::array::from_fn(column))
    })?;
    match matrices.iter().position(|matrix: &DMat4| !matrix.is_finite()) {
        None => Ok(matrices),
        Some(element) => Err(object.error(format!("element {element} has a number that is not finite"))),
    }
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
pub(super) fn elements<T: Clone>(
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
        None => {
            if sparse.is_none() {
                if let Some(error) = object.stored_elsewhere() {
                    return Err(error);
                }
                asset.notes.once("accessor without data read as zeros", &object.place, String::new);
            }
            vec![zero; count]
        }
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
