//! Modes 1 and 2: indices of triangles, by edges and vertices met shortly before; and any other indices, by
//! their differences.

use super::{LONG, Layout, Malformed, SHORT, take};

/// The table at the end of a stream of triangles.
const TABLE_BYTES: usize = 16;
/// What pads the end of a stream of indices.
const PADDING_BYTES: usize = 4;

/// The fewest bytes of this many triangles or indices: a header and one each; `None` beyond any stream.
pub(super) fn least_bytes(count: usize) -> Option<usize> {
    count.checked_add(1)
}

/// Triangles; `count` is that of their indices.
pub(super) fn decode_triangles(
    stream: &[u8],
    Layout { count, stride }: Layout,
) -> Result<Vec<u8>, Malformed> {
    let body = body(stream, 0xe1, TABLE_BYTES, "the first byte is not that of triangles")?;
    let table = &stream[stream.len() - TABLE_BYTES..];
    let mut data = body;
    let codes = take(&mut data, count / 3)?;
    let mut state = Triangles { data, next: 0, last: 0, edges: Recent::new(), vertices: Recent::new() };
    let mut out = Vec::with_capacity(count * stride);
    for &code in codes {
        for index in state.triangle(code, table)? {
            push(&mut out, index, stride);
        }
    }
    if state.data.is_empty() { Ok(out) } else { Err(LONG) }
}

/// Indices one by one, each a difference from one of two that came before.
pub(super) fn decode_sequence(stream: &[u8], Layout { count, stride }: Layout) -> Result<Vec<u8>, Malformed> {
    let mut data = body(stream, 0xd1, PADDING_BYTES, "the first byte is not that of indices")?;
    let mut last = [0_u32; 2];
    let mut out = Vec::with_capacity(count * stride);
    for _ in 0..count {
        let stored = varint(&mut data)?;
        let last = &mut last[(stored & 1) as usize];
        *last = last.wrapping_add(signed(stored >> 1));
        push(&mut out, *last, stride);
    }
    if data.is_empty() { Ok(out) } else { Err(LONG) }
}

/// What is between the first byte and the tail.
fn body(stream: &[u8], first: u8, tail: usize, other: Malformed) -> Result<&[u8], Malformed> {
    match stream.split_first() {
        Some((&is, rest)) if is == first => rest.len().checked_sub(tail).map(|end| &rest[..end]).ok_or(SHORT),
        Some(_) => Err(other),
        None => Err(SHORT),
    }
}

/// Writes an index in two or four bytes.
fn push(out: &mut Vec<u8>, index: u32, stride: usize) {
    out.extend_from_slice(&index.to_le_bytes()[..stride]);
}

/// A number in groups of seven bits, the lowest first (unsigned LEB128).
fn varint(data: &mut &[u8]) -> Result<u32, Malformed> {
    let mut value = 0;
    for shift in (0..35).step_by(7) {
        let byte = take(data, 1)?[0];
        value |= u32::from(byte & 127).wrapping_shl(shift);
        if byte < 128 {
            return Ok(value);
        }
    }
    Err("a number has more than five bytes")
}

/// Differences alternate between above and below: 0, −1, 1, −2, …
fn signed(stored: u32) -> u32 {
    stored >> 1 ^ (stored & 1).wrapping_neg()
}

/// The sixteen items that came last.
struct Recent<T> {
    items: [Option<T>; 16],
    /// Where the next one goes.
    at: usize,
}

impl<T: Copy> Recent<T> {
    fn new() -> Self {
        Self { items: [None; 16], at: 0 }
    }

    fn push(&mut self, item: T) {
        self.items[self.at] = Some(item);
        self.at = (self.at + 1) % 16;
    }

    /// The item that came this many before the last one, below 16.
    fn get(&self, back: u8) -> Result<T, Malformed> {
        self.items[(self.at + 15 - usize::from(back)) % 16].ok_or("a triangle refers to one before the first")
    }
}

struct Triangles<'a> {
    data: &'a [u8],
    /// The vertex that was not met yet.
    next: u32,
    /// The vertex that was last written out.
    last: u32,
    edges: Recent<(u32, u32)>,
    vertices: Recent<u32>,
}

impl Triangles<'_> {
    fn triangle(&mut self, code: u8, table: &[u8]) -> Result<[u32; 3], Malformed> {
        match (code >> 4, code & 15) {
            (15, low @ 14..) => {
                let how = take(&mut self.data, 1)?[0];
                if how == 0 {
                    self.next = 0;
                }
                let first = if low == 14 { 0 } else { 15 };
                self.free(first, how >> 4, how & 15)
            }
            (15, low) => {
                let how = table[usize::from(low)];
                let (b, c) = (how >> 4, how & 15);
                if b == 15 || c == 15 {
                    return Err("the table of triangles has an entry that is not allowed");
                }
                self.free(0, b, c)
            }
            (edge, low) => {
                let (a, b) = self.edges.get(edge)?;
                let c = match low {
                    0 => self.new_vertex(),
                    1..13 => self.vertices.get(low)?,
                    13 => self.beside(u32::MAX),
                    14 => self.beside(1),
                    _ => self.written_out()?,
                };
                if !(1..13).contains(&low) {
                    self.vertices.push(c);
                }
                self.edges.push((c, b));
                self.edges.push((a, c));
                Ok([a, b, c])
            }
        }
    }

    /// A triangle of three vertices: each a new one (0), one written out (15), or a recent one.
    fn free(&mut self, first: u8, second: u8, third: u8) -> Result<[u32; 3], Malformed> {
        let mut corners = [0; 3];
        for (corner, how) in corners.iter_mut().zip([first, second, third]) {
            *corner = match how {
                0 => self.new_vertex(),
                15 => self.written_out()?,
                _ => self.vertices.get(how - 1)?,
            };
        }
        let [a, b, c] = corners;
        [(b, a), (c, b), (a, c)].into_iter().for_each(|edge| self.edges.push(edge));
        // Recent ones stay where they are.
        for (corner, how) in corners.into_iter().zip([first, second, third]) {
            if matches!(how, 0 | 15) {
                self.vertices.push(corner);
            }
        }
        Ok(corners)
    }

    fn new_vertex(&mut self) -> u32 {
        let vertex = self.next;
        self.next = vertex.wrapping_add(1);
        vertex
    }

    /// The vertex this far from the one last written out.
    fn beside(&mut self, step: u32) -> u32 {
        self.last = self.last.wrapping_add(step);
        self.last
    }

    fn written_out(&mut self) -> Result<u32, Malformed> {
        let step = signed(varint(&mut self.data)?);
        Ok(self.beside(step))
    }
}
