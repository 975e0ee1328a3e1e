//! Quake II model (MD2, version 8): triangles and the frames of an animation.
//!
//! Frame 0 is the mesh, all later ones its further frames. A position is byte · scale + translate, in `f32`,
//! and stays as stored: right-handed, z up. MD2 winds clockwise; faces are turned to counter-clockwise.
//! Skins, texture coordinates, normals and OpenGL commands are skipped.

use std::io::{BufRead, Read, Seek};

use super::text::{counted, unreadable};
use super::{Format, Place, ReadError, Source, refused};
use crate::mesh::Mesh;
use crate::scene::Scene;

/// Bytes of the header: 17 numbers of four bytes.
const HEADER: u64 = 68;
/// Bytes of a frame before its vertices: scale, translate, name.
const FRAME_HEADER: u64 = 40;
/// Bytes of a vertex: three coordinates and a normal.
const VERTEX: u64 = 4;
/// Bytes of a triangle: three vertices and three texture coordinates, 16 bits each.
const TRIANGLE: u64 = 12;

pub(super) fn read<R: BufRead + Seek>(source: Source<R>) -> Result<Scene, ReadError> {
    let mut bytes = Vec::new();
    source
        .reader
        .take(source.len)
        .read_to_end(&mut bytes)
        .map_err(|error| unreadable(Format::Md2, Place::File, &error))?;
    let error = |place, problem: String| ReadError::new(Format::Md2, Place::Byte(place), problem);
    let len = bytes.len() as u64;
    if len < HEADER {
        let problem = format!("an MD2 header has {HEADER} bytes, but the file has {len}");
        return Err(ReadError::new(Format::Md2, Place::File, problem));
    }
    if !bytes.starts_with(b"IDP2") {
        return Err(error(0, "an MD2 file begins with IDP2, this one does not".to_owned()));
    }
    let header = |field: u64| u64::from(u32::from_le_bytes(array(&bytes, 4 * field)));
    if header(1) != 8 {
        let problem = format!("MD2 version {} is not known, only version 8 is", header(1));
        return Err(error(4, problem).remedy("export the file as a Quake II model"));
    }
    let (frame_bytes, vertex_count, triangle_count, frame_count) =
        (header(4), header(6), header(8), header(10));
    let (triangles_at, frames_at, end) = (header(13), header(14), header(16));
    if end > len {
        return Err(error(64, format!("the header says that the file has {end} bytes, but it has {len}")));
    }
    if frame_count == 0 {
        return Err(error(40, "the file has no frame, and so no positions".to_owned()));
    }
    if frame_bytes < FRAME_HEADER + VERTEX * vertex_count {
        let vertices = counted(vertex_count, "vertex");
        return Err(error(16, format!("a frame of {frame_bytes} bytes cannot hold {vertices}")));
    }
    // Each factor is below 2³², so the product fits; the frame is at least 40 bytes, so the count is bounded.
    let holds = |at: u64, count: u64, size: u64| (count * size).checked_add(at).is_some_and(|end| end <= len);
    if !holds(triangles_at, triangle_count, TRIANGLE) {
        let triangles = counted(triangle_count, "triangle");
        return Err(error(
            32,
            format!("{triangles} from byte {triangles_at} do not fit a file of {len} bytes"),
        ));
    }
    if !holds(frames_at, frame_count, frame_bytes) {
        let frames = counted(frame_count, "frame");
        let problem =
            format!("{frames} of {frame_bytes} bytes from byte {frames_at} do not fit a file of {len} bytes");
        return Err(error(40, problem));
    }

    let mut triangles = Vec::with_capacity(triangle_count as usize);
    for at in (0..triangle_count).map(|triangle| triangles_at + TRIANGLE * triangle) {
        let [a, b, c] = [0, 2, 4].map(|corner| u32::from(u16::from_le_bytes(array(&bytes, at + corner))));
        if let Some(bad) = [a, b, c].into_iter().find(|&vertex| u64::from(vertex) >= vertex_count) {
            let (face, vertices) = (triangles.len(), counted(vertex_count, "vertex"));
            return Err(error(
                at,
                format!("triangle {face} names vertex {bad}, but the file has {vertices}"),
            ));
        }
        triangles.push([a, c, b]);
    }
    let frame = |frame: u64| -> Result<Vec<[f32; 3]>, ReadError> {
        let at = frames_at + frame_bytes * frame;
        let number = |field: u64| f32::from_le_bytes(array(&bytes, at + 4 * field));
        let (scale, translate) = ([0, 1, 2].map(number), [3, 4, 5].map(number));
        let vertices = &bytes[(at + FRAME_HEADER) as usize..][..(VERTEX * vertex_count) as usize];
        let positions: Vec<[f32; 3]> = vertices
            .chunks_exact(VERTEX as usize)
            .map(|vertex| std::array::from_fn(|axis| f32::from(vertex[axis]) * scale[axis] + translate[axis]))
            .collect();
        match positions.iter().position(|position| !position.iter().all(|value| value.is_finite())) {
            None => Ok(positions),
            Some(vertex) => {
                let problem =
                    format!("frame {frame} gives vertex {vertex} a coordinate that is not a finite number");
                Err(error(at, problem))
            }
        }
    };
    let refused = |error| refused(Format::Md2, &error);
    let mesh = Mesh::new(frame(0)?, triangles).map_err(refused)?;
    let frames = (1..frame_count).map(frame).collect::<Result<Vec<_>, _>>()?;
    Ok(Scene::of(mesh.with_frames(frames).map_err(refused)?))
}

/// The `N` bytes from `at` on, which the caller has checked to exist.
fn array<const N: usize>(bytes: &[u8], at: u64) -> [u8; N] {
    std::array::from_fn(|byte| bytes[at as usize + byte])
}
