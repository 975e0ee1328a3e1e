//! Buffer views: a range of a buffer, or what a compressed range decodes to; and elements in them, at a
//! stride.

use super::asset::Asset;
use super::document::Kind;
use super::meshopt;
use super::object::Object;
use crate::read::ReadError;

/// The content of buffer view `index`.
///
/// Compressed data wins over the plain bytes beside it, which are there for programs that do not decode
/// (fallback buffers); where it does not decode, they serve, with a note.
pub(super) fn bytes<'a>(asset: &'a Asset, index: usize) -> Result<&'a [u8], ReadError> {
    let view = asset.document.item(Kind::BufferView, index)?;
    let Some(compressed) = meshopt::of(&view) else { return plain(asset, &view) };
    meshopt::bytes(asset, index, &view, &compressed).or_else(|error| {
        let bytes = plain(asset, &view).map_err(|_| error.clone())?;
        let what = "compressed data passed over for the plain data beside it";
        asset.notes.once(what, &compressed.place, || error.problem);
        Ok(bytes)
    })
}

/// The range of a buffer that `object`, a view or what stands for one, names.
pub(super) fn plain<'a>(asset: &'a Asset, object: &Object) -> Result<&'a [u8], ReadError> {
    let index = object.required("buffer", object.link("buffer", asset.document, Kind::Buffer)?)?;
    let buffer = asset.document.item(Kind::Buffer, index)?;
    let bytes = asset.buffer(index).map_err(|error| object.stored_elsewhere().unwrap_or(error))?;
    let start = object.whole("byteOffset")?.unwrap_or(0);
    let length = object.required("byteLength", object.whole("byteLength")?)?;
    let stated = buffer.whole("byteLength")?;
    let end = start.checked_add(length);
    let range = end.and_then(|end| bytes.get(start..end)).ok_or_else(|| {
        let there = bytes.len();
        let says = match stated {
            Some(stated) if stated != there => format!(", not the {stated} of its byteLength"),
            _ => String::new(),
        };
        let error = object.error(format!(
            "is {length} bytes from byte {start}, but buffer {index} has {there} bytes{says}"
        ));
        match says.is_empty() {
            true => error,
            false => error.remedy("the buffer may be cut off; copy or export it again"),
        }
    })?;
    match stated {
        None => {
            asset.notes.once("no byteLength: the buffer read as far as it goes", &buffer.place, String::new);
        }
        // A view within the bytes that are there needs no more of them.
        Some(stated) if stated > bytes.len() => {
            let why = || format!("it is {stated}, but there are {} bytes", bytes.len());
            asset.notes.once("byteLength of a buffer passed over", &buffer.place, why);
        }
        Some(stated) if end > Some(stated) => {
            let why = || format!("it is {stated}, but {} ends at byte {}", object.place, start + length);
            asset.notes.once("byteLength of a buffer passed over", &buffer.place, why);
        }
        Some(_) => {}
    }
    Ok(range)
}

/// Elements of one size at one stride, all of them inside the buffer.
pub(super) struct Strided<'a> {
    bytes: &'a [u8],
    stride: usize,
    size: usize,
}

impl<'a> Strided<'a> {
    /// The elements of `object` (an accessor, or a list of a sparse one) in a buffer view.
    pub(super) fn new(
        asset: &'a Asset,
        object: &Object,
        view: usize,
        count: usize,
        size: usize,
    ) -> Result<Self, ReadError> {
        let bytes = bytes(asset, view)?;
        let view = asset.document.item(Kind::BufferView, view)?;
        let stride = match view.whole("byteStride")? {
            None => size,
            Some(0) => {
                asset.notes.once("stride of 0 bytes taken for none", &view.place, String::new);
                size
            }
            Some(stride) if stride < size => {
                return Err(view.error(format!("has a stride of {stride} bytes, but an element has {size}")));
            }
            Some(stride) => stride,
        };
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
                "{count} elements of {size} bytes, {stride} apart from byte {offset}, do not fit {}, which has {} bytes",
                view.place,
                bytes.len()
            ))
        })?;
        Ok(Self { bytes: elements, stride, size })
    }

    pub(super) fn get(&self, index: usize) -> &'a [u8] {
        &self.bytes[index * self.stride..][..self.size]
    }
}
