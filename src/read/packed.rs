//! Files inside of files: gzip and ZIP, told by their first bytes. Also names what cannot be read at all.

use std::io::{BufRead, Cursor, ErrorKind, Read, Seek};
use std::path::{Path, PathBuf};

use flate2::bufread::MultiGzDecoder;
use zip::ZipArchive;
use zip::result::ZipError;

use super::{Format, Place, ReadError, Source, plain, threemf};
use crate::scene::Scene;

/// What the first bytes of a file show, if it is not a mesh file itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Packing {
    /// One compressed file.
    Gzip,
    /// An archive of files: of 3MF, or of others.
    Zip,
    /// What is not read: its name.
    Unread(&'static str),
}

impl Packing {
    pub(super) fn of(head: &[u8]) -> Option<Self> {
        let unread: [(&[u8], &str); 5] = [
            (b"BZh", "a bzip2 archive"),
            (b"\xfd7zXZ\0", "an xz archive"),
            (b"\x28\xb5\x2f\xfd", "a Zstandard archive"),
            (b"7z\xbc\xaf\x27\x1c", "a 7-Zip archive"),
            (b"Rar!\x1a\x07", "a RAR archive"),
        ];
        match head {
            [0x1f, 0x8b, 8, ..] => Some(Self::Gzip),
            [b'P', b'K', 3, 4, ..] | [b'P', b'K', 5, 6, ..] => Some(Self::Zip),
            _ if head.get(257..262) == Some(b"ustar") => Some(Self::Unread("a tar archive")),
            _ => unread
                .into_iter()
                .find(|(mark, _)| head.starts_with(mark))
                .map(|(_, name)| Self::Unread(name)),
        }
    }
}

/// Bytes that a packed file may unpack to: 256 times its own, and 16 MiB. Meshes as text are packed to a
/// fifth or a twentieth; what is packed tighter is made to fill the memory.
fn most_unpacked(packed: u64) -> u64 {
    packed.saturating_mul(256).saturating_add(1 << 24)
}

/// Reads a packed file.
pub(super) fn read<R: BufRead + Seek>(
    packing: Packing,
    source: Source<R>,
    name: &Path,
    folder: Option<&Path>,
) -> Result<Scene, ReadError> {
    match packing {
        Packing::Gzip => {
            let most = most_unpacked(source.len);
            let bytes = unpacked(MultiGzDecoder::new(source.reader), most, "the gzip file")?;
            plain(Source { len: bytes.len() as u64, reader: Cursor::new(bytes) }, &inner_name(name), folder)
        }
        Packing::Zip => archive(source),
        Packing::Unread(what) => {
            let problem = format!("this is {what}");
            Err(ReadError::new(None, Place::File, problem).remedy("unpack it, and name the mesh file in it"))
        }
    }
}

/// All bytes of `reader`, if they are no more than `most`.
fn unpacked(reader: impl Read, most: u64, what: &str) -> Result<Vec<u8>, ReadError> {
    let mut bytes = Vec::new();
    reader.take(most + 1).read_to_end(&mut bytes).map_err(|error| {
        let problem = match error.kind() {
            ErrorKind::OutOfMemory => format!("{what} does not fit the memory once unpacked"),
            _ => format!("{what} cannot be unpacked: {error}"),
        };
        ReadError::new(None, Place::File, problem)
    })?;
    if bytes.len() as u64 > most {
        return Err(too_much(what));
    }
    Ok(bytes)
}

pub(super) fn too_much(what: &str) -> ReadError {
    let problem = format!("{what} unpacks to more than 256 times its size");
    ReadError::new(None, Place::File, problem).remedy("unpack it, and name the mesh file in it")
}

/// A ZIP archive: a 3MF package, or one mesh file.
fn archive<R: BufRead + Seek>(source: Source<R>) -> Result<Scene, ReadError> {
    let most = most_unpacked(source.len);
    let mut archive = ZipArchive::new(source.reader).map_err(|error| unzipped(&error))?;
    let names: Vec<String> = archive.file_names().filter_map(|name| Some(name.ok()?.into_owned())).collect();
    if let Some(root) = threemf::root(&names) {
        let root = root.to_owned();
        return threemf::read(&mut archive, &root, most);
    }
    let is_mesh = |name: &&String| {
        let own = !name.starts_with("__MACOSX/"); // copies of the folder's attributes
        own && Format::from_extension(Path::new(name)).is_some()
    };
    let meshes: Vec<&String> = names.iter().filter(is_mesh).collect();
    let refused = |problem: String| {
        ReadError::new(None, Place::File, problem).remedy("unpack it, and name a mesh file in it")
    };
    match meshes[..] {
        [only] => {
            let bytes = member(&mut archive, only, most)?;
            let source = Source { len: bytes.len() as u64, reader: Cursor::new(bytes) };
            let mut scene = plain(source, Path::new(only), None).map_err(|error| {
                let problem = format!("in `{only}` of the archive: {}", error.problem);
                ReadError { problem, ..error }
            })?;
            scene.notes.push(format!("`{only}` of the archive is read"));
            Ok(scene)
        }
        [] => Err(refused("a ZIP archive without a mesh file".to_owned())),
        [first, ..] => {
            Err(refused(format!("a ZIP archive of {} mesh files, the first `{first}`", meshes.len())))
        }
    }
}

/// The bytes of one member.
pub(super) fn member<R: Read + Seek>(
    archive: &mut ZipArchive<R>,
    name: &str,
    most: u64,
) -> Result<Vec<u8>, ReadError> {
    let file = archive.by_name(name).map_err(|error| unzipped(&error))?;
    unpacked(file, most, &format!("`{name}` of the archive"))
}

