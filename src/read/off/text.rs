//! Text OFF: a vertex a line, a face a line; what follows the numbers of a line is skipped.

use std::io::BufRead;

use super::header::Header;
use super::{Off, check_size};
use crate::read::text::{counted, loose, parse};
use crate::read::words::Words;
use crate::read::{Place, ReadError};

/// The fewest bytes of a vertex, three digits and as many blanks, and of a face, one of each.
const LEAST: [u64; 2] = [6, 2];

pub(super) fn read<R: BufRead>(
    off: &mut Off,
    words: &mut Words<R>,
    len: u64,
    header: &Header,
) -> Result<(), ReadError> {
    let vertices = match header.vertices {
        Some(vertices) => vertices,
        None => count(words, header.ahead)?,
    };
    let faces = count(words, false)?;
    // The number of edges may follow; it is often wrong or missing.
    words.skip_line()?;
    let left = len.saturating_sub(words.position());
    check_size(vertices, faces, LEAST, left, Place::Line(words.line()))?;

    off.reserve(vertices)?;
    for index in 0..vertices {
        let position = point(words, index)?;
        off.vertex(position, Some(words.line()));
        if words.skip_line()? && header.extras == 0 {
            off.slips.add("vertex", "with more than a position", || format!("on line {}", words.line()));
        }
    }
    for index in 0..faces {
        face(off, words, index)?;
    }
    if words.uncommented()?.is_some() {
        off.slips.add("word", "after the last face ignored", || format!("on line {}", words.line()));
    }
    Ok(())
}

/// The next word as a count, or the last one that was read.
fn count<R: BufRead>(words: &mut Words<R>, last: bool) -> Result<u64, ReadError> {
    if !last && words.uncommented()?.is_none() || words.last().is_empty() {
        return Err(words.error("the file ends before its counts of vertices and faces"));
    }
    parse(words.last())
        .ok_or_else(|| words.error(format!("{} is not a count of vertices or faces", words.quoted())))
}

fn point<R: BufRead>(words: &mut Words<R>, index: u64) -> Result<[(f64, f32); 3], ReadError> {
    let mut point = [(0.0, 0.0); 3];
    let mut line = None;
    for value in &mut point {
        let there = words.uncommented()?.is_some();
        match line {
            None if !there => return Err(words.error(format!("the file ends before vertex {index}"))),
            Some(line) if !there || words.starts_line() => {
                return Err(words.error_on(line, "a position needs three numbers"));
            }
            _ => line = Some(words.line()),
        }
        let Some(number) = loose(words.last()) else {
            return Err(words.error(format!("{} is not a number", words.quoted())));
        };
        *value = number;
    }
    Ok(point)
}

fn face<R: BufRead>(off: &mut Off, words: &mut Words<R>, index: u64) -> Result<(), ReadError> {
    let Some(word) = words.uncommented()? else {
        return Err(words.error(format!("the file ends before face {index}")));
    };
    let Some(corners) = parse::<u64>(word) else {
        return Err(words.error(format!("{} is not a count of corners", words.quoted())));
    };
    let line = words.line();
    for corner in 0..corners {
        if words.uncommented()?.is_none() || words.starts_line() {
            let counted = counted(corners, "corner");
            return Err(words.error_on(line, format!("the face counts {counted}, but its line has {corner}")));
        }
        let Some(vertex) = parse::<i64>(words.last()) else {
            return Err(words.error(format!("{} is not the index of a vertex", words.quoted())));
        };
        off.corner(vertex).map_err(|problem| words.error(problem))?;
    }
    off.end_face(Some(line), || format!("on line {line}"));
    // A color may follow.
    words.skip_line().map(drop)
}
