//! Stereolithography (STL), text and binary: a triangle soup, three vertices per face, in file order.
//!
//! The readers are our own: `stl_io` reports neither line nor byte of an error, takes a binary header's count
//! for granted, and stops after the first of several solids. Normals and attributes are skipped.

mod binary;
mod text;

use std::io::{BufRead, Read, Seek, SeekFrom};

use super::text::unreadable;
use super::{Format, Place, ReadError, Source, refused};
use crate::mesh::Mesh;
use crate::scene::Scene;

pub(super) fn read<R: BufRead + Seek>(mut source: Source<R>) -> Result<Scene, ReadError> {
    let io_error = |error| unreadable(Format::Stl, Place::File, &error);
    let mut head = Vec::new();
    source.reader.by_ref().take(binary::HEADER).read_to_end(&mut head).map_err(io_error)?;
    if !has_binary_length(&head, source.len) && begins_as_text(&head) {
        source.reader.seek(SeekFrom::Start(0)).map_err(io_error)?;
        return text::read(source.reader);
    }
    binary::read(source, count(&head))
}

/// The number of triangles in the header of a binary file; `None` if the file ends before it.
fn count(head: &[u8]) -> Option<u32> {
    head.get(80..).and_then(|count| count.first_chunk()).map(|&count| u32::from_le_bytes(count))
}

/// Whether the length of a file that begins with `head` is that of a binary STL with its number of triangles.
pub(super) fn has_binary_length(head: &[u8], len: u64) -> bool {
    count(head).is_some_and(|count| len == binary::HEADER + binary::RECORD * u64::from(count))
}

/// Whether the first bytes are those of a text file that holds something.
///
/// Binary files may begin with "solid" too. But text has no zero byte before its end, and every count below
/// 2²⁴ has one; a larger one is recognized by the file's length.
fn begins_as_text(head: &[u8]) -> bool {
    let head = head.strip_prefix(b"\xef\xbb\xbf").unwrap_or(head);
    let end = head.iter().position(|&byte| byte == 0).unwrap_or(head.len());
    let whole = end == head.len();
    let text = head[..end].trim_ascii_start().to_ascii_lowercase();
    let ends = || text.windows(8).any(|word| word == b"endsolid" || word == b"end soli");
    (text.starts_with(b"solid") || text.starts_with(b"facet")) && (whole || ends())
}

/// The triangle list of a soup.
fn soup(positions: Vec<[f32; 3]>) -> Result<Mesh, ReadError> {
    // A count that does not fit 32 bits is refused by `Mesh::new`.
    let triangles = (0..positions.len() / 3).map(|face| [0, 1, 2].map(|corner| (3 * face + corner) as u32));
    let triangles = triangles.collect();
    Mesh::new(positions, triangles).map_err(|error| refused(Format::Stl, &error))
}
