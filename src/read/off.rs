//! Object file format (OFF) of Geomview, text and binary.
//!
//! The reader is our own, so that errors name the line. Read are positions and polygons, which are cut into
//! fans; normals, colors and texture coordinates are skipped. A vertex and a face take a line each. Vertices
//! of other than three coordinates (`4OFF`, `nOFF`) are refused.

mod binary;
mod header;
mod text;

use std::io::{BufRead, Seek, SeekFrom};

use header::Header;
pub(super) use header::is_keyword;

use super::lost::Lost;
use super::polygon::{Cut, Faces};
use super::slips::Slips;
use super::text::{counted, unreadable};
use super::words::Words;
use super::{Format, Place, ReadError, Source, refused, unheld};
use crate::mesh::Mesh;
use crate::scene::Scene;

pub(super) fn read<R: BufRead + Seek>(source: Source<R>) -> Result<Scene, ReadError> {
    let len = source.len;
    let mut words = Words::new(source.reader, Format::Off)?;
    let mut off = Off::default();
    let header = Header::read(&mut words, &mut off.slips)?;
    if header.binary {
        let start = words.next_line()?;
        let mut reader = words.into_inner();
        let seek = reader.seek(SeekFrom::Start(start));
        seek.map_err(|error| unreadable(Format::Off, Place::Byte(start), &error))?;
        binary::read(&mut off, reader, start, len, header.extras)?;
    } else {
        text::read(&mut off, &mut words, len, &header)?;
    }
    off.finish()
}

#[derive(Default)]
struct Off {
    positions: Vec<[f32; 3]>,
    faces: Faces,
    lost: Lost,
    /// The most that a coordinate moved when it was rounded.
    rounding: f64,
    slips: Slips,
}

impl Off {
    /// Reserves memory for `vertices`. The caller has checked that the file is long enough for them.
    fn reserve(&mut self, vertices: u64) -> Result<(), ReadError> {
        let reserved = self.positions.try_reserve_exact(vertices as usize);
        reserved.map_err(|_| unheld(Format::Off, vertices, "vertex"))
    }

    /// A vertex; each coordinate also as the file has it.
    fn vertex(&mut self, position: [(f64, f32); 3], line: Option<u64>) {
        let index = self.positions.len() as u64;
        for (wide, near) in position.iter().filter(|(_, near)| near.is_finite()) {
            self.rounding = self.rounding.max((wide - f64::from(*near)).abs());
        }
        self.positions.push(self.lost.rounded(index, position, line));
    }

    /// A corner of the current face; the problem, if there is no such vertex.
    #[inline]
    fn corner(&mut self, vertex: i64) -> Result<(), String> {
        let count = self.positions.len();
        match u32::try_from(vertex) {
            Ok(index) if (index as usize) < count => {
                self.faces.corner(index);
                Ok(())
            }
            _ => {
                let vertices = counted(count as u64, "vertex");
                Err(format!("a face names vertex {vertex}, but the file has {vertices}"))
            }
        }
    }

    /// Ends the current face, on `line` of a text file; `at` is where, for a note.
    fn end_face(&mut self, line: Option<u64>, at: impl FnOnce() -> String) {
        if self.faces.end(line) < 3 {
            self.slips.add("face", "of fewer than three corners left out", at);
        }
    }

    fn finish(mut self) -> Result<Scene, ReadError> {
        let mut notes: Vec<String> = self.slips.notes().collect();
        notes.extend(self.lost.settle(Format::Off, &mut self.positions, &self.faces.triangles)?);
        let Cut { triangles, origins, notes: of_faces } = self.faces.cut(&self.positions);
        notes.extend(of_faces);
        let mesh = Mesh::new(self.positions, triangles).map_err(|error| refused(Format::Off, &error))?;
        Ok(Scene { notes, rounding: self.rounding, ..Scene::of(mesh.with_origins(origins)) })
    }
}

/// The error for counts that the bytes of the file cannot hold.
fn check_size(vertices: u64, faces: u64, least: [u64; 2], left: u64, place: Place) -> Result<(), ReadError> {
    let [vertex, face] = least.map(u128::from);
    // The last number of a text needs no blank after it.
    if u128::from(vertices) * vertex + u128::from(faces) * face > u128::from(left) + 1 {
        let counts = format!("{} and {}", counted(vertices, "vertex"), counted(faces, "face"));
        let problem = format!("the header counts {counts}, but only {left} bytes follow it");
        return Err(ReadError::new(Format::Off, place, problem));
    }
    Ok(())
}
