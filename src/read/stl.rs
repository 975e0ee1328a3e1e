//! Stereolithography (STL), text and binary: a triangle soup, three vertices per face, in file order.
//!
//! The readers are our own: `stl_io` reports neither line nor byte of an error, takes a binary header's count
//! for granted, and stops after the first of several solids. Normals and attributes are skipped.

use std::io::{BufRead, ErrorKind, Read, Seek, SeekFrom};

use super::text::{Line, Lines, counted, quote, unreadable};
use super::{Format, Place, ReadError, Source, refused, unheld};
use crate::mesh::{MAX_TRIANGLES, Mesh, MeshError, Origins, Part};
use crate::scene::Scene;

/// Bytes before the first triangle of a binary file: a comment and the count.
const HEADER: u64 = 84;
/// Bytes of a binary triangle: the normal, three vertices, two bytes of attributes.
const RECORD: u64 = 50;

pub(super) fn read<R: BufRead + Seek>(mut source: Source<R>) -> Result<Scene, ReadError> {
    let io_error = |error| unreadable(Format::Stl, Place::File, &error);
    let mut head = Vec::new();
    source.reader.by_ref().take(HEADER).read_to_end(&mut head).map_err(io_error)?;
    // Binary files may begin with "solid" too. But text has no zero byte, and every count below 2²⁴ has one;
    // a larger one is recognized by the file's length.
    let count = head.get(80..).and_then(|count| count.first_chunk()).map(|&count| u32::from_le_bytes(count));
    let full = count.is_some_and(|count| source.len == HEADER + RECORD * u64::from(count));
    let text = head.strip_prefix(b"\xef\xbb\xbf").unwrap_or(&head).trim_ascii_start();
    let solid = text.get(..5).is_some_and(|word| word.eq_ignore_ascii_case(b"solid"));
    if solid && !full && !head.contains(&0) {
        source.reader.seek(SeekFrom::Start(0)).map_err(io_error)?;
        return read_text(source.reader);
    }
    read_binary(source, count)
}

/// The triangle list of a soup.
fn soup(positions: Vec<[f32; 3]>) -> Result<Mesh, ReadError> {
    // A count that does not fit 32 bits is refused by `Mesh::new`.
    let triangles = (0..positions.len() / 3).map(|face| [0, 1, 2].map(|corner| (3 * face + corner) as u32));
    let triangles = triangles.collect();
    Mesh::new(positions, triangles).map_err(|error| refused(Format::Stl, &error))
}

fn read_binary<R: BufRead>(mut source: Source<R>, count: Option<u32>) -> Result<Scene, ReadError> {
    let len = source.len;
    let Some(count) = count.map(u64::from) else {
        let problem = format!("a binary STL has at least {HEADER} bytes, but the file has {len}");
        return Err(ReadError::new(Format::Stl, Place::File, problem));
    };
    let room = len.saturating_sub(HEADER) / RECORD;
    let rest = len.saturating_sub(HEADER) % RECORD;
    // Less than was promised is a file cut short; exactly another count is a header that was never filled in.
    if room < count || room > count && rest == 0 {
        let problem = format!("the header counts {}, but the file holds {room}", counted(count, "triangle"));
        return Err(ReadError::new(Format::Stl, Place::Byte(80), problem));
    }

    if count > MAX_TRIANGLES as u64 {
        let error = MeshError::TooLarge { what: "triangles", count: count as usize, most: MAX_TRIANGLES };
        return Err(refused(Format::Stl, &error));
    }
    let mut positions = Vec::new();
    // At most 36 bytes for 50 of the file.
    positions.try_reserve_exact(3 * count as usize).map_err(|_| unheld(Format::Stl, count, "triangle"))?;
    let mut chunk = vec![0; (RECORD * count.min(4096)) as usize];
    let mut done = 0;
    while done < count {
        let records = (count - done).min(4096);
        let chunk = &mut chunk[..(RECORD * records) as usize];
        source.reader.read_exact(chunk).map_err(|error| match error.kind() {
            ErrorKind::UnexpectedEof => ReadError::new(Format::Stl, Place::File, "the file ends early"),
            _ => unreadable(Format::Stl, Place::Byte(HEADER + RECORD * done), &error),
        })?;
        for record in chunk.chunks_exact(RECORD as usize) {
            // Spelt out, so that it becomes a few vector instructions.
            let mut numbers = [0.0_f32; 9];
            let mut finite = true;
            for (number, bytes) in numbers.iter_mut().zip(record[12..48].as_chunks().0) {
                *number = f32::from_le_bytes(*bytes);
                finite &= number.is_finite();
            }
            if !finite {
                let bad = numbers.iter().position(|number| !number.is_finite()).expect("one is not");
                let face = positions.len() as u64 / 3;
                let value = numbers[bad];
                let problem =
                    format!("triangle {face} has the coordinate {value}, which is not a finite number");
                let place = Place::Byte(HEADER + RECORD * face + 12 + 4 * bad as u64);
                return Err(ReadError::new(Format::Stl, place, problem));
            }
            positions.extend_from_slice(numbers.as_chunks().0);
        }
        done += records;
    }
    let mut scene = Scene::of(soup(positions)?);
    let trailing = len - HEADER - RECORD * count;
    if trailing > 0 {
        scene.notes.push(format!("{} after the last triangle ignored", counted(trailing, "byte")));
    }
    Ok(scene)
}

