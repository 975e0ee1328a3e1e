//! Wavefront OBJ: positions, faces, and the names of their runs.
//!
//! The parser of the geometry is our own: `tobj` renumbers vertices (so unreferenced ones are lost), splits
//! the file by group and material, and does not report the line of an error. All vertices stay, in the order
//! of the file. Material libraries are parsed by `tobj`.
//!
//! An index may name a vertex that comes later. Polygons are cut into triangles. Texture coordinates, normals
//! and smoothing are skipped without a note; other statements (lines, points, curves) with a note.

mod library;

use std::collections::HashMap;
use std::io::{BufRead, Seek};
use std::path::Path;

use self::library::Libraries;
use super::lost::Lost;
use super::polygon::{Cut, Faces};
use super::slips::Slips;
use super::text::{Line, Lines, counted, name, quote};
use super::{Format, ReadError, Source, refused};
use crate::mesh::{Mesh, Part};
use crate::scene::{Material, Scene};

/// Reads an OBJ. `folder` is where material libraries lie, or `None` if they cannot be reached.
pub(super) fn read<R: BufRead + Seek>(source: Source<R>, folder: Option<&Path>) -> Result<Scene, ReadError> {
    let mut lines = Lines::new(source.reader, Format::Obj, true)?;
    let mut obj = Obj::default();
    while let Some(mut line) = lines.next_line()? {
        match line.word() {
            None => {}
            Some(b"v") => obj.vertex(line)?,
            Some(b"f") => obj.face(line)?,
            Some(b"vt" | b"vn" | b"vp" | b"s") => {}
            Some(b"mtllib") => obj.libraries.add(String::from_utf8_lossy(line.rest).trim(), folder),
            Some(b"o") => obj.rename(0, line),
            Some(b"g") => obj.rename(1, line),
            Some(b"usemtl") => obj.rename(2, line),
            Some([b'#', ..]) => {}
            Some(keyword) => {
                obj.ignored += 1;
                obj.first_ignored.get_or_insert_with(|| (line.number, quote(keyword)));
            }
        }
    }
    let rounding = lines.rounding();
    Ok(Scene { rounding, ..obj.finish()? })
}

#[derive(Default)]
struct Obj {
    positions: Vec<[f32; 3]>,
    lost: Lost,
    faces: Faces,
    parts: Vec<Part>,
    /// Object, group, material: what the next faces belong to.
    names: [String; 3],
    /// The names of the last part, to decide whether a face continues it.
    part_names: [String; 3],
    /// Whether a name came since the last face.
    renamed: bool,
    /// The index of each material that was named.
    materials: HashMap<String, u32>,
    libraries: Libraries,
    /// The highest index (from 1) named by a face, and the first line that names it.
    highest: (u64, u64),
    slips: Slips,
    ignored: u64,
    first_ignored: Option<(u64, String)>,
}

impl Obj {
    fn vertex(&mut self, mut line: Line<'_>) -> Result<(), ReadError> {
        let (index, position) = (self.positions.len() as u64, line.point()?);
        self.positions.push(self.lost.rounded(index, position, Some(line.number)));
        // A weight or a color may follow. Neither is read, so it need not be sound; but no statement may.
        while let Some(word) = line.word() {
            match word {
                [b'#', ..] => break,
                b"v" | b"vn" | b"vt" | b"f" | b"l" | b"p" | b"o" | b"g" | b"s" | b"usemtl" | b"mtllib" => {
                    return Err(line.error(format!("{} follows the position", quote(word))));
                }
                _ if word
                    .iter()
                    .all(|byte| matches!(byte, b'0'..=b'9' | b'+' | b'-' | b'.' | b'e' | b'E')) => {}
                _ => {
                    let what = "ignored for not being a number";
                    self.slips
                        .add("color or weight value", what, || format!("{} ({})", line.at(), quote(word)));
                }
            }
        }
        Ok(())
    }

    fn face(&mut self, mut line: Line<'_>) -> Result<(), ReadError> {
        let start = self.faces.triangles.len();
        loop {
            if let Some((vertex, length)) = plain_corner(line.rest) {
                self.note_highest(u64::from(vertex) + 1, line);
                self.faces.corner(vertex);
                line.rest = &line.rest[length..];
                continue;
            }
            match line.word() {
                None | Some([b'#', ..]) => break,
                Some(word) => {
                    let vertex = self.vertex_of(word, line)?;
                    self.faces.corner(vertex);
                }
            }
        }
        if self.faces.end(Some(line.number)) < 3 {
            self.slips.add("face", "of fewer than three corners left out", || line.at());
            return Ok(());
        }
        if self.parts.is_empty() || self.renamed {
            self.begin_part(start);
        }
        Ok(())
    }

