//! The binary container: a header of 12 bytes, then chunks, each a length, a type and that many bytes.

use crate::read::{Place, ReadError};

const HEADER_BYTES: usize = 12;
const CHUNK_HEADER_BYTES: usize = 8;

/// The JSON chunk and the binary chunk of a GLB. Chunks of other types are passed over, as the specification
/// asks, and so are bytes behind the length that the header states.
pub(super) fn split(file: &[u8]) -> Result<(&[u8], Option<&[u8]>), ReadError> {
    let truncated = |byte: usize, what: &str, wanted: usize| {
        let problem = format!(
            "{what} needs {wanted} bytes from here, but {} are left",
            file.len().saturating_sub(byte)
        );
        error(byte, problem).remedy("the file may be cut off; copy or export it again")
    };
    if file.len() < HEADER_BYTES {
        return Err(truncated(0, "the header", HEADER_BYTES));
    }
    if !file.starts_with(b"glTF") {
        return Err(error(0, "does not begin with `glTF`").remedy("name a GLB file"));
    }
    let version = u32_at(file, 4);
    if version != 2 {
        return Err(error(4, format!("is container version {version}, but only version 2 can be read"))
            .remedy("export as glTF 2.0"));
    }
    let length = u32_at(file, 8) as usize;
    if length > file.len() {
        return Err(truncated(0, "the file", length));
    }
    let (mut json, mut bin) = (None, None);
    let mut at = HEADER_BYTES;
    while at < length {
        if length - at < CHUNK_HEADER_BYTES {
            return Err(truncated(at, "a chunk header", CHUNK_HEADER_BYTES));
        }
        let (size, kind) = (u32_at(file, at) as usize, &file[at + 4..at + 8]);
        let start = at + CHUNK_HEADER_BYTES;
        if length - start < size {
            return Err(truncated(start, "a chunk", size));
        }
        let chunk = &file[start..start + size];
        match kind {
            b"JSON" if json.is_none() => json = Some(chunk),
            _ if json.is_none() => return Err(error(at, "the first chunk is not JSON")),
            b"BIN\0" if bin.is_none() => bin = Some(chunk),
            _ => {}
        }
        at = start + size;
    }
    let json = json.ok_or_else(|| error(HEADER_BYTES, "holds no JSON chunk"))?;
    Ok((json, bin))
}

fn error(byte: usize, problem: impl Into<String>) -> ReadError {
    ReadError::new(None, Place::Byte(byte as u64), problem)
}

/// The little-endian number at `at`; the caller has checked that four bytes are there.
fn u32_at(bytes: &[u8], at: usize) -> u32 {
    u32::from_le_bytes(bytes[at..at + 4].try_into().expect("four bytes"))
}
