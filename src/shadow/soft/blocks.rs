//! Adaptive sampling: every B-th sample along rows and columns is computed, and blocks that agree are
//! interpolated.
//!
//! A block agrees where all its samples are of one shell of one mesh and all blocked, or all open. What is
//! lost are penumbrae that lie within a block without a hard shadow.

use super::light_map::LightMap;
use crate::caster::Caster;
use crate::mesh::FaceId;
use crate::oracle::PrimaryHit;
use crate::shadow::{Answer, Samples, is_front_lit};

/// What the samples of a block have to agree in: mesh, shell, and whether the own texel blocks.
pub(super) type Id = (usize, Option<u32>, bool);

#[derive(Debug)]
pub(super) struct Blocks {
    block: usize,
    row_len: usize,
    rows: usize,
    /// Per sample; `None` where nothing is asked.
    ids: Vec<Option<Id>>,
    /// At the corners of blocks.
    corners: Vec<Option<Answer>>,
}

impl Blocks {
    /// Computes the corners of all blocks of `block` samples a side.
    pub(super) fn of(
        map: &LightMap<'_>,
        samples: &Samples,
        block: usize,
        answer: impl Fn(&PrimaryHit) -> Answer + Sync,
    ) -> Self {
        let mut ids = vec![None; samples.len()];
        crate::parallel::rows(&mut ids, samples.row_len(), |row, ids| {
            for (id, hit) in ids.iter_mut().zip(samples.row(row)) {
                *id = hit.as_ref().and_then(|hit| id_of(map, hit));
            }
        });
        let row_len = samples.row_len();
        let rows = samples.len() / row_len.max(1);
        let mut blocks = Self { block: block.max(1), row_len, rows, ids, corners: Vec::new() };
        let mut corners = vec![None; samples.len()];
        crate::parallel::rows(&mut corners, row_len, |y, row| {
            for (x, (corner, hit)) in row.iter_mut().zip(samples.row(y)).enumerate() {
                if blocks.is_corner(x, row_len)
                    && blocks.is_corner(y, rows)
                    && blocks.ids[y * row_len + x].is_some()
                {
                    *corner = hit.as_ref().map(&answer);
                }
            }
        });
        blocks.corners = corners;
        blocks
    }

    fn is_corner(&self, x: usize, len: usize) -> bool {
        x.is_multiple_of(self.block) || x + 1 == len
    }

    /// The answer that is known without asking: at a corner, and where a block agrees. Interpolated answers
    /// have read the one texel that told whether they agree.
    pub(super) fn answer(&self, index: usize) -> Option<Answer> {
        if let Some(corner) = self.corners[index] {
            return Some(corner);
        }
        let ends = |x: usize, len: usize| {
            let first = x / self.block * self.block;
            // The last block ends with the row.
            [first, (first + self.block).min(len - 1)]
        };
        let (x, y) = (index % self.row_len, index / self.row_len);
        let ([left, right], [top, bottom]) = (ends(x, self.row_len), ends(y, self.rows));
        let id = self.ids[index];
        for row in top..=bottom {
            if self.ids[row * self.row_len..][left..=right].iter().any(|&other| other != id) {
                return None;
            }
        }
        let corner = |x: usize, y: usize| Some(f64::from(self.corners[y * self.row_len + x]?.value));
        let part = |x: usize, [low, high]: [usize; 2]| match high - low {
            0 => 0.0,
            length => (x - low) as f64 / length as f64,
        };
        let (u, v) = (part(x, [left, right]), part(y, [top, bottom]));
        let mix = |a: f64, b: f64, t: f64| a + (b - a) * t;
        let upper = mix(corner(left, top)?, corner(right, top)?, u);
        let lower = mix(corner(left, bottom)?, corner(right, bottom)?, u);
        Some(Answer { reads: 1, ..Answer::of(mix(upper, lower, v) as f32) })
    }

    /// The sabotage of the tests: blocks agree wherever all is asked.
    #[cfg(test)]
    pub(super) fn forget_ids(&mut self) {
        self.ids.iter_mut().flatten().for_each(|id| *id = (0, None, false));
    }
}

/// `None` where the sample is not asked, and where the map has no answer.
fn id_of(map: &LightMap<'_>, hit: &PrimaryHit) -> Option<Id> {
    if !is_front_lit(hit, map.lamp.light()) {
        return None;
    }
    let (_, is_inner) = map.receiver(hit).filter(|receiver| receiver.is_sound())?.own_texel()?;
    let (mesh, face) = map.casters.seen().mesh_face(hit.face);
    let caster: &Caster = map.casters.seen_caster().unwrap_or_else(|| map.casters.casters()[mesh]);
    Some((mesh, shell(caster, face), is_inner))
}

fn shell(caster: &Caster, face: FaceId) -> Option<u32> {
    caster.shells().of_face[face.index()]
}
