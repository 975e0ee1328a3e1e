//! A document and its bytes: the binary chunk, embedded buffers, files next to the document.
//!
//! A buffer is loaded when something needs it, a file once however many buffers name it.
//!
//! Accessors may be shared: a small file can name one large accessor a thousand times over, or claim a count
//! with no data behind it. So that memory stays linear in the input, every element that is decoded is charged
//! against an allowance of one per byte of file and buffers, plus [`FREE_ELEMENTS`].

use std::cell::{Cell, OnceCell, RefCell};
use std::collections::HashMap;
use std::fs;
use std::io::{self, Read};
use std::path::{Path, PathBuf};
use std::rc::Rc;

use super::document::{Document, Kind, Object};
use super::uri::{self, Uri};
use crate::read::ReadError;

/// How many elements any file may decode to: enough for small files that share accessors freely, and some
/// 50 MB as positions.
const FREE_ELEMENTS: usize = 1 << 22;

/// A document with its buffers.
pub(super) struct Asset<'a> {
    pub(super) document: &'a Document,
    bin: Option<&'a [u8]>,
    folder: Option<&'a Path>,
    buffers: Vec<OnceCell<Data<'a>>>,
    /// Files next to the document by their full path.
    files: RefCell<HashMap<PathBuf, Rc<Vec<u8>>>>,
    /// How many elements may still be decoded.
    allowance: Cell<usize>,
}

enum Data<'a> {
    Chunk(&'a [u8]),
    Owned(Rc<Vec<u8>>),
}

impl<'a> Asset<'a> {
    pub(super) fn new(
        document: &'a Document,
        bin: Option<&'a [u8]>,
        folder: Option<&'a Path>,
        file_bytes: usize,
    ) -> Self {
        Self {
            document,
            bin,
            folder,
            buffers: document.list(Kind::Buffer).iter().map(|_| OnceCell::new()).collect(),
            files: RefCell::default(),
            allowance: Cell::new(FREE_ELEMENTS.saturating_add(file_bytes)),
        }
    }

    /// Takes `count` elements from the allowance, on behalf of `object`.
    pub(super) fn charge(&self, count: usize, object: &Object) -> Result<(), ReadError> {
        let left = self.allowance.get().checked_sub(count).ok_or_else(|| {
            let problem = format!(
                "asks for {count} elements, which with those read before are more than one a byte of this file"
            );
            object.error(problem).remedy("export every primitive with only the vertices that it uses")
        })?;
        self.allowance.set(left);
        Ok(())
    }

    /// The bytes of a buffer: as many as its byteLength says.
    pub(super) fn buffer(&self, index: usize) -> Result<&[u8], ReadError> {
        let object = self.document.item(Kind::Buffer, index)?;
        let cell = &self.buffers[index];
        if cell.get().is_none() {
            // Not set yet, and nothing else can set it meanwhile.
            let _ = cell.set(self.load(index, &object)?);
        }
        let data = match cell.get().expect("set above") {
            Data::Chunk(bytes) => bytes,
            Data::Owned(bytes) => bytes.as_slice(),
        };
        let wanted = object.required("byteLength", object.whole("byteLength")?)?;
        data.get(..wanted).ok_or_else(|| {
            object
                .error(format!("is said to hold {wanted} bytes, but there are {}", data.len()))
                .remedy("the buffer may be cut off; copy or export it again")
        })
    }

    fn load(&self, index: usize, object: &Object) -> Result<Data<'a>, ReadError> {
        let Some(text) = object.text("uri")? else {
            return match (index, self.bin, object.compression()) {
                (0, Some(bin), _) => Ok(Data::Chunk(bin)),
                (.., Some(extension)) => Err(compressed(object, extension)),
                _ => Err(object.error("has neither a uri nor a binary chunk")),
            };
        };
        let bytes = match uri::parse(text).map_err(|problem| {
            object
                .error(problem)
                .remedy("put the buffer into the folder of the file and name it by a relative path")
        })? {
            Uri::Data(bytes) => self.own(bytes),
            Uri::Relative(path) => self.file(&path, object)?,
        };
        Ok(Data::Owned(bytes))
    }

    /// The content of a file in the folder of the document or below it.
    fn file(&self, path: &Path, object: &Object) -> Result<Rc<Vec<u8>>, ReadError> {
        let shown = path.display();
        let folder = self.folder.ok_or_else(|| {
            object
                .error(format!("is the file {shown}, which cannot be reached when reading from memory"))
                .remedy("read the file from its folder, or export as GLB")
        })?;
        let failed = |error: io::Error| {
            object
                .error(format!("the file {shown} cannot be read: {error}"))
                .remedy("put the buffer into the folder of the file")
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
            return Err(object.error(format!("{shown} is not a regular file")));
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
        self.allowance.set(self.allowance.get().saturating_add(bytes.len()));
        Rc::new(bytes)
    }

    /// The largest byteLength of all buffers: more of a file is never needed.
    fn longest_buffer(&self) -> u64 {
        let lengths =
            self.document.list(Kind::Buffer).iter().filter_map(|buffer| buffer.get("byteLength")?.as_u64());
        lengths.max().unwrap_or(0)
    }
}

/// The error for data that is only there in compressed form.
pub(super) fn compressed(object: &Object, extension: &str) -> ReadError {
    object
        .error(format!("is compressed with {extension}, which is not supported"))
        .remedy("export without mesh compression")
}
