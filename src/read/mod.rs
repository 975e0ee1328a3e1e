//! Files to scenes: one module per format, sniffed from the content, then from the extension.

mod error;
mod foreign;
mod gltf;
mod lost;
mod md2;
mod obj;
mod off;
mod packed;
mod ply;
mod polygon;
mod slips;
mod sniff;
mod stl;
mod text;
mod threemf;
mod words;

use std::fs::{self, File, Metadata};
use std::io::{self, BufRead, BufReader, Cursor, Read, Seek, SeekFrom};
use std::path::Path;

pub use error::{Place, ReadError};

pub(crate) use gltf::stored;
use packed::Packing;
use sniff::sniff;

use crate::mesh::MeshError;
pub use crate::scene::Format;
use crate::scene::Scene;

/// The input of a reader: buffered, seekable, of known length.
///
/// The length bounds what a header may claim: no count is believed that the remaining bytes could not hold.
pub(crate) struct Source<R> {
    pub(crate) reader: R,
    pub(crate) len: u64,
}

/// Reads a mesh file of any format this crate knows, which [`Format`] lists.
///
/// The format is detected from the content, and where that is ambiguous, from the extension. OBJ has no mark:
/// text that begins with an OBJ statement is taken for it unless the content or the extension shows another
/// format. A slip around plain geometry is read, and named in [`Scene::notes`].
///
/// Memory: no count of a file is believed beyond what its bytes can hold. At its peak reading takes less than
/// 4 times the file for an ordinary one and less than 40 times for any, and 1 MB; for glTF, whose JSON is a
/// tree in memory and whose data may be compressed, 250 times and 256 MB, since accessors may be shared.
///
/// # Errors
///
/// [`ReadError`] if the file cannot be opened or is not a well-formed file of its format. A defect of a
/// readable mesh is no error: that is for the crack report.
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
    // Checked before opening, which would block on a pipe; and again for the file that was opened.
    let regular = |metadata: &Metadata| {
        if metadata.is_file() {
            return Ok(());
        }
        let what = if metadata.is_dir() { "is a directory" } else { "is not a regular file" };
        Err(ReadError::new(None, Place::File, what).remedy("name a mesh file"))
    };
    regular(&fs::metadata(path).map_err(failed)?)?;
    let file = File::open(path).map_err(failed)?;
    let metadata = file.metadata().map_err(failed)?;
    regular(&metadata)?;
    let source = Source { reader: BufReader::with_capacity(1 << 18, file), len: metadata.len() };
    read_source(source, path, path.parent())
}

/// Reads a mesh from memory. `name` is used for its extension and in errors; files next to it cannot
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

/// The first bytes of a file, which is then at its beginning again.
fn head<R: BufRead + Seek>(source: &mut Source<R>) -> Result<Vec<u8>, ReadError> {
    let unreadable = |error: io::Error| ReadError::new(None, Place::File, format!("cannot be read: {error}"));
    let mut head = Vec::new();
    source.reader.by_ref().take(HEAD).read_to_end(&mut head).map_err(unreadable)?;
    source.reader.seek(SeekFrom::Start(0)).map_err(unreadable)?;
    if source.len == 0 {
        return Err(ReadError::new(None, Place::File, "the file is empty"));
    }
    Ok(head)
}

fn read_source<R: BufRead + Seek>(
    mut source: Source<R>,
    name: &Path,
    folder: Option<&Path>,
) -> Result<Scene, ReadError> {
    let head = head(&mut source)?;
    // The header of a binary STL may begin with any mark.
    if let Some(packing) = Packing::of(&head)
        && !stl::has_binary_length(&head, source.len)
    {
        return packed::read(packing, source, name, folder);
    }
    plain_with(&head, source, name, folder)
}

/// Reads a file that is not packed.
fn plain<R: BufRead + Seek>(
    mut source: Source<R>,
    name: &Path,
    folder: Option<&Path>,
) -> Result<Scene, ReadError> {
    let head = head(&mut source)?;
    plain_with(&head, source, name, folder)
}

