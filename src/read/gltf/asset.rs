//! A document and its bytes: the binary chunk, embedded buffers, files next to the document.
//!
//! A buffer is loaded when something needs it, a file once however many buffers name it.
//!
//! Accessors may be shared: a small file can name one large accessor a thousand times over, or claim a count
//! with no data behind it; and compressed data may stand for far more than its own bytes. So that memory
//! stays linear in the input, every element that is decoded is charged against an allowance: one a byte of
//! file and buffers ([`PER_COMPRESSED_BYTE`] where data is compressed), and [`FREE_ELEMENTS`].

use std::cell::{Cell, OnceCell, RefCell};
use std::collections::HashMap;
use std::fs;
use std::io::{self, Read};
use std::path::{Path, PathBuf};
use std::rc::Rc;

use gltf::json::Value;

use super::document::{Document, Kind};
use super::extension;
use super::notes::Notes;
use super::object::Object;
use super::uri::{self, Uri};
use crate::read::ReadError;

/// How many elements any file may decode to: enough for small files that share accessors freely, and some
/// 50 MB as positions.
const FREE_ELEMENTS: usize = 1 << 22;

/// The bytes of a position, by which bytes are charged as elements.
const ELEMENT_BYTES: usize = 12;

/// How many elements a byte may stand for in a file with compressed data. Triangles of the best order take
/// one byte each, which is three indices of four bytes: four elements, with those that the decoded bytes are
/// charged as.
const PER_COMPRESSED_BYTE: usize = 16;

/// A document with its buffers.
pub(super) struct Asset<'a> {
    pub(super) document: &'a Document,
    pub(super) notes: &'a Notes,
    bin: Option<&'a [u8]>,
    folder: Option<&'a Path>,
    buffers: Vec<OnceCell<Data<'a>>>,
    /// Buffer views that were stored in compressed form.
    decoded: Vec<OnceCell<Result<Vec<u8>, ReadError>>>,
    /// Files next to the document by their full path.
    files: RefCell<HashMap<PathBuf, Rc<Vec<u8>>>>,
    /// How many elements may still be decoded.
    allowance: Cell<usize>,
    /// By how many a byte raises it.
    per_byte: usize,
}

enum Data<'a> {
    Chunk(&'a [u8]),
    Owned(Rc<Vec<u8>>),
}

impl<'a> Asset<'a> {
    pub(super) fn new(
        document: &'a Document,
        notes: &'a Notes,
        bin: Option<&'a [u8]>,
        folder: Option<&'a Path>,
        file_bytes: usize,
    ) -> Self {
        let compressed = extension::CODECS.iter().any(|codec| document.uses(codec));
        let per_byte = if compressed { PER_COMPRESSED_BYTE } else { 1 };
        Self {
            document,
            notes,
            bin,
            folder,
            buffers: document.list(Kind::Buffer).iter().map(|_| OnceCell::new()).collect(),
            decoded: document.list(Kind::BufferView).iter().map(|_| OnceCell::new()).collect(),
            files: RefCell::default(),
            allowance: Cell::new(FREE_ELEMENTS.saturating_add(file_bytes.saturating_mul(per_byte))),
            per_byte,
        }
    }

    /// Takes `count` elements from the allowance, on behalf of `object`.
    pub(super) fn charge(&self, count: usize, object: &Object) -> Result<(), ReadError> {
        let allowance = self.allowance.get();
        let left = allowance.checked_sub(count).ok_or_else(|| {
            let problem = format!(
                "asks for {count} elements, but only {allowance} more may be decoded from a file of this size"
            );
            object.error(problem).remedy("export every primitive with only the vertices that it uses")
        })?;
        self.allowance.set(left);
        Ok(())
    }

    /// The same for this many bytes.
    pub(super) fn charge_bytes(&self, bytes: usize, object: &Object) -> Result<(), ReadError> {
        self.charge(bytes.div_ceil(ELEMENT_BYTES), object)
    }

    /// The content of buffer view `index`, which `decode` makes of its compressed bytes, once.
    pub(super) fn decoded(
        &self,
        index: usize,
        decode: impl FnOnce() -> Result<Vec<u8>, ReadError>,
    ) -> Result<&[u8], ReadError> {
        self.decoded[index].get_or_init(decode).as_deref().map_err(ReadError::clone)
    }

    /// The bytes of a buffer, all that there are: fewer or more than its byteLength says.
    pub(super) fn buffer(&self, index: usize) -> Result<&[u8], ReadError> {
        let object = self.document.item(Kind::Buffer, index)?;
        let cell = &self.buffers[index];
        if cell.get().is_none() {
            // Not set yet, and nothing else can set it meanwhile.
            let _ = cell.set(self.load(index, &object)?);
        }
        Ok(match cell.get().expect("set above") {
            Data::Chunk(bytes) => bytes,
            Data::Owned(bytes) => bytes.as_slice(),
        })
    }

