//! The data of the view: meshes, lines, dots and colored faces, as base64 of little-endian numbers.
//!
//! Positions are in units of the view: y is up, and everything lies in a sphere of radius 1 around the
//! origin.

use serde_json::{Value, json};
use umbrage::check::DefectKind;
use umbrage::mesh::Mesh;
use umbrage::view::Up;

use super::coarse::{Coarse, merged};
use super::{OfKind, Page, Row, TRIANGLES, severity};
use crate::cli::Failure;
use crate::cli::check::drawn::color;
use crate::cli::check::json;
use crate::cli::check::report::FileReport;
use crate::cli::output::number32;
use crate::cli::page::base64;

/// Faces of a defect that a row names.
const FACES: usize = 6;

/// What the view leaves out: said on the page.
pub(super) struct Shown {
    pub(super) triangles: usize,
    pub(super) of: usize,
    pub(super) cells: Option<u32>,
}

/// From world space to that of the view.
struct Frame {
    up: Up,
    center: [f64; 3],
    radius: f64,
}

impl Frame {
    /// A frame around all faces. Lines and dots lie at faces.
    fn around(meshes: &[Mesh], up: Up) -> Self {
        let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        for mesh in meshes {
            for corners in mesh.triangles() {
                for &corner in corners {
                    let position = mesh.positions()[corner as usize];
                    for axis in 0..3 {
                        low[axis] = low[axis].min(f64::from(position[axis]));
                        high[axis] = high[axis].max(f64::from(position[axis]));
                    }
                }
            }
        }
        if low[0] > high[0] {
            return Self { up, center: [0.0; 3], radius: 1.0 };
        }
        let center = [0, 1, 2].map(|axis| 0.5 * (low[axis] + high[axis]));
        let radius = 0.5 * [0, 1, 2].map(|axis| (high[axis] - low[axis]).powi(2)).iter().sum::<f64>().sqrt();
        Self { up, center, radius: if radius > 0.0 { radius } else { 1.0 } }
    }

    fn position(&self, point: [f64; 3]) -> [f32; 3] {
        let scaled = [0, 1, 2].map(|axis| (point[axis] - self.center[axis]) / self.radius);
        self.direction(scaled).map(|x| x as f32)
    }

    /// Right, up and back; the inverse of [`Up::turn`].
    fn direction(&self, [x, y, z]: [f64; 3]) -> [f64; 3] {
        match self.up {
            Up::Y => [x, y, z],
            Up::Z => [x, z, -y],
        }
    }

    fn points<'a>(&self, points: impl Iterator<Item = &'a [f32; 3]>) -> Vec<[f32; 3]> {
        points.map(|point| self.position(point.map(f64::from))).collect()
    }
}

/// The data of the page, and what the view leaves out.
pub(super) fn data(page: &Page, report: &FileReport, up: Up) -> Result<(Value, Shown), Failure> {
    let meshes = &page.sketch.meshes;
    let frame = Frame::around(meshes, up);
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    for mesh in meshes {
        let Ok(base) = u32::try_from(positions.len()) else {
            let problem = "the meshes have more vertices than 32-bit indices can name";
            return Err(Failure::new(problem, "leave out --html, or choose meshes with --only"));
        };
        positions.extend(frame.points(mesh.positions().iter()));
        triangles.extend(mesh.triangles().iter().map(|corners| corners.map(|corner| base + corner)));
    }
    let coarse = Coarse::of(&positions, &triangles, TRIANGLES);
    let shown = Shown { triangles: coarse.triangles.len(), of: triangles.len(), cells: coarse.cells };
    // Only what is drawn travels.
    let mut used = Used { number: vec![u32::MAX; positions.len()], positions: Vec::new() };
    let indices = used.indices(&coarse.triangles, &positions);
    let found = page.found();
    let kinds: Vec<Value> = found
        .iter()
        .map(|&(kind, of_kind)| {
            let mut faces = of_kind.faces.clone();
            faces.sort_unstable();
            faces.dedup();
            let colored = faces.iter().map(|&face| &triangles[face as usize]);
            let colored = merged(colored, &coarse.stand_in);
            of_one(kind, of_kind, &frame, &used.indices(&colored, &positions))
        })
        .collect();
    let rows = found.iter().flat_map(|&(kind, of_kind)| of_kind.rows.iter().map(move |row| (kind, row)));
    let defects: Vec<Value> = rows.map(|(kind, row)| defect(kind, row, report, &frame)).collect();
    let data = json!({
        "file": report.file.to_string_lossy(),
        "verdict": report.verdict().name(),
        "triangles": { "drawn": shown.triangles, "all": shown.of, "cells": shown.cells },
        "positions": base64(bytes(used.positions.as_flattened()).as_slice()),
        "indices": indices,
        "kinds": kinds,
        "defects": defects,
    });
    Ok((data, shown))
}