    /// The vertex that a corner (`a`, `a/b`, `a//c` or `a/b/c`) names. Only `a` counts.
    fn vertex_of(&mut self, word: &[u8], line: Line<'_>) -> Result<u32, ReadError> {
        let Some(index) = corner(word) else {
            return Err(line.error(format!("{} is not a corner of a face", quote(word))));
        };
        let count = self.positions.len() as u64;
        let from_one = match u64::try_from(index) {
            Ok(index) => index,
            // Negative: from the end, −1 being the last vertex so far.
            Err(_) => (count + 1).saturating_sub(index.unsigned_abs()),
        };
        if from_one == 0 || from_one > u64::from(u32::MAX) {
            let so_far = counted(count, "vertex");
            let problem = match index {
                0 => "a face names vertex 0, but indices count from 1".to_owned(),
                _ => {
                    // As it is written: the number itself may be beyond every integer type.
                    let written = word.split(|&byte| byte == b'/').next().unwrap_or(word);
                    format!("a face names vertex {}, but the file has {so_far} so far", name(written))
                }
            };
            return Err(line.error(problem));
        }
        self.note_highest(from_one, line);
        Ok((from_one - 1) as u32) // at most u32::MAX − 1, by the check above
    }

    /// A face on `line` names vertex `from_one`, counted from 1.
    #[inline]
    fn note_highest(&mut self, from_one: u64, line: Line<'_>) {
        if from_one > self.highest.0 {
            self.highest = (from_one, line.number);
        }
    }

    fn rename(&mut self, which: usize, line: Line<'_>) {
        self.names[which] = line.name();
        self.renamed = true;
    }

    /// A new run of faces from `start` on, if its names differ. Runs cover all faces, the unnamed ones too.
    fn begin_part(&mut self, start: usize) {
        self.renamed = false;
        if !self.parts.is_empty() && self.names == self.part_names {
            return;
        }
        self.part_names.clone_from(&self.names);
        let mut name = String::new();
        for part in self.names.iter().filter(|part| !part.is_empty()) {
            if !name.is_empty() {
                name.push_str(" / ");
            }
            name.push_str(part);
        }
        // A count that does not fit 32 bits is refused by `Mesh::new` before the parts are used.
        let material = match self.names[2].as_str() {
            "" => None,
            name => Some(self.material(name.to_owned())),
        };
        self.parts.push(Part { name, faces: start as u32..start as u32, material });
    }

    /// The index of a material, which may be new. There are no more of them than faces.
    fn material(&mut self, name: String) -> u32 {
        let next = self.materials.len() as u32;
        *self.materials.entry(name).or_insert(next)
    }

    fn finish(mut self) -> Result<Scene, ReadError> {
        let error = |line, problem| ReadError::new(Format::Obj, super::Place::Line(line), problem);
        let count = self.positions.len() as u64;
        let (highest, line) = self.highest;
        if highest > count {
            let there_are = counted(count, "vertex");
            return Err(error(line, format!("a face names vertex {highest}, but the file has {there_are}")));
        }
        if let (0, Some((line, keyword))) = (count, &self.first_ignored) {
            let problem = format!("{keyword} is not a statement of a mesh, and the file holds no vertex");
            return Err(error(*line, problem).remedy("check that this is a Wavefront OBJ file"));
        }
        let mut end = self.faces.triangles.len() as u32;
        for part in self.parts.iter_mut().rev() {
            part.faces.end = end;
            end = part.faces.start;
        }
        if let [only] = self.parts.as_slice()
            && only.name.is_empty()
        {
            self.parts.clear();
        }
        let lost = self.lost.settle(Format::Obj, &mut self.positions, &self.faces.triangles)?;
        let Cut { triangles, origins, notes } = self.faces.cut(&self.positions);
        let mesh = Mesh::new(self.positions, triangles).map_err(|error| refused(Format::Obj, &error))?;
        let mut scene = Scene::of(mesh.with_parts(self.parts).with_origins(origins));
        scene.materials = materials(self.materials, &self.libraries.materials);
        scene.notes = self.libraries.notes;
        scene.notes.extend(lost);
        scene.notes.extend(notes);
        scene.notes.extend(self.slips.notes());
        if let Some((line, keyword)) = self.first_ignored {
            let statements = counted(self.ignored, "statement");
            scene.notes.push(format!("{statements} ignored, the first on line {line} ({keyword})"));
        }
        Ok(scene)
    }
}

