//! The binary container: a header of 12 bytes, then chunks, each a length, a type and that many bytes.

use super::notes::Notes;
use crate::read::{Place, ReadError};

const HEADER_BYTES: usize = 12;
const CHUNK_HEADER_BYTES: usize = 8;

/// The JSON chunk and the binary chunk of a GLB. Chunks of other types are passed over, as the specification
/// asks.
///
/// The chunks are believed before the header: what the header says of the length may fall short, and so may
/// the last chunk, with a note. Views that are not there are found where they are read.
pub(super) fn split<'a>(file: &'a [u8], notes: &Notes) -> Result<(&'a [u8], Option<&'a [u8]>), ReadError> {
    let truncated = |byte: usize, what: &str, wanted: usize| {
        let left = file.len().saturating_sub(byte);
        error(byte, format!("{what} needs {wanted} bytes from here, but {left} are left"))
            .remedy("the file may be cut off; copy or export it again")
    };
    if file.len() < HEADER_BYTES {
        return Err(truncated(0, "the header", HEADER_BYTES));
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
    // A header that states too little hides neither chunk.
    while at < length || json.is_none() || bin.is_none() && is_bin(file, at) {
        if file.len() - at < CHUNK_HEADER_BYTES {
            if json.is_some() {
                break;
            }
            return Err(truncated(at, "a chunk header", CHUNK_HEADER_BYTES));
        }
        let (size, kind) = (u32_at(file, at) as usize, &file[at + 4..at + 8]);
        let start = at + CHUNK_HEADER_BYTES;
        let left = file.len() - start;
        if size > left {
            match kind {
                _ if json.is_none() => return Err(truncated(start, "a chunk", size)),
                b"BIN\0" => {}
                _ => break,
            }
            let why = || format!("it says {size} bytes, but {left} are left");
            notes.because("binary chunk read to the end of the file", "container", why);
        }
        let chunk = &file[start..][..size.min(left)];
        match kind {
            b"JSON" if json.is_none() => json = Some(chunk),
            _ if json.is_none() => {
                return Err(error(at, "the first chunk is not JSON").remedy("export the file again as GLB"));
            }
            b"BIN\0" if bin.is_none() => bin = Some(chunk),
            _ => {}
        }
        at = start + chunk.len();
    }
    if at > length {
        let why = || format!("it says {length} bytes, but the chunks end at byte {at}");
        notes.because("chunks read beyond the length in the header", "container", why);
    }
    if at < file.len() {
        let why = || format!("{} from byte {at}", file.len() - at);
        notes.because("bytes behind the last chunk passed over", "container", why);
    }
    Ok((json.expect("the loop ends behind the JSON chunk"), bin))
}

/// Whether a binary chunk begins at `at`.
fn is_bin(file: &[u8], at: usize) -> bool {
    file.get(at + 4..at + CHUNK_HEADER_BYTES) == Some(b"BIN\0")
}

fn error(byte: usize, problem: impl Into<String>) -> ReadError {
    ReadError::new(None, Place::Byte(byte as u64), problem)
}

/// The little-endian number at `at`; the caller has checked that four bytes are there.
fn u32_at(bytes: &[u8], at: usize) -> u32 {
    u32::from_le_bytes(bytes[at..at + 4].try_into().expect("four bytes"))
}