/// What a text file may hold next.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Inside {
    File,
    Solid,
    Facet,
    /// How many vertices of the loop came.
    Loop(u8),
    /// A facet whose loop is closed.
    Done,
}

fn read_text<R: BufRead>(reader: R) -> Result<Scene, ReadError> {
    let mut lines = Lines::new(reader, Format::Stl, false)?;
    let mut positions: Vec<[f32; 3]> = Vec::new();
    let mut solids: Vec<Part> = Vec::new();
    let mut origins = Origins::default();
    let mut inside = Inside::File;
    while let Some(mut line) = lines.next_line()? {
        let Some(keyword) = line.word() else { continue };
        let is = |name: &str| keyword.eq_ignore_ascii_case(name.as_bytes());
        inside = match inside {
            Inside::Loop(3) if is("endloop") => Inside::Done,
            Inside::Loop(count @ 0..3) if is("vertex") => {
                positions.push(line.point()?);
                end_of(line)?;
                Inside::Loop(count + 1)
            }
            Inside::Solid if is("facet") => {
                origins.push((positions.len() / 3) as u32, Some(line.number));
                Inside::Facet // its normal follows from the vertices
            }
            Inside::Facet if is("outer") => Inside::Loop(0),
            Inside::Done if is("endfacet") => Inside::Solid,
            Inside::Solid if is("endsolid") => Inside::File,
            Inside::File if is("solid") => {
                let start = (positions.len() / 3) as u32;
                solids.push(Part::new(line.name(), start..start));
                Inside::Solid
            }
            _ => return Err(line.error(format!("{} is wanted, not {}", wanted(inside), quote(keyword)))),
        };
        if inside == Inside::File
            && let Some(solid) = solids.last_mut()
        {
            solid.faces.end = (positions.len() / 3) as u32;
        }
    }
    if inside != Inside::File {
        return Err(lines.error_at_end(format!("the file ends where {} is wanted", wanted(inside))));
    }
    let mesh = soup(positions)?.with_origins(origins);
    solids.retain(|solid| !solid.faces.is_empty());
    Ok(Scene::of(match solids.as_mut_slice() {
        [only] => mesh.with_name(std::mem::take(&mut only.name)),
        _ => mesh.with_parts(solids),
    }))
}

/// What should come next, for a message.
fn wanted(inside: Inside) -> &'static str {
    match inside {
        Inside::File => "`solid`",
        Inside::Solid => "`facet` or `endsolid`",
        Inside::Facet => "`outer loop`",
        Inside::Loop(0..3) => "`vertex`",
        Inside::Loop(_) => "`endloop`",
        Inside::Done => "`endfacet`",
    }
}

fn end_of(mut line: Line<'_>) -> Result<(), ReadError> {
    match line.word() {
        None => Ok(()),
        Some(word) => Err(line.error(format!("{} follows the position", quote(word)))),
    }
}