/// The materials that faces name, in the order of their indices; the first definition of a name counts.
fn materials(named: HashMap<String, u32>, defined: &[Material]) -> Vec<Material> {
    let mut first: HashMap<&str, &Material> = HashMap::new();
    for material in defined {
        first.entry(&material.name).or_insert(material);
    }
    let mut materials = vec![Material::default(); named.len()];
    for (name, index) in named {
        materials[index as usize] = match first.get(name.as_str()) {
            Some(&material) => material.clone(),
            None => Material { name, ..Material::default() },
        };
    }
    materials
}

/// The vertex (from 0) of the next corner in `rest`, and how many bytes it takes with the blanks before it.
///
/// In one pass, for what nearly every file holds: one to three indices, the first positive and of at most
/// nine digits. `None` for all else, sound or not.
#[inline]
fn plain_corner(rest: &[u8]) -> Option<(u32, usize)> {
    let mut at = 0;
    while rest.get(at).is_some_and(u8::is_ascii_whitespace) {
        at += 1;
    }
    let start = at;
    let mut index = 0_u32;
    while let Some(digit) = rest.get(at).map(|byte| byte.wrapping_sub(b'0')).filter(|&digit| digit <= 9) {
        index = index.wrapping_mul(10).wrapping_add(u32::from(digit));
        at += 1;
    }
    if index == 0 || at - start > 9 {
        return None;
    }
    if rest.get(at) == Some(&b'/') {
        let mut slashes = 0;
        while let Some(byte @ (b'0'..=b'9' | b'/' | b'-')) = rest.get(at) {
            slashes += u8::from(*byte == b'/');
            if slashes > 2 {
                return None;
            }
            at += 1;
        }
    }
    rest.get(at).is_none_or(u8::is_ascii_whitespace).then_some((index - 1, at))
}

/// The first index of a corner; `None` if the word is not made of one to three indices.
fn corner(word: &[u8]) -> Option<i64> {
    let negative = word[0] == b'-';
    let digits = &word[usize::from(negative)..];
    let mut index = 0_i64;
    let mut length = 0;
    for &byte in digits {
        let digit = byte.wrapping_sub(b'0');
        if digit > 9 {
            break;
        }
        // No file has 10¹⁷ vertices: beyond that the index only has to stay out of range.
        if index < 100_000_000_000_000_000 {
            index = index * 10 + i64::from(digit);
        }
        length += 1;
    }
    if length == 0 {
        return None;
    }
    let rest = &digits[length..];
    let sound = match rest.first() {
        None => true,
        Some(b'/') => {
            rest.iter().all(|byte| matches!(byte, b'0'..=b'9' | b'/' | b'-'))
                && rest.iter().filter(|&&byte| byte == b'/').count() <= 2
        }
        Some(_) => false,
    };
    sound.then_some(if negative { -index } else { index })
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        /// What the quick scan reads, the plain one reads alike; and it reads what is written plainly.
        #[test]
        fn corner_in_one_pass_is_that_of_the_word(
            text in "[ \t]{0,2}(-?[0-9]{0,11}(/-?[0-9]{0,2}){0,3}|[0-9]{1,3}[a#.]?)([ \t][0-9]{0,2})?",
        ) {
            let rest = text.as_bytes();
            let end = |from: usize| rest[from..].iter().position(u8::is_ascii_whitespace).map_or(rest.len(), |n| from + n);
            let start = rest.iter().position(|byte| !byte.is_ascii_whitespace()).unwrap_or(rest.len());
            let word = &rest[start..end(start)];
            let slow = if word.is_empty() { None } else { corner(word) };
            match plain_corner(rest) {
                Some((vertex, length)) => {
                    prop_assert_eq!(Some(i64::from(vertex) + 1), slow);
                    prop_assert_eq!(length, end(start));
                }
                None => {
                    let digits = word.iter().take_while(|byte| byte.is_ascii_digit()).count();
                    prop_assert!(slow.is_none_or(|index| index <= 0) || digits > 9, "{} is plain", text);
                }
            }
        }
    }
}
