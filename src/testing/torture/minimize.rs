//! A case with as little in it as still disagrees.

use super::repro::Case;
use super::round::Seam;
use crate::geom::Light;
use crate::mesh::Mesh;

/// How often the judges are asked at most.
const MOST_ASKED: usize = 4000;

/// Drops faces while the judges still disagree, then vertices that no face uses, then digits of coordinates.
///
/// A case on which the judges agree comes back as it is.
pub(super) fn minimize(case: &Case, seam: Seam) -> Case {
    let mut search = Search { case: case.clone(), seam, left: MOST_ASKED };
    if search.case.judge_with(seam).agrees {
        return search.case;
    }
    while search.drop_faces() {}
    search.drop_vertices();
    while search.simplify() {}
    search.case
}

struct Search {
    case: Case,
    seam: Seam,
    left: usize,
}

impl Search {
    /// Takes a simpler case over if the judges disagree about it too.
    fn attempt(&mut self, case: Option<Case>) -> bool {
        let Some(case) = case.filter(|_| self.left > 0) else { return false };
        self.left -= 1;
        let disagrees = !case.judge_with(self.seam).agrees;
        if disagrees {
            self.case = case;
        }
        disagrees
    }

    fn drop_faces(&mut self) -> bool {
        let mut dropped = false;
        for face in (0..self.case.mesh.face_count()).rev() {
            let mut triangles = self.case.mesh.triangles().to_vec();
            triangles.remove(face);
            let case = self.with_mesh(self.case.mesh.positions().to_vec(), triangles);
            dropped |= self.attempt(case);
        }
        dropped
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

    /// Every coordinate in turn: 0, then whole, then with fewer and fewer bits left out.
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
                if self.attempt(light.ok().map(|light| Case { light, ..self.case.clone() })) {
                    simplified = true;
                    break;
                }
            }
            for simpler in simpler(self.case.point[axis]) {
                let mut point = self.case.point;
                point[axis] = simpler;
                if self.attempt(Some(Case { point, ..self.case.clone() })) {
                    simplified = true;
                    break;
                }
            }
        }
        simplified
    }

    fn with_mesh(&self, positions: Vec<[f32; 3]>, triangles: Vec<[u32; 3]>) -> Option<Case> {
        Some(Case { mesh: Mesh::new(positions, triangles).ok()?, ..self.case.clone() })
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
