//! Material libraries of OBJ files: `mtllib` names files in its folder.
//!
//! The parser is that of `tobj`. A library that is missing or malformed is noted: it changes no geometry.

use std::fs::{self, File};
use std::io::Read;
use std::path::{Component, Path, PathBuf};

use crate::read::text;
use crate::scene::{AlphaMode, Material};

/// Bytes of all libraries of a file together; a thousand materials take about 200 kB.
const MOST_BYTES: u64 = 1 << 24;

/// Libraries that are read of one file.
const MOST_LIBRARIES: usize = 64;

/// What the libraries of a file define.
#[derive(Default)]
pub(super) struct Libraries {
    /// Without those that no library defines; in the order of the files.
    pub(super) materials: Vec<Material>,
    pub(super) notes: Vec<String>,
    /// Lines that were followed already.
    seen: Vec<String>,
    /// Bytes that were read.
    bytes: u64,
}

impl Libraries {
    /// Reads what a line with `mtllib` names: a file, whose name may hold blanks, or several.
    pub(super) fn add(&mut self, line: &str, folder: Option<&Path>) {
        if self.seen.iter().any(|seen| seen == line) || self.seen.len() == MOST_LIBRARIES {
            return;
        }
        self.seen.push(line.to_owned());
        let whole = read(line, folder, MOST_BYTES - self.bytes);
        let names: Vec<&str> = match &whole {
            Err(_) if line.contains(char::is_whitespace) => line.split_whitespace().collect(),
            _ => vec![line],
        };
        for name in names {
            let quoted = text::quote(name.as_bytes());
            match read(name, folder, MOST_BYTES - self.bytes) {
                Ok(bytes) => {
                    self.bytes += bytes.len() as u64;
                    self.parse(&String::from_utf8_lossy(&bytes), &quoted);
                }
                Err(problem) => self.notes.push(format!(
                    "material library {quoted} not read: {problem}; put it into the folder of the file for colors"
                )),
            }
        }
    }

    /// Each material for itself, so that an error leaves out one of them.
    fn parse(&mut self, library: &str, quoted: &str) {
        let starts = |line: &str| line.split_whitespace().next() == Some("newmtl");
        let mut blocks: Vec<String> = Vec::new();
        for line in library.lines() {
            if starts(line) {
                blocks.push(String::new());
            }
            if let Some(block) = blocks.last_mut() {
                block.push_str(line);
                block.push('\n');
            }
        }
        for block in blocks {
            match parsed(&block) {
                Ok(materials) => self.materials.extend(materials.into_iter().map(material)),
                Err(problem) => {
                    let first = block.lines().next().unwrap_or_default().trim();
                    let name = text::quote(first.strip_prefix("newmtl").unwrap_or(first).trim().as_bytes());
                    self.notes.push(format!("material {name} of {quoted} not read: {problem}"));
                }
            }
        }
    }
}

/// The materials of a block. A color with fewer than three numbers is refused here: the parser panics at it.
fn parsed(block: &str) -> Result<Vec<tobj::Material>, String> {
    for line in block.lines() {
        let mut words = line.split_whitespace();
        if let Some(color @ ("Ka" | "Kd" | "Ks" | "Ke")) = words.next()
            && words.count() < 3
        {
            return Err(format!("{color} needs three numbers"));
        }
    }
    let (materials, _) = tobj::load_mtl_buf(&mut block.as_bytes()).map_err(|error| error.to_string())?;
    Ok(materials)
}

/// The bytes of a file in `folder` or below it.
fn read(name: &str, folder: Option<&Path>, most: u64) -> Result<Vec<u8>, String> {
    let folder = folder.ok_or("it cannot be reached when reading from memory")?;
    let path = PathBuf::from(name.replace('\\', "/"));
    if path.as_os_str().is_empty()
        || !path.components().all(|part| matches!(part, Component::Normal(_) | Component::CurDir))
    {
        return Err("its path leaves the folder of the file".to_owned());
    }
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let path = folder.join(path);
    // Checked before opening, which would block on a pipe.
    let metadata = fs::metadata(&path).map_err(|error| error.to_string())?;
    if !metadata.is_file() {
        return Err("it is not a regular file".to_owned());
    }
    if metadata.len() > most {
        return Err(format!("it takes more than {MOST_BYTES} bytes, with those read before"));
    }
    let mut bytes = Vec::new();
    let read = File::open(&path).and_then(|file| file.take(most).read_to_end(&mut bytes));
    read.map(|_| bytes).map_err(|error| error.to_string())
}

