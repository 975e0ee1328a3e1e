//! Binary STL: records of 50 bytes, after each of which as many bytes may follow as its attribute count says.

use std::io::{self, BufRead, ErrorKind, Read, Seek, SeekFrom};

use super::soup;
use crate::mesh::{MAX_TRIANGLES, MeshError};
use crate::read::text::{counted, unreadable};
use crate::read::{Format, Place, ReadError, Source, refused, unheld};
use crate::scene::Scene;

/// Bytes before the first triangle of a binary file: a comment and the count.
pub(super) const HEADER: u64 = 84;
/// Bytes of a binary triangle: the normal, three vertices, two bytes of attributes.
pub(super) const RECORD: u64 = 50;

/// Reads from byte 84 on. `count` is the header's number of triangles; `None` if the file ends before it.
pub(super) fn read<R: BufRead + Seek>(mut source: Source<R>, count: Option<u32>) -> Result<Scene, ReadError> {
    let len = source.len;
    let Some(count) = count.map(u64::from) else {
        let problem = format!("a binary STL has at least {HEADER} bytes, but the file has {len}");
        return Err(ReadError::new(Format::Stl, Place::File, problem));
    };
    let room = len.saturating_sub(HEADER) / RECORD;
    let wrong_count = || {
        let problem = format!("the header counts {}, but the file holds {room}", counted(count, "triangle"));
        ReadError::new(Format::Stl, Place::Byte(80), problem)
    };
    // Less than was promised is a file cut short.
    if room < count {
        return Err(wrong_count());
    }
    if count > MAX_TRIANGLES as u64 {
        let error = MeshError::TooLarge { what: "triangles", count: count as usize, most: MAX_TRIANGLES };
        return Err(refused(Format::Stl, &error));
    }
    let surplus = len - HEADER - RECORD * count;
    let attributes = match surplus {
        0 => Attributes::Within,
        _ => match attributes(&mut source, count, surplus) {
            // Exactly another count is a header that was never filled in.
            Ok(Attributes::Within) | Err(_) if surplus.is_multiple_of(RECORD) => return Err(wrong_count()),
            attributes => attributes?,
        },
    };
    let mut positions = Vec::new();
    // At most 36 bytes for 50 of the file.
    positions.try_reserve_exact(3 * count as usize).map_err(|_| unheld(Format::Stl, count, "triangle"))?;
    if attributes == Attributes::Behind {
        each_with_payload(&mut source.reader, count, |record, at| push(record, at, &mut positions))?;
    } else {
        in_chunks(&mut source.reader, count, &mut positions)?;
    }
    let mut scene = Scene::of(soup(positions)?);
    match attributes {
        Attributes::Behind => {
            scene.notes.push(format!("{} of attributes behind triangles skipped", counted(surplus, "byte")));
        }
        Attributes::Within if surplus > 0 => {
            scene.notes.push(format!("{} after the last triangle ignored", counted(surplus, "byte")));
        }
        Attributes::Within => {}
    }
    Ok(scene)
}

fn in_chunks<R: BufRead>(reader: &mut R, count: u64, positions: &mut Vec<[f32; 3]>) -> Result<(), ReadError> {
    let mut chunk = vec![0; (RECORD * count.min(4096)) as usize];
    let mut done = 0;
    while done < count {
        let records = (count - done).min(4096);
        let chunk = &mut chunk[..(RECORD * records) as usize];
        reader.read_exact(chunk).map_err(|error| ended(&error, HEADER + RECORD * done))?;
        for (record, index) in chunk.as_chunks().0.iter().zip(done..) {
            push(record, HEADER + RECORD * index, positions)?;
        }
        done += records;
    }
    Ok(())
}

/// Adds the vertices of the triangle at byte `at`.
#[inline]
fn push(record: &[u8; RECORD as usize], at: u64, positions: &mut Vec<[f32; 3]>) -> Result<(), ReadError> {
    // Spelt out, so that it becomes a few vector instructions.
    let mut numbers = [0.0_f32; 9];
    let mut finite = true;
    for (number, bytes) in numbers.iter_mut().zip(record[12..48].as_chunks().0) {
        *number = f32::from_le_bytes(*bytes);
        finite &= number.is_finite();
    }
    if !finite {
        let bad = numbers.iter().position(|number| !number.is_finite()).expect("one is not");
        let (face, value) = (positions.len() / 3, numbers[bad]);
        let problem = format!("triangle {face} has the coordinate {value}, which is not a finite number");
        return Err(ReadError::new(Format::Stl, Place::Byte(at + 12 + 4 * bad as u64), problem));
    }
    positions.extend_from_slice(numbers.as_chunks().0);
    Ok(())
}

/// Where the attributes of triangles lie.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Attributes {
    /// In the two bytes of the count itself: a color, as a rule.
    Within,
    /// Behind each triangle, as many bytes as it counts.
    Behind,
}

/// Tells by the length of the file, which has `surplus` bytes more than its triangles.
fn attributes<R: BufRead + Seek>(
    source: &mut Source<R>,
    count: u64,
    surplus: u64,
) -> Result<Attributes, ReadError> {
    let mut sum = 0;
    let mut first = None;
    let walk = each_with_payload(&mut source.reader, count, |record, at| {
        let attributes = u64::from(u16::from_le_bytes([record[48], record[49]]));
        if attributes > 0 {
            first.get_or_insert((attributes, at + 48));
        }
        sum += attributes;
        // An error ends the walk, before it leaves the file.
        if sum > surplus { Err(ReadError::new(Format::Stl, Place::File, "")) } else { Ok(()) }
    });
    source
        .reader
        .seek(SeekFrom::Start(HEADER))
        .map_err(|error| unreadable(Format::Stl, Place::File, &error))?;
    match first {
        None => walk.map(|()| Attributes::Within),
        // What one triangle counts is not there, and the file holds no more triangles: it is no count.
        Some((attributes, _)) if attributes > surplus && surplus < RECORD => Ok(Attributes::Within),
        Some(_) if sum == surplus && walk.is_ok() => Ok(Attributes::Behind),
        Some((_, at)) => {
            let problem = format!(
                "attributes follow the triangles, from this count on, but their counts do not add up to the {} \
                 that the file has beyond its triangles",
                counted(surplus, "byte")
            );
            Err(ReadError::new(Format::Stl, Place::Byte(at), problem))
        }
    }
}

/// Calls `each` for every triangle and its byte, and skips the attributes behind it.
fn each_with_payload<R: BufRead>(
    reader: &mut R,
    count: u64,
    mut each: impl FnMut(&[u8; RECORD as usize], u64) -> Result<(), ReadError>,
) -> Result<(), ReadError> {
    let mut at = HEADER;
    for _ in 0..count {
        let mut record = [0; RECORD as usize];
        reader.read_exact(&mut record).map_err(|error| ended(&error, at))?;
        each(&record, at)?;
        let payload = u64::from(u16::from_le_bytes([record[48], record[49]]));
        at += RECORD + payload;
        let skipped = io::copy(&mut reader.by_ref().take(payload), &mut io::sink());
        skipped.map_err(|error| ended(&error, at))?;
    }
    Ok(())
}

/// An error of reading at byte `at`.
fn ended(error: &io::Error, at: u64) -> ReadError {
    match error.kind() {
        ErrorKind::UnexpectedEof => ReadError::new(Format::Stl, Place::File, "the file ends early"),
        _ => unreadable(Format::Stl, Place::Byte(at), error),
    }
}