    fn load(&self, index: usize, object: &Object) -> Result<Data<'a>, ReadError> {
        let Some(text) = object.text("uri")? else {
            return match (index, self.bin) {
                (0, Some(bin)) => Ok(Data::Chunk(bin)),
                _ => Err(object.stored_elsewhere().unwrap_or_else(|| {
                    object
                        .error("has neither a uri nor a binary chunk")
                        .remedy("export the file again with its buffers")
                })),
            };
        };
        let bytes =
            match uri::parse(text).map_err(|refused| object.error(refused.problem).remedy(refused.remedy))? {
                Uri::Data(bytes) => self.own(bytes),
                Uri::Relative { decoded, as_written } => {
                    self.first_file(decoded.as_deref(), &as_written, object)?
                }
            };
        Ok(Data::Owned(bytes))
    }

    /// The file that the URI means, or else the first of those that its writer may have meant.
    fn first_file(
        &self,
        decoded: Option<&Path>,
        as_written: &[PathBuf],
        object: &Object,
    ) -> Result<Rc<Vec<u8>>, ReadError> {
        let meant = decoded.map(|path| self.file(path, object));
        if let Some(Ok(bytes)) = meant {
            return Ok(bytes);
        }
        let mut failed = meant.and_then(Result::err);
        for path in as_written {
            match self.file(path, object) {
                Ok(bytes) => {
                    let what = "name of a buffer that is not percent-encoded taken as it stands";
                    self.notes.because(what, &object.place, || uri::shown(&path.to_string_lossy()));
                    return Ok(bytes);
                }
                Err(error) => failed = failed.or(Some(error)),
            }
        }
        Err(failed.expect("a URI means one path at least"))
    }

    /// The content of a file in the folder of the document or below it.
    fn file(&self, path: &Path, object: &Object) -> Result<Rc<Vec<u8>>, ReadError> {
        let shown = uri::shown(&path.to_string_lossy());
        let folder = self.folder.ok_or_else(|| {
            object
                .error(format!("is the file {shown}, which cannot be reached when reading from memory"))
                .remedy("read the file from its folder, or export as GLB")
        })?;
        let failed = |error: io::Error| {
            let remedy = match error.kind() {
                io::ErrorKind::NotFound => "put the buffer into the folder of the file under this name",
                io::ErrorKind::PermissionDenied => "check the permissions of the buffer",
                _ => "check that the buffer can be read",
            };
            object.error(format!("the file {shown} cannot be read: {error}")).remedy(remedy)
        };
        let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
        let folder = folder.canonicalize().map_err(failed)?;
        // Canonical, so that a symbolic link cannot lead out of the folder.
        let path = folder.join(path).canonicalize().map_err(failed)?;
        if !path.starts_with(&folder) {
            let problem = format!("the file {shown} is a link that leaves the folder of the file");
            return Err(object.error(problem).remedy("put the buffer itself into the folder of the file"));
        }
        if let Some(bytes) = self.files.borrow().get(&path) {
            return Ok(Rc::clone(bytes));
        }
        // Checked before opening, which would block on a pipe.
        if !fs::metadata(&path).map_err(failed)?.is_file() {
            let problem = format!("{shown} is not a regular file");
            return Err(object.error(problem).remedy("name the file that holds the buffer"));
        }
        let mut bytes = Vec::new();
        fs::File::open(&path)
            .and_then(|file| file.take(self.longest_buffer()).read_to_end(&mut bytes))
            .map_err(failed)?;
        let bytes = self.own(bytes);
        self.files.borrow_mut().insert(path, Rc::clone(&bytes));
        Ok(bytes)
    }

    /// Bytes that were not there before: what they hold may be decoded too.
    fn own(&self, bytes: Vec<u8>) -> Rc<Vec<u8>> {
        let more = bytes.len().saturating_mul(self.per_byte);
        self.allowance.set(self.allowance.get().saturating_add(more));
        Rc::new(bytes)
    }

    /// The largest byteLength of all buffers, or where the last view ends: more of a file is never needed.
    fn longest_buffer(&self) -> u64 {
        let number = |value: &Value, key: &str| value.get(key).and_then(Value::as_u64).unwrap_or(0);
        let end = |value: &Value| number(value, "byteOffset").saturating_add(number(value, "byteLength"));
        let buffers = self.document.list(Kind::Buffer).iter();
        let views = self.document.list(Kind::BufferView).iter();
        let compressed = views.clone().filter_map(|view| view.get("extensions")?.as_object());
        let compressed = compressed.flat_map(|extensions| extensions.values());
        buffers.chain(views).chain(compressed).map(end).max().unwrap_or(0)
    }
}