/// What is kept of a material: its diffuse color, and its dissolve factor, or transparency, as alpha.
fn material(read: tobj::Material) -> Material {
    let part = |x: f32| if x.is_finite() { x.clamp(0.0, 1.0) } else { 1.0 };
    let transparency = || read.unknown_param.get("Tr")?.split_whitespace().next()?.parse().ok();
    let alpha = read.dissolve.or_else(|| transparency().map(|tr: f32| 1.0 - tr)).map_or(1.0, part);
    let textured = read.dissolve_texture.is_some();
    Material {
        name: text::name(read.name.as_bytes()),
        base_color: read.diffuse.map(|color| color.map(part)),
        alpha,
        alpha_mode: if alpha < 1.0 || textured { AlphaMode::Blend } else { AlphaMode::Opaque },
        textured,
        ..Material::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn libraries_give_colors_and_alpha_and_note_what_they_cannot() {
        let folder = tempfile::tempdir().unwrap();
        let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
        write("a b.mtl", "newmtl red one\nKd 1 0 0\nnewmtl clear\nd 0\nmap_d a.png\n");
        write("c.mtl", "Kd 9 9 9\nnewmtl half\nTr 0.5\nnewmtl odd\nKd 2 nan -1\nnewmtl bad\nKd 1\nnewmtl\n");
        let mut libraries = Libraries::default();
        for line in ["a b.mtl", "c.mtl d.mtl", "c.mtl d.mtl", "/etc/passwd", "..\\x.mtl", ""] {
            libraries.add(line, Some(folder.path()));
        }
        let found: Vec<_> = (libraries.materials.iter())
            .map(|material| (material.name.as_str(), material.base_color, material.alpha, material.textured))
            .collect();
        let wanted = [
            ("red one", Some([1.0, 0.0, 0.0]), 1.0, false),
            ("clear", None, 0.0, true),
            ("half", None, 0.5, false),
            ("odd", Some([1.0, 1.0, 0.0]), 1.0, false),
        ];
        assert_eq!(found, wanted);
        assert!(libraries.materials[1].is_invisible() && !libraries.materials[2].is_invisible());
        let starts = [
            "material `bad` of `c.mtl` not read: Kd needs three numbers",
            "material `` of `c.mtl` not read: ",
            "material library `d.mtl` not read: ",
            "material library `/etc/passwd` not read: its path leaves the folder of the file; put it into",
            "material library `..\\x.mtl` not read: its path leaves the folder",
            "material library `` not read: its path leaves the folder",
        ];
        assert_eq!(libraries.notes.len(), starts.len(), "{:?}", libraries.notes);
        for (note, start) in libraries.notes.iter().zip(starts) {
            assert!(note.starts_with(start), "{note}");
        }
        let mut from_memory = Libraries::default();
        from_memory.add("c.mtl", None);
        assert!(from_memory.notes[0].contains("cannot be reached when reading from memory"));
    }

    #[test]
    fn libraries_end_at_their_limits() {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("long.mtl"), vec![b'#'; MOST_BYTES as usize + 1]).unwrap();
        let mut libraries = Libraries::default();
        libraries.add("long.mtl", Some(folder.path()));
        assert!(libraries.notes[0].contains("it takes more than 16777216 bytes"), "{:?}", libraries.notes);
        for i in 0..1000 {
            libraries.add(&format!("{i}.mtl"), Some(folder.path()));
        }
        assert_eq!(libraries.notes.len(), MOST_LIBRARIES);
    }
}
