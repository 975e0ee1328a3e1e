//! Polygon file format (PLY), text and binary of both byte orders.
//!
//! The reader is our own: `ply-rs-bw` lets a repeated element or property replace the first one, which shifts
//! all data after it unnoticed; it keeps a list on the heap for each face; and its errors in binary data name
//! no place. No list is held here: corners go from the file straight into triangles.
//!
//! Types are those of the format, by either name, and `int64`, `uint64`, `long` and `ulong`.
//!
//! Read are `x`, `y`, `z` of element `vertex` (any numeric type, rounded to `f32`), and the list
//! `vertex_indices` or `vertex_index` of `face` (polygons, cut into triangles) and `tristrips` (strips, −1
//! starts a new one). In a strip every second triangle is turned, and a triangle that repeats a vertex is
//! stitching between strips and no face. Other elements are skipped with a note, other properties in silence.

mod header;
mod junk;
mod number;
mod plain;
mod values;

use std::io::{BufRead, Seek};

use header::{Element, Encoding, Header, Kind, Number};
use values::{Binary, Text, Values};

use super::lost::Lost;
use super::polygon::{Cut, Faces};
use super::text::{Lines, counted};
use super::{Format, Place, ReadError, Source, refused, unheld};
use crate::mesh::Mesh;
use crate::scene::Scene;

pub(super) fn read<R: BufRead + Seek>(source: Source<R>) -> Result<Scene, ReadError> {
    let mut lines = Lines::new(source.reader, Format::Ply, false)?;
    let header = Header::read(&mut lines)?;
    header.check_size(source.len.saturating_sub(lines.position()))?;
    let position = lines.position();
    match header.encoding {
        Encoding::Text => Ply::read(&header, &mut Text::new(lines)),
        Encoding::LittleEndian => {
            Ply::read(&header, &mut Binary::<_, false>::new(lines.into_inner(), position))
        }
        Encoding::BigEndian => Ply::read(&header, &mut Binary::<_, true>::new(lines.into_inner(), position)),
    }
}

#[derive(Default)]
struct Ply {
    positions: Vec<[f32; 3]>,
    /// How far a coordinate moved at most when it was rounded.
    rounding: f64,
    faces: Faces,
    lost: Lost,
    vertex_count: u64,
    strips: u64,
    stitches: u64,
}

impl Ply {
    fn read(header: &Header, values: &mut impl Values) -> Result<Scene, ReadError> {
        let mut notes: Vec<String> = header.slips.notes().collect();
        let no_face = header.element("face")?.is_none_or(|face| face.count == 0);
        let vertex_count = header.element("vertex")?.map_or(0, |vertex| vertex.count);
        let mut ply = Self { vertex_count, ..Self::default() };
        for element in header.elements.iter().filter(|element| element.count > 0) {
            match element.name.as_str() {
                "vertex" => ply.vertices(element, values)?,
                "face" => ply.faces(element, values)?,
                "tristrips" => ply.strips(element, values)?,
                name if no_face && element.is_like_faces() => {
                    let elements = counted(element.count, &format!("{name} element"));
                    notes.push(format!("{elements} read as faces, since there is no element face"));
                    ply.faces(element, values)?;
                }
                name => {
                    notes.push(format!("{} ignored", counted(element.count, &format!("{name} element"))));
                    ply.skip(element, values)?;
                }
            }
        }
        let Cut { triangles, origins, notes: polygons } = ply.faces.cut(&ply.positions);
        notes.extend(polygons);
        if ply.strips > 0 {
            notes.push(format!("{} cut into triangles", counted(ply.strips, "triangle strip")));
        }
        if ply.stitches > 0 {
            notes.push(format!("{} of strips skipped", counted(ply.stitches, "stitching triangle")));
        }
        notes.extend(values.slips().notes());
        notes.extend(ply.lost.settle(Format::Ply, &mut ply.positions, &triangles)?);
        let mesh = Mesh::new(ply.positions, triangles).map_err(|error| refused(Format::Ply, &error))?;
        Ok(Scene { notes, rounding: ply.rounding, ..Scene::of(mesh.with_origins(origins)) })
    }

    fn vertices(&mut self, element: &Element, values: &mut impl Values) -> Result<(), ReadError> {
        let axes = [element.scalar("x")?, element.scalar("y")?, element.scalar("z")?];
        // The header's claim was checked against the file's size: at most 12 bytes for 3 of the file.
        let reserved = self.positions.try_reserve_exact(element.count as usize);
        reserved.map_err(|_| unheld(Format::Ply, element.count, "vertex"))?;
        let plain = plain::Points::of(element, axes);
        loop {
            if let Some(points) = &plain {
                let left = element.count - self.read_vertices();
                let bytes = points.read(values.at_hand(), left, &mut self.positions);
                values.pass(bytes);
            }
            let index = self.read_vertices();
            if index == element.count {
                return Ok(());
            }
            values.begin(&element.name, index)?;
            let mut position = [0.0_f64; 3];
            for (at, property) in element.properties.iter().enumerate() {
                let Kind::Scalar(number) = property.kind else {
                    property.kind.skip(values)?;
                    continue;
                };
                match axes.iter().position(|&axis| axis == at) {
                    Some(axis) => position[axis] = values.number(number)?,
                    None => values.skip(number)?,
                }
            }
            values.end();
            let rounded = self.lost.position(index, position, values.line());
            if position.iter().all(|&value| (value as f32).is_finite()) {
                for (value, rounded) in position.into_iter().zip(rounded) {
                    self.rounding = self.rounding.max((value - f64::from(rounded)).abs());
                }
            }
            self.positions.push(rounded);
        }
    }

