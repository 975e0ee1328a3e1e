//! Minimizing a contradiction: fewer faces, simpler coordinates.
//!
//! After Andreas Zeller and Ralf Hildebrandt, "Simplifying and isolating failure-inducing input", TSE 2002.

use super::repro::Repro;
use super::round::Seam;
use crate::geom::Light;
use crate::mesh::Mesh;

/// The most queries that a search makes.
const MOST_ASKED: usize = 4000;

/// Drops faces and collapses edges while the methods still contradict each other, then drops vertices that no
/// face uses, then digits of coordinates.
///
/// A query on which the methods agree is returned unchanged.
pub(super) fn minimize(case: &Repro, seam: Seam) -> Repro {
    let mut search = Search { case: case.clone(), seam, left: MOST_ASKED };
    if search.case.judge_with(seam).agrees {
        return search.case;
    }
    while search.drop_faces() || search.merge_vertices() {}
    search.drop_vertices();
    while search.simplify() {}
    search.case
}

struct Search {
    case: Repro,
    seam: Seam,
    left: usize,
}

impl Search {
    /// Replaces the case by a simpler one if the methods contradict each other there too.
    fn attempt(&mut self, case: Option<Repro>) -> bool {
        let Some(case) = case.filter(|_| self.left > 0) else { return false };
        self.left -= 1;
        let disagrees = !case.judge_with(self.seam).agrees;
        if disagrees {
            self.case = case;
        }
        disagrees
    }

    /// Drops runs of faces: half of them at once, then a quarter, at last one by one.
    fn drop_faces(&mut self) -> bool {
        let mut dropped = false;
        let mut run = self.case.mesh.face_count().div_ceil(2);
        while run > 0 {
            for start in (0..self.case.mesh.face_count()).step_by(run).rev() {
                let mut triangles = self.case.mesh.triangles().to_vec();
                triangles.drain(start..triangles.len().min(start + run));
                let case = self.with_mesh(self.case.mesh.positions().to_vec(), triangles);
                dropped |= self.attempt(case);
            }
            run /= 2;
        }
        dropped
    }

    /// Collapses edges, which keeps a closed mesh closed: two vertices become one, and faces that have both
    /// go.
    fn merge_vertices(&mut self) -> bool {
        let mut merged = false;
        for vertex in (1..self.case.mesh.vertex_count() as u32).rev() {
            let is_used = self.case.mesh.triangles().as_flattened().contains(&vertex);
            merged |= is_used
                && (0..vertex).any(|other| {
                    let rename = |v: u32| if v == vertex { other } else { v };
                    let mut triangles: Vec<[u32; 3]> =
                        self.case.mesh.triangles().iter().map(|face| face.map(rename)).collect();
                    triangles.retain(|[a, b, c]| a != b && b != c && c != a);
                    let case = self.with_mesh(self.case.mesh.positions().to_vec(), triangles);
                    self.attempt(case)
                });
        }
        merged
    }

    fn drop_vertices(&mut self) {
        let mesh = &self.case.mesh;
        let mut new = vec![None; mesh.vertex_count()];
        let mut positions = Vec::new();
        let used = |vertex: usize| mesh.triangles().iter().flatten().any(|&v| v as usize == vertex);
        for vertex in (0..mesh.vertex_count()).filter(|&vertex| used(vertex)) {
            new[vertex] = Some(positions.len() as u32);
            positions.push(mesh.positions()[vertex]);
        }
        let renumber = |vertex: u32| new[vertex as usize].expect("used by a face");
        let triangles = mesh.triangles().iter().map(|face| face.map(renumber)).collect();
        let case = self.with_mesh(positions, triangles);
        self.attempt(case);
    }

    /// Every coordinate in turn: 0, then an integer, then fewer and fewer bits left out.
    fn simplify(&mut self) -> bool {
        let mut simplified = false;
        for vertex in 0..self.case.mesh.vertex_count() {
            for axis in 0..3 {
                for simpler in simpler(self.case.mesh.positions()[vertex][axis]) {
                    let mut positions = self.case.mesh.positions().to_vec();
                    positions[vertex][axis] = simpler;
                    let case = self.with_mesh(positions, self.case.mesh.triangles().to_vec());
                    if self.attempt(case) {
                        simplified = true;
                        break;
                    }
                }
            }
        }
        for axis in 0..3 {
            for simpler in simpler(self.case.light.xyz()[axis]) {
                let mut xyz = self.case.light.xyz();
                xyz[axis] = simpler;
                let light = if self.case.light.is_directional() {
                    Light::directional(xyz.map(|x| 0.0 - x))
                } else {
                    Light::point(xyz)
                };
                if self.attempt(light.ok().map(|light| Repro { light, ..self.case.clone() })) {
                    simplified = true;
                    break;
                }
            }
            for simpler in simpler(self.case.point[axis]) {
                let mut point = self.case.point;
                point[axis] = simpler;
                if self.attempt(Some(Repro { point, ..self.case.clone() })) {
                    simplified = true;
                    break;
                }
            }
        }
        simplified
    }

    fn with_mesh(&self, positions: Vec<[f32; 3]>, triangles: Vec<[u32; 3]>) -> Option<Repro> {
        Some(Repro { mesh: Mesh::new(positions, triangles).ok()?, ..self.case.clone() })
    }
}

/// Simpler numbers than `x`, the simplest first.
fn simpler(x: f32) -> Vec<f32> {
    let keep = |bits: u32| f32::from_bits(x.to_bits() & (u32::MAX << (23 - bits)));
    let mut numbers = vec![0.0, x.round(), keep(0), keep(4), keep(8), keep(12), keep(16)];
    numbers.iter_mut().for_each(|x| *x += 0.0); // not −0
    // Each has fewer bits than `x`, so this comes to an end.
    numbers.retain(|simpler| simpler.to_bits().trailing_zeros() > x.to_bits().trailing_zeros());
    numbers
}