/// The same, if its first bytes are `head`.
fn plain_with<R: BufRead + Seek>(
    head: &[u8],
    source: Source<R>,
    name: &Path,
    folder: Option<&Path>,
) -> Result<Scene, ReadError> {
    if let Some(encoding) = utf16(head) {
        let problem = format!("the text is encoded in {encoding}, but mesh files are in ASCII or UTF-8");
        return Err(ReadError::new(None, Place::File, problem).remedy("save it as UTF-8"));
    }
    let format = sniff(head, source.len, name)?;
    let mut scene = match format {
        Format::Obj => obj::read(source, folder),
        Format::Gltf | Format::Glb => gltf::read(source, format, folder),
        Format::Stl => stl::read(source),
        Format::Ply => ply::read(source),
        Format::Off => off::read(source),
        Format::Md2 => md2::read(source),
        Format::ThreeMf => {
            let problem = "a 3MF file is a ZIP archive, which this is not";
            Err(ReadError::new(format, Place::File, problem))
        }
    }?;
    (scene.format, scene.up) = (Some(format), format.up());
    if let Some(note) = scene.rounding_note() {
        scene.notes.push(note);
    }
    Ok(scene)
}

/// The error for a mesh that [`Mesh::new`](crate::mesh::Mesh::new) refuses for its size.
fn refused(format: Format, error: &MeshError) -> ReadError {
    ReadError::new(format, Place::File, error.to_string()).remedy("split the file")
}

/// The error for items that the file holds, but that do not fit the memory.
fn unheld(format: Format, count: u64, noun: &str) -> ReadError {
    let problem = format!("{} do not fit the memory", text::counted(count, noun));
    ReadError::new(format, Place::File, problem).remedy("free some memory, or split the file")
}

/// Bytes of a file that its format is detected from: enough for the comments that exporters begin with.
const HEAD: u64 = 4096;

/// The encoding of a text of 16-bit units, by its byte order mark or by its zeros.
fn utf16(head: &[u8]) -> Option<&'static str> {
    // ASCII in 16 bits: every second byte is 0, the others are none. No binary format begins so.
    let ascii = |first: usize| {
        head.len() >= 16
            && (0..16).all(|at| (head[at] == 0) == (at % 2 != first))
            && head[..16].iter().all(u8::is_ascii)
    };
    match head {
        [0xff, 0xfe, ..] => Some("UTF-16"),
        [0xfe, 0xff, ..] => Some("UTF-16"),
        _ if ascii(0) || ascii(1) => Some("UTF-16"),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::shapes;
    use crate::write::{Layer, Model, Target, to_bytes};

    /// A file of each format.
    fn files() -> Vec<(&'static str, Vec<u8>)> {
        let model = Model { layers: vec![Layer::from(&shapes::icosphere(1))] };
        let bytes = |target| to_bytes(&model, target).unwrap();
        let mut stl = vec![0; 80];
        stl.extend(3_u32.to_le_bytes());
        stl.resize(84 + 3 * 50, 0);
        let mut md2 = b"IDP2\x08\0\0\0".to_vec();
        md2.resize(200, 0);
        for (field, value) in [(4, 52_u32), (6, 3), (8, 1), (10, 1), (13, 68), (14, 80), (16, 132)] {
            md2[4 * field..][..4].copy_from_slice(&value.to_le_bytes());
        }
        let text = b"solid a\nfacet normal 0 0 0\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid\n";
        vec![
            ("a.obj", bytes(Target::Obj)),
            ("a.ply", bytes(Target::Ply)),
            ("a.glb", bytes(Target::Glb)),
            ("b.stl", stl),
            ("t.stl", text.to_vec()),
            ("a.off", b"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n".to_vec()),
            ("a.md2", md2),
        ]
    }

    #[test]
    fn read_of_a_file_that_changes_its_length_meanwhile_is_an_answer_or_one_line() {
        for (name, bytes) in files() {
            let read = |bytes: &[u8], len: usize| {
                let source = Source { reader: Cursor::new(bytes), len: len as u64 };
                read_source(source, Path::new(name), None).map_err(|error| error.in_file(name).to_string())
            };
            read(&bytes, bytes.len()).unwrap_or_else(|error| panic!("{error}"));
            for there in (0..bytes.len()).step_by(1 + bytes.len() / 97) {
                // It has shrunk since its length was asked, or grown.
                for result in [read(&bytes[..there], bytes.len()), read(&bytes, there)] {
                    if let Err(line) = result {
                        assert!(line.lines().count() == 1 && line.contains("; "), "{name}: {line}");
                    }
                }
            }
        }
    }
}