    fn read_vertices(&self) -> u64 {
        self.positions.len() as u64
    }

    fn faces(&mut self, element: &Element, values: &mut impl Values) -> Result<(), ReadError> {
        let plain = plain::Polygons::of(element, self.vertex_count);
        self.lists(element, values, plain.as_ref(), |ply, values, number, length| {
            if length < 3 {
                let at = values.at();
                values.slips().add("face", "of fewer than three corners left out", || at);
            }
            if length == 3 {
                let mut corners = [0; 3];
                for corner in &mut corners {
                    let vertex = values.number(number)?;
                    *corner = ply.vertex(vertex, values)?;
                }
                ply.faces.triangle(corners, values.line());
                return Ok(());
            }
            for _ in 0..length {
                let vertex = values.number(number)?;
                ply.faces.corner(ply.vertex(vertex, values)?);
            }
            ply.faces.end(values.line());
            Ok(())
        })
    }

    fn strips(&mut self, element: &Element, values: &mut impl Values) -> Result<(), ReadError> {
        self.lists(element, values, None, |ply, values, number, length| {
            let (mut before, mut corners) = ([0; 2], 0_u64);
            let first = ply.faces.triangles.len();
            for _ in 0..length {
                let value = values.number(number)?;
                if value == -1.0 {
                    corners = 0;
                    continue;
                }
                let vertex = ply.vertex(value, values)?;
                let [a, b] = before;
                match corners {
                    0 => ply.strips += 1,
                    1 => {}
                    _ if a == b || b == vertex || a == vertex => ply.stitches += 1,
                    _ if corners % 2 == 0 => ply.faces.triangles.push([a, b, vertex]),
                    _ => ply.faces.triangles.push([b, a, vertex]),
                }
                before = [b, vertex];
                corners += 1;
            }
            ply.faces.end_strip(first, values.line());
            Ok(())
        })
    }

    /// Calls `each` for the list of vertex indices of each item, with the numbers' type and the list's
    /// length; it must read them all. Triangles and quads that `plain` can read do not come to it.
    fn lists<V: Values>(
        &mut self,
        element: &Element,
        values: &mut V,
        plain: Option<&plain::Polygons>,
        each: impl Fn(&mut Self, &mut V, Number, u64) -> Result<(), ReadError>,
    ) -> Result<(), ReadError> {
        let list = element.index_list()?;
        let mut index = 0;
        loop {
            if let Some(plain) = plain {
                index += self.run::<3>(values, plain, element.count - index);
                index += self.run::<4>(values, plain, element.count - index);
            }
            if index == element.count {
                return Ok(());
            }
            values.begin(&element.name, index)?;
            for (at, property) in element.properties.iter().enumerate() {
                match property.kind {
                    Kind::List { length, item } if at == list => {
                        let length = values.length(length)?;
                        each(self, values, item, length)?;
                    }
                    kind => kind.skip(values)?,
                }
            }
            values.end();
            index += 1;
        }
    }

    /// Reads the polygons of `N` corners that `plain` can read, at most `most`; how many there were.
    #[inline]
    fn run<const N: usize>(&mut self, values: &mut impl Values, plain: &plain::Polygons, most: u64) -> u64 {
        let (count, bytes) = plain.read::<N>(values.at_hand(), most, &mut self.faces.triangles);
        values.pass(bytes);
        self.faces.end_polygons(count, N as u32 - 2);
        count
    }

    fn skip(&mut self, element: &Element, values: &mut impl Values) -> Result<(), ReadError> {
        if element.properties.is_empty() {
            return Ok(()); // no property, no data, whatever the count
        }
        for index in 0..element.count {
            values.begin(&element.name, index)?;
            for property in &element.properties {
                property.kind.skip(values)?;
            }
            values.end();
        }
        Ok(())
    }

    /// The vertex that `value` names.
    #[inline]
    fn vertex(&self, value: f64, values: &impl Values) -> Result<u32, ReadError> {
        if value >= 0.0 && value < self.vertex_count as f64 && value <= f64::from(u32::MAX) {
            return Ok(value as u32); // whole: the header is refused unless the list's type is
        }
        let vertices = counted(self.vertex_count, "vertex");
        Err(values.error(format!("a face names vertex {value}, but the file has {vertices}")))
    }
}

/// An error that concerns the file as a whole.
fn file_error(problem: impl Into<String>) -> ReadError {
    ReadError::new(Format::Ply, Place::File, problem)
}