pub(super) fn unzipped(error: &ZipError) -> ReadError {
    let problem = format!("the ZIP archive cannot be read: {error}");
    ReadError::new(None, Place::File, problem).remedy("pack it again")
}

/// The file's name without what only says that it is packed: `ball.obj.gz` holds `ball.obj`.
fn inner_name(path: &Path) -> PathBuf {
    match path.extension() {
        Some(extension) if extension.eq_ignore_ascii_case("gz") => path.with_extension(""),
        _ => path.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use std::io::Write;

    use flate2::Compression;
    use flate2::write::GzEncoder;
    use zip::ZipWriter;
    use zip::write::SimpleFileOptions;

    use crate::read::read_bytes;
    use crate::testing::shapes;
    use crate::write::{Layer, Model, Target, to_bytes};

    fn mesh_file(target: Target) -> Vec<u8> {
        to_bytes(&Model { layers: vec![Layer::from(&shapes::icosphere(2))] }, target).unwrap()
    }

    fn gzip(bytes: &[u8]) -> Vec<u8> {
        let mut encoder = GzEncoder::new(Vec::new(), Compression::default());
        encoder.write_all(bytes).unwrap();
        encoder.finish().unwrap()
    }

    fn archive(files: &[(&str, &[u8])]) -> Vec<u8> {
        let mut writer = ZipWriter::new(std::io::Cursor::new(Vec::new()));
        for (name, bytes) in files {
            writer.start_file(*name, SimpleFileOptions::default()).unwrap();
            writer.write_all(bytes).unwrap();
        }
        writer.finish().unwrap().into_inner()
    }

    #[test]
    fn packed_mesh_is_the_mesh_that_was_packed() {
        for (target, name) in [(Target::Obj, "a.obj"), (Target::Ply, "a.ply"), (Target::Glb, "a.glb")] {
            let plain = mesh_file(target);
            let wanted = read_bytes(&plain, name).unwrap();
            // By its content alone, whatever the name says.
            for packed_name in [format!("{name}.gz"), name.to_owned(), "x.stl".to_owned()] {
                let found = read_bytes(&gzip(&plain), packed_name).unwrap();
                assert_eq!(found.meshes[0].positions(), wanted.meshes[0].positions());
                assert_eq!(found.format, wanted.format);
            }
            let mac = ("__MACOSX/._a.obj", &b"\0\x05"[..]);
            let found =
                read_bytes(&archive(&[(name, &plain), ("readme.txt", b"hello"), mac]), "a.zip").unwrap();
            assert_eq!(found.meshes[0].triangles(), wanted.meshes[0].triangles());
            assert!(found.notes.iter().any(|note| note == &format!("`{name}` of the archive is read")));
        }
    }

    #[test]
    fn packed_file_that_is_no_mesh_is_named_as_what_it_is() {
        let obj = mesh_file(Target::Obj);
        let bomb = vec![b' '; 40 << 20];
        let utf16 =
            |text: &str, bytes: fn(u16) -> [u8; 2]| text.encode_utf16().flat_map(bytes).collect::<Vec<_>>();
        let text = "# made by hand\nv 0 0 0\n";
        for (bytes, problem) in [
            (archive(&[("a.txt", b"hello")]), "a ZIP archive without a mesh file"),
            (
                archive(&[("b.obj", &obj), ("a/c.obj", &obj)]),
                "a ZIP archive of 2 mesh files, the first `b.obj`",
            ),
            (
                archive(&[("a.obj", b"v 0 0 x\n")]),
                "line 1 (obj): in `a.obj` of the archive: `x` is not a number",
            ),
            (archive(&[("bomb.obj", &bomb)]), "unpacks to more than 256 times its size"),
            (gzip(&bomb), "unpacks to more than 256 times its size"),
            (gzip(&gzip(&obj)), "neither the content nor the extension tells the format"),
            (gzip(&obj)[..100].to_vec(), "the gzip file cannot be unpacked"),
            (b"PK\x03\x04 and so on".to_vec(), "the ZIP archive cannot be read"),
            (b"\xfd7zXZ\0....".to_vec(), "this is an xz archive; unpack it"),
            (b"7z\xbc\xaf\x27\x1c....".to_vec(), "this is a 7-Zip archive"),
            (utf16(text, u16::to_le_bytes), "the text is encoded in UTF-16"),
            (utf16(text, u16::to_be_bytes), "the text is encoded in UTF-16"),
            (utf16(&format!("\u{feff}{text}"), u16::to_le_bytes), "the text is encoded in UTF-16"),
        ] {
            let line = read_bytes(&bytes, "a").unwrap_err().to_string();
            assert!(line.contains(problem), "{line}");
        }
    }

    #[test]
    fn packed_mark_at_the_beginning_of_a_binary_stl_means_nothing() {
        for mark in [&b"\x1f\x8b\x08"[..], b"PK\x03\x04", b"BZh", b"Rar!\x1a\x07"] {
            let mut stl = vec![0; 84 + 2 * 50];
            stl[..mark.len()].copy_from_slice(mark);
            stl[80] = 2;
            assert_eq!(read_bytes(&stl, "a.stl").unwrap().meshes[0].face_count(), 2);
            stl.pop(); // then the length says nothing
            assert!(read_bytes(&stl, "a.stl").is_err());
        }
    }

    #[test]
    fn packed_text_may_be_well_packed_but_not_without_bound() {
        // A plain file of blanks is an OBJ without vertices; packed it is as small as a bomb below 16 MiB.
        let text = [&b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"[..], &vec![b'\n'; 15 << 20]].concat();
        assert_eq!(read_bytes(&gzip(&text), "a.obj.gz").unwrap().meshes[0].face_count(), 1);
    }
}
