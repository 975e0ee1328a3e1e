//! Files to scenes: one format a file, sniffed from the content, then from the extension.

mod error;
mod fan;
mod gltf;
mod md2;
mod obj;
mod ply;
mod stl;
mod text;

use std::fmt;
use std::fs::File;
use std::io::{self, BufRead, BufReader, Cursor, Read, Seek, SeekFrom};
use std::path::Path;

pub use error::{Place, ReadError};

use crate::mesh::MeshError;
use crate::scene::Scene;

/// A file format that can be read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Format {
    /// Wavefront OBJ.
    Obj,
    /// glTF 2.0, JSON with external or embedded buffers.
    Gltf,
    /// glTF 2.0, binary container.
    Glb,
    /// Stereolithography, text or binary.
    Stl,
    /// Polygon file format, text or binary.
    Ply,
    /// Quake II model.
    Md2,
}

impl Format {
    /// Lower-case name, as in reports and as a file extension.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Obj => "obj",
            Self::Gltf => "gltf",
            Self::Glb => "glb",
            Self::Stl => "stl",
            Self::Ply => "ply",
            Self::Md2 => "md2",
        }
    }

    /// The format that a file name's extension stands for.
    #[must_use]
    pub fn from_extension(path: &Path) -> Option<Self> {
        let extension = path.extension()?.to_str()?.to_ascii_lowercase();
        [Self::Obj, Self::Gltf, Self::Glb, Self::Stl, Self::Ply, Self::Md2]
            .into_iter()
            .find(|format| format.name() == extension)
    }
}

impl fmt::Display for Format {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// What a reader reads from: buffered, seekable, of known length.
///
/// The length bounds what a header may claim: no count is believed that the remaining bytes could not hold.
pub(crate) struct Source<R> {
    pub(crate) reader: R,
    pub(crate) len: u64,
}

/// Reads a mesh file of any format this crate knows.
///
/// The format is told from the content, and where that leaves it open (OBJ has no mark), from the extension.
///
/// # Errors
///
/// [`ReadError`] if the file cannot be opened or is not a well-formed file of its format. A defect of a
/// readable mesh is no error: the crack report tells of it.
pub fn read(path: impl AsRef<Path>) -> Result<Scene, ReadError> {
    let path = path.as_ref();
    read_file(path).map_err(|error| error.in_file(path))
}

fn read_file(path: &Path) -> Result<Scene, ReadError> {
    let failed = |error: io::Error| {
        let remedy = match error.kind() {
            io::ErrorKind::NotFound => "check the path",
            io::ErrorKind::PermissionDenied => "check the permissions",
            _ => "check that the file can be read",
        };
        ReadError::new(None, Place::File, format!("cannot be opened: {error}")).remedy(remedy)
    };
    let file = File::open(path).map_err(failed)?;
    let metadata = file.metadata().map_err(failed)?;
    if !metadata.is_file() {
        let what = if metadata.is_dir() { "is a directory" } else { "is not a regular file" };
        return Err(ReadError::new(None, Place::File, what).remedy("name a mesh file"));
    }
    let source = Source { reader: BufReader::with_capacity(1 << 18, file), len: metadata.len() };
    read_source(source, path, path.parent())
}

/// Reads a mesh from memory. `name` is used for its extension and in errors; buffers beside the file cannot
/// be reached, so a glTF must carry its own.
///
/// # Errors
///
/// As [`read`].
pub fn read_bytes(bytes: &[u8], name: impl AsRef<Path>) -> Result<Scene, ReadError> {
    let name = name.as_ref();
    let source = Source { reader: Cursor::new(bytes), len: bytes.len() as u64 };
    read_source(source, name, None).map_err(|error| error.in_file(name))
}

fn read_source<R: BufRead + Seek>(
    mut source: Source<R>,
    name: &Path,
    folder: Option<&Path>,
) -> Result<Scene, ReadError> {
    let unreadable = |error: io::Error| ReadError::new(None, Place::File, format!("cannot be read: {error}"));
    let mut head = Vec::new();
    source.reader.by_ref().take(512).read_to_end(&mut head).map_err(unreadable)?;
    source.reader.seek(SeekFrom::Start(0)).map_err(unreadable)?;
    if source.len == 0 {
        return Err(ReadError::new(None, Place::File, "the file is empty"));
    }
    let format = sniff(&head, source.len, name).ok_or_else(|| {
        ReadError::new(None, Place::File, "neither the content nor the extension tells the format")
            .remedy("name a file in obj, gltf, glb, stl, ply or md2 format")
    })?;
    let mut scene = match format {
        Format::Obj => obj::read(source),
        Format::Gltf | Format::Glb => gltf::read(source, format, folder),
        Format::Stl => stl::read(source),
        Format::Ply => ply::read(source),
        Format::Md2 => md2::read(source),
    }?;
    scene.format = Some(format);
    Ok(scene)
}

/// What [`Mesh::new`](crate::mesh::Mesh::new) refuses although the reader let it pass: a mesh too large.
fn refused(format: Format, error: &MeshError) -> ReadError {
    ReadError::new(format, Place::File, error.to_string()).remedy("split the file")
}

/// The format that the first bytes of a file show, or else its extension.
fn sniff(head: &[u8], len: u64, name: &Path) -> Option<Format> {
    let text = head.strip_prefix(b"\xef\xbb\xbf").unwrap_or(head).trim_ascii_start();
    // A binary STL may begin with "solid" too; its length is the stronger sign: 80 + 4 + 50 bytes a triangle.
    let binary_stl = head.get(80..84).is_some_and(|count| {
        len == 84 + 50 * u64::from(u32::from_le_bytes(count.try_into().expect("four bytes")))
    });
    match text {
        _ if head.starts_with(b"glTF") => Some(Format::Glb),
        _ if head.starts_with(b"IDP2") => Some(Format::Md2),
        _ if head.starts_with(b"ply\n") || head.starts_with(b"ply\r") => Some(Format::Ply),
        _ if binary_stl => Some(Format::Stl),
        _ if text.starts_with(b"{") => Some(Format::Gltf),
        _ if text.get(..5).is_some_and(|word| word.eq_ignore_ascii_case(b"solid")) => Some(Format::Stl),
        _ => Format::from_extension(name),
    }
}
