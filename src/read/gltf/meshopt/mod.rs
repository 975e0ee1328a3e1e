//! Buffer views compressed with EXT_meshopt_compression or KHR_meshopt_compression.
//!
//! Source: Khronos, *EXT_meshopt_compression* and *KHR_meshopt_compression*, appendices A (bitstream) and
//! B (filters). Version 1 of the attribute codec belongs to the latter, and is read in both.
//!
//! A decoder allocates count × stride bytes, once these are known to be possible: attributes of version 0
//! take at least a byte for 64 of them, triangles a byte for 12 and indices a byte for 4; version 1 can say
//! that a whole block stays as it is, and then the bytes are charged against what the file may decode to.

mod attributes;
mod filter;
mod indices;

use super::asset::Asset;
use super::object::Object;
use super::view::plain;
use crate::read::ReadError;

/// What a view's compressed data says of itself.
#[derive(Clone, Copy, Debug)]
struct Layout {
    count: usize,
    stride: usize,
}

/// Why bytes do not decode.
type Malformed = &'static str;

/// The stream ends before its elements do.
const SHORT: Malformed = "the stream ends too early";
/// The stream goes on behind its last element.
const LONG: Malformed = "there are bytes behind the last element";

/// The compressed data of a view, if it is compressed in this manner.
pub(super) fn of<'a>(view: &Object<'a>) -> Option<Object<'a>> {
    ["KHR_meshopt_compression", "EXT_meshopt_compression"].iter().find_map(|name| view.extension(name))
}

/// The bytes that the compressed data of buffer view `index` stands for.
pub(super) fn bytes<'a>(
    asset: &'a Asset,
    index: usize,
    view: &Object,
    compressed: &Object,
) -> Result<&'a [u8], ReadError> {
    let stream = plain(asset, compressed)?;
    let bytes = asset.decoded(index, || decode(asset, compressed, stream))?;
    let length = view.required("byteLength", view.whole("byteLength")?)?;
    bytes.get(..length).ok_or_else(|| {
        let there = bytes.len();
        view.error(format!("is {length} bytes, but its compressed data is {there} bytes"))
    })
}

fn decode(asset: &Asset, compressed: &Object, stream: &[u8]) -> Result<Vec<u8>, ReadError> {
    let whole = |key| compressed.required(key, compressed.whole(key)?);
    let layout = Layout { count: whole("count")?, stride: whole("byteStride")? };
    let mode = compressed.required("mode", compressed.text("mode")?)?;
    let filter = compressed.text("filter")?.unwrap_or("NONE");
    let Layout { count, stride } = layout;
    let allowed = match (mode, filter) {
        ("ATTRIBUTES", "NONE" | "EXPONENTIAL") => stride % 4 == 0 && (4..=256).contains(&stride),
        ("ATTRIBUTES", "OCTAHEDRAL") => matches!(stride, 4 | 8),
        ("ATTRIBUTES", "QUATERNION") => stride == 8,
        ("ATTRIBUTES", "COLOR") => {
            let problem = "is filtered as colors, which are no positions, indices or rotations";
            return Err(compressed.error(problem));
        }
        ("TRIANGLES", "NONE") => matches!(stride, 2 | 4) && count % 3 == 0,
        ("INDICES", "NONE") => matches!(stride, 2 | 4),
        _ => {
            let known = "ATTRIBUTES with NONE, OCTAHEDRAL, QUATERNION or EXPONENTIAL, TRIANGLES, INDICES";
            return Err(compressed.error(format!("has a mode and filter that are not among: {known}")));
        }
    };
    if !allowed {
        let problem = format!("has {count} elements of {stride} bytes, which the mode {mode} does not allow");
        return Err(compressed.error(problem));
    }
    let least = match mode {
        "ATTRIBUTES" => attributes::least_bytes(stream, layout),
        "TRIANGLES" => indices::least_bytes(count / 3),
        _ => indices::least_bytes(count),
    };
    let bytes = count.checked_mul(stride).filter(|_| least.is_some_and(|least| least <= stream.len()));
    let Some(bytes) = bytes else {
        let problem =
            format!("has {} bytes, too few for {count} elements of {stride} bytes as {mode}", stream.len());
        return Err(compressed.error(problem));
    };
    asset.charge_bytes(bytes, compressed)?;
    let decoded = match mode {
        "ATTRIBUTES" => attributes::decode(stream, layout).map(|mut bytes| {
            filter::apply(filter, &mut bytes, stride);
            bytes
        }),
        "TRIANGLES" => indices::decode_triangles(stream, layout),
        _ => indices::decode_sequence(stream, layout),
    };
    decoded.map_err(|malformed| compressed.error(format!("does not decode: {malformed}")))
}

/// The next `count` bytes of a stream.
fn take<'a>(stream: &mut &'a [u8], count: usize) -> Result<&'a [u8], Malformed> {
    stream.split_off(..count).ok_or(SHORT)
}

#[cfg(test)]
pub(super) mod tests;