/// Vertices that are drawn, numbered in the order of their first use.
struct Used {
    number: Vec<u32>,
    positions: Vec<[f32; 3]>,
}

impl Used {
    fn indices(&mut self, triangles: &[[u32; 3]], positions: &[[f32; 3]]) -> String {
        let mut bytes = Vec::with_capacity(12 * triangles.len());
        for &corner in triangles.as_flattened() {
            let number = &mut self.number[corner as usize];
            if *number == u32::MAX {
                *number = self.positions.len() as u32; // at most three for each of the triangles drawn
                self.positions.push(positions[corner as usize]);
            }
            bytes.extend(number.to_le_bytes());
        }
        base64(&bytes)
    }
}

fn bytes(numbers: &[f32]) -> Vec<u8> {
    numbers.iter().flat_map(|number| number.to_le_bytes()).collect()
}

fn of_one(kind: DefectKind, of_kind: &OfKind, frame: &Frame, faces: &str) -> Value {
    let lines = frame.points(of_kind.lines.items().iter().flatten());
    let spots = frame.points(of_kind.spots.items().iter());
    json!({
        "kind": kind.name(),
        "code": kind.code(),
        "severity": severity(kind),
        "color": color(kind).1,
        "count": of_kind.complete.then_some(of_kind.count),
        "at_least": (!of_kind.complete).then_some(of_kind.count),
        "effect": kind.effect(),
        "listed": of_kind.rows.len(),
        "lines": { "drawn": of_kind.lines.items().len(), "all": of_kind.line_count, "ends": base64(&bytes(lines.as_flattened())) },
        "spots": { "drawn": of_kind.spots.items().len(), "all": of_kind.spot_count, "at": base64(&bytes(spots.as_flattened())) },
        "faces": faces,
    })
}

fn defect(kind: DefectKind, row: &Row, report: &FileReport, frame: &Frame) -> Value {
    let mut entry = json::place(&row.place);
    let object = entry.as_object_mut().expect("a place is an object");
    for key in ["faces", "origins"] {
        object[key].as_array_mut().expect("both are lists").truncate(FACES);
    }
    object.insert("face_count".into(), row.place.face_count.into());
    object.insert("length".into(), row.place.length.into());
    object.insert("kind".into(), kind.name().into());
    object.insert("mesh".into(), report.meshes[row.mesh].name.as_str().into());
    let normal = frame.direction(row.normal);
    let length = normal.iter().map(|x| x * x).sum::<f64>().sqrt();
    // Less than a tenth of a face: the faces cancel, and no side is the outer one.
    let normal = (length > 0.1).then(|| normal.map(|x| (x / length * 1000.0).round() / 1000.0));
    object.insert(
        "view".into(),
        json!({
            "at": frame.position(row.target).map(number32),
            "reach": number32((row.reach / frame.radius) as f32),
            "normal": normal,
            "lines": row.lines,
        }),
    );
    entry
}
